//! Why a branch of equilibria ends, apart from the reasons that all curves share.

use crate::branch::WithParameter;
use crate::continuation::{Explanation, Reason};
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

impl WithParameter for EquilibriumEnd {
    fn with_parameter(self, convert: impl Fn(f64) -> f64) -> Self {
        let Self::StateUnbounded { parameter } = self;
        Self::StateUnbounded { parameter: convert(parameter) }
    }
}

impl Reason for EquilibriumEnd {
    fn explain(&self, keys: &[&str]) -> Explanation {
        let Self::StateUnbounded { parameter } = self;
        let key = keys.first().copied().unwrap_or("the parameter");
        Explanation::of(format!(
            "the state grows without bound while {key} tends to {}",
            readable(*parameter)
        ))
        .try_this("nothing, if it does in truth; else other coordinates, such as reciprocals")
    }
}
