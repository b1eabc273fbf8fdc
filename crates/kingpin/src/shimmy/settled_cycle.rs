//! Shimmy of a wheel with a tyre: its equations are smooth, so that it is a cycle as any other, on which kicked motions settle.
//!
//! Towed straight without `c_u` the longitudinal springs ring for ever, and no motion settles. It is left to settle with a longitudinal damper
//! then, and the cycle is followed as that is taken away.

use super::error::ShimmyError;
use super::kicks::Kick;
use super::search::{AT_REST, SETTLING_TOLERANCE, SlidingMotionSearch};
use crate::branches::{Along, CycleOptions};
use crate::parameters::Key;
use crate::simulation::SimulationError;
use crate::wheel::Wheel;
use arclength::control::Control;
use arclength::cycle::{CycleStart, Orbit};
use std::ops::ControlFlow;

/// The longitudinal damper with which motions are left to settle, as part of the critical one.
const SETTLING_DAMPING: f64 = 0.3;
/// Samples of the longest period between which the range of the caster angle is taken.
const SAMPLES: usize = 1000;

impl Wheel {
    /// The cycle of a wheel with a tyre on which it settles after a disturbance of the uniform motion.
    ///
    /// # Errors
    /// [`ShimmyError`]: the motion dies out, does not repeat itself, comes to where the equations end, or the cycle is lost as the
    /// longitudinal damper is taken away.
    ///
    /// ```
    /// use arclength::control::Control;
    /// use kingpin::Wheel;
    /// // Somieski's nose gear (1997).
    /// let gear = include_str!("../../examples/nose_gear.toml").replace("linear", "brush");
    /// let wheel = Wheel::from_toml(&gear)?.with(kingpin::Key::V, 40.0)?;
    /// let orbit = wheel.settled_cycle(wheel.strong_kicks()[0], &wheel.settling_search(), &Control::none())?;
    /// assert!((orbit.period - 0.019780).abs() < 1e-5);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn settled_cycle(
        &self,
        kick: Kick,
        search: &SlidingMotionSearch,
        control: &Control<'_>,
    ) -> Result<Orbit, ShimmyError> {
        search.check()?;
        let damped = self.damped_to_settle()?;
        let swinging = damped.swinging(SETTLING_TOLERANCE)?;
        let start = swinging.free_state(&damped.perturbed_states(&[(kick.state, kick.change)])?);
        let settled = swinging.follow(&start, search.settling_time, &[], control, |_| {})?;
        let at_border = |time| SimulationError::ModelEnds { time, what: swinging.at_the_border() };
        if let Some(time) = settled.border {
            return Err(at_border(time).into());
        }
        let window = search.longest_period;
        let times: Vec<f64> = (0..=SAMPLES).map(|i| window * (i as f64 / SAMPLES as f64)).collect();
        let (mut low, mut high) = (f64::INFINITY, f64::NEG_INFINITY);
        // The period begins where the tyre is deflected most: far from where a brush begins or ceases to slide as a whole.
        let (mut largest, mut farthest) = (0.0, Vec::new());
        let reached = swinging.follow(&settled.state, window, &times, control, |stretch| {
            for (_, free) in stretch.solution.samples() {
                let angle = swinging.reduced(free)[2];
                (low, high) = (low.min(angle), high.max(angle));
                let deflection = free.last().map_or(0.0, |deflection| deflection.abs());
                if deflection > largest {
                    (largest, farthest) = (deflection, free.to_vec());
                }
            }
        })?;
        if let Some(time) = reached.border {
            return Err(at_border(search.settling_time + time).into());
        }
        if high - low < AT_REST {
            return Err(ShimmyError::DiesOut { window, range: high - low });
        }
        let model = damped.rolling_model(&[])?;
        let orbit = Orbit::from_time_history(&model, &[], &farthest, window)?;
        self.without_settling_damper(&damped, orbit)
    }

    /// The wheel with a longitudinal damper, where it has none and needs one to come to rest.
    fn damped_to_settle(&self) -> Result<Self, ShimmyError> {
        let stiffness = self.get(Key::KU);
        if self.get(Key::CU) > 0.0 || stiffness.is_infinite() {
            return Ok(*self);
        }
        let critical = 2.0 * (stiffness * self.body().rolling_mass).sqrt();
        Ok(self.with(Key::CU, SETTLING_DAMPING * critical)?)
    }

    /// The cycle of this wheel to which that of the damped one leads as the damper becomes weaker.
    fn without_settling_damper(&self, damped: &Self, orbit: Orbit) -> Result<Orbit, ShimmyError> {
        let [own, damping] = [self, damped].map(|wheel| wheel.get(Key::CU));
        if own == damping {
            return Ok(orbit);
        }
        let along = Along::new(Key::CU, own, damping)?;
        let options = CycleOptions::default();
        let cycles =
            damped.cycles_from(CycleStart::Orbit(orbit), along, &options, |_| ControlFlow::Continue(()))?;
        let found = cycles.points.into_iter().find(|point| point.value == own);
        found.map(|point| point.orbit).ok_or(ShimmyError::LostWithoutDamper { c_u: damping })
    }
}
