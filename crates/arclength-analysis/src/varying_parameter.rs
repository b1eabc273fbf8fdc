//! The parameter that varies, in results.

use crate::interval::Interval;
use kingpin_report::numbers::{readable, significant};
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

impl VaryingParameter {
    /// A value with the unit, where there is one: `4 m/s`.
    pub fn quantity(&self, value: f64) -> String {
        self.with_unit(value, readable(value))
    }

    /// The key with a value, `v = 4 m/s`.
    pub fn at(&self, value: f64) -> String {
        format!("{} = {}", self.key, self.quantity(value))
    }

    /// The key with a value of a few digits.
    pub fn near(&self, value: f64) -> String {
        format!("{} = {}", self.key, self.with_unit(value, significant(value, 3)))
    }

    /// The key with the unit, where there is one, as a heading: `v (m/s)`.
    pub fn heading(&self) -> String {
        match &self.unit {
            Some(unit) => format!("{} ({unit})", self.key),
            None => self.key.clone(),
        }
    }

    fn with_unit(&self, value: f64, text: String) -> String {
        match &self.unit {
            Some(unit) if unit != "1" && value.is_finite() => format!("{text} {unit}"),
            _ => text,
        }
    }
}
