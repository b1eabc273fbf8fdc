//! The uniform motions that were followed, in a result.

use crate::states::named_state;
use arclength::equilibrium::{EquilibriumPoint, SpecialPoint};
use arclength_analysis::VaryingParameter;
use arclength_analysis::branch::{pairs, tests};
use arclength_analysis::monitor::named;
use arclength_analysis::normal_form::of_equilibrium;
use kingpin_report::NamedNumbers;
use kingpin_report::numbers::readable;
use serde::{Deserialize, Serialize};

/// A uniform motion that was computed on the way.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct MotionResult {
    /// Value of the parameter.
    #[serde(with = "kingpin_report::number")]
    pub value: f64,
    /// The uniform motion.
    pub state: NamedNumbers,
    /// Eigenvalues by descending real part.
    pub eigenvalues: Vec<[Option<f64>; 2]>,
    /// Nothing where that is not decided.
    pub stable: Option<bool>,
    /// Of special points.
    pub label: Option<String>,
    /// Test functions by the label of the point at which each changes its sign.
    pub tests: NamedNumbers,
    /// What was monitored, where it exists.
    #[serde(default, skip_serializing_if = "NamedNumbers::is_empty")]
    pub monitors: NamedNumbers,
    /// What the normal form of a special point says.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub remark: Option<String>,
}

/// A special point that was detected but only bracketed.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct BracketedResult {
    /// Value of the parameter.
    #[serde(with = "kingpin_report::number")]
    pub value: f64,
    /// Half of the length of the bracket.
    #[serde(with = "kingpin_report::number")]
    pub location_error: f64,
}

impl BracketedResult {
    /// The point at a motion, if it is only bracketed.
    pub(super) fn at(motion: &EquilibriumPoint) -> Option<Self> {
        match motion.special.as_deref() {
            Some(SpecialPoint::Degenerate { location_error, .. }) => {
                Some(Self { value: motion.value, location_error: *location_error })
            }
            _ => None,
        }
    }

    /// In words.
    pub(super) fn text(&self, along: &VaryingParameter) -> String {
        format!(
            "a special point at {} is only bracketed, to {}: its defining system is singular there",
            along.at(self.value),
            readable(self.location_error)
        )
    }
}

/// The test functions at a motion.
pub(super) fn named_tests(motion: &EquilibriumPoint) -> NamedNumbers {
    tests(motion.tests.iter().map(|(name, value)| (name.as_ref(), *value)))
}

impl MotionResult {
    /// A motion of the branch.
    pub(super) fn new(motion: &EquilibriumPoint, monitors: &[String]) -> Self {
        Self {
            value: motion.value,
            state: named_state(&motion.state),
            eigenvalues: pairs(&motion.eigenvalues),
            stable: motion.stability.is_stable(),
            label: motion.label.map(|label| label.to_string()),
            tests: named_tests(motion),
            monitors: named(monitors, &motion.monitors),
            remark: motion.special.as_deref().map(of_equilibrium),
        }
    }
}
