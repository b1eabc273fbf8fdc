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
}

impl WithParameters for EquilibriumEnd {
    fn with_parameters(self, convert: impl Fn(usize, f64) -> f64) -> Self {
        let Self::StateUnbounded { parameter } = self;
        Self::StateUnbounded { parameter: convert(0, parameter) }
    }
}

impl Reason for EquilibriumEnd {
    fn explain(&self, wording: &Wording<'_>) -> Explanation {
        let Self::StateUnbounded { parameter } = self;
        let key = wording.name(0);
        Explanation::of(format!(
            "the state grows without bound while {key} tends to {}",
            readable(*parameter)
        ))
        .try_this("nothing, if it does in truth; else other coordinates, such as reciprocals")
    }
}
