//! Intervals of parameters and how they are written: `KEY=A:B`, with samples `KEY=A:B:N`, lists of values `KEY=A,B,C`, one value
//! `KEY=VALUE`.
//!
//! The keys are checked by whoever knows them; here they are text.

use crate::error::InvalidField;
use serde::{Deserialize, Serialize};
use std::str::FromStr;

/// Part of an interval by which what was computed may be outside: special points at one of its ends are known to rounding.
const COMPUTED_ROUNDING: f64 = 1e-9;

/// An interval of a parameter, `KEY=A:B`. The ends may be written in either order.
///
/// ```
/// use arclength_analysis::Interval;
/// let interval: Interval = "v=9:0.5".parse()?;
/// assert_eq!((interval.key.as_str(), interval.start, interval.end), ("v", 0.5, 9.0));
/// # Ok::<(), arclength_analysis::IntervalError>(())
/// ```
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Interval {
    /// Key of the parameter.
    pub key: String,
    /// The lower end.
    #[serde(with = "kingpin_report::number")]
    pub start: f64,
    /// The upper end, perhaps infinite.
    #[serde(with = "kingpin_report::number")]
    pub end: f64,
}

/// A parameter along which something is followed, `KEY=A:B`, or `KEY` alone where the model says from where to where.
///
/// ```
/// use arclength_analysis::{Along, Interval};
/// assert_eq!("v=9:0.5".parse(), Ok(Along::Interval(Interval::new("v", 0.5, 9.0))));
/// assert_eq!("v".parse(), Ok(Along::Parameter { key: "v".to_owned() }));
/// ```
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(untagged)]
pub enum Along {
    /// In this interval.
    Interval(Interval),
    /// In the interval that the model has in its lines `@`.
    Parameter {
        /// Key of the parameter.
        key: String,
    },
}

/// Equidistant values of a parameter, `KEY=A:B:N`, both ends included.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct SampledInterval {
    /// The interval.
    #[serde(flatten)]
    pub interval: Interval,
    /// Number of values, at least 2.
    pub count: usize,
}

/// Values of a parameter, `KEY=A,B,C` or `A,B,C`.
#[derive(Clone, Debug, PartialEq)]
pub struct Values {
    /// Key of the parameter, where it is given.
    pub key: Option<String>,
    /// The values, perhaps infinite.
    pub values: Vec<f64>,
}

/// A parameter with its value as text, `KEY=VALUE`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Assignment {
    /// Key of the parameter.
    pub key: String,
    /// Its value.
    pub value: String,
}

/// Why a text is no interval, list of values or assignment.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum IntervalError {
    /// Not of the form asked for.
    #[error("it must have the form {form}, such as {example}")]
    Form {
        /// The form.
        form: &'static str,
        /// An example.
        example: &'static str,
    },
    /// Text that is no number.
    #[error("`{given}` is not a number")]
    NotANumber {
        /// The text.
        given: String,
    },
    /// Both ends are equal.
    #[error("an empty interval: both ends are {end}; allowed: two different ends")]
    Empty {
        /// The end.
        end: f64,
    },
    /// Not a number of points.
    #[error("`{given}` points; allowed: a whole number of at least 2")]
    Count {
        /// The text.
        given: String,
    },
}

const INTERVAL: IntervalError = IntervalError::Form { form: "KEY=A:B", example: "v=0.5:9" };
const SAMPLED_INTERVAL: IntervalError = IntervalError::Form { form: "KEY=A:B:N", example: "v=0.1:12:240" };
const VALUES: IntervalError = IntervalError::Form { form: "KEY=A,B,C", example: "v=1,2,4" };
const ASSIGNMENT: IntervalError = IntervalError::Form { form: "KEY=VALUE", example: "l=0.08" };

fn key_and_rest(text: &str, form: IntervalError) -> Result<(String, &str), IntervalError> {
    match text.split_once('=') {
        Some((key, rest)) if !key.trim().is_empty() => Ok((key.trim().to_owned(), rest)),
        _ => Err(form),
    }
}

fn number(text: &str) -> Result<f64, IntervalError> {
    match text.trim().parse::<f64>() {
        Ok(number) if !number.is_nan() => Ok(number),
        _ => Err(IntervalError::NotANumber { given: text.trim().to_owned() }),
    }
}

impl Interval {
    /// The interval of a parameter between two values, in either order.
    pub fn new(key: impl Into<String>, first: f64, second: f64) -> Self {
        Self { key: key.into(), start: first.min(second), end: first.max(second) }
    }

    /// Whether a value is inside, ends included.
    pub fn contains(&self, value: f64) -> bool {
        (self.start..=self.end).contains(&value)
    }

    /// Whether a value that was computed is inside, or outside by rounding.
    pub fn contains_nearly(&self, value: f64) -> bool {
        let margin = COMPUTED_ROUNDING * (self.end - self.start);
        (self.start - margin..=self.end + margin).contains(&value)
    }

    /// That every value is inside.
    ///
    /// # Errors
    /// The field `at` with the first value that is not.
    pub fn check_values(&self, values: &[f64]) -> Result<(), InvalidField> {
        match values.iter().find(|value| !self.contains(**value)) {
            Some(outside) => Err(InvalidField {
                fields: &["at"],
                given: outside.to_string(),
                problem: "outside the interval".to_owned(),
                allowed: format!("{} to {}", self.start, self.end),
            }),
            None => Ok(()),
        }
    }

