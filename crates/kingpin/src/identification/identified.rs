//! What was learned: estimates with their intervals, what could not be told apart, and the fitted records.

use super::distributions::{chi_squared_tail, half_width};
use super::error::IdentificationError;
use super::information::Information;
use super::interval::{Interval, IntervalMethod};
use super::least_squares::Minimum;
use super::problem::{Problem, Unknown};
use super::propagation::JointDistribution;
use super::record::Record;
use super::whiteness::Whiteness;
use crate::parameters::Key;
use crate::wheel::Wheel;
use arclength::control::Control;

/// Correlation from which on two parameters are hardly told apart.
const HARDLY_SEPARATED: f64 = 0.99;

/// An estimated parameter.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Estimate {
    /// Which.
    pub key: Key,
    /// Its value in SI units; nothing where the records do not determine it.
    pub value: Option<f64>,
    /// Its standard error; nothing at a bound, and where the value is not determined.
    pub standard_error: Option<f64>,
    /// Its 95 per cent confidence interval.
    pub interval: Interval,
}

/// Parameters that the records do not tell apart, or hardly.
#[derive(Clone, Debug, PartialEq)]
pub struct NotSeparated {
    /// Which.
    pub keys: Vec<Key>,
    /// The correlation of two that are hardly told apart; nothing where the information matrix is singular.
    pub correlation: Option<f64>,
}

/// A measured state of a record with what was fitted to it.
#[derive(Clone, Debug, PartialEq)]
pub struct FittedColumn {
    /// Its name.
    pub state: String,
    /// The fitted values at the times of the record.
    pub values: Vec<f64>,
    /// What the instrument shows where the state is zero; zero where that is not unknown.
    pub offset: f64,
    /// Standard deviation of the noise: that of the residuals, or the one that was given.
    pub deviation: f64,
    /// Whether the residuals are noise.
    pub whiteness: Whiteness,
}

/// A record with what was fitted to it.
#[derive(Clone, Debug, PartialEq)]
pub struct FittedRecord {
    /// The wheel with the estimates, at the speed and on the path of the record.
    pub wheel: Wheel,
    /// The free states at the first sample.
    pub start: Vec<f64>,
    /// The measured states.
    pub columns: Vec<FittedColumn>,
}

/// Whether residuals are as large as the deviations that were given say.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ChiSquared {
    /// Sum of the squared residuals, each divided by its deviation.
    pub value: f64,
    /// Probability that noise of these deviations has a larger one.
    pub probability: f64,
}

/// What was learned from records.
#[derive(Clone, Debug, PartialEq)]
pub struct Identified {
    /// The wheel with the estimates, otherwise that of the first record.
    pub wheel: Wheel,
    /// The estimates, in the order that was asked for.
    pub estimates: Vec<Estimate>,
    /// Their correlations; nothing where one of two is at a bound or not determined.
    pub correlations: Vec<Vec<Option<f64>>>,
    /// Parameters that are not told apart, or hardly.
    pub not_separated: Vec<NotSeparated>,
    /// Parameters that the records do not determine.
    pub undetermined: Vec<Key>,
    /// The fitted records.
    pub records: Vec<FittedRecord>,
    /// Number of measured values.
    pub values: usize,
    /// What is unknown, by name: parameters, states at the start and offsets.
    pub unknowns: Vec<String>,
    /// Number of values less that of the unknowns that they determine.
    pub degrees_of_freedom: usize,
    /// Whether the residuals are as large as was said; nothing where not all deviations were given.
    pub chi_squared: Option<ChiSquared>,
    /// Whether the smallest sum of squares was found.
    pub converged: bool,
    /// How likely other parameters are; nothing where some are not determined.
    pub distribution: Option<JointDistribution>,
    /// Where the sum of squares is smallest.
    pub(super) fit: Fit,
}

/// Where the sum of squares is smallest, for what is computed from there on.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Fit {
    pub unknowns: Vec<f64>,
    /// Standard deviations by which residuals are divided, for every column of every record.
    pub deviations: Vec<Vec<f64>>,
    /// Half width of intervals in standard errors.
    pub half_width: f64,
}

/// The number of values less that of the unknowns that are not held by a bound.
pub(super) fn degrees_of_freedom(problem: &Problem<'_>, minimum: &Minimum, bounds: &[[f64; 2]]) -> usize {
    problem.count() - minimum.free(bounds).len()
}

/// The names of unknowns: `k`, `psi at the start of record 1`, `zero of psi in record 1`.
pub(super) fn names_of(unknowns: &[Unknown], records: &[Record]) -> Vec<String> {
    let name = |unknown: &Unknown| match *unknown {
        Unknown::Parameter(key) => key.name().to_owned(),
        Unknown::Start { record, state } => {
            let names = records[record].wheel.free_states();
            format!("{} at the start of record {}", names[state], record + 1)
        }
        Unknown::Offset { record, column } => {
            format!("zero of {} in record {}", records[record].columns[column].state, record + 1)
        }
    };
    unknowns.iter().map(name).collect()
}

