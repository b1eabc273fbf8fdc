//! Stability and the sense of a bifurcation, as far as the numbers tell.

use serde::{Deserialize, Serialize};

/// Whether perturbations die out, as far as the computed eigenvalues or multipliers can tell.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Stability {
    /// All perturbations decay.
    Stable,
    /// Perturbations grow in some directions.
    Unstable {
        /// Number of unstable eigenvalues or multipliers, the dimension of the unstable manifold; `None` where further ones are
        /// closer to the boundary of stability than they are accurate.
        dimension: Option<usize>,
    },
    /// An eigenvalue or multiplier is closer to the boundary of stability than it is accurate, and none is surely beyond it.
    Undecided,
}

impl Stability {
    /// `None` when undecided.
    pub fn is_stable(self) -> Option<bool> {
        match self {
            Self::Stable => Some(true),
            Self::Unstable { .. } => Some(false),
            Self::Undecided => None,
        }
    }

    /// Whether every eigenvalue or multiplier is on a side of the boundary of stability that is certain.
    pub(crate) fn is_decided(self) -> bool {
        self.unstable_dimension().is_some()
    }

    /// Number of unstable directions; `None` when undecided.
    pub fn unstable_dimension(self) -> Option<usize> {
        match self {
            Self::Stable => Some(0),
            Self::Unstable { dimension } => dimension,
            Self::Undecided => None,
        }
    }
}

/// The sense of a bifurcation to cycles, to doubled cycles or to tori: on which side the new solutions lie.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Criticality {
    /// The normal-form coefficient is negative: the new solutions are stable within the centre manifold.
    Supercritical,
    /// The normal-form coefficient is positive: the new solutions are unstable.
    Subcritical,
    /// The coefficient is too close to zero to tell.
    Degenerate,
}
