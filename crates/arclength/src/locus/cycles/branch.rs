//! Curves of special cycles as plain data.

use super::curve::CycleLocusInspection;
use super::end::CycleLocusEnd;
use crate::branch::{Branch, Label, LabelCounter, Labelled};
use crate::continuation::Solution;
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
    /// Error of cycle and eigenfunctions relative to their sizes: what the defect of the polynomials does through the linearised
    /// equations.
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
    /// Values of the monitors, in the order in which they were asked for; not a number where one does not exist.
    #[serde(default)]
    pub monitors: Vec<f64>,
    /// The cycle itself.
    pub orbit: Orbit,
}

/// A curve of special cycles in two parameters.
pub type CycleLocusBranch = Branch<CycleLocusPoint, CycleLocusEnd>;

impl Labelled for CycleLocusPoint {
    fn label(&self) -> Option<Label> {
        self.label
    }

    fn values(&self) -> Vec<f64> {
        self.values.to_vec()
    }
}

impl CycleLocusBranch {
    /// Adds the points in which the curve ends.
    pub(super) fn extend(&mut self, first: Option<CycleLocusPoint>, last: Option<CycleLocusPoint>) {
        if let Some(point) = first {
            self.points.insert(0, point);
            self.start += 1;
        }
        self.points.extend(last);
        // Ends are labelled by the curve on which they were located: counted anew along this one.
        let mut labels = LabelCounter::default();
        for label in self.points.iter_mut().filter_map(|point| point.label.as_mut()) {
            *label = labels.next(label.kind);
        }
    }
}

impl CycleLocusPoint {
    /// A solution of the curve as plain data; `degree` is that of the polynomials.
    pub(super) fn new(
        solution: &Solution<CycleLocusInspection>,
        label: Option<Label>,
        degree: usize,
    ) -> Self {
        let CycleLocusInspection {
            error_estimate,
            floquet,
            extremes,
            mesh,
            tests,
            coefficient,
            argument,
            location_error,
            ..
        } = &solution.point;
        let n = extremes.len();
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
            max: extremes.iter().map(|extremes| extremes.largest).collect(),
            min: extremes.iter().map(|extremes| extremes.smallest).collect(),
            multipliers: floquet.multipliers(),
            trivial_multiplier_error: floquet.trivial_error,
            error_estimate: *error_estimate,
            argument: *argument,
            coefficient: *coefficient,
            label,
            location_error: *location_error,
            tests: tests.iter().map(|(kind, value)| (kind.label().into(), *value)).collect(),
            monitors: Vec::new(),
            orbit: Orbit { mesh: mesh.clone(), degree, dimension: n, states, period },
        }
    }
}