/// The result of a fit with its intervals; `known` says that all deviations of the noise were given.
///
/// # Errors
/// A motion that cannot be followed, an interruption.
pub(super) fn identified(
    problem: &Problem<'_>,
    minimum: &Minimum,
    bounds: &[[f64; 2]],
    intervals: Vec<Interval>,
    known: bool,
    control: &Control<'_>,
) -> Result<Identified, IdentificationError> {
    let count = problem.keys.len();
    let information = Information::of(minimum, &minimum.free(bounds));
    let degrees_of_freedom = degrees_of_freedom(problem, minimum, bounds);
    let freedom = if known { f64::INFINITY } else { degrees_of_freedom as f64 };
    let distribution = distribution(problem, minimum, bounds, &intervals, freedom);
    let groups: Vec<Vec<usize>> = information.undetermined();
    let is_undetermined = |index: usize| groups.iter().any(|group| group.contains(&index));
    let estimates =
        problem.keys.iter().zip(intervals).enumerate().map(|(index, (&key, interval))| Estimate {
            key,
            value: Some(minimum.unknowns[index]).filter(|_| !is_undetermined(index)),
            standard_error: information.covariance(index, index).map(f64::sqrt),
            interval,
        });
    let correlations: Vec<Vec<Option<f64>>> = (0..count)
        .map(|row| (0..count).map(|column| information.correlation(row, column)).collect())
        .collect();
    let mut not_separated: Vec<NotSeparated> = Vec::new();
    for group in &groups {
        let keys: Vec<Key> = group.iter().filter_map(|&index| problem.keys.get(index).copied()).collect();
        if !keys.is_empty() {
            not_separated.push(NotSeparated { keys, correlation: None });
        }
    }
    // One that its bound holds may still be told apart from another one or not.
    let all = Information::of(minimum, &(0..minimum.unknowns.len()).collect::<Vec<usize>>());
    for (row, column) in (0..count).flat_map(|row| (row + 1..count).map(move |column| (row, column))) {
        let correlation = all.correlation(row, column);
        if correlation.is_some_and(|correlation| correlation.abs() > HARDLY_SEPARATED) {
            let keys = vec![problem.keys[row], problem.keys[column]];
            not_separated.push(NotSeparated { keys, correlation });
        }
    }
    let sum = minimum.sum_of_squares();
    Ok(Identified {
        wheel: problem.wheel(0, &minimum.unknowns)?,
        estimates: estimates.collect(),
        correlations,
        not_separated,
        undetermined: (0..count)
            .filter(|&index| is_undetermined(index))
            .map(|index| problem.keys[index])
            .collect(),
        records: fitted_records(problem, minimum, &control.quiet())?,
        values: problem.count(),
        unknowns: names_of(problem.unknowns, problem.records),
        degrees_of_freedom,
        chi_squared: known.then(|| ChiSquared {
            value: sum,
            probability: chi_squared_tail(sum, degrees_of_freedom as f64),
        }),
        converged: minimum.converged,
        distribution,
        fit: Fit {
            unknowns: minimum.unknowns.clone(),
            deviations: problem.deviations.clone(),
            half_width: half_width(freedom),
        },
    })
}

fn fitted_records(
    problem: &Problem<'_>,
    minimum: &Minimum,
    control: &Control<'_>,
) -> Result<Vec<FittedRecord>, IdentificationError> {
    let mut fitted = Vec::new();
    let mut first = 0;
    for (index, record) in problem.records.iter().enumerate() {
        let predicted = problem.predicted(index, &minimum.unknowns, control)?;
        let mut columns = Vec::new();
        for (column, values) in predicted.into_iter().enumerate() {
            let rows = first..first + values.len();
            first = rows.end;
            let offset = Unknown::Offset { record: index, column };
            let place = problem.unknowns.iter().position(|unknown| *unknown == offset);
            columns.push(FittedColumn {
                state: record.columns[column].state.clone(),
                values,
                offset: place.map_or(0.0, |place| minimum.unknowns[place]),
                deviation: problem.deviations[index][column],
                whiteness: Whiteness::of(&minimum.residuals[rows]),
            });
        }
        let wheel = problem.wheel(index, &minimum.unknowns)?;
        fitted.push(FittedRecord { wheel, start: problem.start(index, &minimum.unknowns)?, columns });
    }
    Ok(fitted)
}

/// The distribution of the parameters, those at a bound included, each as wide as its interval; where a bound holds one of them
/// intervals are cut off by it, and widths are those of the quadratic model.
fn distribution(
    problem: &Problem<'_>,
    minimum: &Minimum,
    bounds: &[[f64; 2]],
    intervals: &[Interval],
    freedom: f64,
) -> Option<JointDistribution> {
    let all: Vec<usize> = (0..minimum.unknowns.len()).collect();
    let information = Information::of(minimum, &all);
    let step = information.newton_step(&minimum.residuals);
    let count = problem.keys.len();
    let is_held = minimum.free(bounds).len() < minimum.unknowns.len();
    // Where the model is not nearly linear, the interval says more than the standard error.
    let stretch = |index: usize| {
        let Interval { lower, upper, reaches_lower_bound, method } = intervals[index];
        if is_held {
            return Some(1.0);
        }
        let value = minimum.unknowns[index];
        let half = match (lower, upper) {
            (_, Some(upper)) if reaches_lower_bound => upper - value,
            (Some(lower), Some(upper)) => 0.5 * (upper - lower),
            _ => return Some(1.0),
        };
        let deviation = information.covariance(index, index)?.sqrt();
        Some(if method == IntervalMethod::Linear { 1.0 } else { half / (half_width(freedom) * deviation) })
    };
    let stretches: Vec<f64> = (0..count).map(stretch).collect::<Option<_>>()?;
    let entry = |row: usize, column: usize| {
        Some(stretches[row] * stretches[column] * information.covariance(row, column)?)
    };
    let row = |row: usize| (0..count).map(|column| entry(row, column)).collect();
    let covariance: Option<Vec<Vec<f64>>> = (0..count).map(row).collect();
    Some(JointDistribution {
        keys: problem.keys.to_vec(),
        centre: (0..count).map(|index| minimum.unknowns[index] + step[index]).collect(),
        covariance: covariance?,
        degrees_of_freedom: freedom,
    })
}
