//! A periodic orbit as plain data: a piecewise polynomial that can be sampled, stored and restarted from.

use super::resting::rests_at;
use crate::collocation::gauss::Gauss;
use crate::collocation::mesh::{SAME_TIME, dividing_equally};
use crate::collocation::polynomials::Polynomials;
use crate::error::Error;
use crate::field::VectorField;
use crate::integration::{Crossing, Event, Integrator, Method, Stepper, autonomous};
use serde::{Deserialize, Serialize};

/// A periodic orbit, piecewise polynomial in the unit time `t / period`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Orbit {
    /// Mesh `0 = t_0 < ... < t_N = 1`.
    pub mesh: Vec<f64>,
    /// Degree of the polynomials.
    pub degree: usize,
    /// Number of state variables.
    pub dimension: usize,
    /// For every interval the states at its left end and at its Gauss points.
    pub states: Vec<f64>,
    /// Period.
    pub period: f64,
}

/// Tolerance with which a time history is cut into an orbit.
const HISTORY_TOLERANCE: f64 = 1e-9;
/// Degree and fewest intervals of an orbit made from a time history, intervals for each unit of what is made equal in all of them
/// (a harmonic motion has 6.5), and most intervals.
const HISTORY_DEGREE: usize = 7;
const FEWEST_INTERVALS: usize = 40;
const INTERVALS_PER_UNIT: f64 = 12.0;
const MOST_INTERVALS: usize = 400;
/// Fewest intervals between two breaks of a motion.
const FEWEST_BETWEEN_BREAKS: usize = 4;
/// Agreement of the state after one period, relative to the size of the motion.
const HISTORY_CLOSURE: f64 = 0.05;

/// A mesh of the unit interval that suits samples of a motion over one period: in every interval there is as much of the way in
/// time, of the changes of the states and of the roots of those of their rates.
fn mesh_for(times: &[f64], value: impl Fn(usize, usize) -> f64, dimension: usize, fewest: usize) -> Vec<f64> {
    let count = times.len();
    let period = times[count - 1] - times[0];
    let mut masses = vec![0.0; count - 1];
    for component in 0..dimension {
        let (low, high) = (0..count).fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), index| {
            (low.min(value(index, component)), high.max(value(index, component)))
        });
        if high <= low {
            continue;
        }
        let change = |index: usize| (value(index + 1, component) - value(index, component)) / (high - low);
        let rate = |index: usize| change(index) / (times[index + 1] - times[index]);
        for (index, mass) in masses.iter_mut().enumerate() {
            let bend = (rate((index + 1) % (count - 1)) - rate(index)).abs();
            let root = (bend * (times[index + 1] - times[index])).sqrt();
            *mass += (change(index).abs() + root) / dimension as f64;
        }
    }
    for (mass, pair) in masses.iter_mut().zip(times.windows(2)) {
        *mass += (pair[1] - pair[0]) / period;
    }
    let total: f64 = masses.iter().sum();
    let intervals = ((INTERVALS_PER_UNIT * total) as usize).clamp(fewest, MOST_INTERVALS);
    let inner =
        dividing_equally(times, &masses, intervals).into_iter().map(|time| (time - times[0]) / period);
    let mut mesh: Vec<f64> = [0.0].into_iter().chain(inner).chain([1.0]).collect();
    mesh.dedup_by(|later, earlier| *later <= *earlier);
    mesh
}

impl Orbit {
    /// An approximate periodic orbit from a function of time over one period, which need not be a solution: Newton's method
    /// corrects it where a branch of [`Cycles`](super::Cycles) starts.
    ///
    /// ```
    /// use arclength::cycle::Orbit;
    /// use std::f64::consts::TAU;
    /// let circle = Orbit::from_function(TAU, |time| vec![time.cos(), time.sin()]);
    /// assert!((circle.state_at(1.0)[0] - 1_f64.cos()).abs() < 1e-10);
    /// ```
    pub fn from_function(period: f64, state_at: impl FnMut(f64) -> Vec<f64>) -> Self {
        let mesh = (0..=FEWEST_INTERVALS).map(|index| index as f64 / FEWEST_INTERVALS as f64);
        Self::on_mesh(mesh.collect(), period, state_at)
    }

