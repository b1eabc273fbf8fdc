//! Estimates with their intervals, as results, and numbers rounded to what is known of them.

use kingpin::identification::Estimate;
use kingpin_report::numbers::significant;
use serde::Serialize;

/// Significant digits of a standard error.
pub(super) const DIGITS_OF_ERROR: i32 = 2;
/// Digits of what has no error.
pub(super) const DIGITS: usize = 4;

/// An estimated parameter with its 95 per cent confidence interval.
#[derive(Debug, Serialize)]
pub struct EstimateResult {
    /// Its key.
    pub key: &'static str,
    /// Its unit.
    pub unit: &'static str,
    /// Its value; nothing where the records do not determine it.
    pub value: Option<f64>,
    /// Its standard error; nothing at a bound, and where the value is not determined.
    pub standard_error: Option<f64>,
    /// Lower end of the interval; nothing where none was found.
    pub lower: Option<f64>,
    /// Upper end of the interval; nothing where none was found.
    pub upper: Option<f64>,
    /// Whether the lower end is the smallest value that the parameter may have: then the interval is one-sided.
    pub reaches_lower_bound: bool,
    /// How the interval was found: `linear` by the standard error, `profile` by fits with the parameter held.
    pub method: &'static str,
}

impl EstimateResult {
    pub(super) fn new(estimate: &Estimate) -> Self {
        let Estimate { key, value, standard_error, interval } = *estimate;
        Self {
            key: key.name(),
            unit: key.unit(),
            value,
            standard_error,
            lower: interval.lower,
            upper: interval.upper,
            reaches_lower_bound: interval.reaches_lower_bound,
            method: interval.method.name(),
        }
    }

    /// The size of what is uncertain of it.
    pub(super) fn uncertainty(&self) -> Option<f64> {
        let width = || Some((self.upper? - self.lower?) / 4.0);
        self.standard_error.or_else(width)
    }

    /// The interval in words.
    pub(super) fn interval(&self) -> String {
        let end = |end: f64| rounded(end, self.uncertainty());
        match (self.lower, self.upper) {
            (_, Some(upper)) if self.reaches_lower_bound => format!("at most {}", end(upper)),
            (Some(lower), Some(upper)) => format!("{} to {}", end(lower), end(upper)),
            (Some(lower), None) if !self.reaches_lower_bound => format!("at least {}", end(lower)),
            (None, Some(upper)) => format!("at most {}", end(upper)),
            _ => "unknown".to_owned(),
        }
    }
}

/// A number rounded to the digits that its uncertainty leaves.
pub(super) fn rounded(value: f64, uncertainty: Option<f64>) -> String {
    let size = |value: f64| value.abs().log10().floor() as i32;
    match uncertainty {
        Some(error) if error > 0.0 && error.is_finite() && value != 0.0 => {
            let digits = size(value) - size(error) + DIGITS_OF_ERROR;
            significant(value, digits.clamp(DIGITS_OF_ERROR, 12) as usize)
        }
        _ => significant(value, DIGITS),
    }
}
