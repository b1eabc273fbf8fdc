//! Shimmy that one motion has settled on, so that others which come near it need not be followed any longer.
//!
//! How near is near is tried: a motion on the cycle is pushed in every state by a part of its size, both ways, and comes back.

use super::course::Course;
use super::fate::Target;
use super::maxima::Maximum;
use super::pushed::comes_back;
use crate::simulation::SimulationError;
use arclength::control::Control;

/// So many maxima in a row must be those of the shimmy, and no fewer than it has in one period.
const FEWEST_MAXIMA: usize = 3;
/// Parts of its size by which a cycle is pushed, from the largest on, until it comes back from all directions.
const PUSHES: [f64; 3] = [0.1, 0.03, 0.01];
/// A pushed motion comes back when it is this much nearer than it was pushed, ...
const NEARER: f64 = 0.5;
/// ... and does not while it is so many times as far.
const FARTHER: f64 = 10.0;

/// A cycle that motions come back to which were pushed.
#[derive(Clone, Debug)]
pub(super) struct Attractor {
    maxima: Vec<Maximum>,
    /// Its largest distance from the uniform motion at a maximum, all states counted.
    size: f64,
    /// Part of that from which motions come back.
    reach: f64,
}

impl Attractor {
    /// The cycle with these maxima in one period, and the part of its size from which motions are known to come back.
    pub(super) fn new(maxima: Vec<Maximum>, reach: f64, target: &Target) -> Self {
        let size = maxima.iter().map(|maximum| target.separation(&maximum.state, target.state()));
        Self { size: size.fold(0.0, f64::max), maxima, reach }
    }

    /// Whether two motions have settled on the same cycle.
    pub(super) fn is(&self, other: &Self, target: &Target) -> bool {
        let period = self.maxima.len().max(FEWEST_MAXIMA);
        let repeated: Vec<Maximum> =
            self.maxima.iter().copied().cycle().take(period.max(other.maxima.len())).collect();
        other.is_followed_by(&repeated, target)
    }

    /// Whether the last maxima of a motion are those of the cycle, in its order, in all states, as near as it is known to come back from.
    pub(super) fn is_followed_by(&self, motion: &[Maximum], target: &Target) -> bool {
        self.deviation(motion, target).is_some_and(|deviation| deviation < self.reach)
    }

    /// How far the last maxima of a motion are from those of the cycle at most, as a part of its size. Nothing where there are too few.
    fn deviation(&self, motion: &[Maximum], target: &Target) -> Option<f64> {
        let period = self.maxima.len();
        let last = &motion[motion.len().checked_sub(period.max(FEWEST_MAXIMA))?..];
        let shifted = (0..period).map(|shift| {
            let distances = last.iter().enumerate().map(|(index, maximum)| {
                target.separation(&maximum.state, &self.maxima[(index + shift) % period].state)
            });
            distances.fold(0.0, f64::max) / self.size
        });
        shifted.reduce(f64::min)
    }

    /// Finds the largest part of its size tried from which motions come back that were pushed off the cycle in any one state, both
    /// ways; `course` is a motion on it.
    ///
    /// # Errors
    /// [`SimulationError::Interrupted`].
    pub(super) fn explore(
        &mut self,
        course: &Course<'_>,
        patience: f64,
        target: &Target,
        control: &Control<'_>,
    ) -> Result<(), SimulationError> {
        for part in PUSHES.into_iter().take_while(|part| *part > self.reach) {
            if self.regains(course, part, patience, target, control)? {
                self.reach = part;
                break;
            }
        }
        Ok(())
    }

    /// Whether it comes back from every push by a part of its size.
    fn regains(
        &self,
        course: &Course<'_>,
        part: f64,
        patience: f64,
        target: &Target,
        control: &Control<'_>,
    ) -> Result<bool, SimulationError> {
        for state in 0..5 {
            for sign in [1.0, -1.0] {
                let amount = sign * part * self.size / target.scale(state);
                let verdict = |motion: &[Maximum]| match self.deviation(motion, target)? {
                    deviation if deviation > FARTHER * part => Some(false),
                    deviation if deviation < NEARER * part => Some(true),
                    _ => None,
                };
                if !comes_back(course.displaced(state, amount), patience, target, control, verdict)? {
                    return Ok(false);
                }
            }
        }
        Ok(true)
    }
}
