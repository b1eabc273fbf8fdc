//! What was noticed along a branch and could not be located, as results tell it.

use arclength::branch::{SpecialKind, Unlocated};
use kingpin_report::numbers::readable;
use serde::{Deserialize, Serialize};

/// A change behind which no special point could be located.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct UnlocatedResult {
    /// What the test is for.
    pub test: String,
    /// Parameter values between which it changed.
    pub between: [f64; 2],
}

impl UnlocatedResult {
    /// What the engine could not locate on a branch of one parameter.
    pub fn of(change: &Unlocated) -> Self {
        let value = |side: usize| change.between[side].first().copied().unwrap_or_default();
        Self { test: test_name(change.kind), between: [value(0), value(1)] }
    }

    /// In words, with what to try.
    pub fn text(&self, key: &str) -> String {
        let [first, second] = self.between.map(readable);
        format!(
            "{} changes between {key} = {first} and {second}, but no such point was located there; \
             try: shorter steps (--finer 10)",
            subject(&self.test)
        )
    }
}

/// What the test of a change that was not located is for.
pub(crate) fn test_name(kind: Option<SpecialKind>) -> String {
    kind.map_or(NUMBER, SpecialKind::name).to_owned()
}

/// What changes where a test says so.
pub(crate) fn subject(test: &str) -> String {
    if test == NUMBER { format!("the {NUMBER}") } else { format!("the test for a {test}") }
}

/// What changes where no test function does.
const NUMBER: &str = "number of unstable directions";
