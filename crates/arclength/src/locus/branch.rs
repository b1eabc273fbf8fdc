//! Curves of special equilibria as plain data.

use super::codimension_two::CodimensionTwoPoint;
use super::curve::Inspection;
use crate::branch::{Label, LabelCounter, SpecialKind};
use crate::continuation::{Followed, Origin, Solution, Stop};
use crate::erased::ErasedField;
use crate::field::VectorField;
use num_complex::Complex64;
use serde::{Deserialize, Serialize};
use std::borrow::Cow;

/// A point on a curve of special equilibria.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct LocusPoint {
    /// Values of the two parameters that vary.
    pub values: [f64; 2],
    /// The equilibrium.
    pub state: Vec<f64>,
    /// Eigenvalues by descending real part.
    pub eigenvalues: Vec<Complex64>,
    /// On a curve of Hopf points the angular frequency; `None` where the curve consists of neutral saddles.
    pub frequency: Option<f64>,
    /// First Lyapunov coefficient (Kuznetsov's scaling) of a Hopf point.
    pub first_lyapunov: Option<f64>,
    /// Label of a point of codimension two or of a value asked for.
    pub label: Option<Label>,
    /// Values of the test functions by the label of the point at which each changes sign.
    pub tests: Vec<(Cow<'static, str>, f64)>,
    /// What is known about a point of codimension two.
    pub special: Option<Box<CodimensionTwoPoint>>,
}

/// A curve of special equilibria in two parameters.
#[derive(Debug)]
pub struct EquilibriumLocusBranch {
    /// What the curve consists of.
    pub kind: SpecialKind,
    /// Names of the states.
    pub state_names: Vec<String>,
    /// Names of the parameters.
    pub parameter_names: Vec<String>,
    /// Values of all parameters where the curve was started.
    pub parameters: Vec<f64>,
    /// Indices of the two parameters that vary.
    pub active: [usize; 2],
    /// The points in the order of the curve.
    pub points: Vec<LocusPoint>,
    /// Why the curve ends at its first point.
    pub backward_stop: Stop,
    /// Why the curve ends at its last point.
    pub forward_stop: Stop,
}

impl EquilibriumLocusBranch {
    pub(super) fn assemble(
        kind: SpecialKind,
        field: ErasedField<'_>,
        parameters: Vec<f64>,
        active: [usize; 2],
        [mut backward, forward]: [Followed<Inspection>; 2],
    ) -> Self {
        if !backward.solutions.is_empty() {
            backward.solutions.remove(0);
        }
        backward.solutions.reverse();
        let mut solutions = backward.solutions;
        solutions.extend(forward.solutions);
        let n = field.dimension();
        let mut labels = LabelCounter::default();
        let points = solutions
            .into_iter()
            .map(|(solution, origin)| {
                let kind = match (&solution.point.special, origin) {
                    (Some(special), _) => Some(special.kind),
                    (None, Origin::Requested) => Some(SpecialKind::Requested),
                    _ => None,
                };
                let label = kind.map(|kind| labels.next(kind));
                LocusPoint::new(solution, n, label)
            })
            .collect();
        Self {
            kind,
            state_names: field.state_names(),
            parameter_names: field.parameter_names(),
            parameters,
            active,
            points,
            backward_stop: backward.stop,
            forward_stop: forward.stop,
        }
    }

    /// All parameters at a point of the curve.
    pub fn parameters_at(&self, point: &LocusPoint) -> Vec<f64> {
        let mut parameters = self.parameters.clone();
        for (&index, value) in self.active.iter().zip(point.values) {
            if let Some(entry) = parameters.get_mut(index) {
                *entry = value;
            }
        }
        parameters
    }

    /// Points of codimension two in the order of the curve.
    pub fn special_points(&self) -> impl Iterator<Item = &CodimensionTwoPoint> {
        self.points.iter().filter_map(|point| point.special.as_deref())
    }

    /// The point with a label.
    pub fn labelled(&self, label: Label) -> Option<&LocusPoint> {
        self.points.iter().find(|point| point.label == Some(label))
    }
}

impl LocusPoint {
    fn new(solution: Solution<Inspection>, dimension: usize, label: Option<Label>) -> Self {
        let Inspection { spectrum, monitor, special } = solution.point;
        let end = solution.unknown.len() - 2;
        Self {
            values: [solution.unknown[end], solution.unknown[end + 1]],
            state: solution.unknown[..dimension].to_vec(),
            eigenvalues: spectrum.eigenvalues,
            frequency: monitor.frequency,
            first_lyapunov: monitor.first_lyapunov,
            label,
            tests: monitor.tests.iter().map(|(kind, value)| (kind.label().into(), *value)).collect(),
            special,
        }
    }
}
