//! Where the search for the unknowns begins.
//!
//! Over many swings the sum of squares has a minimum near every stiffness with which the phases differ by whole swings. So unless the
//! values to start from lead to residuals that are noise, the first swing is fitted first, then twice as much, and so on to the whole
//! records, from stiffnesses up to 64 times as small and as large too; and the best of all is taken.

use super::least_squares::{Limits, Minimum, Residuals, minimise};
use super::problem::{Problem, Unknown, bounds, typical};
use super::record::{Record, Start};
use super::whiteness::Whiteness;
use crate::parallel;
use crate::parameters::Key;
use crate::simulation::SimulationError;
use arclength::control::Control;

/// Factors by which stiffnesses are changed.
const FACTORS: [f64; 7] = [1.0, 0.25, 4.0, 0.0625, 16.0, 1.0 / 64.0, 64.0];
/// Keys that are.
const STIFFNESSES: [Key; 5] = [Key::K, Key::KQ, Key::KU, Key::KPsi, Key::CAlpha];
/// Factor by which a parameter may change on the way.
const REACH: f64 = 16.0;
/// Part of its typical size at which a damping or friction that is zero begins.
const SMALL: f64 = 0.01;
/// Samples through which a parabola is laid for the value and the slope at the start, and part of a record that it takes at most.
const FIRST_SAMPLES: usize = 7;
const FIRST_PART: f64 = 0.05;
/// Zeros after which a first swing has been made.
const ZEROS_OF_A_SWING: usize = 3;
/// Standard deviations of the noise by which one minimum has to be better than another.
const FAR_BETTER: f64 = 5.0;
/// Part of their spread within which values are met by the right motion only.
const EXACT: f64 = 1e-6;
/// Steps from swing to swing, and to the end.
const STEPS_ON_THE_WAY: usize = 12;
const STEPS: usize = 200;
/// Relative reductions of the sum of squares that are not worth a step then.
const TOLERANCE_ON_THE_WAY: f64 = 1e-3;
const TOLERANCE: f64 = 1e-8;

/// The unknowns with the smallest sum of squares that was found.
///
/// # Errors
/// No motion can be followed from any start; an interruption.
pub(super) fn search(problem: &Problem<'_>, control: &Control<'_>) -> Result<Minimum, SimulationError> {
    let first = first_values(problem, 1.0).and_then(|values| finish(problem, &values, control));
    if let Ok(minimum) = &first
        && minimum.converged
        && (is_noise(problem, minimum) || is_exact(minimum))
    {
        return first;
    }
    control.check()?;
    control.done(0.2);
    let varies = problem.keys.iter().any(|key| STIFFNESSES.contains(key));
    let factors = if varies { &FACTORS[..] } else { &FACTORS[..1] };
    let counter = control.part(0.2..0.9);
    let counter = counter.count(FACTORS.len());
    let others = parallel::map(factors, |&factor| {
        let found = grow(problem, factor, &control.quiet());
        counter.advance(1);
        // Most lead nowhere.
        found.ok()
    });
    let sum = |minimum: &Minimum| minimum.sum_of_squares();
    let best = others.into_iter().flatten().min_by(|one, other| sum(one).total_cmp(&sum(other)));
    control.check()?;
    match (first, best) {
        (Ok(first), Some(other)) if !is_far_better(&other, &first) => Ok(first),
        (_, Some(other)) => finish(problem, &other.unknowns, control),
        (first, None) => first,
    }
}

/// Whether a minimum is better than another by more than noise can make it: records of few samples a swing fit several stiffnesses, and then
/// the one that was supposed is nearest.
fn is_far_better(other: &Minimum, first: &Minimum) -> bool {
    let (better, worse) = (other.sum_of_squares(), first.sum_of_squares());
    let freedom = other.residuals.len().saturating_sub(other.unknowns.len()).max(1) as f64;
    worse - better > FAR_BETTER * FAR_BETTER * better / freedom
}

/// Fits the first swing, and then more and more, with the stiffnesses to start from multiplied by a factor; a few steps each.
fn grow(problem: &Problem<'_>, factor: f64, control: &Control<'_>) -> Result<Minimum, SimulationError> {
    let control = &control.quiet();
    let mut values = first_values(problem, factor)?;
    let limits: Vec<[f64; 2]> = problem
        .unknowns
        .iter()
        .zip(&values)
        .map(|(&unknown, &value)| reach(problem, unknown, value))
        .collect();
    let limits = Limits { bounds: &limits, steps: STEPS_ON_THE_WAY, tolerance: TOLERANCE_ON_THE_WAY };
    let mut part = problem.clone();
    part.samples = problem.records.iter().map(|record| samples_of_a_swing(record, problem)).collect();
    loop {
        let minimum = minimise(&part, &values, &limits, control)?;
        if part.samples == problem.samples {
            return Ok(minimum);
        }
        values = minimum.unknowns;
        for (some, all) in part.samples.iter_mut().zip(&problem.samples) {
            *some = (2 * *some).min(*all);
        }
    }
}

/// How far an unknown may go on the way: the little that a part of the records says of it could lead it anywhere.
fn reach(problem: &Problem<'_>, unknown: Unknown, value: f64) -> [f64; 2] {
    let [low, high] = bounds(unknown);
    let Unknown::Parameter(key) = unknown else { return [low, high] };
    let lowest = if low > 0.0 { (value / REACH).max(low) } else { low };
    let highest = REACH * value.abs().max(typical(&problem.records[0].wheel, key));
    [lowest, highest.min(high)]
}

