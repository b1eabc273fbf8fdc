//! Records with what was fitted to them, as results.

use crate::error::Error;
use arclength::control::Control;
use kingpin::identification::{FittedColumn, FittedRecord, Record};
use kingpin::{Key, Tyre};
use kingpin_report::history::extremes;
use kingpin_report::{NamedNumbers, number};
use serde::Serialize;
use std::path::Path;

/// Part of the range of a motion below which what is left is rounding.
const EXACT: f64 = 1e-8;

/// A measured state with what was fitted to it.
#[derive(Debug, Serialize)]
pub struct FittedColumnResult {
    /// Its name.
    pub state: String,
    /// Its unit.
    pub unit: &'static str,
    /// Standard deviation of the noise: that of the residuals, unless it was given.
    pub sigma: f64,
    /// What the instrument shows where the state is zero.
    pub offset: f64,
    /// Correlation of each residual with the next.
    pub correlation_with_next: f64,
    /// Probability that noise is as correlated as the residuals (Ljung and Box).
    pub whiteness: f64,
    /// Whether the residuals may be noise.
    pub noise: bool,
    /// The measured values.
    pub measured: Vec<f64>,
    /// The fitted ones.
    pub fitted: Vec<f64>,
}

impl FittedColumnResult {
    /// Whether the values are met so exactly that no instrument can have measured them: what is left is rounding, and no noise.
    pub(super) fn is_met(&self) -> bool {
        let [low, high] = extremes(&self.fitted);
        self.sigma < EXACT * (high - low)
    }
}

/// A record with what was fitted to it.
#[derive(Debug, Serialize)]
pub struct FittedRecordResult {
    /// Its file.
    pub file: String,
    /// Towing speed in m/s.
    pub v: f64,
    /// Radius of the path of the towing point in m.
    #[serde(with = "number")]
    pub r: f64,
    /// Number of samples.
    pub samples: usize,
    /// The states at the first sample.
    pub start: NamedNumbers,
    /// Time in s, in the record, from which on the fitted motion takes more than the static friction; nothing where it does not.
    pub rolling_lost_at: Option<f64>,
    /// Times in s.
    pub t: Vec<f64>,
    /// The measured states.
    pub columns: Vec<FittedColumnResult>,
}

/// A record with what was fitted to it.
///
/// # Errors
/// A fitted motion that cannot be followed.
pub(super) fn fitted_record(
    file: &Path,
    record: &Record,
    fitted: FittedRecord,
) -> Result<FittedRecordResult, Error> {
    let names = fitted.wheel.free_states();
    let start = names.iter().zip(&fitted.start).map(|(name, value)| ((*name).to_owned(), *value)).collect();
    let first = record.times[0];
    let duration = record.times[record.times.len() - 1] - first;
    let rolling_lost_at = match <[f64; 5]>::try_from(fitted.start.as_slice()) {
        Ok(start) if fitted.wheel.tyre() == Tyre::Rigid => fitted
            .wheel
            .simulate_from(&start, duration, 2, &Control::none())?
            .rolling_lost_at
            .map(|time| first + time),
        _ => None,
    };
    let columns = record.columns.iter().zip(fitted.columns).map(|(measured, fitted)| {
        let FittedColumn { state, values, offset, deviation, whiteness } = fitted;
        FittedColumnResult {
            unit: unit(&state),
            state,
            sigma: deviation,
            offset,
            correlation_with_next: whiteness.correlation_with_next,
            whiteness: whiteness.probability,
            noise: whiteness.is_white(),
            measured: measured.values.clone(),
            fitted: values,
        }
    });
    Ok(FittedRecordResult {
        file: file.display().to_string(),
        v: fitted.wheel.get(Key::V),
        r: fitted.wheel.get(Key::TurningRadius),
        samples: record.times.len(),
        start: NamedNumbers(start),
        rolling_lost_at,
        t: record.times.clone(),
        columns: columns.collect(),
    })
}

/// The unit of a state.
pub(super) fn unit(state: &str) -> &'static str {
    match state {
        "psi" => "rad",
        "Omega" => "rad/s",
        "V" | "V1" | "V2" => "m/s",
        _ => "m",
    }
}

/// What is measured less what is fitted.
pub(super) fn residuals(column: &FittedColumnResult) -> Vec<f64> {
    column.measured.iter().zip(&column.fitted).map(|(measured, fitted)| measured - fitted).collect()
}
