//! A motion of a model: piece by piece between the times at which its field switches, phase by phase, from event to event.
//!
//! Where a field switches in time a step of the integrator would see one side only and pass a pulse without noticing it. So every
//! switch that depends on the time alone ends a piece, in which the field is that of one side. What switches on a state divides a
//! piece into phases: in each the field of one region goes on, and where its border is crossed is located. Events set the state where
//! their conditions pass zero, and the motion goes on from there.

use super::accuracy::Accuracy;
use super::events::{Events, Happening};
use super::phase::{Exit, Phase, Stage};
use super::samples::{Again, Samples};
use super::section::{Section, SectionWatch};
use arclength::control::Control;
use arclength::integration::{Crossing, EventLocator, IntegrationError, Stepper};
use arclength::{Threshold, VectorField};
use arclength_ode::{GivenUp, Model, Switch};

/// Phases that may follow each other without time passing, for every switch, and some more.
const PHASES_AT_ONCE: usize = 4;
/// How often a crossing is located with smaller steps where the dense output does not agree with a step to it, and how much smaller.
const REFINEMENTS: usize = 4;
const FINER: f64 = 4.0;
/// Distance from a switch, in tolerances, at which a motion that slides along it is drawn back.
const LARGEST_DRIFT: f64 = 1.0;
/// Part of the time that is none.
const NO_TIME: f64 = 64.0 * f64::EPSILON;

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
    /// Stops it, and is told how far it has come.
    pub control: Control<'a>,
}

/// A motion as far as it was followed.
#[derive(Debug)]
pub(super) struct Motion<'a> {
    /// The states at the sampling times that were reached, and at events.
    pub samples: Samples<'a>,
    /// The largest magnitude of every state.
    pub sizes: Vec<f64>,
    /// Why it was not followed to the end, and at what time.
    pub ending: Option<(f64, Ending)>,
    /// Steps that were tried.
    pub steps: usize,
    /// The time from which on switches in time are not known.
    pub unknown_switches: Option<f64>,
    /// The section with its crossings.
    pub section: Option<SectionWatch>,
    /// The times at which one phase gave way to another, events among them.
    pub breaks: Vec<f64>,
}

/// Why a motion was not followed further.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Ending {
    /// A state had left the bound.
    LeftBound,
    /// The event of this index asked for it.
    Stopped(usize),
    /// The event of this index happens again and again while no time passes.
    Accumulation(usize),
    /// The control stopped it.
    Interrupted,
}

impl Course<'_> {
    /// Follows the motion, with samples at these times.
    ///
    /// # Errors
    /// [`IntegrationError`]; a sample that is no number is one.
    pub(super) fn follow<'t>(
        &self,
        accuracy: &Accuracy,
        times: &'t [f64],
    ) -> Result<Motion<'t>, IntegrationError> {
        let motion = Motion {
            samples: Samples::new(times),
            sizes: vec![0.0; self.start.len()],
            ending: None,
            steps: 0,
            unknown_switches: None,
            section: self.section.map(|section| section.watch(self.start_time, self.start)),
            breaks: Vec::new(),
        };
        let thresholds = self.model.thresholds();
        let interval = [f64::NEG_INFINITY, f64::INFINITY];
        let anywhere =
            Stage { model: self.model, parameters: self.parameters, thresholds: &thresholds, interval };
        let flow = anywhere.flow(&anywhere.phase_at(self.start_time, self.start));
        let events = Events::new(self.model.global_events(), &flow, self.start_time, self.start);
        let mut pursuit = Pursuit {
            course: *self,
            accuracy,
            time: self.start_time,
            state: self.start.to_vec(),
            events,
            motion,
        };
        pursuit.run(&thresholds)?;
        Ok(pursuit.motion)
    }
}

/// A motion that is being followed.
struct Pursuit<'a, 't> {
    course: Course<'a>,
    accuracy: &'a Accuracy,
    time: f64,
    state: Vec<f64>,
    events: Events<'a>,
    motion: Motion<'t>,
}

