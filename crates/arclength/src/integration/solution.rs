//! The common tasks of an integration, and what they give: the final state, samples, crossings of events.

use super::event::EventLocator;
use super::{Crossing, Event, IntegrationError, Integrator, Statistics, Stepper, System};
use crate::control::Control;

/// Part of the time after which progress is told again.
const WORTH_TELLING: f64 = 0.01;

/// A solution: samples, crossings and where it ended.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Solution {
    /// Time at which the integration ended: the end that was asked for, or that of a terminal event.
    pub time: f64,
    /// State at that time.
    pub state: Vec<f64>,
    /// Sampling times that were reached.
    pub times: Vec<f64>,
    /// States at the sampling times, one after the other.
    pub states: Vec<f64>,
    /// Crossings in the order in which they were passed.
    pub crossings: Vec<Crossing>,
    /// Index of the terminal event that ended the integration.
    pub ended_by: Option<usize>,
    /// Work done.
    pub statistics: Statistics,
}

impl Solution {
    /// Sampling times with the states there.
    pub fn samples(&self) -> impl Iterator<Item = (f64, &[f64])> {
        self.times.iter().copied().zip(self.states.chunks_exact(self.state.len().max(1)))
    }
}

/// An [`Integrator`] at work under a [`Control`], which is told the part of the time that has passed and may stop it.
#[derive(Clone, Copy, Debug)]
pub struct ControlledIntegrator<'a> {
    integrator: &'a Integrator,
    control: Control<'a>,
}

impl Integrator {
    /// The same tasks under a control.
    pub fn under<'a>(&'a self, control: &Control<'a>) -> ControlledIntegrator<'a> {
        ControlledIntegrator { integrator: self, control: *control }
    }

    /// Integrates from `initial` at `start` to `end`.
    ///
    /// # Errors
    /// [`IntegrationError`]: bad settings or lengths, a singular or non-finite right-hand side, too many steps.
    pub fn integrate<S: System>(
        &self,
        system: S,
        start: f64,
        initial: &[f64],
        end: f64,
    ) -> Result<Solution, IntegrationError> {
        self.under(&Control::none()).integrate(system, start, initial, end)
    }

    /// Integrates from the first to the last of `times` and gives the states at all of them.
    ///
    /// # Errors
    /// As [`Integrator::integrate`]; the times must be monotone.
    pub fn sample<S: System>(
        &self,
        system: S,
        initial: &[f64],
        times: &[f64],
    ) -> Result<Solution, IntegrationError> {
        self.under(&Control::none()).sample(system, initial, times)
    }

    /// Integrates from `start` to `end` or to the first crossing of a terminal event, with samples at
    /// `times` (in the order of the integration) and all crossings of `events`.
    ///
    /// # Errors
    /// As [`Integrator::integrate`]; the times must lie between start and end and be monotone.
    pub fn with_events<S: System>(
        &self,
        system: S,
        start: f64,
        initial: &[f64],
        end: f64,
        times: &[f64],
        events: &mut [Event],
    ) -> Result<Solution, IntegrationError> {
        self.under(&Control::none()).with_events(system, start, initial, end, times, events)
    }
}

impl ControlledIntegrator<'_> {
    /// As [`Integrator::integrate`].
    ///
    /// # Errors
    /// As [`Integrator::integrate`]; [`IntegrationError::Interrupted`].
    pub fn integrate<S: System>(
        &self,
        system: S,
        start: f64,
        initial: &[f64],
        end: f64,
    ) -> Result<Solution, IntegrationError> {
        self.with_events(system, start, initial, end, &[], &mut [])
    }

    /// As [`Integrator::sample`].
    ///
    /// # Errors
    /// As [`Integrator::sample`]; [`IntegrationError::Interrupted`].
    pub fn sample<S: System>(
        &self,
        system: S,
        initial: &[f64],
        times: &[f64],
    ) -> Result<Solution, IntegrationError> {
        match (times.first(), times.last()) {
            (Some(&start), Some(&end)) => self.with_events(system, start, initial, end, times, &mut []),
            _ => Err(IntegrationError::WrongLength {
                name: "the list of sampling times",
                found: 0,
                expected: 1,
            }),
        }
    }

    /// As [`Integrator::with_events`].
    ///
    /// # Errors
    /// As [`Integrator::with_events`]; [`IntegrationError::Interrupted`].
    pub fn with_events<S: System>(
        &self,
        system: S,
        start: f64,
        initial: &[f64],
        end: f64,
        times: &[f64],
        events: &mut [Event],
    ) -> Result<Solution, IntegrationError> {
        check_times(start, end, times)?;
        let dimension = system.dimension();
        let mut stepper = Stepper::new(system, self.integrator, start, initial, end)?;
        let mut solution = Solution {
            times: Vec::with_capacity(times.len()),
            states: Vec::with_capacity(times.len() * dimension),
            ..Solution::default()
        };
        let mut locator = EventLocator::new(events, start, initial);
        let mut told = 0.0;
        loop {
            let is_terminated =
                !events.is_empty() && locator.locate(&mut stepper, events, &mut solution.crossings);
            let reached = match solution.crossings.last() {
                Some(crossing) if is_terminated => crossing.time,
                _ => stepper.time(),
            };
            record_samples(&mut stepper, times, reached, end - start, &mut solution);
            if is_terminated || stepper.is_finished() {
                solution.time = reached;
                solution.statistics = stepper.statistics();
                match solution.crossings.last() {
                    Some(crossing) if is_terminated => {
                        solution.state.clone_from(&crossing.state);
                        solution.ended_by = Some(crossing.event);
                    }
                    _ => solution.state.extend_from_slice(stepper.state()),
                }
                return Ok(solution);
            }
            self.control.check()?;
            let done = (stepper.time() - start) / (end - start);
            if done - told >= WORTH_TELLING {
                self.control.done(done);
                told = done;
            }
            stepper.advance()?;
        }
    }
}

/// Samples at the times that were not yet recorded and are not past `reached`.
fn record_samples<S: System>(
    stepper: &mut Stepper<S>,
    times: &[f64],
    reached: f64,
    direction: f64,
    solution: &mut Solution,
) {
    for &time in &times[solution.times.len()..] {
        if (time - reached) * direction.signum() > 0.0 {
            return;
        }
        let from = solution.states.len();
        if time == stepper.time() {
            solution.states.extend_from_slice(stepper.state());
        } else {
            stepper.prepare_dense_output();
            solution.states.resize(from + stepper.state().len(), 0.0);
            stepper.interpolate(time, &mut solution.states[from..]);
        }
        solution.times.push(time);
    }
}

fn check_times(start: f64, end: f64, times: &[f64]) -> Result<(), IntegrationError> {
    let direction = if end < start { -1.0 } else { 1.0 };
    let mut last = start;
    for &time in times {
        if !((time - last) * direction >= 0.0 && (end - time) * direction >= 0.0) {
            return Err(IntegrationError::BadSamplingTime { time });
        }
        last = time;
    }
    Ok(())
}
