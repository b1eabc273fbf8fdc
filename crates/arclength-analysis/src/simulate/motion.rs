//! A motion of a model: piece by piece between the times at which its field switches, with samples that are checked.
//!
//! Where a field switches in time a step of the integrator would see one side only and pass a pulse without noticing it. So every
//! switch that depends on the time alone ends a piece, in which the field is that of one side. What switches on a state divides a
//! piece into phases: in each the field of one region goes on, and where its border is crossed is located.
//!
//! Samples inside a step come from its dense output, as long as a step of its own to one of them agrees.

use super::phase::{Phase, Stage};
use super::section::{Section, SectionWatch};
use arclength::VectorField;
use arclength::integration::{EventLocator, IntegrationError, Integrator, Method, Stepper, System};
use arclength_ode::{GivenUp, Model, Switch};

/// Phases that may follow each other without time passing, for every switch, and some more.
const PHASES_AT_ONCE: usize = 4;
/// Part of the time that is none.
const NO_TIME: f64 = 64.0 * f64::EPSILON;

/// Largest difference of a sample from a step of its own, in units of the tolerance.
const AGREEMENT: f64 = 10.0;

/// How exactly a motion is followed.
#[derive(Clone, Debug)]
pub(super) struct Accuracy {
    /// Relative tolerance.
    pub relative: f64,
    /// Absolute tolerance of every state.
    pub absolute: Vec<f64>,
    /// Largest step.
    pub largest_step: f64,
    /// Largest number of steps.
    pub most_steps: usize,
    /// Method of integration.
    pub method: Method,
}

impl Accuracy {
    fn integrator(&self) -> Integrator {
        Integrator::default()
            .relative_tolerance(self.relative)
            .absolute_tolerances(&self.absolute)
            .maximum_step(self.largest_step)
            .method(self.method)
    }

    /// The root mean square of the differences of two states in units of their tolerances.
    fn distance(&self, a: &[f64], b: &[f64]) -> f64 {
        let squares = a.iter().zip(b).zip(&self.absolute).map(|((a, b), absolute)| {
            let scale = (absolute + self.relative * a.abs().max(b.abs())).max(f64::MIN_POSITIVE);
            ((a - b) / scale).powi(2)
        });
        (squares.sum::<f64>() / self.absolute.len().max(1) as f64).sqrt()
    }
}

/// Where a motion starts and how long it is followed.
#[derive(Clone, Copy, Debug)]
pub(super) struct Course<'a> {
    pub model: &'a Model,
    pub parameters: &'a [f64],
    pub start_time: f64,
    pub start: &'a [f64],
    pub end_time: f64,
    /// Magnitude of a state at which it ends.
    pub bound: f64,
    /// A section whose crossings are wanted.
    pub section: Option<&'a Section>,
}

/// A motion as far as it was followed.
#[derive(Debug, Default)]
pub(super) struct Motion {
    /// The states at the sampling times that were reached.
    pub samples: Vec<Vec<f64>>,
    /// The largest magnitude of every state.
    pub sizes: Vec<f64>,
    /// The time by which a state had left the bound.
    pub left_bound: Option<f64>,
    /// Steps that were tried.
    pub steps: usize,
    /// The time from which on switches in time are not known.
    pub unknown_switches: Option<f64>,
    /// The section with its crossings.
    pub section: Option<SectionWatch>,
}

