//! The parameter that varies, in results.

use crate::interval::Interval;
use serde::{Deserialize, Serialize};

/// A parameter that varies and its interval.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct VaryingParameter {
    /// Its name.
    pub key: String,
    /// Its unit, where parameters have units.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub unit: Option<String>,
    /// The lower end.
    #[serde(with = "kingpin_report::number")]
    pub start: f64,
    /// The upper end, perhaps infinite.
    #[serde(with = "kingpin_report::number")]
    pub end: f64,
}

impl From<&Interval> for VaryingParameter {
    fn from(interval: &Interval) -> Self {
        Self { key: interval.key.clone(), unit: None, start: interval.start, end: interval.end }
    }
}
