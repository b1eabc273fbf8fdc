//! Branches of equilibria as plain data.

use super::branch_point::BranchPoint;
use super::curve::{Inspection, reversed};
use super::departure;
use super::fold::FoldPoint;
use super::hopf::HopfPoint;
use super::special::SpecialPoint;
use crate::branch::{Label, LabelCounter, SpecialKind, Stability};
use crate::continuation::{Origin, Solution, Stop};
use crate::erased::ErasedField;
use crate::field::VectorField;
use num_complex::Complex64;
use serde::{Deserialize, Serialize};
use std::borrow::Cow;

/// An equilibrium on a branch.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct EquilibriumPoint {
    /// Value of the parameter that varies.
    pub parameter: f64,
    /// The equilibrium.
    pub state: Vec<f64>,
    /// Eigenvalues by descending real part.
    pub eigenvalues: Vec<Complex64>,
    /// Stability.
    pub stability: Stability,
    /// Label of a special or requested point.
    pub label: Option<Label>,
    /// Values of the test functions by the label of the special point at which each changes sign.
    pub tests: Vec<(Cow<'static, str>, f64)>,
    /// Normal form of a special point.
    pub special: Option<Box<SpecialPoint>>,
}

/// A branch of equilibria of one parameter, in the order of the curve.
#[derive(Debug)]
pub struct EquilibriumBranch {
    /// Names of the states.
    pub state_names: Vec<String>,
    /// Names of the parameters.
    pub parameter_names: Vec<String>,
    /// Values of all parameters; that of the varying one is where the branch started.
    pub parameters: Vec<f64>,
    /// Index of the parameter that varies.
    pub active: usize,
    /// The equilibria.
    pub points: Vec<EquilibriumPoint>,
    /// Index of the point at which the branch was started.
    pub start: usize,
    /// Why the branch ends at its first point.
    pub backward_stop: Stop,
    /// Why the branch ends at its last point.
    pub forward_stop: Stop,
}

/// What was found in one direction from the start.
pub(super) struct BranchDirection {
    pub solutions: Vec<(Solution<Inspection>, Origin)>,
    pub stop: Stop,
}

/// What lies between the two directions.
pub(super) struct BetweenDirections<'a> {
    /// The branch point from which both leave.
    pub middle: Option<(Solution<Inspection>, Origin)>,
    /// Special points at the start and close to it.
    pub special: Vec<Solution<Inspection>>,
    /// Sizes of the unknowns.
    pub scales: &'a [f64],
}

impl EquilibriumBranch {
    pub(super) fn assemble(
        field: ErasedField<'_>,
        active: usize,
        parameters: Vec<f64>,
        requested: &[f64],
        directions: [BranchDirection; 2],
        between: BetweenDirections<'_>,
    ) -> Self {
        let BetweenDirections { middle, special, scales } = between;
        let [backward, forward] = directions;
        let mut solutions = backward.solutions;
        // Both directions begin with the start.
        let repeated = middle.is_none() && !forward.solutions.is_empty() && !solutions.is_empty();
        if repeated {
            solutions.remove(0);
        }
        solutions.reverse();
        solutions = solutions.into_iter().map(|(solution, origin)| (reversed(solution), origin)).collect();
        let start = if repeated || middle.is_some() || solutions.is_empty() {
            solutions.len()
        } else {
            solutions.len() - 1
        };
        solutions.extend(middle);
        solutions.extend(forward.solutions);
        let start = departure::insert(&mut solutions, start, special, scales);
        // Values asked for at the start or at an end of the range are there already.
        for (solution, origin) in &mut solutions {
            let value = solution.unknown.last();
            if solution.point.special.is_none() && value.is_some_and(|value| requested.contains(value)) {
                *origin = Origin::Requested;
            }
        }
        solutions.dedup_by(|next, previous| {
            next.1 == Origin::Requested
                && previous.1 == Origin::Requested
                && next.0.unknown.last() == previous.0.unknown.last()
        });
        let mut labels = LabelCounter::default();
        let points = solutions
            .into_iter()
            .map(|(solution, origin)| {
                let kind = match (&solution.point.special, origin) {
                    (Some(special), _) => Some(special.kind()),
                    (None, Origin::Requested) => Some(SpecialKind::Requested),
                    _ => None,
                };
                let label = kind.map(|kind| labels.next(kind));
                EquilibriumPoint::new(solution, label)
            })
            .collect();
        Self {
            state_names: field.state_names(),
            parameter_names: field.parameter_names(),
            parameters,
            active,
            points,
            start,
            backward_stop: backward.stop,
            forward_stop: forward.stop,
        }
    }

    /// All parameters at a point of the branch.
    pub fn parameters_at(&self, point: &EquilibriumPoint) -> Vec<f64> {
        let mut parameters = self.parameters.clone();
        if let Some(value) = parameters.get_mut(self.active) {
            *value = point.parameter;
        }
        parameters
    }

    /// Special points in the order of the branch.
    pub fn special_points(&self) -> impl Iterator<Item = &SpecialPoint> {
        self.points.iter().filter_map(|point| point.special.as_deref())
    }

    /// Folds in the order of the branch.
    pub fn folds(&self) -> impl Iterator<Item = &FoldPoint> {
        self.special_points().filter_map(|special| match special {
            SpecialPoint::Fold(point) => Some(point),
            _ => None,
        })
    }

    /// Hopf points in the order of the branch.
    pub fn hopf_points(&self) -> impl Iterator<Item = &HopfPoint> {
        self.special_points().filter_map(|special| match special {
            SpecialPoint::Hopf(point) => Some(point),
            _ => None,
        })
    }

    /// Branch points in the order of the branch.
    pub fn branch_points(&self) -> impl Iterator<Item = &BranchPoint> {
        self.special_points().filter_map(|special| match special {
            SpecialPoint::BranchPoint(point) => Some(point),
            _ => None,
        })
    }

    /// The point with a label.
    pub fn labelled(&self, label: Label) -> Option<&EquilibriumPoint> {
        self.points.iter().find(|point| point.label == Some(label))
    }
}

impl EquilibriumPoint {
    fn new(solution: Solution<Inspection>, label: Option<Label>) -> Self {
        let Inspection { spectrum, tests, special, .. } = solution.point;
        let mut state = solution.unknown;
        let parameter = state.pop().unwrap_or_default();
        Self {
            parameter,
            state,
            stability: spectrum.stability,
            eigenvalues: spectrum.eigenvalues,
            label,
            tests: vec![
                ("LP".into(), tests.fold),
                ("BP".into(), tests.branch_point),
                ("HB".into(), tests.hopf),
            ],
            special,
        }
    }
}
