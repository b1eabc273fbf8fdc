//! Curves of special cycles as plain data.

use super::curve::Inspection;
use crate::branch::{Label, LabelCounter, SpecialKind};
use crate::continuation::{Followed, Origin, Solution, Stop};
use crate::cycle::Orbit;
use num_complex::Complex64;
use serde::{Deserialize, Serialize};
use std::borrow::Cow;

/// A cycle on a curve of special cycles.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct CycleLocusPoint {
    /// Values of the two parameters that vary.
    pub values: [f64; 2],
    /// Period.
    pub period: f64,
    /// Largest value of each state.
    pub max: Vec<f64>,
    /// Smallest value of each state.
    pub min: Vec<f64>,
    /// Floquet multipliers, largest modulus first, the trivial one among them.
    pub multipliers: Vec<Complex64>,
    /// Distance of the computed trivial multiplier from 1.
    pub trivial_multiplier_error: f64,
    /// Error estimate of cycle and eigenfunctions relative to their sizes.
    pub error_estimate: f64,
    /// Argument of the multipliers of a torus bifurcation.
    pub argument: Option<f64>,
    /// Coefficient of the normal form, with the integral of the eigenfunction's square over the unit interval equal to one: of
    /// a fold the quadratic one, with the null function orthogonal to the flow in the mean and its sign such that the
    /// coefficient is positive where the curve starts; of a period doubling the cubic one; of a torus bifurcation the real part
    /// of the cubic one. `None` where it does not exist: at resonances where it has a pole.
    pub coefficient: Option<f64>,
    /// Label of a point of codimension two or of a value asked for.
    pub label: Option<Label>,
    /// Error estimates of the parameters at a point of codimension two.
    pub location_error: Option<[f64; 2]>,
    /// Values of the test functions by the label of the point at which each changes sign.
    pub tests: Vec<(Cow<'static, str>, f64)>,
    /// The cycle itself.
    pub orbit: Orbit,
}

/// A change of sign of a test function behind which no point of codimension two could be located.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct UnlocatedChange {
    /// What lies where the test function vanishes.
    pub kind: SpecialKind,
    /// Values of the two parameters between which it changed.
    pub between: [[f64; 2]; 2],
}

/// A curve of special cycles in two parameters.
#[derive(Debug)]
pub struct CycleLocusBranch {
    /// What the curve consists of: folds, period doublings or torus bifurcations of cycles.
    pub kind: SpecialKind,
    /// Indices of the two parameters that vary.
    pub active: [usize; 2],
    /// The points in the order of the curve.
    pub points: Vec<CycleLocusPoint>,
    /// What was detected but not located.
    pub unlocated: Vec<UnlocatedChange>,
    /// Why the curve ends at its first point.
    pub backward_stop: Stop,
    /// Why the curve ends at its last point.
    pub forward_stop: Stop,
}

impl CycleLocusBranch {
    pub(super) fn assemble(
        kind: SpecialKind,
        active: [usize; 2],
        degree: usize,
        [mut backward, forward]: [Followed<Inspection>; 2],
        unlocated: Vec<UnlocatedChange>,
    ) -> Self {
        if !backward.solutions.is_empty() {
            backward.solutions.remove(0);
        }
        backward.solutions.reverse();
        let solutions = backward.solutions.into_iter().chain(forward.solutions);
        let mut labels = LabelCounter::default();
        let points = solutions
            .map(|(solution, origin)| {
                let kind = match (solution.point.special, origin) {
                    (Some((kind, _)), _) => Some(kind),
                    (None, Origin::Requested) => Some(SpecialKind::Requested),
                    _ => None,
                };
                let label = kind.map(|kind| labels.next(kind));
                CycleLocusPoint::new(solution, degree, label)
            })
            .collect();
        Self { kind, active, points, unlocated, backward_stop: backward.stop, forward_stop: forward.stop }
    }

    /// Adds the points in which the curve ends.
    pub(super) fn extend(&mut self, first: Option<CycleLocusPoint>, last: Option<CycleLocusPoint>) {
        if let Some(point) = first {
            self.points.insert(0, point);
        }
        self.points.extend(last);
        // Ends are labelled by the curve on which they were located: counted anew along this one.
        let mut labels = LabelCounter::default();
        for label in self.points.iter_mut().filter_map(|point| point.label.as_mut()) {
            *label = labels.next(label.kind);
        }
    }

    /// Points of codimension two in the order of the curve.
    pub fn special_points(&self) -> impl Iterator<Item = (SpecialKind, &CycleLocusPoint)> {
        self.points.iter().filter_map(|point| match point.label {
            Some(label) if label.kind != SpecialKind::Requested => Some((label.kind, point)),
            _ => None,
        })
    }
}

impl CycleLocusPoint {
    fn new(solution: Solution<Inspection>, degree: usize, label: Option<Label>) -> Self {
        let Inspection {
            error_estimate, floquet, ranges, mesh, tests, coefficient, argument, special, ..
        } = solution.point;
        let n = ranges.len();
        let nodes = (mesh.len() - 1) * (degree + 1);
        let length = solution.unknown.len();
        // Every node holds the state and behind it the eigenfunctions.
        let width = (length - 3) / nodes;
        let states = solution
            .unknown
            .chunks_exact(width)
            .take(nodes)
            .flat_map(|node| node[..n].iter().copied())
            .collect();
        let period = solution.unknown[nodes * width];
        Self {
            values: [solution.unknown[length - 2], solution.unknown[length - 1]],
            period,
            max: ranges.iter().map(|range| range.largest).collect(),
            min: ranges.iter().map(|range| range.smallest).collect(),
            multipliers: floquet.multipliers(),
            trivial_multiplier_error: floquet.trivial_error,
            error_estimate,
            argument,
            coefficient,
            label,
            location_error: special.map(|(_, error)| error),
            tests: tests.iter().map(|(kind, value)| (kind.label().into(), *value)).collect(),
            orbit: Orbit { mesh, degree, dimension: n, states, period },
        }
    }
}
