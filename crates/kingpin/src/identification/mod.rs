//! Identification: the parameters of a wheel from records of its motion.
//!
//! A caster is released or hit, and its angle, or any other state, is measured against time while it swings. The parameters that are
//! estimated, and for every record the states at its start that are not known, are those with which the motion of the model is
//! nearest to what was measured, in the sum of squared residuals, each divided by the standard deviation of its column. These
//! deviations are estimated too, unless they are given: the fit is repeated until they are those of its residuals. Derivatives are exact,
//! through swings and rests of a caster with dry friction too.
//!
//! The noise is taken to be independent from sample to sample and normal; [`Whiteness`] says whether that may be so. The model is
//! that of a wheel that rolls.

mod consequence;
mod distributions;
mod error;
mod identified;
mod information;
mod interval;
mod least_squares;
mod motion;
mod problem;
mod propagation;
mod record;
mod singular_values;
mod start;
#[cfg(test)]
mod tests;
mod whiteness;

pub use consequence::ConsequenceInterval;
pub use error::IdentificationError;
pub use identified::{ChiSquared, Estimate, FittedColumn, FittedRecord, Identified, NotSeparated};
pub use interval::{Interval, IntervalMethod};
pub use problem::Unknown;
pub use propagation::JointDistribution;
pub use record::{Column, FEWEST_SAMPLES, Record, Start};
pub use whiteness::Whiteness;

use crate::parameters::{Key, Tyre};
use crate::wheel::Wheel;
use arclength::control::Control;
use information::Information;
use least_squares::{Limits, Minimum, minimise};
use problem::{Problem, bounds, unknowns};

/// How often a smaller sum of squares that is found beside the smallest one is gone on from.
const MOST_RETURNS: usize = 10;
/// Most repetitions of the fit for the deviations of the noise, and their relative change at which it ends.
const MOST_REPETITIONS: usize = 30;
const DEVIATION_TOLERANCE: f64 = 1e-5;
/// Smallest deviation of a column, as a part of how far its values spread: that of a motion without noise is the error of the integration.
const SMALLEST_DEVIATION: f64 = 1e-12;
/// Samples from which on noise is told from motion.
const ENOUGH_TO_TELL_NOISE: usize = 30;
/// Steps of a repeated fit.
const STEPS: usize = 100;
/// Relative reduction of the sum of squares that is not worth a step of it.
const TOLERANCE: f64 = 1e-12;

/// What is to be learned from which records.
///
/// ```
/// use arclength::control::Control;
/// use kingpin::identification::{Column, Identification, Record};
/// use kingpin::{Key, Wheel};
///
/// let mut wheel = Wheel::default();
/// for (key, value) in [("r", "inf"), ("v", "1"), ("c_psi", "0.003")] {
///     wheel.set(key, value)?;
/// }
/// let history = wheel.simulate(1.0, &[("psi", 0.2)], 101, &Control::none())?;
/// let values = history.state("psi").unwrap_or_default();
/// let columns = vec![Column { state: "psi".to_owned(), values }];
/// // Nothing is known of stiffness and damping but what the wheel is thought to have.
/// let start = wheel.with(Key::K, 150.0)?.with(Key::CPsi, 0.0)?;
/// let record = Record { wheel: start, times: history.times, columns };
/// let identified = Identification::new(vec![record], &[Key::K, Key::CPsi])?.run(&Control::none())?;
/// assert!((identified.wheel.get(Key::K) - 100.0).abs() < 1e-6);
/// assert!((identified.wheel.get(Key::CPsi) - 0.003).abs() < 1e-9);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug)]
pub struct Identification {
    records: Vec<Record>,
    keys: Vec<Key>,
    starts: Vec<Start>,
    offsets: Vec<String>,
    deviations: Vec<(String, f64)>,
}

impl Wheel {
    /// The parameters that records of a decaying motion are usually asked for: stiffness, dampers and dry friction about the king pin,
    /// as far as the wheel has them.
    pub fn usually_estimated(&self) -> Vec<Key> {
        let has_tyre = self.tyre() != Tyre::Rigid;
        let rigid_sideways = self.get(Key::KQ).is_infinite();
        let stiffness = if self.get(Key::KU) == self.get(Key::KQ) { Key::K } else { Key::KQ };
        let mut keys = if rigid_sideways { vec![Key::CAlpha] } else { vec![stiffness, Key::CQ] };
        keys.push(Key::CPsi);
        if !has_tyre && !self.has_lateral_elasticity_only() {
            keys.push(Key::MF);
        }
        keys
    }
}

