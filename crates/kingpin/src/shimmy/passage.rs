//! A motion as the sequence of its passages: stretches along which it is smooth, each with its own equations.

use super::error::Grazing;
use crate::simulation::SimulationError;
use crate::sliding::model::SlipState;
use crate::sliding::{HybridState, Mode, Piece, Regime, SlidingWheel, as_slip_state};
use arclength::control::Control;

/// A stretch of the motion.
#[derive(Clone, Debug)]
pub(crate) struct Passage {
    pub mode: Mode,
    pub start: f64,
    pub end: f64,
    /// Whether what the caster does about the king pin ends it: a swing stands still, or a rest takes more than `M_f`.
    pub ends_about_king_pin: bool,
    pub initial: SlipState,
    /// State at the end.
    pub last: SlipState,
    /// Where the straight way of vanishing slip to zero begins, with the state there.
    pub vanishing: Option<(f64, SlipState)>,
    /// Samples inside.
    pub samples: Vec<(f64, SlipState)>,
}

impl Passage {
    pub(crate) fn duration(&self) -> f64 {
        self.end - self.start
    }

    /// Times with states along which the motion is smooth: the start, the samples inside, and the end, or where the straight
    /// way of vanishing slip begins.
    pub(crate) fn nodes(&self) -> impl Iterator<Item = (f64, &SlipState)> {
        let (end, last) =
            self.vanishing.as_ref().map_or((self.end, &self.last), |(time, state)| (*time, state));
        let inside = self.samples.iter().filter(move |(time, _)| self.start < *time && *time < end);
        std::iter::once((self.start, &self.initial))
            .chain(inside.map(|(time, state)| (*time, state)))
            .chain([(end, last)])
    }
}

/// Follows a motion and cuts it into passages, with samples at `times`.
///
/// # Errors
/// A motion that cannot be followed; [`SimulationError::Interrupted`].
pub(crate) fn passages(
    wheel: &SlidingWheel,
    initial: HybridState,
    duration: f64,
    times: &[f64],
    control: &Control<'_>,
) -> Result<(Vec<Passage>, HybridState), SimulationError> {
    let mut list: Vec<Passage> = Vec::new();
    let mut present = initial.state;
    let end =
        wheel.follow(initial, duration, times, control, |Piece { phase, mode, solution, .. }| {
            let last = as_slip_state(&solution.state);
            list.push(Passage {
                mode,
                start: phase.start,
                end: phase.end,
                ends_about_king_pin: solution.ended_by == Some(mode.regime.contact_events()),
                initial: present,
                last,
                vanishing: (mode.regime == Regime::Sliding)
                    .then(|| solution.crossings.first())
                    .flatten()
                    .map(|crossing| (crossing.time, as_slip_state(&crossing.state))),
                samples: solution.samples().map(|(time, state)| (time, as_slip_state(state))).collect(),
            });
            present = last;
            true
        })?;
    Ok((list, end))
}

/// What distinguishes a motion from one with other phases; `None` where they are the same.
pub(super) fn difference(expected: &[Passage], found: &[Passage]) -> Option<Grazing> {
    /// Times that differ by more than this part of the whole belong to different events.
    const SAME_EVENT: f64 = 0.02;
    let what =
        |passage: &Passage| (passage.mode.regime, passage.mode.king_pin(), passage.ends_about_king_pin);
    if expected.len() == found.len() && expected.iter().map(what).eq(found.iter().map(what)) {
        return None;
    }
    let (Some(last_expected), Some(last_found)) = (expected.last(), found.last()) else {
        return Some(Grazing::SlipMissesZero);
    };
    let tolerance = SAME_EVENT * last_expected.end.max(last_found.end);
    for (one, other) in expected.iter().zip(found) {
        let rolls = one.mode.regime == Regime::Rolling;
        let same_regime = one.mode.regime == other.mode.regime;
        if same_regime && (one.mode.king_pin() != other.mode.king_pin()) {
            return Some(Grazing::KingPin);
        }
        if one.mode.regime != other.mode.regime {
            return Some(if rolls { Grazing::HoldsNoLonger } else { Grazing::HoldsAgain });
        }
        let is_moved = (other.end - one.end).abs() > tolerance;
        if one.ends_about_king_pin != other.ends_about_king_pin
            || (is_moved && (one.ends_about_king_pin || other.ends_about_king_pin))
        {
            return Some(Grazing::KingPin);
        }
        if other.end < one.end - tolerance {
            return Some(if rolls { Grazing::StaticLimitReached } else { Grazing::SlipVanishes });
        }
        if other.end > one.end + tolerance {
            return Some(if rolls { Grazing::StaticLimitMissed } else { Grazing::SlipMissesZero });
        }
    }
    // Same up to the end: a phase begins or is lost at the very end.
    let rolls = last_expected.mode.regime == Regime::Rolling;
    Some(match (found.len() > expected.len(), rolls) {
        (true, true) => Grazing::StaticLimitReached,
        (true, false) => Grazing::SlipVanishes,
        (false, true) => Grazing::SlipMissesZero,
        (false, false) => Grazing::StaticLimitMissed,
    })
}