/// Goes on until the smallest sum of squares is reached.
fn finish(problem: &Problem<'_>, values: &[f64], control: &Control<'_>) -> Result<Minimum, SimulationError> {
    let limits: Vec<[f64; 2]> = problem.unknowns.iter().map(|&unknown| bounds(unknown)).collect();
    minimise(
        problem,
        values,
        &Limits { bounds: &limits, steps: STEPS, tolerance: TOLERANCE },
        &control.quiet(),
    )
}

/// Whether the residuals are too small for noise of an instrument: they are in units of how far the values spread.
fn is_exact(minimum: &Minimum) -> bool {
    minimum.sum_of_squares() < EXACT * EXACT * minimum.residuals.len() as f64
}

/// Whether all residuals look like noise.
fn is_noise(problem: &Problem<'_>, minimum: &Minimum) -> bool {
    let mut residuals = minimum.residuals.as_slice();
    for (record, &samples) in problem.records.iter().zip(&problem.samples) {
        for _ in &record.columns {
            let (column, rest) = residuals.split_at(samples);
            if !Whiteness::of(column).is_white() {
                return false;
            }
            residuals = rest;
        }
    }
    true
}

/// Values of the unknowns to start from.
fn first_values(problem: &Problem<'_>, factor: f64) -> Result<Vec<f64>, SimulationError> {
    let mut values: Vec<f64> = problem
        .keys
        .iter()
        .map(|&key| {
            let wheel = &problem.records[0].wheel;
            let given = wheel.get(key);
            let value =
                if given == 0.0 && key.allowed().lowest == 0.0 { SMALL * typical(wheel, key) } else { given };
            let [low, high] = bounds(Unknown::Parameter(key));
            (if STIFFNESSES.contains(&key) { factor * value } else { value }).clamp(low, high)
        })
        .collect();
    values.resize(problem.unknowns.len(), 0.0);
    for (record, measured) in problem.records.iter().enumerate() {
        let wheel = problem.wheel(record, &values)?;
        let names = measured.wheel.free_states();
        let known = |wanted: &str| {
            let column = measured.columns.iter().find(|column| column.state == wanted)?;
            Some(value_and_slope(&measured.times, &column.values))
        };
        let towed = if wheel.get(Key::V) > 0.0 {
            let model = wheel.rolling_model(&[])?;
            model.free_state(&wheel.uniform_motion()?.states())
        } else {
            vec![0.0; names.len()]
        };
        for (index, unknown) in problem.unknowns.iter().enumerate() {
            let &Unknown::Start { record: of, state } = unknown else { continue };
            if of == record {
                let name = names[state];
                let of_angle = known("psi")
                    .filter(|_| name == "Omega")
                    .map(|[_, slope]| wheel.towing_yaw_rate() - slope);
                let value = known(name).map(|[value, _]| value).or(of_angle);
                values[index] = value.unwrap_or(towed[state]);
            }
        }
    }
    Ok(values)
}

/// Value and slope at the first sample, of the parabola through the first ones.
fn value_and_slope(times: &[f64], values: &[f64]) -> [f64; 2] {
    let most = ((FIRST_PART * times.len() as f64) as usize).max(FIRST_SAMPLES).min(times.len());
    let span = times[most - 1] - times[0];
    let (times, values) = (&times[..most], &values[..most]);
    let powers = |power: i32| times.iter().map(|time| ((time - times[0]) / span).powi(power)).collect();
    let parabola = Polynomial { columns: (0..3).map(powers).collect(), values };
    // A linear problem, of which every step is the last.
    let limits =
        Limits { bounds: &[[f64::NEG_INFINITY, f64::INFINITY]; 3], steps: STEPS, tolerance: TOLERANCE };
    match minimise(&parabola, &[values[0], 0.0, 0.0], &limits, &Control::none()) {
        Ok(minimum) => [minimum.unknowns[0], minimum.unknowns[1] / span],
        Err(_) => [values[0], (values[1] - values[0]) / (times[1] - times[0])],
    }
}

/// A polynomial through values.
struct Polynomial<'a> {
    /// Powers of the time.
    columns: Vec<Vec<f64>>,
    values: &'a [f64],
}

impl Residuals for Polynomial<'_> {
    type Error = SimulationError;

    fn residuals(&self, unknowns: &[f64], _: &Control<'_>) -> Result<Vec<f64>, SimulationError> {
        let value =
            |row: usize| unknowns.iter().zip(&self.columns).map(|(x, column)| x * column[row]).sum::<f64>();
        Ok(self.values.iter().enumerate().map(|(row, measured)| value(row) - measured).collect())
    }

    fn jacobian(&self, _: &[f64], _: &Control<'_>) -> Result<Vec<Vec<f64>>, SimulationError> {
        Ok(self.columns.clone())
    }
}

/// Samples of the first swing of a record, but enough of them for its unknowns.
fn samples_of_a_swing(record: &Record, problem: &Problem<'_>) -> usize {
    let fewest =
        2 * (problem.keys.len() + problem.starts.iter().filter(|start| **start == Start::Free).count());
    let values = &record.columns[0].values;
    let mean = values.iter().sum::<f64>() / values.len() as f64;
    let changes = |index: &usize| (values[*index] < mean) != (values[index - 1] < mean);
    let swing = (1..values.len()).filter(changes).nth(ZEROS_OF_A_SWING - 1);
    swing.map_or(values.len(), |index| (index + 1).max(fewest)).min(values.len())
}