impl Identification {
    /// The identification of some parameters. At the start of every record states that were measured, the caster angle, its rate and
    /// the lateral deflection are unknown, and all others are those of the uniform motion.
    ///
    /// # Errors
    /// A record or a list of parameters that makes no sense, or one with more unknowns than values.
    pub fn new(records: Vec<Record>, keys: &[Key]) -> Result<Self, IdentificationError> {
        let first = records.first().ok_or(IdentificationError::NoRecord)?;
        let names = first.wheel.free_states();
        let measured = |name: &str| {
            records.iter().any(|record| record.columns.iter().any(|column| column.state == name))
        };
        let start = |name: &&str| {
            let free = measured(name) || !["u", "V", "V1"].contains(name);
            if free { Start::Free } else { Start::Uniform }
        };
        let starts = names.iter().map(start).collect();
        let identification =
            Self { starts, keys: keys.to_vec(), offsets: Vec::new(), deviations: Vec::new(), records };
        identification.check()?;
        Ok(identification)
    }

    /// Says what is known of a state at the start of every record.
    ///
    /// # Errors
    /// A state that the wheel does not have.
    pub fn start(mut self, state: &str, start: Start) -> Result<Self, IdentificationError> {
        let names = self.records[0].wheel.free_states();
        let index = names.iter().position(|name| *name == state).ok_or_else(|| {
            IdentificationError::UnknownState { given: state.to_owned(), allowed: names.join(", ") }
        })?;
        self.starts[index] = start;
        Ok(self)
    }

    /// Says that what was measured of a state has an unknown zero, one for every record.
    ///
    /// # Errors
    /// A state that was not measured.
    pub fn offset(mut self, state: &str) -> Result<Self, IdentificationError> {
        self.offsets.push(state.to_owned());
        unknowns(&self.records, &self.keys, &self.starts, &self.offsets)?;
        Ok(self)
    }

    /// Says what the standard deviation of the noise of a state is.
    ///
    /// # Errors
    /// One that is not positive and finite, a state that was not measured.
    pub fn deviation(mut self, state: &str, deviation: f64) -> Result<Self, IdentificationError> {
        if !(deviation > 0.0 && deviation.is_finite()) {
            return Err(IdentificationError::Deviation { state: state.to_owned(), value: deviation });
        }
        unknowns(&self.records, &self.keys, &self.starts, &[state.to_owned()])?;
        self.deviations.push((state.to_owned(), deviation));
        Ok(self)
    }

    fn check(&self) -> Result<(), IdentificationError> {
        for (index, record) in self.records.iter().enumerate() {
            record.check(index)?;
            record.wheel.check()?;
            if record.wheel.free_states() != self.records[0].wheel.free_states() {
                let problem = "its wheel has other states than that of the first record".to_owned();
                return Err(IdentificationError::Record { record: index, problem });
            }
            // Keys that cannot vary, or not together, are told by the fields.
            let smooth: Vec<Key> = self.keys.iter().copied().filter(|key| *key != Key::MF).collect();
            record.wheel.rolling_model(&smooth)?;
            let has_tyre = record.wheel.tyre() != Tyre::Rigid;
            if has_tyre || record.wheel.has_lateral_elasticity_only() {
                self.check_without_dry_friction(&record.wheel, has_tyre)?;
            }
        }
        if let Some(&key) = self.keys.iter().find(|key| NOT_IN_THE_MOTION.contains(key)) {
            let problem = "the motion of a wheel that rolls does not depend on it";
            return Err(IdentificationError::NotEstimated { key, problem });
        }
        Ok(())
    }

    /// That dry friction about the king pin is neither there nor estimated: the derivatives of its motions are those of the rigid wheel with
    /// two springs.
    fn check_without_dry_friction(&self, wheel: &Wheel, has_tyre: bool) -> Result<(), IdentificationError> {
        if self.keys.contains(&Key::MF) {
            let problem = match has_tyre {
                true => {
                    "a fit of a wheel with a tyre takes no dry friction; leave M_f out, or set tyre = rigid"
                }
                false => "with k_u = inf there is no model of dry friction; set a finite k_u",
            };
            return Err(IdentificationError::NotEstimated { key: Key::MF, problem });
        }
        let (what, remedy) = match has_tyre {
            true => ("a fit of a wheel with a tyre", "set M_f = 0, or tyre = rigid"),
            false => ("a fit with k_u = inf", "set M_f = 0, or a finite k_u"),
        };
        wheel.check_without_dry_friction(what, remedy).map_err(IdentificationError::Wheel)
    }

    /// That every record is more than noise, where there are samples enough to tell.
    fn check_motion(&self) -> Result<(), IdentificationError> {
        for (index, record) in self.records.iter().enumerate() {
            let is_noise = |column: &Column| Whiteness::of(&column.values).is_white();
            if record.times.len() >= ENOUGH_TO_TELL_NOISE && record.columns.iter().all(is_noise) {
                let problem = "its values are noise: nothing moves; begin where the caster swings".to_owned();
                return Err(IdentificationError::Record { record: index, problem });
            }
        }
        Ok(())
    }