    fn on_mesh(mesh: Vec<f64>, period: f64, mut state_at: impl FnMut(f64) -> Vec<f64>) -> Self {
        let gauss = Gauss::of(HISTORY_DEGREE);
        let (mut states, mut dimension) = (Vec::new(), 0);
        for pair in mesh.windows(2) {
            for node in std::iter::once(0.0).chain(gauss.points.iter().copied()) {
                let state = state_at(period * (pair[0] + node * (pair[1] - pair[0])));
                dimension = state.len();
                states.extend(state);
            }
        }
        Self { mesh, degree: HISTORY_DEGREE, dimension, states, period }
    }

    /// An approximate periodic orbit from samples over one period, stable or not: the last sample is the first one, one period
    /// later.
    ///
    /// # Errors
    /// [`Error::Invalid`] for fewer than [`Self::FEWEST_SAMPLES`] samples, times that do not grow, numbers that are not finite, states
    /// of different lengths, or a last state that differs from the first by more than a twentieth of the size of the orbit.
    ///
    /// ```
    /// use arclength::cycle::Orbit;
    /// use std::f64::consts::TAU;
    /// let times: Vec<f64> = (0..=100).map(|index| TAU * f64::from(index) / 100.0).collect();
    /// let states: Vec<Vec<f64>> = times.iter().map(|time| vec![time.cos(), time.sin()]).collect();
    /// let circle = Orbit::from_samples(&times, &states)?;
    /// assert!((circle.period - TAU).abs() < 1e-15 && (circle.state_at(1.0)[1] - 1_f64.sin()).abs() < 1e-5);
    /// # Ok::<(), arclength::Error>(())
    /// ```
    pub fn from_samples(times: &[f64], states: &[Vec<f64>]) -> Result<Self, Error> {
        let wrong = |name: &str, value: String, allowed: &str| Error::Invalid {
            name: name.into(),
            value,
            allowed: allowed.into(),
        };
        let count = times.len();
        if count < Self::FEWEST_SAMPLES || states.len() != count {
            let allowed = format!("at least {}, each with its time", Self::FEWEST_SAMPLES);
            return Err(wrong("samples of the orbit", states.len().to_string(), &allowed));
        }
        if let Some(pair) = times.windows(2).find(|pair| !(pair[0] < pair[1] && pair[1].is_finite())) {
            return Err(wrong(
                "time of a sample",
                pair[1].to_string(),
                "a finite number larger than the one before",
            ));
        }
        let dimension = states[0].len();
        let bad = states.iter().position(|state| {
            state.len() != dimension || dimension == 0 || state.iter().any(|value| !value.is_finite())
        });
        if let Some(index) = bad {
            let allowed = format!("{dimension} finite numbers, as in the first");
            return Err(wrong("state of a sample", format!("{:?}", states[index]), &allowed));
        }
        for component in 0..dimension {
            let values = || states.iter().map(|state| state[component]);
            let (low, high) = values().fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), value| {
                (low.min(value), high.max(value))
            });
            let gap = (states[count - 1][component] - states[0][component]).abs();
            if gap > HISTORY_CLOSURE * (high - low) {
                return Err(wrong(
                    "last sample of the orbit",
                    format!("{:?}", states[count - 1]),
                    "the first sample, one period later",
                ));
            }
        }
        let period = times[count - 1] - times[0];
        // Around the period: the last sample repeats the first.
        let sample = |index: isize| {
            let turns = index.div_euclid(count as isize - 1);
            let place = index.rem_euclid(count as isize - 1) as usize;
            (times[place] + turns as f64 * period, &states[place])
        };
        let slope = |index: isize, component: usize| {
            let ((before, one), (after, other)) = (sample(index - 1), sample(index + 1));
            (other[component] - one[component]) / (after - before)
        };
        let mesh = mesh_for(times, |index, component| states[index][component], dimension, FEWEST_INTERVALS);
        Ok(Self::on_mesh(mesh, period, |time| {
            let time = times[0] + time;
            let index =
                times.partition_point(|candidate| *candidate <= time).clamp(1, count - 1) as isize - 1;
            let ((start, one), (end, other)) = (sample(index), sample(index + 1));
            let (step, s) = (end - start, (time - start) / (end - start));
            (0..dimension)
                .map(|component| {
                    let (a, b) = (one[component], other[component]);
                    let (u, v) = (step * slope(index, component), step * slope(index + 1, component));
                    a + s * (u + s * (3.0 * (b - a) - 2.0 * u - v + s * (u + v - 2.0 * (b - a))))
                })
                .collect()
        }))
    }

    /// Fewest samples from which an orbit is made.
    pub const FEWEST_SAMPLES: usize = 8;

    /// An approximate periodic orbit from the time history that starts at `initial`, which should have settled on a
    /// stable cycle with a period below `longest_period`.
    ///
    /// The period is the time after which the state passes, in the same direction, the plane through `initial`
    /// normal to the flow there, close to `initial`. Good enough to start [`Cycles`](super::Cycles) from.
    ///
    /// # Errors
    /// [`Error::Motion`] when the motion cannot be integrated, [`Error::Resting`] when it comes to rest, [`Error::NoReturn`] when it does
    /// not return in that time.
    pub fn from_time_history<F: VectorField>(
        field: &F,
        parameters: &[f64],
        initial: &[f64],
        longest_period: f64,
    ) -> Result<Self, Error> {
        if let Some(equilibrium) = rests_at(field, parameters, initial, longest_period) {
            return Err(Error::Resting { equilibrium });
        }
        let dimension = initial.len();
        let mut normal = vec![0.0; dimension];
        field.evaluate(initial, parameters, &mut normal);
        let position = |state: &[f64]| {
            normal.iter().zip(state).zip(initial).map(|((n, x), x0)| n * (x - x0)).sum::<f64>()
        };
        let integrator = Integrator::with_tolerance(HISTORY_TOLERANCE).method(Method::Automatic);
        let mut events = [Event::new(|_, state: &[f64]| position(state)).rising()];
        let system = autonomous(field, parameters);
        let history = integrator.with_events(system, 0.0, initial, longest_period, &[], &mut events)?;
        let distance =
            |state: &[f64]| state.iter().zip(initial).map(|(a, b)| (a - b).powi(2)).sum::<f64>().sqrt();
        let sampling: Vec<f64> = (0..=100).map(|index| longest_period * f64::from(index) / 100.0).collect();
        let sampled = integrator.sample(autonomous(field, parameters), initial, &sampling)?;
        let size = sampled.samples().map(|(_, state)| distance(state)).fold(0.0, f64::max);
        let back =
            |crossing: &&Crossing| crossing.time > 0.0 && distance(&crossing.state) < HISTORY_CLOSURE * size;
        let Some(period) = history.crossings.iter().find(back).map(|crossing| crossing.time) else {
            let states: Vec<&[f64]> = sampled.samples().map(|(_, state)| state).collect();
            return Err(Error::no_return(longest_period, &field.state_names(), &states));
        };
        let (mut steps, mut along) = (vec![0.0], initial.to_vec());
        let mut stepper = Stepper::new(autonomous(field, parameters), &integrator, 0.0, initial, period)?;
        while !stepper.is_finished() {
            stepper.advance()?;
            steps.push(stepper.time());
            along.extend_from_slice(stepper.state());
        }
        let gauss = Gauss::of(HISTORY_DEGREE);
        let value = |index: usize, component: usize| along[index * dimension + component];
        let mesh = mesh_for(&steps, value, dimension, FEWEST_INTERVALS);
        let times: Vec<f64> = mesh
            .windows(2)
            .flat_map(|pair| {
                std::iter::once(pair[0]).chain(gauss.points.iter().map(|c| pair[0] + c * (pair[1] - pair[0])))
            })
            .map(|time| time * period)
            .collect();
        let states = integrator.sample(autonomous(field, parameters), initial, &times)?.states;
        Ok(Self { mesh, degree: HISTORY_DEGREE, dimension, states, period })
    }

    /// An approximate periodic orbit of a motion that has breaks, at which its state jumps or its slope does, over one period from the
    /// first of the samples to the last: the mesh suits the samples, of which those behind a break at its time come after those before,
    /// and has the breaks among its points. `states_at` gives the states at ascending times, behind the break at one.
    ///
    /// # Errors
    /// Those of `states_at`.
    pub fn from_pieces<E>(
        times: &[f64],
        states: &[Vec<f64>],
        breaks: &[f64],
        states_at: impl FnOnce(&[f64]) -> Result<Vec<Vec<f64>>, E>,
    ) -> Result<Self, E> {
        let dimension = states.first().map_or(0, Vec::len);
        let (start, end) = times.first().zip(times.last()).map_or((0.0, 1.0), |(start, end)| (*start, *end));
        let period = end - start;
        let mut mesh = vec![0.0];
        let mut from = start;
        for until in breaks.iter().copied().chain([end]) {
            // Samples at a break are of either side.
            let margin = SAME_TIME * period;
            let first = times.partition_point(|time| *time <= from + margin);
            let last = times.partition_point(|time| *time < until - margin).max(first);
            let inside = &times[first..last];
            let points = if inside.len() < FEWEST_BETWEEN_BREAKS {
                (0..=FEWEST_BETWEEN_BREAKS).map(|index| index as f64 / FEWEST_BETWEEN_BREAKS as f64).collect()
            } else {
                let value = |index: usize, component: usize| states[first + index][component];
                mesh_for(inside, value, dimension, FEWEST_BETWEEN_BREAKS)
            };
            let scale = |point: &f64| (from + point * (until - from) - start) / period;
            mesh.extend(points[1..points.len() - 1].iter().map(scale));
            mesh.push((until - start) / period);
            from = until;
        }
        if let Some(last) = mesh.last_mut() {
            *last = 1.0;
        }
        let gauss = Gauss::new(HISTORY_DEGREE);
        let nodes: Vec<f64> = Polynomials { mesh: &mesh, gauss: &gauss, n: 0, states: &[] }
            .node_times()
            .into_iter()
            .map(|time| start + period * time)
            .collect();
        let states = states_at(&nodes)?.concat();
        Ok(Self { mesh, degree: HISTORY_DEGREE, dimension, states, period })
    }

    /// That the numbers fit together and belong to a field of `dimension` states.
    ///
    /// # Errors
    /// [`Error::Invalid`] with what does not fit.
    pub fn check(&self, dimension: usize) -> Result<(), Error> {
        let invalid = |name: &str, value: String, allowed: String| {
            Err(Error::Invalid { name: format!("{name} of the orbit"), value, allowed })
        };
        if self.dimension != dimension {
            return invalid(
                "dimension",
                self.dimension.to_string(),
                format!("{dimension}, that of the field"),
            );
        }
        if !(2..=16).contains(&self.degree) {
            return invalid("degree", self.degree.to_string(), "2 to 16".into());
        }
        let ends = self.mesh.first() == Some(&0.0) && self.mesh.last() == Some(&1.0);
        if !(ends && self.mesh.windows(2).all(|pair| pair[0] < pair[1])) {
            return invalid("mesh", format!("{} points", self.mesh.len()), "ascending from 0 to 1".into());
        }
        let expected = (self.mesh.len() - 1) * (self.degree + 1) * dimension;
        if self.states.len() != expected || self.states.iter().any(|value| !value.is_finite()) {
            let allowed = format!("{expected} finite numbers");
            return invalid("states", format!("{} numbers", self.states.len()), allowed);
        }
        if !(self.period > 0.0 && self.period.is_finite()) {
            return invalid("period", self.period.to_string(), "a positive number".into());
        }
        Ok(())
    }

    /// The same orbit by polynomials of another degree; where that is lower, each interval becomes several.
    pub(crate) fn with_degree(self, degree: usize) -> Self {
        if degree == self.degree {
            return self;
        }
        let parts = self.degree.div_ceil(degree);
        let (from, gauss) = (Gauss::of(self.degree), Gauss::of(degree));
        let polynomials =
            Polynomials { mesh: &self.mesh, gauss: &from, n: self.dimension, states: &self.states };
        let intervals = self.mesh.len() - 1;
        let mut mesh = Vec::with_capacity(intervals * parts + 1);
        let mut states = vec![0.0; intervals * parts * (degree + 1) * self.dimension];
        let mut nodes = states.chunks_exact_mut(self.dimension);
        for (interval, pair) in self.mesh.windows(2).enumerate() {
            let point = |part: usize| pair[0] + (pair[1] - pair[0]) * part as f64 / parts as f64;
            for part in 0..parts {
                let (left, right) = (point(part), if part + 1 == parts { pair[1] } else { point(part + 1) });
                mesh.push(left);
                let inner = gauss.points.iter().map(|place| left + place * (right - left));
                for (time, state) in std::iter::once(left).chain(inner).zip(&mut nodes) {
                    polynomials.state_within(interval..interval + 1, time, state);
                }
            }
        }
        mesh.push(1.0);
        drop(nodes);
        Self { mesh, degree, dimension: self.dimension, states, period: self.period }
    }

    /// Differences of the states from the middle of their ranges: the direction in which cycles grow.
    pub(super) fn deviation(&self) -> Vec<f64> {
        let middle: Vec<f64> = (0..self.dimension)
            .map(|component| {
                let values = self.states.iter().skip(component).step_by(self.dimension);
                let (low, high) = values.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), value| {
                    (low.min(*value), high.max(*value))
                });
                0.5 * (low + high)
            })
            .collect();
        let nodes = self.states.chunks_exact(self.dimension);
        nodes.flat_map(|state| state.iter().zip(&middle).map(|(value, middle)| value - middle)).collect()
    }

    /// States at `count` equidistant times `0, T/count, ...`, with the times.
    pub fn sample(&self, count: usize) -> Vec<(f64, Vec<f64>)> {
        let gauss = Gauss::of(self.degree);
        (0..count)
            .map(|index| {
                let phase = index as f64 / count as f64;
                (phase * self.period, self.state_with(&gauss, phase))
            })
            .collect()
    }

    /// State at time `time` (any real number; the orbit repeats).
    pub fn state_at(&self, time: f64) -> Vec<f64> {
        self.state_with(&Gauss::of(self.degree), (time / self.period).rem_euclid(1.0))
    }

    pub(super) fn state_with(&self, gauss: &Gauss, phase: f64) -> Vec<f64> {
        let mut state = vec![0.0; self.dimension];
        let polynomials = Polynomials { mesh: &self.mesh, gauss, n: self.dimension, states: &self.states };
        polynomials.state(phase, &mut state);
        state
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn polynomials_of_another_degree_are_the_same_orbit() {
        let mesh = vec![0.0, 0.3, 0.5, 1.0];
        let cubic = |t: f64| [1.0 + t * (2.0 - 3.0 * t * t), t * t];
        let gauss = Gauss::of(6);
        let states = mesh.windows(2).flat_map(|pair| {
            let inner = gauss.points.iter().map(|place| pair[0] + place * (pair[1] - pair[0]));
            std::iter::once(pair[0]).chain(inner).flat_map(cubic).collect::<Vec<f64>>()
        });
        let orbit =
            Orbit { degree: 6, dimension: 2, states: states.collect(), period: 2.0, mesh: mesh.clone() };
        for (degree, intervals) in [(8, 3), (6, 3), (4, 6), (3, 6)] {
            let other = orbit.clone().with_degree(degree);
            assert!(other.check(2).is_ok());
            assert_eq!(other.mesh.len(), intervals + 1);
            for time in [0.0, 0.1, 0.6, 0.7, 1.3, 1.9] {
                for (one, other) in orbit.state_at(time).iter().zip(other.state_at(time)) {
                    assert!((one - other).abs() < 1e-14);
                }
            }
        }
    }
}
