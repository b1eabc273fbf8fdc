//! Large shimmy: periodic motions of the wheel in which it rolls and slides in turn.
//!
//! [`Wheel::sliding_motion`] lets a motion settle, detects that it repeats itself and refines it by Newton's method on the
//! return map: shooting through the events of the hybrid model of [`sliding`](crate::sliding), with the exact derivatives of the
//! map, so that the Floquet multipliers are those of the hybrid model. [`PeriodicSliding::along`] follows it along a
//! parameter, stable or not, until the sequence of its phases changes.
//!
//! Where the wheel rolls the motion has five states and where it slides seven. A motion with a rolling phase has five multipliers: the
//! other two of the seven-state model are exactly zero, since all that is left of the slip is forgotten where it vanishes. With dry
//! friction about the king pin the caster swings and sticks by turns besides; where it sticks its yaw rate is forgotten in the same way.

mod branch;
mod curve;
mod error;
pub(crate) mod extrema;
mod forces;
mod kicks;
pub(crate) mod passage;
mod return_map;
mod search;
mod settled_cycle;
#[cfg(test)]
mod tests;
mod variation;

pub use branch::{SlidingBranch, SlidingBranchEnd, SlidingBranchOptions, SlidingBranchPoint, SlidingRole};
pub use error::{Grazing, Refusal, ShimmyError};
pub use forces::ShimmyForces;
pub use kicks::Kick;
pub use search::SlidingMotionSearch;

use crate::simulation::SimulationError;
use crate::sliding::model::Equations;
use crate::sliding::{Contact, KingPin, Phase, Regime, SlidingHistory};
use crate::wheel::Wheel;
use arclength::control::Control;
use arclength::linear::eigenvalues::eigenvalues;
use num_complex::Complex64;
use passage::Passage;
use return_map::{Return, ReturnMap, Start, newton_update};

/// Relative tolerance of the integration of periodic motions.
pub const MOTION_TOLERANCE: f64 = 1e-11;

/// The error estimate compares with a motion computed with a tolerance so much looser, ...
const LOOSER: f64 = 100.0;
/// ... and in which slip is taken to begin and to end at slip speeds so many times as high: beside them the steps do not depend on the
/// tolerance, but on how well the direction of the slip is known.
const HIGHER: f64 = 10.0;

/// Motions whose period and extrema differ by less than this part are the same; one that is not known as well is none.
const SAME: f64 = 1e-3;

/// Samples of a period between which extrema are sought.
const SAMPLES_PER_PERIOD: usize = 400;

/// A periodic motion with sliding phases. Everything is SI.
#[derive(Clone, Debug)]
pub struct PeriodicSliding {
    /// The wheel.
    pub wheel: Wheel,
    /// Period in s.
    pub period: f64,
    /// Largest caster angle in rad; where the caster turns right round, over one period from the start.
    pub psi_max: f64,
    /// Smallest caster angle in rad.
    pub psi_min: f64,
    /// Turns of the caster in a period, towards larger angles.
    pub turns: i32,
    /// The phases of one period, from the start, which lies inside a phase; neighbours of the same kind are those between which
    /// the slip passes through zero.
    pub phases: Vec<Phase>,
    /// Floquet multipliers, largest modulus first, the trivial one among them: five, or seven if the wheel never rolls.
    pub multipliers: Vec<Complex64>,
    /// Distance of the computed trivial multiplier from 1.
    pub trivial_multiplier_error: f64,
    /// Whether the motion is stable; `None` when a multiplier is closer to the unit circle than the error.
    pub stable: Option<bool>,
    /// Change of period and extrema, relative to the period and the range of the angle, when the tolerance of the integration is a hundred
    /// times looser and slip begins and ends at ten times the slip speed; no less than the tolerance.
    pub error_estimate: f64,
    start: Start,
    map: ReturnMap,
}

impl PeriodicSliding {
    /// Part of the period in which the wheel slides.
    pub fn sliding_fraction(&self) -> f64 {
        let slides = |phase: &&Phase| phase.contact == Contact::Sliding;
        self.phases.iter().filter(slides).fold(0.0, |sum, phase| sum + phase.end - phase.start) / self.period
    }

    /// State at the start, as [`SLIDING_STATE_NAMES`](crate::sliding::SLIDING_STATE_NAMES).
    pub fn state(&self) -> [f64; 7] {
        self.start.state.public()
    }

    /// Number of multipliers outside the unit circle.
    pub fn unstable_multipliers(&self) -> usize {
        self.nontrivial().filter(|multiplier| multiplier.norm() > 1.0).count()
    }

    /// The motion from its start, sampled at equal intervals over some periods.
    ///
    /// # Errors
    /// As [`SlidingWheel::simulate`](crate::sliding::SlidingWheel::simulate).
    pub fn history(
        &self,
        periods: f64,
        samples: usize,
        control: &Control<'_>,
    ) -> Result<SlidingHistory, SimulationError> {
        let wheel = self.wheel.sliding()?.tolerance(self.map.tolerance);
        wheel.simulate_hybrid(self.start.state, periods * self.period, samples, control)
    }

