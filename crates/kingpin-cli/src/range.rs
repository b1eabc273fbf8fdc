//! Ranges as they are written in options: `KEY=A:B` and `KEY=A:B:N`, and lists of values `KEY=A,B,C`.
//!
//! The keys are checked by whoever knows them; here they are text.

use std::str::FromStr;

/// An interval of a parameter, `KEY=A:B`. The ends may be written in either order.
///
/// ```
/// use kingpin_cli::range::Range;
/// let range: Range = "v=9:0.5".parse()?;
/// assert_eq!((range.key.as_str(), range.start, range.end), ("v", 0.5, 9.0));
/// # Ok::<(), kingpin_cli::range::RangeError>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Range {
    /// Key of the parameter.
    pub key: String,
    /// The lower end.
    pub start: f64,
    /// The upper end, perhaps infinite.
    pub end: f64,
}

/// Equidistant values of a parameter, `KEY=A:B:N`, both ends included.
#[derive(Clone, Debug, PartialEq)]
pub struct SampledRange {
    /// The interval.
    pub range: Range,
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
#[derive(Clone, Debug, PartialEq)]
pub struct Assignment {
    /// Key of the parameter.
    pub key: String,
    /// Its value.
    pub value: String,
}

/// Why a text is no range.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum RangeError {
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

const RANGE: RangeError = RangeError::Form { form: "KEY=A:B", example: "v=0.5:9" };
const SAMPLED_RANGE: RangeError = RangeError::Form { form: "KEY=A:B:N", example: "v=0.1:12:240" };
const VALUES: RangeError = RangeError::Form { form: "KEY=A,B,C", example: "v=1,2,4" };
const ASSIGNMENT: RangeError = RangeError::Form { form: "KEY=VALUE", example: "l=0.08" };

fn key_and_rest(text: &str, form: RangeError) -> Result<(String, &str), RangeError> {
    match text.split_once('=') {
        Some((key, rest)) if !key.trim().is_empty() => Ok((key.trim().to_owned(), rest)),
        _ => Err(form),
    }
}

fn number(text: &str) -> Result<f64, RangeError> {
    match text.trim().parse::<f64>() {
        Ok(number) if !number.is_nan() => Ok(number),
        _ => Err(RangeError::NotANumber { given: text.trim().to_owned() }),
    }
}

impl Range {
    fn new(key: String, first: &str, second: &str) -> Result<Self, RangeError> {
        let (first, second) = (number(first)?, number(second)?);
        if first == second {
            return Err(RangeError::Empty { end: first });
        }
        Ok(Self { key, start: first.min(second), end: first.max(second) })
    }
}

impl FromStr for Range {
    type Err = RangeError;

    fn from_str(text: &str) -> Result<Self, RangeError> {
        let (key, ends) = key_and_rest(text, RANGE)?;
        match ends.split(':').collect::<Vec<_>>()[..] {
            [first, second] => Self::new(key, first, second),
            _ => Err(RANGE),
        }
    }
}

impl FromStr for SampledRange {
    type Err = RangeError;

    fn from_str(text: &str) -> Result<Self, RangeError> {
        let (key, ends) = key_and_rest(text, SAMPLED_RANGE)?;
        let [first, second, count] = ends.split(':').collect::<Vec<_>>()[..] else {
            return Err(SAMPLED_RANGE);
        };
        let range = Range::new(key, first, second)?;
        match count.trim().parse() {
            Ok(count) if count >= 2 => Ok(Self { range, count }),
            _ => Err(RangeError::Count { given: count.trim().to_owned() }),
        }
    }
}

impl FromStr for Values {
    type Err = RangeError;

    fn from_str(text: &str) -> Result<Self, RangeError> {
        let (key, list) = match text.split_once('=') {
            Some(_) => key_and_rest(text, VALUES).map(|(key, list)| (Some(key), list))?,
            None => (None, text),
        };
        let values = list.split(',').map(number).collect::<Result<_, _>>()?;
        Ok(Self { key, values })
    }
}

impl FromStr for Assignment {
    type Err = RangeError;

    fn from_str(text: &str) -> Result<Self, RangeError> {
        let (key, value) = key_and_rest(text, ASSIGNMENT)?;
        Ok(Self { key, value: value.trim().to_owned() })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_no_range_is_refused() {
        for wrong in ["", "v", "v=", "v=1", "v=1:2:3", "=1:2", "v=1:x", "v=nan:1", "v=1:", "v=2:2"] {
            assert!(wrong.parse::<Range>().is_err(), "{wrong}");
        }
        for wrong in ["v=1:2", "v=1:2:1", "v=1:2:0", "v=1:2:-3", "v=1:2:2.5", "v=1:2:3:4", "v=1:1:5"] {
            assert!(wrong.parse::<SampledRange>().is_err(), "{wrong}");
        }
        for wrong in ["", "v=", "v=1,,2", "1,a", "=1"] {
            assert!(wrong.parse::<Values>().is_err(), "{wrong}");
        }
        assert_eq!("v=1, 2".parse(), Ok(Values { key: Some("v".to_owned()), values: vec![1.0, 2.0] }));
        assert_eq!("inf".parse(), Ok(Values { key: None, values: vec![f64::INFINITY] }));
    }
}