impl Course<'_> {
    /// Follows the motion, with samples at these times.
    ///
    /// # Errors
    /// [`IntegrationError`]; a sample that is no number is one.
    pub(super) fn follow(&self, accuracy: &Accuracy, times: &[f64]) -> Result<Motion, IntegrationError> {
        let thresholds = self.model.thresholds();
        let section = self.section.map(|section| section.watch(self.start_time, self.start));
        let mut motion = Motion { sizes: vec![0.0; self.start.len()], section, ..Motion::default() };
        let mut state = self.start.to_vec();
        let mut time = self.start_time;
        // The side of the last switch on which the field is evaluated.
        let mut low = f64::NEG_INFINITY;
        loop {
            let switch = self.next_switch(low.max(time), &mut motion);
            let (high, end, next_low) = switch
                .map_or((f64::INFINITY, self.end_time, f64::INFINITY), |switch| {
                    (switch.before, switch.after.min(self.end_time), switch.after)
                });
            // A switch where the piece begins only says on which side that is.
            if high > low.max(time) || switch.is_none() {
                let stage = Stage {
                    model: self.model,
                    parameters: self.parameters,
                    thresholds: &thresholds,
                    interval: [low, high],
                };
                if !self.piece(&stage, (time, end), &mut state, (accuracy, times), &mut motion)? {
                    return Ok(motion);
                }
                time = end;
            }
            if time >= self.end_time {
                return Ok(motion);
            }
            low = next_low;
        }
    }

    fn next_switch(&self, from: f64, motion: &mut Motion) -> Option<Switch> {
        if motion.unknown_switches.is_some() {
            return None;
        }
        match self.model.next_switch(from, self.end_time, self.parameters) {
            Ok(switch) => switch,
            Err(GivenUp { time }) => {
                motion.unknown_switches = Some(time);
                None
            }
        }
    }

    /// Follows the motion over a piece without switches in time, phase by phase; says whether to its end.
    fn piece(
        &self,
        stage: &Stage<'_>,
        (start, end): (f64, f64),
        state: &mut [f64],
        (accuracy, times): (&Accuracy, &[f64]),
        motion: &mut Motion,
    ) -> Result<bool, IntegrationError> {
        let mut time = start;
        let mut phase = stage.phase_at(time, state);
        let mut at_once = 0;
        while time < end {
            let before = time;
            let next = self.phase(stage, &phase, (&mut time, end), state, (accuracy, times), motion)?;
            match next {
                PhaseEnd::Passed(next) => phase = next,
                PhaseEnd::LeftBound => return Ok(false),
                PhaseEnd::Reached => break,
            }
            let has_passed = time - before > NO_TIME * time.abs();
            at_once = if has_passed { 0 } else { at_once + 1 };
            if at_once > PHASES_AT_ONCE * (stage.thresholds.len() + 1) {
                return Err(IntegrationError::SwitchesWithoutEnd { time });
            }
        }
        Ok(true)
    }

    /// Follows the motion in a phase, at most to `end`; `time` and `state` become those at its end.
    fn phase(
        &self,
        stage: &Stage<'_>,
        phase: &Phase,
        (time, end): (&mut f64, f64),
        state: &mut [f64],
        (accuracy, times): (&Accuracy, &[f64]),
        motion: &mut Motion,
    ) -> Result<PhaseEnd, IntegrationError> {
        let steps_before = motion.steps;
        let too_many = |error| match error {
            IntegrationError::TooManySteps { time, steps } => {
                IntegrationError::TooManySteps { time, steps: steps + steps_before }
            }
            other => other,
        };
        let left = accuracy.most_steps.saturating_sub(motion.steps);
        if left == 0 {
            return Err(IntegrationError::TooManySteps { time: *time, steps: motion.steps });
        }
        let integrator = accuracy.integrator().maximum_steps(left);
        let field = || stage.flow(phase);
        let exits = stage.exits(phase);
        let mut events = stage.events(phase, &exits);
        let mut locator = EventLocator::from_positive(events.len(), state.len());
        let mut stepper = Stepper::new(field(), &integrator, *time, state, end)?;
        let samples = Samples { field: &field, accuracy, integrator: &integrator, times };
        let mut crossings = Vec::new();
        loop {
            let is_over = stepper.time() != stepper.previous_time()
                && !events.is_empty()
                && locator.locate(&mut stepper, &mut events, &mut crossings);
            let crossing = crossings.pop().filter(|_| is_over);
            let reached = crossing.as_ref().map_or(stepper.time(), |crossing| crossing.time);
            samples.record(&mut stepper, reached, motion)?;
            if let Some(section) = &mut motion.section {
                section
                    .record(&mut stepper, reached, |origin, time| samples.step(origin.0, origin.1, time))?;
            }
            let outside = {
                let end = crossing.as_ref().map_or(stepper.state(), |crossing| &crossing.state);
                let sizes = motion.sizes.iter_mut().zip(end);
                sizes.for_each(|(size, value)| *size = size.max(value.abs()));
                end.iter().any(|value| value.abs() > self.bound)
            };
            if outside {
                motion.left_bound = Some(reached);
                let beyond = |sample: &Vec<f64>| sample.iter().any(|value| value.abs() > self.bound);
                let within = motion.samples.iter().position(beyond).unwrap_or(motion.samples.len());
                motion.samples.truncate(within.max(1));
                return Ok(PhaseEnd::LeftBound);
            }
            if crossing.is_some() || stepper.is_finished() {
                let done = stepper.statistics();
                motion.steps += done.accepted_steps + done.rejected_steps;
                *time = reached;
                let Some(crossing) = crossing else {
                    state.copy_from_slice(stepper.state());
                    return Ok(PhaseEnd::Reached);
                };
                state.copy_from_slice(&crossing.state);
                return Ok(PhaseEnd::Passed(stage.behind(phase, exits[crossing.event], reached, state)));
            }
            stepper.advance().map_err(too_many)?;
        }
    }
}

/// How a phase ended.
enum PhaseEnd {
    /// At the end of the piece.
    Reached,
    /// By a switch, behind which there is another phase.
    Passed(Phase),
    /// By a state beyond the bound.
    LeftBound,
}

/// Samples of the steps of an integrator.
struct Samples<'a, F> {
    field: &'a F,
    accuracy: &'a Accuracy,
    integrator: &'a Integrator,
    times: &'a [f64],
}

impl<S: System, F: Fn() -> S> Samples<'_, F> {
    /// Adds the samples of the last step up to a time in it.
    fn record(
        &self,
        stepper: &mut Stepper<S>,
        reached: f64,
        motion: &mut Motion,
    ) -> Result<(), IntegrationError> {
        let left = &self.times[motion.samples.len()..];
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
                self.accuracy.distance(sample, &line)
            };
            let doubts: Vec<f64> = inside.iter().zip(&samples).map(doubt).collect();
            let worst = (0..doubts.len()).max_by(|a, b| doubts[*a].total_cmp(&doubts[*b])).unwrap_or(0);
            let own = self.step(start, &origin, inside[worst])?;
            let agrees = self.accuracy.distance(&own, &samples[worst]) <= AGREEMENT;
            if !agrees {
                let (mut time, mut state) = (start, origin);
                for (sample, next) in samples.iter_mut().zip(inside) {
                    state = self.step(time, &state, *next)?;
                    time = *next;
                    sample.clone_from(&state);
                }
            }
            motion.samples.append(&mut samples);
        }
        motion.samples.extend(std::iter::repeat_n(stepper.state().to_vec(), at_end));
        let new = left.iter().zip(motion.samples.iter().skip(self.times.len() - left.len()));
        let no_number =
            new.filter(|(_, sample)| !sample.iter().all(|value| value.is_finite())).map(|(time, _)| *time);
        no_number.min_by(f64::total_cmp).map_or(Ok(()), |time| Err(IntegrationError::NotFinite { time }))
    }

    /// The state at a time, by steps of its own.
    fn step(&self, time: f64, state: &[f64], end: f64) -> Result<Vec<f64>, IntegrationError> {
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