    fn nontrivial(&self) -> impl Iterator<Item = Complex64> + '_ {
        let trivial = trivial_index(&self.multipliers);
        self.multipliers
            .iter()
            .enumerate()
            .filter(move |(index, _)| Some(*index) != trivial)
            .map(|(_, multiplier)| *multiplier)
    }

    /// What is to be known about a solution of the map.
    fn describe(
        map: &ReturnMap,
        start: &Start,
        image: &Return,
        control: &Control<'_>,
    ) -> Result<Self, Refusal> {
        let (multipliers, trivial_multiplier_error) = multipliers(map, image)?;
        let range = angles(map, start, control)?;
        let mut motion = Self {
            wheel: map.wheel,
            period: start.period,
            psi_max: range[1],
            psi_min: range[0],
            turns: map.turns,
            phases: phases(&image.passages),
            multipliers,
            trivial_multiplier_error,
            stable: None,
            error_estimate: 0.0,
            start: start.clone(),
            map: map.clone(),
        };
        let undecided = |multiplier: Complex64| (multiplier.norm() - 1.0).abs() <= trivial_multiplier_error;
        let undecided = motion.nontrivial().any(undecided);
        motion.stable = (!undecided).then(|| motion.unstable_multipliers() == 0);
        motion.error_estimate = error_estimate(map, start, image, range, control)?;
        Ok(motion)
    }
}

/// The multiplier nearest to 1.
fn trivial_index(multipliers: &[Complex64]) -> Option<usize> {
    let distance = |index: &usize| (multipliers[*index] - 1.0).norm();
    (0..multipliers.len()).min_by(|a, b| distance(a).total_cmp(&distance(b)))
}

/// Floquet multipliers, and the distance of the trivial one from 1.
fn multipliers(map: &ReturnMap, image: &Return) -> Result<(Vec<Complex64>, f64), Refusal> {
    let d = map.free().len();
    let mut monodromy = Vec::with_capacity(d * d);
    for (column, entries) in image.jacobian.chunks_exact(d + 1).take(d).enumerate() {
        monodromy
            .extend(entries[..d].iter().enumerate().map(|(row, entry)| entry + f64::from(row == column)));
    }
    let mut list = eigenvalues(&monodromy, d).map_err(|error| Refusal::Integration(error.to_string()))?;
    list.sort_by(|a, b| b.norm().total_cmp(&a.norm()).then(b.im.total_cmp(&a.im)));
    if image.passages.iter().any(|passage| passage.mode.regime != Regime::Sliding) {
        // Slip vanishes somewhere: in the states of sliding two multipliers are zero.
        list.truncate(5);
    }
    let error = trivial_index(&list).map_or(f64::INFINITY, |index| (list[index] - 1.0).norm());
    Ok((list, error))
}

/// Smallest and largest caster angle over a period.
fn angles(map: &ReturnMap, start: &Start, control: &Control<'_>) -> Result<[f64; 2], Refusal> {
    let interval = start.period / SAMPLES_PER_PERIOD as f64;
    let times: Vec<f64> = (1..SAMPLES_PER_PERIOD).map(|index| index as f64 * interval).collect();
    let (passages, _) = map.follow(start, &times, control)?;
    Ok(extrema::caster_angles(&Equations::new(&map.wheel)?, &passages))
}

/// How far period and extrema move when the tolerance is looser.
fn error_estimate(
    map: &ReturnMap,
    start: &Start,
    image: &Return,
    range: [f64; 2],
    control: &Control<'_>,
) -> Result<f64, Refusal> {
    let mut loose = map.clone();
    loose.tolerance *= LOOSER;
    loose.slips = loose.slips.map(|slip| HIGHER * slip);
    // Near a grazing the looser tolerance may pass it.
    loose.expected = None;
    let residual = loose.evaluate(start, false, control)?.residual;
    let update = newton_update(&Return { residual, ..image.clone() })?;
    let moved = loose.moved(start, &update, -1.0);
    let loose_range = angles(&loose, &moved, control)?;
    let size = range[1] - range[0];
    Ok((moved.period / start.period - 1.0)
        .abs()
        .max((loose_range[0] - range[0]).abs() / size)
        .max((loose_range[1] - range[1]).abs() / size)
        .max(map.tolerance))
}

/// The phases as they are told: an onset is part of the sliding phase that it begins.
fn phases(passages: &[Passage]) -> Vec<Phase> {
    let mut list: Vec<Phase> = Vec::new();
    let mut before = None;
    for passage in passages {
        let phase = Phase {
            contact: passage.mode.regime.contact(),
            king_pin: passage.mode.king_pin(),
            start: passage.start,
            end: passage.end,
        };
        match list.last_mut() {
            Some(last)
                if before == Some(Regime::Onset)
                    && passage.mode.regime == Regime::Sliding
                    && last.king_pin == phase.king_pin =>
            {
                last.end = phase.end;
            }
            _ => list.push(phase),
        }
        before = Some(passage.mode.regime);
    }
    list
}

/// The time at which the longest passage is half over: the start that is farthest from the events. The first and the last
/// passage of a period are one.
fn middle_of_longest_passage(passages: &[Passage], period: f64) -> f64 {
    let [first, .., last] = passages else { return 0.0 };
    let is_split = first.mode.regime == last.mode.regime && first.mode.king_pin() == last.mode.king_pin();
    let lead = if is_split { last.duration() } else { 0.0 };
    // A caster that sticks has no yaw rate of its own.
    let is_free = |passage: &Passage| {
        passage.mode.regime != Regime::Onset && passage.mode.king_pin() == KingPin::Swinging
    };
    let candidates = passages.iter().enumerate().filter(|(_, passage)| is_free(passage));
    let spans = candidates.map(|(index, passage)| match index {
        0 => (passage.start - lead, passage.end),
        _ if index + 1 == passages.len() && is_split => (0.0, 0.0),
        _ => (passage.start, passage.end),
    });
    let longest = spans.max_by(|a, b| (a.1 - a.0).total_cmp(&(b.1 - b.0)));
    longest.map_or(0.0, |(start, end)| (0.5 * (start + end)).rem_euclid(period))
}
