//! The circles and the loads for which a damper is asked.

use crate::error::Error;
use arclength_analysis::{Interval, Values};
use kingpin::branches::Along;
use kingpin::{Condition, Key, Wheel};
use kingpin_report::numbers::readable;
use serde::{Deserialize, Serialize};
use std::fmt;
use std::str::FromStr;

/// Most values of a list.
const MOST: usize = 24;

/// All values of an interval `A:B`, or each of `A,B,C`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(untagged)]
pub enum Range {
    /// All values between two.
    Interval {
        /// The smaller one.
        #[serde(with = "kingpin_report::number")]
        start: f64,
        /// The larger one, perhaps infinite.
        #[serde(with = "kingpin_report::number")]
        end: f64,
    },
    /// Each of these.
    Values(Vec<Value>),
}

/// One of several values, perhaps infinite.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(transparent)]
pub struct Value(#[serde(with = "kingpin_report::number")] pub f64);

impl FromStr for Range {
    type Err = arclength_analysis::IntervalError;

    fn from_str(text: &str) -> Result<Self, Self::Err> {
        if text.contains(':') {
            let Interval { start, end, .. } = format!("value={text}").parse()?;
            return Ok(Self::Interval { start, end });
        }
        let Values { values, .. } = text.parse()?;
        Ok(Self::Values(values.into_iter().map(Value).collect()))
    }
}

impl fmt::Display for Range {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Interval { start, end } => write!(f, "from {} to {}", readable(*start), readable(*end)),
            Self::Values(values) => {
                let values: Vec<String> = values.iter().map(|value| readable(value.0)).collect();
                write!(f, "= {}", values.join(", "))
            }
        }
    }
}

impl Range {
    /// The values of a parameter of the wheel.
    ///
    /// # Errors
    /// Values that the parameter may not take, or too many.
    pub(super) fn of(
        &self,
        key: Key,
        field: &'static [&'static str],
        wheel: &Wheel,
    ) -> Result<Condition, Error> {
        match self {
            Self::Interval { start, end } => Ok(Condition::Interval(Along::new(key, *start, *end)?)),
            Self::Values(values) => {
                if values.len() > MOST {
                    let allowed = format!("at most {MOST} values");
                    return Err(Error::invalid(
                        field,
                        format!("{} values", values.len()),
                        "too many",
                        allowed,
                    ));
                }
                let values: Vec<f64> = values.iter().map(|value| value.0).collect();
                values.iter().try_for_each(|value| wheel.with(key, *value).map(|_| ()))?;
                Ok(Condition::Values(key, values))
            }
        }
    }
}
