//! What was detected along a branch of cycles but not located.

use crate::branch::shortened;
use crate::varying_parameter::VaryingParameter;
use arclength::cycle::Unlocated;
use serde::{Deserialize, Serialize};

/// A change of a test function behind which no special cycle could be located.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct UnlocatedResult {
    /// What the test is for.
    pub test: String,
    /// Parameter values between which it changed.
    #[serde(with = "kingpin_report::number")]
    pub between: [f64; 2],
}

impl UnlocatedResult {
    /// In words, with what to try.
    pub fn text(&self, along: &VaryingParameter) -> String {
        let [first, second] = self.between;
        format!(
            "the test for a {} changes between {} and {}, but no such cycle was located there; \
             try: shorter steps (--finer 10)",
            self.test,
            along.at(first),
            along.quantity(second)
        )
    }
}

impl From<&Unlocated> for UnlocatedResult {
    fn from(change: &Unlocated) -> Self {
        Self { test: change.test.to_owned(), between: change.between }
    }
}

/// Warnings of changes that were not located, each once, the first few of them.
pub fn warnings(changes: &[UnlocatedResult], along: &VaryingParameter) -> Vec<String> {
    let mut texts: Vec<String> = changes.iter().map(|change| change.text(along)).collect();
    texts.dedup();
    shortened(texts)
}
