//! Estimates, and what follows from them, as a result.

use super::consequences::{Consequence, Consequences};
use super::picture;
use crate::description;
use crate::error::Error;
use crate::parameters::parameters_of;
use arclength::control::Control;
use kingpin::identification::{Estimate, FittedColumn, FittedRecord, Identified, NotSeparated, Record};
use kingpin::{Key, Tyre, Wheel};
use kingpin_figure::{Figure, FigureError};
use kingpin_report::history::extremes;
use kingpin_report::numbers::{readable, significant};
use kingpin_report::{Columns, NamedNumbers, Parameters, Report, Schema, Table, number};
use serde::Serialize;
use std::io::{self, Write};
use std::path::{Path, PathBuf};

/// Significant digits of a standard error.
const DIGITS_OF_ERROR: i32 = 2;
/// Digits of what has no error.
const DIGITS: usize = 4;
/// Part of the range of a motion below which what is left is rounding.
const EXACT: f64 = 1e-8;
/// Probability below which residuals are larger than the noise that was given explains.
const UNBELIEVABLE: f64 = 0.01;

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
    fn new(estimate: &Estimate) -> Self {
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
    fn uncertainty(&self) -> Option<f64> {
        let width = || Some((self.upper? - self.lower?) / 4.0);
        self.standard_error.or_else(width)
    }

    fn interval(&self) -> String {
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

/// Correlations of the estimates.
#[derive(Debug, Serialize)]
pub struct Correlations {
    /// Their keys, in the order of rows and columns.
    pub keys: Vec<&'static str>,
    /// The correlations, row by row; nothing where one of two is at a bound or not determined.
    pub matrix: Vec<Vec<Option<f64>>>,
}

/// Parameters that the records do not tell apart, or hardly.
#[derive(Debug, Serialize)]
pub struct NotSeparatedResult {
    /// Their keys.
    pub keys: Vec<&'static str>,
    /// The correlation of two that are hardly told apart; nothing where the information matrix is singular.
    pub correlation: Option<f64>,
}

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
    fn is_met(&self) -> bool {
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

/// Estimates and what follows from them.
#[derive(Debug, Serialize)]
pub struct FitResult {
    /// The wheel with the estimates.
    #[serde(skip)]
    pub wheel: Wheel,
    #[serde(skip)]
    keys: Vec<Key>,
    /// The estimates.
    pub estimates: Vec<EstimateResult>,
    /// Their correlations.
    pub correlations: Correlations,
    /// Parameters that are not told apart, or hardly.
    pub not_separated: Vec<NotSeparatedResult>,
    /// Keys of parameters that the records do not determine.
    pub undetermined: Vec<&'static str>,
    /// Number of measured values.
    pub values: usize,
    /// What was unknown, by name.
    pub unknowns: Vec<String>,
    /// Values less unknowns that they determine.
    pub degrees_of_freedom: usize,
    /// Sum of the squared residuals over their variances, where all deviations were given.
    pub chi_squared: Option<f64>,
    /// Probability that noise has a larger one.
    pub chi_squared_probability: Option<f64>,
    /// Whether the smallest sum of squares was found.
    pub converged: bool,
    /// What follows from the estimates; nothing where some are not determined.
    #[serde(flatten)]
    pub consequences: Option<Consequences>,
    /// The records.
    pub records: Vec<FittedRecordResult>,
}

impl FitResult {
    pub(super) fn new(
        wheel: Wheel,
        keys: &[Key],
        files: &[PathBuf],
        records: &[Record],
        identified: Identified,
        consequences: Option<Consequences>,
    ) -> Result<Self, Error> {
        let names = |keys: &[Key]| keys.iter().map(|key| key.name()).collect::<Vec<_>>();
        let not_separated = |group: &NotSeparated| NotSeparatedResult {
            keys: names(&group.keys),
            correlation: group.correlation,
        };
        let fitted = files.iter().zip(records).zip(identified.records);
        Ok(Self {
            wheel,
            keys: keys.to_vec(),
            estimates: identified.estimates.iter().map(EstimateResult::new).collect(),
            correlations: Correlations { keys: names(keys), matrix: identified.correlations },
            not_separated: identified.not_separated.iter().map(not_separated).collect(),
            undetermined: names(&identified.undetermined),
            values: identified.values,
            unknowns: identified.unknowns,
            degrees_of_freedom: identified.degrees_of_freedom,
            chi_squared: identified.chi_squared.map(|chi_squared| chi_squared.value),
            chi_squared_probability: identified.chi_squared.map(|chi_squared| chi_squared.probability),
            converged: identified.converged,
            consequences,
            records: fitted
                .map(|((file, record), fitted)| fitted_record(file, record, fitted))
                .collect::<Result<_, _>>()?,
        })
    }

    /// What is worth knowing about it.
    pub fn warnings(&self) -> Vec<String> {
        let mut warnings = Vec::new();
        if !self.converged {
            warnings.push(
                "the smallest sum of squares was not reached; start nearer to it, or estimate less"
                    .to_owned(),
            );
        }
        if !self.undetermined.is_empty() {
            warnings.push(format!(
                "the records do not determine {}: give one of them its value, or add a record at another speed",
                self.undetermined.join(", ")
            ));
        }
        for record in &self.records {
            if let Some(time) = record.rolling_lost_at {
                warnings.push(format!(
                    "{}: from t = {} s on the fitted motion takes more than the static friction; the wheel may have slid",
                    record.file,
                    readable(time)
                ));
            }
            for column in record.columns.iter().filter(|column| !column.noise && !column.is_met()) {
                warnings.push(format!(
                    "{}: what is left of {} is no noise (probability {}): something moves the wheel that is not in the model, \
                     and the intervals are too narrow",
                    record.file,
                    column.state,
                    significant(column.whiteness, 2)
                ));
            }
        }
        if self.chi_squared_probability.is_some_and(|probability| probability < UNBELIEVABLE) {
            warnings.push("the residuals are larger than the noise that was given explains".to_owned());
        }
        warnings
    }
}

fn fitted_record(file: &Path, record: &Record, fitted: FittedRecord) -> Result<FittedRecordResult, Error> {
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

/// A number rounded to the digits that its uncertainty leaves.
fn rounded(value: f64, uncertainty: Option<f64>) -> String {
    let size = |value: f64| value.abs().log10().floor() as i32;
    match uncertainty {
        Some(error) if error > 0.0 && error.is_finite() && value != 0.0 => {
            let digits = size(value) - size(error) + DIGITS_OF_ERROR;
            significant(value, digits.clamp(DIGITS_OF_ERROR, 12) as usize)
        }
        _ => significant(value, DIGITS),
    }
}

impl Report for FitResult {
    fn schema(&self) -> Schema {
        Schema::first("kingpin.fit")
    }

    fn parameters(&self) -> Parameters {
        parameters_of(&self.wheel, &self.keys)
    }

    fn write_table(&self, out: &mut dyn Write) -> io::Result<()> {
        let count = self.records.len();
        let records = if count == 1 { "1 record".to_owned() } else { format!("{count} records") };
        writeln!(out, "parameters from {records} at {}", description::of(&self.wheel, &self.keys))?;
        writeln!(
            out,
            "{} values, {} unknowns: {}\n",
            self.values,
            self.unknowns.len(),
            self.unknowns.join(", ")
        )?;
        let mut table = Table::new(["", "estimate", "standard error", "95 % interval", "by", ""]);
        for estimate in &self.estimates {
            let uncertainty = estimate.uncertainty();
            table.row([
                estimate.key.into(),
                estimate.value.map(|value| rounded(value, uncertainty)).into(),
                estimate.standard_error.map(|error| significant(error, DIGITS_OF_ERROR as usize)).into(),
                estimate.interval().into(),
                estimate.method.into(),
                estimate.unit.into(),
            ]);
        }
        table.write(out)?;
        self.write_correlations(out)?;
        self.write_records(out)?;
        self.write_consequences(out)
    }

    fn columns(&self) -> Columns {
        let rows = || {
            self.records.iter().flat_map(|record| record.columns.iter().map(move |column| (record, column)))
        };
        let texts =
            |text: &dyn Fn(&FittedRecordResult, &FittedColumnResult) -> String| -> Vec<Option<String>> {
                rows().flat_map(|(record, column)| vec![Some(text(record, column)); record.samples]).collect()
            };
        let times = rows().flat_map(|(record, _)| record.t.iter().copied());
        let measured = rows().flat_map(|(_, column)| column.measured.iter().copied());
        let fitted = rows().flat_map(|(_, column)| column.fitted.iter().copied());
        let residuals = rows().flat_map(|(_, column)| residuals(column));
        Columns::new()
            .texts("record", texts(&|record, _| record.file.clone()))
            .texts("state", texts(&|_, column| column.state.clone()))
            .numbers("t", times)
            .unit("s")
            .numbers("measured", measured)
            .numbers("fitted", fitted)
            .numbers("residual", residuals.collect::<Vec<_>>())
    }

    fn figure(&self) -> Result<Option<Figure>, FigureError> {
        Ok(Some(picture::figure(self)))
    }
}

/// What is measured less what is fitted.
pub(super) fn residuals(column: &FittedColumnResult) -> Vec<f64> {
    column.measured.iter().zip(&column.fitted).map(|(measured, fitted)| measured - fitted).collect()
}

impl FitResult {
    fn write_correlations(&self, out: &mut dyn Write) -> io::Result<()> {
        if self.correlations.keys.len() > 1 {
            writeln!(out, "\ncorrelations\n")?;
            let headings = std::iter::once("").chain(self.correlations.keys.iter().copied());
            let mut table = Table::new(headings);
            for (row, (key, entries)) in
                self.correlations.keys.iter().zip(&self.correlations.matrix).enumerate()
            {
                let entries =
                    entries.iter().take(row + 1).map(|entry| entry.map(|entry| format!("{entry:.3}")).into());
                table.row(std::iter::once((*key).into()).chain(entries));
            }
            table.write(out)?;
        }
        for NotSeparatedResult { keys, correlation } in &self.not_separated {
            let keys = keys.join(" and ");
            match correlation {
                None => writeln!(
                    out,
                    "\n{keys}: the records do not tell them apart, only a combination of them is known"
                ),
                Some(correlation) => writeln!(
                    out,
                    "\n{keys} are hardly told apart (correlation {correlation:.3}): what one takes the other can give; a record at \
                     another speed may"
                ),
            }?;
        }
        Ok(())
    }

    fn write_records(&self, out: &mut dyn Write) -> io::Result<()> {
        writeln!(out)?;
        let mut table = Table::new(["record", "v (m/s)", "samples", "of", "residual sigma", "left over"]);
        for record in &self.records {
            for column in &record.columns {
                let probability = significant(column.whiteness, DIGITS_OF_ERROR as usize);
                let left = match column.noise {
                    _ if column.is_met() => "rounding".to_owned(),
                    true => format!("noise (probability {probability})"),
                    false => format!("no noise (probability {probability})"),
                };
                table.row([
                    record.file.clone().into(),
                    record.v.into(),
                    (record.samples as f64).into(),
                    column.state.clone().into(),
                    format!("{} {}", significant(column.sigma, DIGITS), column.unit).into(),
                    left.into(),
                ]);
            }
        }
        table.write(out)?;
        if let (Some(value), Some(probability)) = (self.chi_squared, self.chi_squared_probability) {
            writeln!(
                out,
                "\nchi-squared {} with {} degrees of freedom: probability {}",
                significant(value, DIGITS),
                self.degrees_of_freedom,
                significant(probability, 2)
            )?;
        }
        Ok(())
    }

    fn write_consequences(&self, out: &mut dyn Write) -> io::Result<()> {
        let Some(consequences) = &self.consequences else {
            return writeln!(
                out,
                "\nwhat follows is not told, since the records do not determine {}",
                self.undetermined.join(", ")
            );
        };
        writeln!(out)?;
        let nothing = "none: the motion is stable at all speeds";
        tell("critical speed", "m/s", &consequences.critical_speed, nothing, out)?;
        if let Some(speed) = &consequences.critical_speed_with_friction {
            tell(
                "critical speed with friction",
                "m/s",
                speed,
                "none: small motions die out at all speeds",
                out,
            )?;
        }
        if let Some(blow) = &consequences.safe_blow {
            let largest = consequences.largest_blow.map(readable).unwrap_or_default();
            let name = format!("smallest unsafe blow at v = {} m/s", readable(self.wheel.get(Key::V)));
            tell(&name, "N s", blow, &format!("none up to {largest} N s"), out)?;
        }
        Ok(())
    }
}

/// Tells what follows, with its interval and where that comes from.
fn tell(
    name: &str,
    unit: &str,
    consequence: &Consequence,
    nothing: &str,
    out: &mut dyn Write,
) -> io::Result<()> {
    let Consequence { value, lower, upper, method, without } = consequence;
    let width = lower.zip(*upper).map(|(lower, upper)| (upper - lower) / 4.0);
    let text = |value: f64| rounded(value, width);
    let value = value.map_or_else(|| nothing.to_owned(), |value| format!("{} {unit}", text(value)));
    let how = match *method {
        Some("samples") => "by samples of the estimates",
        Some(_) => "by the delta method, with differences",
        None => return writeln!(out, "{name}: {value}; its interval is not known"),
    };
    let percent = without.map(|part| format!("{:.0} %", 100.0 * part)).unwrap_or_default();
    let interval = match (lower, upper) {
        (Some(lower), Some(upper)) => format!("{} to {} {unit}", text(*lower), text(*upper)),
        (Some(lower), None) => format!("at least {} {unit}, {percent} have none", text(*lower)),
        (None, Some(upper)) => format!("at most {} {unit}", text(*upper)),
        (None, None) => format!("none, {percent} have none"),
    };
    writeln!(out, "{name}: {value}; 95 % interval {interval} ({how})")
}
