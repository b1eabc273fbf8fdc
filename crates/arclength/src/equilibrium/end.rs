//! Why a branch of equilibria ends, apart from the reasons that all curves share.

use crate::branch::WithParameters;
use crate::continuation::{Explanation, Reason, Wording};
use crate::numbers::readable;
use serde::{Deserialize, Serialize};

/// The reason of its own for which a branch of equilibria ends.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
#[non_exhaustive]
pub enum EquilibriumEnd {
    /// The state grows without bound while the parameter tends to a value.
    StateUnbounded {
        /// That value.
        parameter: f64,
    },
    /// The state changes and the parameter does not: equilibria for one value of it.
    ParameterStandsStill {
        /// That value.
        parameter: f64,
    },
    /// The branch comes to a border between two pieces of the field and no equilibrium lies beyond: the field jumps there.
    Border {
        /// The value of the parameter there.
        parameter: f64,
    },
}

impl WithParameters for EquilibriumEnd {
    fn with_parameters(self, convert: impl Fn(usize, f64) -> f64) -> Self {
        match self {
            Self::StateUnbounded { parameter } => Self::StateUnbounded { parameter: convert(0, parameter) },
            Self::ParameterStandsStill { parameter } => {
                Self::ParameterStandsStill { parameter: convert(0, parameter) }
            }
            Self::Border { parameter } => Self::Border { parameter: convert(0, parameter) },
        }
    }
}

impl Reason for EquilibriumEnd {
    fn explain(&self, wording: &Wording<'_>) -> Explanation {
        let key = wording.name(0);
        match self {
            Self::StateUnbounded { parameter } => Explanation::of(format!(
                "the state grows without bound while {key} tends to {}",
                readable(*parameter)
            ))
            .try_this("nothing, if it does in truth; else other coordinates, such as reciprocals"),
            Self::ParameterStandsStill { parameter } => Explanation::of(format!(
                "{key} stands still at {} while the state changes: there are equilibria for this value only, a whole line of them",
                readable(*parameter)
            ))
            .try_this("another parameter; where a state is to end the branch, --until STATE=VALUE"),
            Self::Border { parameter } => Explanation::of(format!(
                "at {key} = {} the equilibrium comes to a border at which the field jumps, and no equilibrium lies beyond it",
                readable(*parameter)
            )),
        }
    }
}
