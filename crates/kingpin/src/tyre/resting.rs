//! The caster angles at which a wheel with a tyre rests where dry friction acts about its king pin.
//!
//! Held at an angle the wheel runs askew, the tyre gives way until its force balances the spring, and nothing moves any more; the moment
//! that this takes about the king pin grows with the angle. Where it is less than `M_f` the wheel rests. Straight, under the linear law
//! and without a spring about the king pin, those are the angles with `|tan psi| <= M_f/((l + t_p) C_alpha)`.

use super::uniform::Padded;
use crate::error::KingpinError;
use crate::parameters::{Key, Tyre};
use crate::simulation::SIMULATION_TOLERANCE;
use crate::swinging::SwingingWheel;
use crate::wheel::Wheel;

/// Angles in rad between rests that are looked at on the way to the last one, and the farthest from the uniform motion.
const STEP: f64 = 0.02;
const FARTHEST: f64 = 1.5;
/// The last one is found to this part of the distance from the uniform motion.
const RESOLUTION: f64 = 1e-12;
/// Intervals between the rests that are kept.
const INTERVALS: usize = 32;

/// The rests of a wheel, from the smallest to the largest caster angle.
#[derive(Clone, Debug)]
pub(crate) struct Rests {
    /// Smallest and largest angle in rad.
    pub angles: [f64; 2],
    /// `(u, q, psi, V1, Omega)` of rests at equal distances of the angle between them.
    states: Vec<[f64; 5]>,
}

impl Rests {
    /// The rest nearest to a caster angle, `(u, q, psi, V1, Omega)`.
    pub(crate) fn nearest(&self, psi: f64) -> [f64; 5] {
        let [low, high] = self.angles;
        let place = (psi.clamp(low, high) - low) / (high - low) * INTERVALS as f64;
        let index = (place as usize).min(INTERVALS - 1);
        let (before, after, part) = (self.states[index], self.states[index + 1], place - index as f64);
        std::array::from_fn(|i| before[i] + part * (after[i] - before[i]))
    }
}

impl Wheel {
    /// The smallest and the largest caster angle in rad at which a wheel with a tyre rests where dry friction acts about its king pin.
    /// `None` without a tyre and without such friction. No rests farther than 1.5 rad from the uniform motion are looked for.
    ///
    /// ```
    /// use kingpin::Wheel;
    /// let text = "tyre = \"linear\"\nsigma = 0.05\na = 0.03\nC_alpha = 500.0\nl = 0.1\nr = inf\nM_f = 1.0";
    /// let [low, high] = Wheel::from_toml(text)?.resting_angles()?.unwrap_or_default();
    /// // tan psi = M_f/((l + t_p) C_alpha)
    /// assert!((high - (1.0_f64 / (0.11 * 500.0)).atan()).abs() < 1e-9 && (low + high).abs() < 1e-9);
    /// # Ok::<(), kingpin::KingpinError>(())
    /// ```
    ///
    /// # Errors
    /// No uniform motion; those of [`check_tyre`](Self::check_tyre).
    pub fn resting_angles(&self) -> Result<Option<[f64; 2]>, KingpinError> {
        Ok(self.rests()?.map(|rests| rests.angles))
    }

    /// The rests of a wheel with a tyre and dry friction about its king pin.
    pub(crate) fn rests(&self) -> Result<Option<Rests>, KingpinError> {
        let limit = self.get(Key::MF);
        if self.tyre() == Tyre::Rigid || limit == 0.0 {
            return Ok(None);
        }
        let uniform = self.tyre_uniform_state().map_err(|reason| self.no_uniform_motion(reason))?;
        let wheel = self.swinging(SIMULATION_TOLERANCE)?;
        let centre = uniform[2];
        let start = wheel.free_state(&uniform);
        let last = |sign: f64| {
            let (mut held, mut state) = (0.0, start);
            let mut lost = loop {
                let next = held + STEP;
                match self.held_at(&wheel, centre + sign * next, &state) {
                    Some((found, moment)) if moment.abs() <= limit => (held, state) = (next, found),
                    _ => break next,
                }
                if held >= FARTHEST {
                    break held;
                }
            };
            while lost - held > RESOLUTION * lost {
                let middle = 0.5 * (held + lost);
                match self.held_at(&wheel, centre + sign * middle, &state) {
                    Some((found, moment)) if moment.abs() <= limit => (held, state) = (middle, found),
                    _ => lost = middle,
                }
                if middle == held && middle == lost {
                    break;
                }
            }
            centre + sign * held
        };
        let angles = [last(-1.0), last(1.0)];
        let mut states = Vec::with_capacity(INTERVALS + 1);
        // From the uniform motion to the smallest angle, and from there to the largest.
        let mut state = start;
        let mut psi = centre;
        while psi > angles[0] {
            psi = (psi - STEP).max(angles[0]);
            state = self.held_at(&wheel, psi, &state).map_or(state, |(found, _)| found);
        }
        for index in 0..=INTERVALS {
            let psi = angles[0] + (angles[1] - angles[0]) * (index as f64 / INTERVALS as f64);
            state = self.held_at(&wheel, psi, &state).map_or(state, |(found, _)| found);
            states.push(wheel.reduced(&state));
        }
        Ok(Some(Rests { angles, states }))
    }

    /// The free states of the wheel whose caster is held at an angle, from ones near it, and the moment that holds it.
    fn held_at(&self, wheel: &SwingingWheel, psi: f64, start: &Padded<f64>) -> Option<(Padded<f64>, f64)> {
        let free = self.newton_with_tyre(start, self.get(Key::Curvature), Some(psi)).ok()?;
        let rolls_on = wheel.full_state(&free)[3] > 0.0;
        rolls_on.then(|| (free, wheel.holding_moment(&free)))
    }
}
