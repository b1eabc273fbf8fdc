//! What was noticed along a branch and could not be located, as results tell it.

use crate::branch::shortened;
use crate::varying_parameter::VaryingParameter;
use arclength::branch::{SpecialKind, Unlocated};
use serde::{Deserialize, Serialize};

/// A change along a branch of one parameter behind which no special point could be located.
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
            "{} changes between {} and {}, but no such point was located there; try: shorter steps (--finer 10)",
            subject(&self.test),
            along.at(first),
            along.quantity(second)
        )
    }
}

impl From<&Unlocated> for UnlocatedResult {
    fn from(change: &Unlocated) -> Self {
        let value = |side: usize| change.between[side].first().copied().unwrap_or_default();
        Self { test: test_name(change.kind), between: [value(0), value(1)] }
    }
}

/// A change along a curve in two parameters behind which no point of codimension two could be located.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct UnlocatedChangeResult {
    /// What the test is for.
    pub test: String,
    /// Values of the two parameters between which it changed.
    #[serde(with = "kingpin_report::number")]
    pub between: [[f64; 2]; 2],
}

impl UnlocatedChangeResult {
    /// In words, with what to try.
    pub fn text(&self, [one, two]: &[VaryingParameter; 2]) -> String {
        let [from, to] = self.between.map(|[first, second]| format!("{}, {}", one.at(first), two.at(second)));
        format!(
            "{} changes between {from} and {to}, but no such point was located there; \
             try: shorter steps (--finer 10)",
            subject(&self.test)
        )
    }
}

impl From<&Unlocated> for UnlocatedChangeResult {
    fn from(change: &Unlocated) -> Self {
        let values =
            |side: usize| [0, 1].map(|place| change.between[side].get(place).copied().unwrap_or_default());
        Self { test: test_name(change.kind), between: [values(0), values(1)] }
    }
}

/// What changes where no test function does.
const NUMBER: &str = "number of unstable directions";

fn test_name(kind: Option<SpecialKind>) -> String {
    kind.map_or(NUMBER, SpecialKind::name).to_owned()
}

fn subject(test: &str) -> String {
    if test == NUMBER { format!("the {NUMBER}") } else { format!("the test for a {test}") }
}

/// Warnings of changes that were not located, each once, the first few of them.
pub fn warnings(changes: &[UnlocatedResult], along: &VaryingParameter) -> Vec<String> {
    let mut texts: Vec<String> = changes.iter().map(|change| change.text(along)).collect();
    texts.dedup();
    shortened(texts)
}