    /// Estimates the parameters.
    ///
    /// # Errors
    /// A record that is nothing but noise, too few values, no motion that can be followed, an interruption.
    pub fn run(&self, control: &Control<'_>) -> Result<Identified, IdentificationError> {
        self.check_motion()?;
        let unknowns = unknowns(&self.records, &self.keys, &self.starts, &self.offsets)?;
        let mut problem = self.problem(&unknowns, self.first_deviations()?);
        if problem.count() <= unknowns.len() {
            return Err(IdentificationError::TooFewValues {
                values: problem.count(),
                unknowns: unknowns.len(),
                names: identified::names_of(&unknowns, &self.records).join(", "),
            });
        }
        let limits: Vec<[f64; 2]> = unknowns.iter().map(|&unknown| bounds(unknown)).collect();
        let mut minimum = start::search(&problem, &control.part(0.0..0.5))?;
        let known = self.is_deviation_known();
        for _ in 0..MOST_RETURNS {
            for _ in 0..MOST_REPETITIONS {
                let change = self.estimate_deviations(&mut problem, &minimum, &limits);
                let limits = Limits { bounds: &limits, steps: STEPS, tolerance: TOLERANCE };
                minimum = minimise(&problem, &minimum.unknowns, &limits, &control.quiet())?;
                if change < DEVIATION_TOLERANCE {
                    break;
                }
            }
            let freedom = identified::degrees_of_freedom(&problem, &minimum, &limits) as f64;
            let half_width = distributions::half_width(if known { f64::INFINITY } else { freedom });
            let part = control.part(0.5..1.0);
            let (intervals, better) = interval::intervals(&problem, &minimum, &limits, half_width, &part)?;
            match better {
                Some(better) => minimum = better,
                None => {
                    return identified::identified(&problem, &minimum, &limits, intervals, known, control);
                }
            }
        }
        Err(IdentificationError::ManyMinima { returns: MOST_RETURNS })
    }

    /// The residuals of all samples, divided by these deviations.
    fn problem<'a>(&'a self, unknowns: &'a [Unknown], deviations: Vec<Vec<f64>>) -> Problem<'a> {
        Problem {
            records: &self.records,
            keys: &self.keys,
            starts: &self.starts,
            unknowns,
            deviations,
            samples: self.records.iter().map(|record| record.times.len()).collect(),
        }
    }

    /// Whether the deviations of all columns were given.
    fn is_deviation_known(&self) -> bool {
        let given = |column: &Column| self.deviations.iter().any(|(state, _)| *state == column.state);
        self.records.iter().flat_map(|record| &record.columns).all(given)
    }

    /// The deviations that were given, elsewhere how far the values of a state spread in all records.
    fn first_deviations(&self) -> Result<Vec<Vec<f64>>, IdentificationError> {
        let deviation = |(index, column): (usize, &Column)| {
            if let Some((_, given)) = self.deviations.iter().rfind(|(state, _)| *state == column.state) {
                return Ok(*given);
            }
            let spread = self.spread(&column.state);
            if spread > 0.0 {
                return Ok(spread);
            }
            let problem = format!("{} is the same in all samples: nothing moves", column.state);
            Err(IdentificationError::Record { record: index, problem })
        };
        let of_record = |(index, record): (usize, &Record)| {
            record.columns.iter().map(|column| deviation((index, column))).collect()
        };
        self.records.iter().enumerate().map(of_record).collect()
    }

    /// The standard deviation of a state about its mean in all records.
    fn spread(&self, state: &str) -> f64 {
        let columns = self.records.iter().flat_map(|record| &record.columns);
        let values: Vec<f64> = columns
            .filter(|column| column.state == state)
            .flat_map(|column| &column.values)
            .copied()
            .collect();
        if values.iter().all(|value| *value == values[0]) {
            // Their mean is not always the same number.
            return 0.0;
        }
        let mean = values.iter().sum::<f64>() / values.len() as f64;
        (values.iter().map(|value| (value - mean).powi(2)).sum::<f64>() / values.len() as f64).sqrt()
    }

    /// Sets the deviations that were not given to those of the residuals, corrected for the unknowns that each column determines.
    /// Returns the largest relative change.
    fn estimate_deviations(&self, problem: &mut Problem<'_>, minimum: &Minimum, limits: &[[f64; 2]]) -> f64 {
        let information = Information::of(minimum, &minimum.free(limits));
        let mut change = 0.0_f64;
        let mut first = 0;
        for (record, deviations) in self.records.iter().zip(&mut problem.deviations) {
            for (column, deviation) in record.columns.iter().zip(deviations) {
                let rows = first..first + column.values.len();
                first = rows.end;
                if self.deviations.iter().any(|(state, _)| *state == column.state) {
                    continue;
                }
                let freedom = (rows.len() as f64 - information.determined_by(rows.clone())).max(1.0);
                let sum: f64 = minimum.residuals[rows].iter().map(|residual| residual * residual).sum();
                let estimated = (*deviation * (sum / freedom).sqrt())
                    .max(SMALLEST_DEVIATION * self.spread(&column.state));
                change = change.max((estimated / *deviation - 1.0).abs());
                *deviation = estimated;
            }
        }
        change
    }
}

/// Parameters without which a wheel that rolls moves in the same way.
const NOT_IN_THE_MOTION: [Key; 4] = [Key::G, Key::MuS, Key::MuD, Key::FAz];
