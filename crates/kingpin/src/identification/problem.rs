//! The weighted residuals of all records as functions of the unknowns: the estimated parameters, and for every record the states at
//! its start that are not known, and the zeros of its instruments where these are not.

use super::error::IdentificationError;
use super::least_squares::Residuals;
use super::motion::{Direction, EstimatedWheel};
use super::record::{Record, Start};
use crate::parameters::Key;
use crate::simulation::SimulationError;
use crate::wheel::Wheel;
use arclength::control::Control;

/// What is unknown.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Unknown {
    /// A parameter of the wheel.
    Parameter(Key),
    /// A state at the first sample of a record.
    Start {
        /// Index of the record.
        record: usize,
        /// Index of the state among the free ones.
        state: usize,
    },
    /// What an instrument shows where the state is zero.
    Offset {
        /// Index of the record.
        record: usize,
        /// Index of the column.
        column: usize,
    },
}

/// The residuals of some samples of the records.
#[derive(Clone, Debug)]
pub(super) struct Problem<'a> {
    pub records: &'a [Record],
    pub keys: &'a [Key],
    /// What is known of every free state at the start.
    pub starts: &'a [Start],
    pub unknowns: &'a [Unknown],
    /// Standard deviations by which residuals are divided, for every column of every record.
    pub deviations: Vec<Vec<f64>>,
    /// Number of samples of every record that count, from the first on.
    pub samples: Vec<usize>,
}

impl Problem<'_> {
    /// The estimated wheel of a record.
    pub(super) fn wheel(&self, record: usize, values: &[f64]) -> Result<Wheel, SimulationError> {
        let settings = self.keys.iter().zip(values);
        Ok(settings
            .into_iter()
            .try_fold(self.records[record].wheel, |wheel, (&key, &value)| wheel.with(key, value))?)
    }

    fn estimated(&self, record: usize, values: &[f64]) -> Result<EstimatedWheel<'_>, SimulationError> {
        Ok(EstimatedWheel { wheel: self.wheel(record, values)?, keys: self.keys })
    }

    /// The free states at the start of a record.
    pub(super) fn start(&self, record: usize, values: &[f64]) -> Result<Vec<f64>, SimulationError> {
        let uniform = if self.starts.contains(&Start::Uniform) {
            self.estimated(record, values)?.uniform()?.0
        } else {
            vec![0.0; self.starts.len()]
        };
        let state = |(index, start): (usize, &Start)| match *start {
            Start::Free => self.value_of(Unknown::Start { record, state: index }, values),
            Start::Uniform => uniform[index],
            Start::At(value) => value,
        };
        Ok(self.starts.iter().enumerate().map(state).collect())
    }

    fn value_of(&self, unknown: Unknown, values: &[f64]) -> f64 {
        self.unknowns.iter().position(|other| *other == unknown).map_or(0.0, |index| values[index])
    }

    /// The measured states of a record as they follow from the unknowns, column by column.
    pub(super) fn predicted(
        &self,
        record: usize,
        values: &[f64],
        control: &Control<'_>,
    ) -> Result<Vec<Vec<f64>>, SimulationError> {
        let measured = &self.records[record];
        let times = &measured.times[..self.samples[record]];
        let states = self.estimated(record, values)?.states(&self.start(record, values)?, times, control)?;
        let columns = self.states_of_columns(record).enumerate().map(|(column, state)| {
            let offset = self.value_of(Unknown::Offset { record, column }, values);
            states.iter().map(|sample| sample[state] + offset).collect()
        });
        Ok(columns.collect())
    }

    /// The index of the free state in every column of a record.
    pub(super) fn states_of_columns(&self, record: usize) -> impl Iterator<Item = usize> {
        let names = self.records[record].wheel.free_states();
        let columns = self.records[record].columns.iter();
        columns.filter_map(|column| names.iter().position(|name| *name == column.state))
    }

    /// The size of an unknown: of a parameter that is zero, one at which it matters.
    pub(super) fn scale(&self, unknown: Unknown, value: f64) -> f64 {
        let typical = match unknown {
            Unknown::Parameter(key) => typical(&self.records[0].wheel, key),
            Unknown::Start { .. } | Unknown::Offset { .. } => return 1.0,
        };
        if value == 0.0 { typical } else { value.abs() }
    }

    /// Whether dry friction acts about the king pin in any of the records, or might.
    pub(super) fn has_dry_friction(&self) -> bool {
        self.keys.contains(&Key::MF) || self.records.iter().any(|record| record.wheel.get(Key::MF) > 0.0)
    }

    /// The number of measured values that count.
    pub(super) fn count(&self) -> usize {
        self.records.iter().zip(&self.samples).map(|(record, &samples)| record.values_in(samples)).sum()
    }

    /// The directions in which the motion of a record varies, with the index of the unknown of each.
    fn directions(
        &self,
        record: usize,
        values: &[f64],
        estimated: &EstimatedWheel<'_>,
    ) -> Result<Vec<(usize, Direction)>, SimulationError> {
        let uniform = if self.starts.contains(&Start::Uniform) { Some(estimated.uniform()?.1) } else { None };
        let mut directions = Vec::new();
        for (index, &unknown) in self.unknowns.iter().enumerate() {
            let mut start = vec![0.0; self.starts.len()];
            let parameter = match unknown {
                Unknown::Parameter(_) => {
                    let scale = self.scale(unknown, values[index]);
                    for (state, rule) in self.starts.iter().enumerate() {
                        if let (Start::Uniform, Some(uniform)) = (rule, &uniform) {
                            start[state] = scale * uniform[index][state];
                        }
                    }
                    Some((index, scale))
                }
                Unknown::Start { record: of, state } if of == record => {
                    start[state] = 1.0;
                    None
                }
                Unknown::Start { .. } | Unknown::Offset { .. } => continue,
            };
            directions.push((index, Direction { parameter, start }));
        }
        Ok(directions)
    }
}

