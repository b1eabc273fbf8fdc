//! Estimates, and what follows from them, as a result.

use super::consequences::{Consequence, Consequences};
use super::estimate::{DIGITS, DIGITS_OF_ERROR, EstimateResult, rounded};
use super::fitted::{FittedColumnResult, FittedRecordResult, fitted_record, residuals};
use super::picture;
use crate::description;
use crate::error::Error;
use crate::parameters::parameters_of;
use kingpin::identification::{Identified, NotSeparated, Record};
use kingpin::{Key, Wheel};
use kingpin_figure::{Figure, FigureError};
use kingpin_report::numbers::{counted, readable, significant};
use kingpin_report::{Columns, Parameters, Report, Schema, Table};
use serde::Serialize;
use std::io::{self, Write};
use std::path::PathBuf;

/// Probability below which residuals are larger than the noise that was given explains.
const UNBELIEVABLE: f64 = 0.01;

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

/// Estimates and what follows from them.
#[derive(Debug, Serialize)]
pub struct FitResult {
    /// The wheel with the estimates.
    #[serde(skip)]
    pub wheel: Wheel,
    #[serde(skip)]
    keys: Vec<Key>,
    /// What is not the same in all records, or tells of the records and not of the wheel: the table of records has it.
    #[serde(skip)]
    of_records: Vec<Key>,
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
        let differs = |key: Key| records.iter().any(|record| record.wheel.get(key) != wheel.get(key));
        let of_records = keys.iter().copied().chain([Key::V]);
        let set = wheel.parameters().map(|(key, _)| key).filter(|key| !keys.contains(key) && differs(*key));
        let of_records = of_records.chain(set).collect();
        let fitted = files.iter().zip(records).zip(identified.records);
        Ok(Self {
            wheel,
            keys: keys.to_vec(),
            of_records,
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
        if let Some(failure) = self.consequences.as_ref().and_then(|found| found.safe_blow_failure.as_ref()) {
            warnings.push(format!("the largest safe blow is not known: {failure}"));
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

impl Report for FitResult {
    fn schema(&self) -> Schema {
        Schema::first("kingpin.fit")
    }

    fn parameters(&self) -> Parameters {
        parameters_of(&self.wheel, &self.keys)
    }

    fn write_table(&self, out: &mut dyn Write) -> io::Result<()> {
        let records = counted(self.records.len(), "record", "records");
        writeln!(
            out,
            "parameters from {records} at {}",
            description::on_lines(&self.wheel, &self.of_records)
        )?;
        writeln!(
            out,
            "{}, {}: {}\n",
            counted(self.values, "value", "values"),
            counted(self.unknowns.len(), "unknown", "unknowns"),
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
        Ok(Some(picture::figure(&self.records)))
    }
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
                "\nchi-squared {} with {} of freedom: probability {}",
                significant(value, DIGITS),
                counted(self.degrees_of_freedom, "degree", "degrees"),
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
        if consequences.critical_speed.value == Some(0.0) {
            writeln!(
                out,
                "  (0: the motion is unstable from standstill on; `kingpin stability` tells at which speeds it is stable, if at any)"
            )?;
        }
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
            let speed = readable(self.wheel.get(Key::V));
            let contact = consequences.contact.unwrap_or_default();
            let name = format!("largest safe blow at v = {speed} m/s, {contact}");
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
    if *without == Some(1.0) && lower.is_none() {
        return writeln!(out, "{name}: {value}, for all samples of the estimates");
    }
    let how = match *method {
        Some("profile") => "by fits with it held",
        Some(_) => "by the delta method, with differences",
        None => return writeln!(out, "{name}: {value}; its interval is not known"),
    };
    let none = match without {
        Some(part) if *part >= 0.01 => {
            format!("{:.0} % of the samples of the estimates have none", 100.0 * part)
        }
        _ => "there may be none".to_owned(),
    };
    let interval = match (lower, upper) {
        (Some(lower), Some(upper)) => format!("{} to {} {unit}", text(*lower), text(*upper)),
        (Some(lower), None) => format!("at least {} {unit}, {none}", text(*lower)),
        (None, Some(upper)) => format!("at most {} {unit}", text(*upper)),
        (None, None) => format!("none: {none}"),
    };
    writeln!(out, "{name}: {value}; 95 % interval {interval} ({how})")
}
