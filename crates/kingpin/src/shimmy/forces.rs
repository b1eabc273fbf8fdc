//! Forces and powers along a periodic motion with sliding phases.
//!
//! A period is sampled at equal intervals within each of its passages, between which forces jump: the largest value is that of the
//! parabola through three neighbours, a mean is Simpson's.

use super::PeriodicSliding;
use super::error::{Refusal, ShimmyError};
use super::passage::Passage;
use crate::forces::CycleForces;
use crate::sliding::model::{Equations, SlipState, slips};
use crate::sliding::{Contact, Regime};
use arclength::control::Control;

/// Samples of a period: the largest value of the parabola through three of them is then exact to about 1e-10.
const SAMPLES: usize = 4000;

/// Forces and powers along a periodic motion with sliding phases.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ShimmyForces {
    /// The largest forces, and what the dampers take.
    pub forces: CycleForces,
    /// What the friction takes while the wheel slides, the mean over a period in W.
    pub sliding_power: f64,
    /// What the towing frame gives, the mean over a period in W: as much as dampers and friction take.
    pub towing_power: f64,
    /// What dry friction about the king pin takes, the mean over a period in W.
    pub dry_friction_power: f64,
}

/// Values at a sample.
#[derive(Clone, Copy)]
struct Sample {
    friction: f64,
    king_pin: f64,
    /// Of dampers, of sliding friction, of the towing frame and of dry friction about the king pin.
    powers: [f64; 4],
}

impl PeriodicSliding {
    /// Forces and powers over a period.
    ///
    /// # Errors
    /// [`ShimmyError::NotConverged`] where the motion cannot be followed, [`ShimmyError::Interrupted`].
    pub fn forces(&self, control: &Control<'_>) -> Result<ShimmyForces, ShimmyError> {
        let (bounds, _) = self.map.follow(&self.start, &[], control)?;
        let times: Vec<f64> = bounds.iter().flat_map(|passage| self.inner_times(passage)).collect();
        let (passages, _) = self.map.follow(&self.start, &times, control)?;
        let equations = Equations::new(&self.wheel)?;
        let (mut friction_max, mut king_pin_force_max, mut energies) = (0.0_f64, 0.0_f64, [0.0; 4]);
        for passage in &passages {
            let samples = samples(&equations.under(passage.mode.friction_moment), passage);
            if samples.len().is_multiple_of(2) {
                let cause = format!("{} samples of a phase cannot be integrated", samples.len());
                return Err(Refusal::Integration(cause).into());
            }
            friction_max = friction_max.max(largest(&samples, |sample| sample.friction));
            king_pin_force_max = king_pin_force_max.max(largest(&samples, |sample| sample.king_pin));
            let step = passage.duration() / (samples.len() - 1) as f64;
            for (power, energy) in energies.iter_mut().enumerate() {
                let values = samples.iter().map(|sample| sample.powers[power]);
                *energy += simpson(values, samples.len() - 1) * step;
            }
        }
        let [damper_power, sliding_power, towing_power, dry_friction_power] =
            energies.map(|energy| energy / self.period);
        let static_limit = self.wheel.static_limit();
        // The force at which a phase of rolling ends is the limit.
        let friction_max = if self.starts_to_slide() { static_limit } else { friction_max };
        let forces = CycleForces { friction_max, static_limit, king_pin_force_max, damper_power };
        Ok(ShimmyForces { forces, sliding_power, towing_power, dry_friction_power })
    }

    /// Whether a phase of sliding follows one of rolling. The period begins inside a phase.
    fn starts_to_slide(&self) -> bool {
        self.phases
            .windows(2)
            .any(|pair| [pair[0].contact, pair[1].contact] == [Contact::Rolling, Contact::Sliding])
    }

    /// Times between the ends of a passage, an odd number of them.
    fn inner_times(&self, passage: &Passage) -> Vec<f64> {
        let share = passage.duration() / self.period;
        let half = (0.5 * share * SAMPLES as f64).ceil().max(1.0) as usize;
        let intervals = 2 * half;
        let time = |index| passage.start + passage.duration() * index as f64 / intervals as f64;
        let inside = (1..intervals).map(time).filter(|time| passage.start < *time && *time < passage.end);
        let times: Vec<f64> = inside.collect();
        // So short a passage that its inner times are not told apart has none.
        if times.len() == intervals - 1 && times.windows(2).all(|pair| pair[0] < pair[1]) {
            times
        } else {
            Vec::new()
        }
    }
}

/// What is known at the ends of a passage and at the samples inside; three times the middle of what is too short for samples.
fn samples(equations: &Equations<f64>, passage: &Passage) -> Vec<Sample> {
    let inside: Vec<&SlipState> = passage
        .samples
        .iter()
        .filter(|(time, _)| passage.start < *time && *time < passage.end)
        .map(|(_, state)| state)
        .collect();
    if inside.is_empty() {
        return vec![sample(equations, passage.mode.regime, &passage.last); 3];
    }
    let states = [&passage.initial].into_iter().chain(inside).chain([&passage.last]);
    states.map(|state| sample(equations, passage.mode.regime, state)).collect()
}

fn sample(equations: &Equations<f64>, regime: Regime, state: &SlipState) -> Sample {
    // Where slip vanishes its direction is not defined; the power of the friction is zero there.
    let friction = match regime {
        Regime::Sliding if !slips(state) => [0.0; 2],
        regime => regime.friction(equations, state),
    };
    let (towing, _) = equations.power(state, friction);
    let [x, y] = equations.king_pin_force(state);
    Sample {
        friction: friction[0].hypot(friction[1]),
        king_pin: x.hypot(y),
        powers: [
            equations.power_of_damping(state),
            equations.power_of_sliding(state, friction),
            towing,
            equations.friction_moment(state, friction) * equations.swing_rate(state),
        ],
    }
}

/// The largest of some values at equal intervals, or of the parabola through it and its neighbours.
fn largest(samples: &[Sample], value: impl Fn(&Sample) -> f64) -> f64 {
    let values: Vec<f64> = samples.iter().map(value).collect();
    let ends = values.iter().copied().fold(0.0, f64::max);
    values.windows(3).fold(ends, |largest, three| {
        let [before, here, after] = [three[0], three[1], three[2]];
        let bend = before - 2.0 * here + after;
        if here < before || here < after || bend == 0.0 {
            return largest;
        }
        largest.max(here - (after - before).powi(2) / (8.0 * bend))
    })
}

/// Simpson's sum of an odd number of values at equal intervals, in units of the interval.
fn simpson(values: impl Iterator<Item = f64>, last: usize) -> f64 {
    let weight = |index: usize| match index {
        0 => 1.0,
        index if index == last => 1.0,
        index if index % 2 == 1 => 4.0,
        _ => 2.0,
    };
    values.enumerate().map(|(index, value)| weight(index) * value).sum::<f64>() / 3.0
}