impl Residuals for Problem<'_> {
    type Error = SimulationError;

    fn residuals(&self, values: &[f64], control: &Control<'_>) -> Result<Vec<f64>, SimulationError> {
        let mut residuals = Vec::with_capacity(self.count());
        for (index, record) in self.records.iter().enumerate() {
            let predicted = self.predicted(index, values, control)?;
            for ((column, predicted), deviation) in
                record.columns.iter().zip(predicted).zip(&self.deviations[index])
            {
                residuals.extend(
                    predicted
                        .iter()
                        .zip(&column.values)
                        .map(|(predicted, value)| (predicted - value) / deviation),
                );
            }
        }
        Ok(residuals)
    }

    fn jacobian(&self, values: &[f64], control: &Control<'_>) -> Result<Vec<Vec<f64>>, SimulationError> {
        let count = self.count();
        let mut jacobian = vec![vec![0.0; count]; self.unknowns.len()];
        let mut first = 0;
        for (index, record) in self.records.iter().enumerate() {
            let samples = self.samples[index];
            let estimated = self.estimated(index, values)?;
            let (unknowns, directions): (Vec<usize>, Vec<Direction>) =
                self.directions(index, values, &estimated)?.into_iter().unzip();
            let times = &record.times[..samples];
            let start = self.start(index, values)?;
            let derivatives = estimated.derivatives(&start, &directions, times, control)?;
            for (column, state) in self.states_of_columns(index).enumerate() {
                let deviation = self.deviations[index][column];
                let rows = first + column * samples..first + (column + 1) * samples;
                for (direction, &unknown) in unknowns.iter().enumerate() {
                    let scale = directions[direction].parameter.map_or(1.0, |(_, scale)| scale);
                    let entries = &mut jacobian[unknown][rows.clone()];
                    for (entry, sample) in entries.iter_mut().zip(&derivatives) {
                        *entry = sample[direction][state] / (scale * deviation);
                    }
                }
                let offset = Unknown::Offset { record: index, column };
                if let Some(unknown) = self.unknowns.iter().position(|other| *other == offset) {
                    jacobian[unknown][rows].fill(1.0 / deviation);
                }
            }
            first += record.values_in(samples);
        }
        Ok(jacobian)
    }
}

/// A size of a parameter at which it matters: its value or, if that is zero, one in relation to stiffnesses and masses.
pub(super) fn typical(wheel: &Wheel, key: Key) -> f64 {
    let value = wheel.get(key).abs();
    if value > 0.0 && value.is_finite() {
        return value;
    }
    let body = wheel.body();
    let l = body.caster_length;
    let stiffness = [body.lateral_stiffness, body.longitudinal_stiffness].into_iter().find(|k| k.is_finite());
    let stiffness = stiffness.unwrap_or_else(|| wheel.get(Key::CAlpha).max(1.0));
    match key {
        Key::CU | Key::CQ => (stiffness * body.rolling_mass).sqrt(),
        Key::CPsi => l * (stiffness * body.yaw_inertia).sqrt(),
        Key::KPsi | Key::Kappa => stiffness * l * l,
        Key::MF => 0.1 * stiffness * l * l,
        Key::HalfContactLength | Key::TP | Key::LC => l,
        Key::FAz => wheel.mass() * wheel.get(Key::G),
        _ => 1.0,
    }
}

/// The bounds of an unknown.
pub(super) fn bounds(unknown: Unknown) -> [f64; 2] {
    match unknown {
        Unknown::Parameter(key) => [key.allowed().lowest, key.allowed().highest],
        Unknown::Start { .. } | Unknown::Offset { .. } => [f64::NEG_INFINITY, f64::INFINITY],
    }
}

/// What is unknown, where the parameters come first.
///
/// # Errors
/// An offset of a state that is not measured.
pub(super) fn unknowns(
    records: &[Record],
    keys: &[Key],
    starts: &[Start],
    offsets: &[String],
) -> Result<Vec<Unknown>, IdentificationError> {
    for given in offsets {
        let measured = |record: &Record| record.columns.iter().any(|column| column.state == *given);
        if !records.iter().any(measured) {
            let mut names: Vec<&str> = records
                .iter()
                .flat_map(|record| &record.columns)
                .map(|column| column.state.as_str())
                .collect();
            names.sort_unstable();
            names.dedup();
            return Err(IdentificationError::UnknownState {
                given: given.clone(),
                allowed: names.join(", "),
            });
        }
    }
    let mut unknowns: Vec<Unknown> = keys.iter().map(|&key| Unknown::Parameter(key)).collect();
    for (record, measured) in records.iter().enumerate() {
        let free = starts.iter().enumerate().filter(|(_, start)| **start == Start::Free);
        unknowns.extend(free.map(|(state, _)| Unknown::Start { record, state }));
        let with_offset =
            measured.columns.iter().enumerate().filter(|(_, column)| offsets.contains(&column.state));
        unknowns.extend(with_offset.map(|(column, _)| Unknown::Offset { record, column }));
    }
    Ok(unknowns)
}