impl Pursuit<'_, '_> {
    /// Follows the motion to its end.
    fn run(&mut self, thresholds: &[Threshold]) -> Result<(), IntegrationError> {
        let Course { model, parameters, end_time, .. } = self.course;
        // The side of the last switch on which the field is evaluated.
        let mut low = f64::NEG_INFINITY;
        loop {
            let switch = self.next_switch(low.max(self.time));
            let (high, end, next_low) = switch.map_or((f64::INFINITY, end_time, f64::INFINITY), |switch| {
                (switch.before, switch.after.min(end_time), switch.after)
            });
            let mut stage = Stage { model, parameters, thresholds, interval: [low, high] };
            // A switch where the piece begins only says on which side that is.
            if high > low.max(self.time) || switch.is_none() {
                self.piece(&stage, end)?;
                if self.motion.ending.is_some() {
                    return Ok(());
                }
                self.time = end;
            }
            if self.time >= end_time {
                return Ok(());
            }
            low = next_low;
            stage.interval = [low, f64::INFINITY];
            let before = self.state.clone();
            let flow = |state: &[f64]| stage.flow(&stage.phase_at(low, state));
            let happening = self.events.switch(flow, self.time, &mut self.state, &self.motion.sizes);
            self.record(happening, &before);
            if self.motion.ending.is_some() {
                return Ok(());
            }
        }
    }

    fn next_switch(&mut self, from: f64) -> Option<Switch> {
        if self.motion.unknown_switches.is_some() {
            return None;
        }
        match self.course.model.next_switch(from, self.course.end_time, self.course.parameters) {
            Ok(switch) => switch,
            Err(GivenUp { time }) => {
                self.motion.unknown_switches = Some(time);
                None
            }
        }
    }

    /// Takes note of what has happened to a state.
    fn record(&mut self, happening: Happening, before: &[f64]) {
        let Happening { stopped_by, accumulates, is_seen } = happening;
        if is_seen || stopped_by.is_some() {
            self.motion.samples.record_jump(self.time, before, &self.state);
        }
        let ending = accumulates.map(Ending::Accumulation).or(stopped_by.map(Ending::Stopped));
        self.motion.ending = ending.map(|ending| (self.time, ending));
    }

    /// Follows the motion over a piece without switches in time, phase by phase, unless it ends before.
    fn piece(&mut self, stage: &Stage<'_>, end: f64) -> Result<(), IntegrationError> {
        let mut phase = stage.phase_at(self.time, &self.state);
        let mut at_once = 0;
        while self.time < end {
            let before = self.time;
            let phase_end = self.phase(stage, &phase, end)?;
            if matches!(phase_end, PhaseEnd::Passed(_) | PhaseEnd::Happens(_)) {
                self.motion.breaks.push(self.time);
            }
            match phase_end {
                PhaseEnd::Passed(exit) => {
                    let scales = self.accuracy.scales(&self.state);
                    stage.draw_to_slide(&phase, self.time, &mut self.state, &scales);
                    phase = stage.behind(&phase, exit, self.time, &self.state);
                    stage.draw_to_slide(&phase, self.time, &mut self.state, &scales);
                }
                PhaseEnd::Happens(event) => {
                    let before = self.state.clone();
                    let time = self.time;
                    let flow = |state: &[f64]| stage.flow(&stage.phase_at(time, state));
                    let arriving = stage.flow(&phase);
                    let sizes = &self.motion.sizes;
                    let happening = self.events.happen(event, &arriving, flow, time, &mut self.state, sizes);
                    self.record(happening, &before);
                    if self.motion.ending.is_some() {
                        return Ok(());
                    }
                    phase = stage.phase_at(time, &self.state);
                }
                PhaseEnd::Reached | PhaseEnd::LeftBound | PhaseEnd::Interrupted => return Ok(()),
            }
            let has_passed = self.time - before > NO_TIME * self.time.abs();
            at_once = if has_passed { 0 } else { at_once + 1 };
            if at_once > PHASES_AT_ONCE * (stage.thresholds.len() + self.events.sides().len() + 1) {
                return Err(IntegrationError::SwitchesWithoutEnd { time: self.time });
            }
        }
        Ok(())
    }

