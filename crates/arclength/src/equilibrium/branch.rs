//! Points of a branch of equilibria as plain data.

use super::branch_point::BranchPoint;
use super::curve::{EquilibriumCurve, EquilibriumInspection};
use super::end::EquilibriumEnd;
use super::fold::FoldPoint;
use super::hopf::HopfPoint;
use super::special::SpecialPoint;
use crate::branch::{Branch, Label, Labelled, SpecialKind, Stability};
use crate::continuation::Solution;
use num_complex::Complex64;
use serde::{Deserialize, Serialize};
use std::borrow::Cow;

/// An equilibrium on a branch.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct EquilibriumPoint {
    /// Value of the parameter that varies.
    pub value: f64,
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
    /// Values of the monitors, in the order in which they were asked for; not a number where one does not exist.
    #[serde(default)]
    pub monitors: Vec<f64>,
    /// Normal form of a special point.
    pub special: Option<Box<SpecialPoint>>,
}

/// A branch of equilibria of one parameter, in the order of the curve.
pub type EquilibriumBranch = Branch<EquilibriumPoint, EquilibriumEnd>;

impl Labelled for EquilibriumPoint {
    fn label(&self) -> Option<Label> {
        self.label
    }

    fn values(&self) -> Vec<f64> {
        vec![self.value]
    }
}

impl EquilibriumBranch {
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
}

impl EquilibriumPoint {
    /// A solution of the curve as plain data; `range` is the length of the parameter's range.
    pub(super) fn new(solution: &Solution<EquilibriumInspection>, label: Option<Label>, range: f64) -> Self {
        let EquilibriumInspection { spectrum, determinant, special, .. } = &solution.point;
        let (&value, state) = solution.unknown.split_last().unwrap_or((&0.0, &[]));
        let test = |kind: SpecialKind, value: f64| (Cow::Borrowed(kind.label()), value);
        Self {
            value,
            state: state.to_vec(),
            // An eigenvalue on the axis, however its rounding comes out, decides nothing.
            stability: match special.as_deref() {
                Some(SpecialPoint::Fold(_) | SpecialPoint::BranchPoint(_)) => {
                    spectrum.stability_beside(&[Complex64::ZERO])
                }
                Some(SpecialPoint::Hopf(hopf)) => {
                    let critical = Complex64::new(0.0, hopf.frequency);
                    spectrum.stability_beside(&[critical, critical.conj()])
                }
                _ => spectrum.stability,
            },
            eigenvalues: spectrum.eigenvalues.clone(),
            label,
            tests: vec![
                test(SpecialKind::Fold, EquilibriumCurve::turn_of(&solution.tangent, range)),
                test(SpecialKind::BranchPoint, solution.orientation * determinant),
                test(SpecialKind::Hopf, spectrum.hopf_test),
            ],
            monitors: Vec::new(),
            special: special.clone(),
        }
    }
}
