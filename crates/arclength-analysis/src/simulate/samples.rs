//! The samples of a motion, which are checked: inside a step they come from its dense output, as long as a step of its own to one of
//! them agrees.

use super::accuracy::Accuracy;
use super::condition::ROUNDING;
use arclength::integration::{IntegrationError, Integrator, Stepper, System};

/// Largest difference of a sample from a step of its own, in units of the tolerance.
const AGREEMENT: f64 = 10.0;

/// The samples of a motion as far as it was followed.
#[derive(Clone, Debug)]
pub(super) struct Samples<'a> {
    /// The times that are asked for.
    asked: &'a [f64],
    /// How many of them were reached.
    taken: usize,
    /// The times of the samples: those, and those at which something happens.
    pub times: Vec<f64>,
    /// The states at these times.
    pub states: Vec<Vec<f64>>,
}

/// How steps are taken again, to check samples.
pub(super) struct Again<'a, F> {
    pub field: &'a F,
    pub accuracy: &'a Accuracy,
    pub integrator: &'a Integrator,
}

impl<'a> Samples<'a> {
    /// None yet of those at these times.
    pub(super) fn new(asked: &'a [f64]) -> Self {
        Self { asked, taken: 0, times: Vec::new(), states: Vec::new() }
    }

    /// Adds what happens at a time: the state before it, unless that is known, and the one behind it. Before the first time that is
    /// asked for there are no samples.
    pub(super) fn record_jump(&mut self, time: f64, before: &[f64], behind: &[f64]) {
        if self.asked.first().is_none_or(|first| time < *first) {
            return;
        }
        let known = self.times.last().copied().filter(|last| time - last <= ROUNDING * time.abs());
        let time = known.unwrap_or(time);
        if known.is_none() {
            self.times.push(time);
            self.states.push(before.to_vec());
        }
        if self.states.last().is_none_or(|last| last != behind) {
            self.times.push(time);
            self.states.push(behind.to_vec());
        }
        // One that is asked for at this very time is here.
        self.taken += self.asked[self.taken..].iter().take_while(|asked| **asked <= time).count();
    }

    /// Leaves out the samples from the first that is beyond a bound on, but for the very first one.
    pub(super) fn leave_out_beyond(&mut self, bound: f64) {
        let beyond = |state: &Vec<f64>| state.iter().any(|value| value.abs() > bound);
        let within = self.states.iter().position(beyond).unwrap_or(self.states.len()).max(1);
        self.states.truncate(within);
        self.times.truncate(within);
    }

    /// Adds the samples of the last step up to a time in it.
    pub(super) fn record<S: System, F: Fn() -> S>(
        &mut self,
        stepper: &mut Stepper<S>,
        reached: f64,
        again: &Again<'_, F>,
    ) -> Result<(), IntegrationError> {
        let left = &self.asked[self.taken..];
        let (start, end) = (stepper.previous_time(), stepper.time());
        let inside = &left[..left.iter().take_while(|time| **time < end && **time <= reached).count()];
        let at_end = left[inside.len()..].iter().take_while(|time| **time == end && end == reached).count();
        if !inside.is_empty() {
            stepper.prepare_dense_output();
            let interpolated = |time: f64| {
                let mut state = vec![0.0; stepper.state().len()];
                stepper.interpolate(time, &mut state);
                state
            };
            let origin = interpolated(start);
            let mut samples: Vec<Vec<f64>> = inside.iter().map(|time| interpolated(*time)).collect();
            // What is farthest from the straight line through the ends is most in doubt.
            let doubt = |(time, sample): (&f64, &Vec<f64>)| {
                let part = (time - start) / (end - start);
                let ends = origin.iter().zip(stepper.state());
                let line: Vec<f64> = ends.map(|(from, to)| from + part * (to - from)).collect();
                again.accuracy.distance(sample, &line)
            };
            let doubts: Vec<f64> = inside.iter().zip(&samples).map(doubt).collect();
            let worst = (0..doubts.len()).max_by(|a, b| doubts[*a].total_cmp(&doubts[*b])).unwrap_or(0);
            let own = again.step(start, &origin, inside[worst])?;
            let agrees = again.accuracy.distance(&own, &samples[worst]) <= AGREEMENT;
            if !agrees {
                let (mut time, mut state) = (start, origin);
                for (sample, next) in samples.iter_mut().zip(inside) {
                    state = again.step(time, &state, *next)?;
                    time = *next;
                    sample.clone_from(&state);
                }
            }
            self.states.append(&mut samples);
        }
        self.states.extend(std::iter::repeat_n(stepper.state().to_vec(), at_end));
        let first = self.times.len();
        self.taken += inside.len() + at_end;
        self.times.extend(&left[..inside.len() + at_end]);
        let new = self.times[first..].iter().zip(&self.states[first..]);
        let no_number =
            new.filter(|(_, sample)| !sample.iter().all(|value| value.is_finite())).map(|(time, _)| *time);
        no_number.min_by(f64::total_cmp).map_or(Ok(()), |time| Err(IntegrationError::NotFinite { time }))
    }
}

impl<S: System, F: Fn() -> S> Again<'_, F> {
    /// Whether the dense output of the last step agrees at a time in it with a step to there.
    pub(super) fn confirms(
        &self,
        stepper: &Stepper<S>,
        time: f64,
        state: &[f64],
    ) -> Result<bool, IntegrationError> {
        let mut origin = vec![0.0; state.len()];
        stepper.interpolate(stepper.previous_time(), &mut origin);
        let own = self.step(stepper.previous_time(), &origin, time)?;
        Ok(self.accuracy.distance(&own, state) <= AGREEMENT)
    }

    /// The state at a time, by steps of its own.
    pub(super) fn step(&self, time: f64, state: &[f64], end: f64) -> Result<Vec<f64>, IntegrationError> {
        if end <= time {
            return Ok(state.to_vec());
        }
        let integrator = self.integrator.clone().initial_step(end - time);
        let mut stepper = Stepper::new((self.field)(), &integrator, time, state, end)?;
        while !stepper.is_finished() {
            stepper.advance()?;
        }
        Ok(stepper.state().to_vec())
    }
}