    /// Follows the motion in a phase, at most to `end`.
    fn phase(&mut self, stage: &Stage<'_>, phase: &Phase, end: f64) -> Result<PhaseEnd, IntegrationError> {
        let steps_before = self.motion.steps;
        let too_many = |error| match error {
            IntegrationError::TooManySteps { time, steps } => {
                IntegrationError::TooManySteps { time, steps: steps + steps_before }
            }
            other => other,
        };
        let left = self.accuracy.most_steps.saturating_sub(steps_before);
        if left == 0 {
            return Err(IntegrationError::TooManySteps { time: self.time, steps: steps_before });
        }
        let integrator = self.accuracy.integrator().maximum_steps(left);
        let field = || stage.flow(phase);
        let exits = stage.exits(phase);
        let mut events = stage.events(phase, &exits);
        events.extend(stage.model_events(phase));
        let signs = [&vec![1.0; exits.len()], self.events.sides()].concat();
        let mut locator = EventLocator::from_signs(signs, self.state.len());
        let mut stepper = Stepper::new(field(), &integrator, self.time, &self.state, end)?;
        let again = Again { field: &field, accuracy: self.accuracy, integrator: &integrator };
        let mut crossings = Vec::new();
        let mut refinements = 0;
        loop {
            let signs = locator.signs().to_vec();
            let is_over = stepper.time() != stepper.previous_time()
                && !events.is_empty()
                && locator.locate(&mut stepper, &mut events, &mut crossings);
            let crossing = crossings.pop().filter(|_| is_over);
            if let Some(Crossing { time, state, .. }) = &crossing
                && refinements < REFINEMENTS
                && !again.confirms(&stepper, *time, state)?
            {
                // The dense output is worse than the step: smaller steps, from where this one began.
                refinements += 1;
                let start = stepper.previous_time();
                let step = (stepper.time() - start) / FINER;
                let mut state = vec![0.0; self.state.len()];
                stepper.interpolate(start, &mut state);
                let done = stepper.statistics();
                self.motion.steps += done.accepted_steps + done.rejected_steps;
                let finer = integrator.clone().maximum_step(step);
                stepper = Stepper::new(field(), &finer, start, &state, end)?;
                locator = EventLocator::from_signs(signs, state.len());
                continue;
            }
            let reached = crossing.as_ref().map_or(stepper.time(), |crossing| crossing.time);
            self.motion.samples.record(&mut stepper, reached, &again)?;
            if let Some(section) = &mut self.motion.section {
                section.record(&mut stepper, reached, |origin, time| again.step(origin.0, origin.1, time))?;
            }
            let bound = self.course.bound;
            let outside = {
                let end = crossing.as_ref().map_or(stepper.state(), |crossing| &crossing.state);
                let sizes = self.motion.sizes.iter_mut().zip(end);
                sizes.for_each(|(size, value)| *size = size.max(value.abs()));
                end.iter().any(|value| value.abs() > bound)
            };
            if outside {
                self.motion.ending = Some((reached, Ending::LeftBound));
                self.motion.samples.leave_out_beyond(bound);
                return Ok(PhaseEnd::LeftBound);
            }
            if crossing.is_none() {
                self.events.note(&locator.signs()[exits.len()..]);
                if phase.slide().is_some() {
                    let scales = self.accuracy.scales(stepper.state());
                    if stage.drift(phase, reached, stepper.state(), &scales) > LARGEST_DRIFT {
                        let mut state = stepper.state().to_vec();
                        stage.draw_to_slide(phase, reached, &mut state, &scales);
                        stepper.restart(reached, &state, end)?;
                    }
                }
            }
            if crossing.is_some() || stepper.is_finished() {
                let done = stepper.statistics();
                self.motion.steps += done.accepted_steps + done.rejected_steps;
                self.time = reached;
                let Some(crossing) = crossing else {
                    self.state.copy_from_slice(stepper.state());
                    return Ok(PhaseEnd::Reached);
                };
                self.state.copy_from_slice(&crossing.state);
                return Ok(match exits.get(crossing.event) {
                    Some(exit) => PhaseEnd::Passed(*exit),
                    None => PhaseEnd::Happens(crossing.event - exits.len()),
                });
            }
            let Course { control, start_time, end_time, .. } = self.course;
            if control.is_stopped() {
                self.motion.ending = Some((reached, Ending::Interrupted));
                return Ok(PhaseEnd::Interrupted);
            }
            control.done((reached - start_time) / (end_time - start_time));
            match stepper.advance() {
                Ok(()) => {}
                Err(error @ (IntegrationError::NotFinite { .. } | IntegrationError::StepTooSmall { .. })) => {
                    let (time, state) = (stepper.time(), stepper.state());
                    let Some(exit) = stage.exit_without_step(phase, &exits, time, state) else {
                        return Err(error);
                    };
                    let done = stepper.statistics();
                    self.motion.steps += done.accepted_steps + done.rejected_steps;
                    self.time = time;
                    self.state.copy_from_slice(state);
                    stage.draw_to_border(phase, exit, time, &mut self.state);
                    return Ok(PhaseEnd::Passed(exit));
                }
                Err(error) => return Err(too_many(error)),
            }
        }
    }
}

/// How a phase ended.
enum PhaseEnd {
    /// At the end of the piece.
    Reached,
    /// By a switch, behind which there is another phase.
    Passed(Exit),
    /// By the event of the model with this index.
    Happens(usize),
    /// By a state beyond the bound.
    LeftBound,
    /// By the control.
    Interrupted,
}
