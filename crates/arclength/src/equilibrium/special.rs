//! Special points of a branch of equilibria.

use super::branch_point::BranchPoint;
use super::fold::FoldPoint;
use super::hopf::HopfPoint;
use crate::branch::SpecialKind;
use serde::{Deserialize, Serialize};

/// Two real eigenvalues with sum zero: not a bifurcation, but the Hopf test function vanishes there too.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct NeutralSaddle {
    /// All parameters.
    pub parameters: Vec<f64>,
    /// Index of the parameter along which it was found.
    pub active: usize,
    /// Value of that parameter.
    #[serde(rename = "parameter")]
    pub value: f64,
    /// Error estimate of that value.
    pub location_error: f64,
    /// The equilibrium.
    pub state: Vec<f64>,
    /// The positive one of the two eigenvalues.
    pub eigenvalue: f64,
}

/// A special point with its normal form.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(tag = "kind", rename_all = "snake_case")]
pub enum SpecialPoint {
    /// Fold.
    Fold(FoldPoint),
    /// Branch point.
    BranchPoint(BranchPoint),
    /// Hopf point.
    Hopf(HopfPoint),
    /// Neutral saddle.
    NeutralSaddle(NeutralSaddle),
    /// A special point that was bracketed but whose defining system is not regular: a coefficient of its normal form is zero,
    /// or symmetry makes several eigenvalues cross at once.
    Degenerate {
        /// What changes sign there.
        of: SpecialKind,
        /// Value of the parameter.
        #[serde(rename = "parameter")]
        value: f64,
        /// Half of the length of the bracket.
        location_error: f64,
        /// Whether it is a border between two pieces of the field: what changes jumps there, and there is no normal form.
        #[serde(default, skip_serializing_if = "std::ops::Not::not")]
        at_border: bool,
    },
}

impl SpecialPoint {
    /// Its kind.
    pub fn kind(&self) -> SpecialKind {
        match self {
            Self::Fold(_) => SpecialKind::Fold,
            Self::BranchPoint(_) => SpecialKind::BranchPoint,
            Self::Hopf(_) => SpecialKind::Hopf,
            Self::NeutralSaddle(_) => SpecialKind::NeutralSaddle,
            Self::Degenerate { of, .. } => *of,
        }
    }

    /// Value of the parameter.
    pub fn value(&self) -> f64 {
        match self {
            Self::Fold(point) => point.value,
            Self::BranchPoint(point) => point.value,
            Self::Hopf(point) => point.value,
            Self::NeutralSaddle(point) => point.value,
            Self::Degenerate { value, .. } => *value,
        }
    }

    /// Error estimate of that value.
    pub fn location_error(&self) -> f64 {
        match self {
            Self::Fold(point) => point.location_error,
            Self::BranchPoint(point) => point.location_error,
            Self::Hopf(point) => point.location_error,
            Self::NeutralSaddle(point) => point.location_error,
            Self::Degenerate { location_error, .. } => *location_error,
        }
    }
}
