//! Motions that last: whether they are shimmy, or only slow to leave or to return.
//!
//! A motion near an unstable cycle, or one that hardly decays, keeps its amplitude for long, so that a steady amplitude
//! alone says nothing. Here a motion is shimmy if the maxima of the caster angle repeat themselves (Poincare's return map, seen through
//! one coordinate) *and* the motion comes back to them after it was pushed, outwards and inwards: from an
//! unstable cycle it would go away. Of a motion that never repeats itself, and whose size scatters without a trend, no time of following
//! tells whether it lasts: swinging of this kind was seen to die out after hundreds of seconds.

use super::attractor::Attractor;
use super::course::{Course, Node};
use super::fate::{Fate, NEAR, PATIENCE, Target, Watch};
use super::maxima::{Cycle, Maxima, Maximum, RUN, WINDOWS};
use super::pushed::comes_back;
use crate::simulation::SimulationError;
use arclength::control::Control;
use arclength::integration::IntegrationError;
use std::f64::consts::TAU;

/// Part of its deviation from the uniform motion by which a motion is pushed.
const PUSH: f64 = 1e-3;
/// It has come back when its maxima are so near, in units of the push and the range of the angle, and is gone when so far.
const BACK: f64 = 0.1;
const GONE: f64 = 30.0;
/// Nodes are so many times as far apart while the caster turns right round.
const COARSER: f64 = 16.0;
/// The size of an irregular motion is taken in windows of so many natural periods.
const PERIODS_PER_WINDOW: f64 = 10.0;
/// Natural periods for which a motion is looked at in passing, and those which it takes to tell whether it is irregular.
pub(super) const BRIEF: f64 = 60.0;
pub(super) const THOROUGH: f64 = PERIODS_PER_WINDOW * (WINDOWS + 1) as f64;

/// A motion that is followed until it is known what becomes of it.
#[derive(Clone, Debug)]
pub(super) struct Lasting<'a> {
    course: Course<'a>,
    time: f64,
    maxima: Maxima,
    /// Shimmy that is known: motions that come near it end on it.
    known: &'a [Attractor],
    /// The shimmy that the motion settled on by itself.
    found: Option<Attractor>,
    /// Not before this time is it pushed.
    push_after: f64,
}

/// What is known of a motion when it was followed for a while.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Seen {
    /// Where it ends.
    Ends(Fate),
    /// It still swings to and fro.
    Swings,
}

impl<'a> Lasting<'a> {
    /// From where it is at a time, where some shimmy is known.
    pub(super) fn new(course: Course<'a>, time: f64, known: &'a [Attractor]) -> Self {
        Self { course, time, maxima: Maxima::default(), known, found: None, push_after: 0.0 }
    }

    /// The shimmy that the motion settled on without coming near one that was known, and the motion on it.
    pub(super) fn found(self) -> Option<(Attractor, Course<'a>)> {
        self.found.map(|attractor| (attractor, self.course))
    }

    /// Time that was reached.
    pub(super) fn time(&self) -> f64 {
        self.time
    }

    /// State `(u, q, psi, V, Omega)` there.
    pub(super) fn state(&self) -> [f64; 5] {
        self.course.state()
    }

