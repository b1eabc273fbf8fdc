//! The parameter along which branches of the wheel are followed.

use crate::error::Error;
use arclength_analysis::{Interval, Values};
use kingpin::branches::Along;
use kingpin::{Key, KingpinError};
use kingpin_report::Number;
use serde::Serialize;

/// The interval of a parameter of the wheel; `r` may end at infinity.
///
/// # Errors
/// An unknown key, or ends that the parameter may not take.
pub fn along(interval: &Interval) -> Result<Along, KingpinError> {
    Along::new(interval.key.parse()?, interval.start, interval.end)
}

/// Values of the parameter, within its interval.
///
/// # Errors
/// Another parameter, or a value outside the interval.
pub fn values_on(along: &Along, given: &[Values]) -> Result<Vec<f64>, Error> {
    let failure =
        |given: String, problem: String, allowed: String| Error::invalid(&["at"], given, problem, allowed);
    let name = along.key().name();
    for key in given.iter().filter_map(|values| values.key.as_ref()) {
        if key != name {
            let problem = "this parameter does not vary here".to_owned();
            return Err(failure(key.clone(), problem, format!("values of {name}")));
        }
    }
    let values: Vec<f64> = given.iter().flat_map(|values| values.values.iter().copied()).collect();
    match values.iter().find(|value| !along.contains(**value)) {
        Some(outside) => {
            let (start, end) = along.ends();
            let problem = "outside the interval".to_owned();
            Err(failure(outside.to_string(), problem, format!("{start} to {end}")))
        }
        None => Ok(values),
    }
}

/// The parameter and its interval, in results.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct VaryingParameter {
    /// Its key.
    pub key: &'static str,
    /// Its unit.
    pub unit: &'static str,
    /// The lower end.
    pub start: Number,
    /// The upper end.
    pub end: Number,
}

impl From<Along> for VaryingParameter {
    fn from(along: Along) -> Self {
        let (start, end) = along.ends();
        Self { key: along.key().name(), unit: along.key().unit(), start: Number(start), end: Number(end) }
    }
}

/// A value of the parameter as the continuation knows it, which follows `1/r` in place of `r`; and back.
pub fn as_followed(along: &Along, value: f64) -> f64 {
    if along.key() == Key::TurningRadius { value.recip() } else { value }
}

/// Where a value is drawn: an `r` that reaches infinity is drawn as a curvature.
pub fn drawn_as(along: &Along) -> (Key, fn(f64) -> f64) {
    if along.key() == Key::TurningRadius && along.ends().1.is_infinite() {
        (Key::Curvature, f64::recip)
    } else {
        (along.key(), |value| value)
    }
}