    fn parsed(key: String, first: &str, second: &str) -> Result<Self, IntervalError> {
        let (first, second) = (number(first)?, number(second)?);
        if first == second {
            return Err(IntervalError::Empty { end: first });
        }
        Ok(Self { key, start: first.min(second), end: first.max(second) })
    }
}

impl std::fmt::Display for Interval {
    fn fmt(&self, formatter: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(formatter, "{}={}:{}", self.key, self.start, self.end)
    }
}

impl FromStr for Interval {
    type Err = IntervalError;

    fn from_str(text: &str) -> Result<Self, IntervalError> {
        let (key, ends) = key_and_rest(text, INTERVAL)?;
        match ends.split(':').collect::<Vec<_>>()[..] {
            [first, second] => Self::parsed(key, first, second),
            _ => Err(INTERVAL),
        }
    }
}

impl Along {
    /// Key of the parameter.
    pub fn key(&self) -> &str {
        match self {
            Self::Interval(Interval { key, .. }) | Self::Parameter { key } => key,
        }
    }
}

impl From<Interval> for Along {
    fn from(interval: Interval) -> Self {
        Self::Interval(interval)
    }
}

impl FromStr for Along {
    type Err = IntervalError;

    fn from_str(text: &str) -> Result<Self, IntervalError> {
        let key = text.trim();
        if key.is_empty() || key.contains(['=', ':', ',']) {
            return text.parse().map(Self::Interval);
        }
        Ok(Self::Parameter { key: key.to_owned() })
    }
}

impl SampledInterval {
    /// Equidistant values of a parameter between two values, both included.
    pub fn new(key: impl Into<String>, first: f64, second: f64, count: usize) -> Self {
        Self { interval: Interval::new(key, first, second), count }
    }

    /// That there are at least two values; `fields` is where they were given.
    ///
    /// # Errors
    /// There are fewer.
    pub fn check_count(&self, fields: &'static [&'static str]) -> Result<(), InvalidField> {
        if self.count >= 2 {
            return Ok(());
        }
        Err(InvalidField {
            fields,
            given: self.to_string(),
            problem: "too few values".to_owned(),
            allowed: "at least 2".to_owned(),
        })
    }
}

impl std::fmt::Display for SampledInterval {
    fn fmt(&self, formatter: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(formatter, "{}:{}", self.interval, self.count)
    }
}

impl FromStr for SampledInterval {
    type Err = IntervalError;

    fn from_str(text: &str) -> Result<Self, IntervalError> {
        let (key, ends) = key_and_rest(text, SAMPLED_INTERVAL)?;
        let [first, second, count] = ends.split(':').collect::<Vec<_>>()[..] else {
            return Err(SAMPLED_INTERVAL);
        };
        let interval = Interval::parsed(key, first, second)?;
        match count.trim().parse() {
            Ok(count) if count >= 2 => Ok(Self { interval, count }),
            _ => Err(IntervalError::Count { given: count.trim().to_owned() }),
        }
    }
}

impl FromStr for Values {
    type Err = IntervalError;

    fn from_str(text: &str) -> Result<Self, IntervalError> {
        let (key, list) = match text.split_once('=') {
            Some(_) => key_and_rest(text, VALUES).map(|(key, list)| (Some(key), list))?,
            None => (None, text),
        };
        let values = list.split(',').map(number).collect::<Result<_, _>>()?;
        Ok(Self { key, values })
    }
}

impl Assignment {
    /// The key with its value, which must be a number.
    ///
    /// # Errors
    /// The fields with what was given where that is no finite number.
    pub fn number(&self, fields: &'static [&'static str]) -> Result<(String, f64), InvalidField> {
        match self.value.parse::<f64>() {
            Ok(number) if number.is_finite() => Ok((self.key.clone(), number)),
            _ => Err(InvalidField {
                fields,
                given: format!("{}={}", self.key, self.value),
                problem: "not a finite number".to_owned(),
                allowed: "a finite number".to_owned(),
            }),
        }
    }
}

impl FromStr for Assignment {
    type Err = IntervalError;

    fn from_str(text: &str) -> Result<Self, IntervalError> {
        let (key, value) = key_and_rest(text, ASSIGNMENT)?;
        Ok(Self { key, value: value.trim().to_owned() })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_no_interval_is_refused() {
        for wrong in ["", "v", "v=", "v=1", "v=1:2:3", "=1:2", "v=1:x", "v=nan:1", "v=1:", "v=2:2"] {
            assert!(wrong.parse::<Interval>().is_err(), "{wrong}");
        }
        for wrong in ["v=1:2", "v=1:2:1", "v=1:2:0", "v=1:2:-3", "v=1:2:2.5", "v=1:2:3:4", "v=1:1:5"] {
            assert!(wrong.parse::<SampledInterval>().is_err(), "{wrong}");
        }
        for wrong in ["", "v=", "v=1,,2", "1,a", "=1"] {
            assert!(wrong.parse::<Values>().is_err(), "{wrong}");
        }
        assert_eq!("v=1, 2".parse(), Ok(Values { key: Some("v".to_owned()), values: vec![1.0, 2.0] }));
        assert_eq!("inf".parse(), Ok(Values { key: None, values: vec![f64::INFINITY] }));
    }
}