    /// Follows the motion until its fate is known or a time is reached.
    ///
    /// # Errors
    /// A motion that cannot be followed for another reason than that it grows without bound or takes too many steps;
    /// [`SimulationError::Interrupted`].
    pub(super) fn follow(
        &mut self,
        until: f64,
        target: &Target,
        watch: &mut Watch,
        control: &Control<'_>,
    ) -> Result<Seen, SimulationError> {
        let piece = target.piece();
        let mut spacing = target.spacing();
        let mut nodes = Vec::new();
        while self.time < until {
            let duration = piece.min(until - self.time);
            match self.course.follow(duration, spacing, &mut nodes, control) {
                Ok(()) => {}
                Err(error) => return ended_by(error, watch).map(Seen::Ends),
            }
            for node in &nodes {
                if watch.observe(self.time + node.time, &node.state).is_break() {
                    return Ok(watch.fate().map_or(Seen::Swings, Seen::Ends));
                }
                self.maxima.take(self.time, node, PERIODS_PER_WINDOW * target.natural_period);
            }
            if self.slides_steadily(&nodes, target) {
                return Ok(Seen::Ends(Fate::SteadySliding));
            }
            // The maxima of a caster that turns right round tell nothing.
            let angles = nodes.iter().map(|node| node.angle[0]);
            let [low, high] = angles.fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], angle| {
                [low.min(angle), high.max(angle)]
            });
            spacing = target.spacing() * if high - low > TAU { COARSER } else { 1.0 };
            // The end itself, not the sum of the pieces, where rounding would leave a rest.
            self.time = if duration < piece { until } else { self.time + duration };
            if self.known.iter().any(|attractor| attractor.is_followed_by(self.maxima.list(), target)) {
                return Ok(Seen::Ends(Fate::Shimmy));
            }
            if self.time >= self.push_after
                && let Some(cycle) = self.maxima.cycle()
            {
                let patience = watch.duration().max(BRIEF * target.natural_period);
                if self.regains(&cycle, patience, target, control)? {
                    self.found = Some(Attractor::new(cycle.maxima, PUSH, target));
                    return Ok(Seen::Ends(Fate::Shimmy));
                }
                // It lingers at a cycle that does not attract, and may leave it yet.
                self.push_after = 2.0 * self.time;
            }
        }
        Ok(Seen::Swings)
    }

    /// Follows a motion to the end of the patience; where small motions grow, one that swings irregularly only to the end of a
    /// duration: it cannot return, and no time of following tells whether it will settle.
    ///
    /// # Errors
    /// As [`follow`](Self::follow).
    pub(super) fn until_the_end(
        &mut self,
        target: &Target,
        mut watch: Watch,
        control: &Control<'_>,
    ) -> Result<Fate, SimulationError> {
        let until = PATIENCE * watch.duration();
        while target.attracts() == Some(false) && self.time < until {
            let next = (self.time + watch.duration()).min(until);
            if let Seen::Ends(fate) = self.follow(next, target, &mut watch, control)? {
                return Ok(fate);
            }
            if self.is_irregular_for_good(target) {
                return Ok(Fate::Irregular);
            }
        }
        match self.follow(until, target, &mut watch, control)? {
            Seen::Ends(fate) => Ok(fate),
            Seen::Swings if self.maxima.is_irregular() => Ok(Fate::Irregular),
            Seen::Swings => Ok(Fate::Undecided),
        }
    }

    /// Whether the wheel stayed, for all of a piece of the motion, near steady sliding of which small disturbances die out.
    fn slides_steadily(&self, piece: &[Node], target: &Target) -> bool {
        let Some(last) = piece.last() else { return false };
        let stays_near = |centre: &[f64; 5], distance: f64| {
            piece.iter().all(|node| target.separation(&node.state, centre) < distance)
        };
        // Looking for it costs more than seeing that the motion is far from steady.
        stays_near(&last.state, 2.0 * NEAR)
            && self.course.steady_sliding().is_some_and(|steady| stays_near(&steady, NEAR))
    }

    /// Whether the motion swings irregularly and cannot return.
    pub(super) fn is_irregular_for_good(&self, target: &Target) -> bool {
        target.attracts() == Some(false) && self.maxima.is_irregular()
    }

    /// Whether it comes back to the maxima of its cycle, pushed outwards and inwards.
    fn regains(
        &self,
        cycle: &Cycle,
        patience: f64,
        target: &Target,
        control: &Control<'_>,
    ) -> Result<bool, SimulationError> {
        let distance = |maximum: &Maximum| {
            let nearest = cycle.maxima.iter().map(|of_cycle| (maximum.angle - of_cycle.angle).abs());
            nearest.fold(f64::INFINITY, f64::min) / (PUSH * cycle.range)
        };
        for factor in [1.0 + PUSH, 1.0 - PUSH] {
            let mut known = 0;
            let verdict = |motion: &[Maximum]| {
                if motion[known..].iter().any(|maximum| distance(maximum) > GONE) {
                    return Some(false);
                }
                known = motion.len();
                let last = motion.len().checked_sub(RUN).map(|first| &motion[first..]);
                last.is_some_and(|last| last.iter().all(|maximum| distance(maximum) < BACK)).then_some(true)
            };
            if !comes_back(self.course.pushed(target, factor), patience, target, control, verdict)? {
                return Ok(false);
            }
        }
        Ok(true)
    }
}

/// The fate of a motion that cannot be followed any further.
fn ended_by(error: SimulationError, watch: &Watch) -> Result<Fate, SimulationError> {
    match error {
        SimulationError::Integration(
            IntegrationError::NotFinite { .. } | IntegrationError::StepTooSmall { .. },
        ) => Ok(Fate::Escape),
        SimulationError::Integration(IntegrationError::TooManySteps { .. }) => {
            Ok(watch.fate_when_cut_short())
        }
        SimulationError::ModelEnds { .. } => Ok(Fate::ModelEnds),
        other => Err(other),
    }
}
