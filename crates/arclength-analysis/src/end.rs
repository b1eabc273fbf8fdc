//! Why a branch ends, as results tell it.

use arclength::continuation::{Explanation, Reason, Stop};
use kingpin_report::NamedNumbers;
use kingpin_report::numbers::readable;
use serde::{Deserialize, Serialize};

/// Why a branch ends in one direction, and what can be done.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct End {
    /// The cause.
    pub cause: String,
    /// The last good point.
    pub last: NamedNumbers,
    /// What to try, where anything is left to do.
    pub remedy: Option<String>,
}

impl End {
    /// The end of a branch, with its last good point, along parameters with these names; of one that starts at a point of another
    /// branch where there is no stop.
    pub fn of<R: Reason>(stop: Option<&Stop<R>>, keys: &[&str], last: NamedNumbers) -> Self {
        let explanation = stop.map_or_else(|| Explanation::of("starts there"), |stop| stop.explain(keys));
        Self { cause: explanation.cause, last, remedy: explanation.remedy.map(str::to_owned) }
    }

    /// In one line.
    pub fn text(&self) -> String {
        let last: Vec<String> =
            self.last.0.iter().map(|(name, value)| format!("{name} = {}", readable(*value))).collect();
        match &self.remedy {
            Some(remedy) => {
                format!("{}; last good point: {}; try: {remedy}", self.cause, last.join(", "))
            }
            None => self.cause.clone(),
        }
    }
}
