//! Time histories of the rolling wheel.
//!
//! A motion starts from the uniform motion with some states perturbed, or from any state, and is sampled at
//! equal intervals from the dense output of the integration, with the contact force at every sample. The
//! first time at which the ground can no longer supply the friction force that rolling needs, `|T| = mu_s N`, is
//! located as an event; the history goes on as if the wheel kept rolling.

mod error;
#[cfg(test)]
mod tests;

pub use error::SimulationError;

use crate::rolling::STATE_NAMES;
use crate::{ContactForce, Wheel};
use arclength::integration::{Event, Integrator, Statistics, autonomous};

/// Relative tolerance of a simulation; the absolute one is a hundredth of it in SI units.
pub const SIMULATION_TOLERANCE: f64 = 1e-11;

/// A motion of the rolling wheel, sampled at equal intervals. Everything is SI.
#[derive(Clone, Debug, PartialEq)]
pub struct TimeHistory {
    /// Times in s.
    pub times: Vec<f64>,
    /// States `(u, q, psi, V, Omega)`, one for each time.
    pub states: Vec<[f64; 5]>,
    /// Force of the ground on the wheel, one for each time.
    pub contact_forces: Vec<ContactForce>,
    /// First time at which rolling needs more than the static friction: 0 if it does so from the start.
    pub rolling_lost_at: Option<f64>,
    /// Work done by the integration.
    pub statistics: Statistics,
}

impl TimeHistory {
    /// The samples of one state, by the name it has in [`STATE_NAMES`].
    pub fn state(&self, name: &str) -> Option<Vec<f64>> {
        let index = STATE_NAMES.iter().position(|&candidate| candidate == name)?;
        Some(self.states.iter().map(|state| state[index]).collect())
    }

    /// Friction force `|T|` in N at each time.
    pub fn friction_force(&self) -> Vec<f64> {
        self.contact_forces.iter().map(ContactForce::friction).collect()
    }

    /// Normal force in N at each time.
    pub fn normal_force(&self) -> Vec<f64> {
        self.contact_forces.iter().map(|force| force.normal).collect()
    }
}

impl Wheel {
    /// The uniform motion with some states, given by name, changed by some amount.
    ///
    /// # Errors
    /// An unknown name, an amount that is not finite, or no uniform motion.
    pub fn perturbed_uniform_motion(
        &self,
        perturbations: &[(&str, f64)],
    ) -> Result<[f64; 5], SimulationError> {
        let mut state = self.uniform_motion()?.state();
        for &(name, amount) in perturbations {
            let index = STATE_NAMES.iter().position(|&candidate| candidate == name).ok_or_else(|| {
                SimulationError::UnknownState { given: name.to_owned(), allowed: STATE_NAMES.join(", ") }
            })?;
            if !amount.is_finite() {
                return Err(SimulationError::out_of_range(name, amount, "a finite change"));
            }
            state[index] += amount;
        }
        Ok(state)
    }

    /// Simulates from the uniform motion with some states perturbed, sampled at `samples` equidistant times
    /// from 0 to `duration`, both included.
    ///
    /// # Errors
    /// A perturbation, duration or number of samples that is not allowed, no uniform motion, or a motion that
    /// grows without bound before the end.
    ///
    /// ```
    /// use kingpin::Wheel;
    ///
    /// let history = Wheel::default().simulate(10.0, &[("psi", 0.1)], 1001)?;
    /// let angle = history.state("psi").unwrap_or_default();
    /// assert!((angle[1000] - 0.0798).abs() < 1e-3); // back at the uniform motion
    /// assert!(history.rolling_lost_at.is_some_and(|time| time < 0.1)); // but ideal rolling is too much to ask
    /// # Ok::<(), kingpin::simulation::SimulationError>(())
    /// ```
    pub fn simulate(
        &self,
        duration: f64,
        perturbations: &[(&str, f64)],
        samples: usize,
    ) -> Result<TimeHistory, SimulationError> {
        self.simulate_from(&self.perturbed_uniform_motion(perturbations)?, duration, samples)
    }

    /// Simulates from a state `(u, q, psi, V, Omega)`; otherwise like [`simulate`](Self::simulate).
    ///
    /// # Errors
    /// As [`simulate`](Self::simulate).
    pub fn simulate_from(
        &self,
        initial: &[f64; 5],
        duration: f64,
        samples: usize,
    ) -> Result<TimeHistory, SimulationError> {
        if !(duration > 0.0 && duration.is_finite()) {
            return Err(SimulationError::out_of_range("duration", duration, "positive and finite, in s"));
        }
        if samples < 2 {
            return Err(SimulationError::out_of_range("samples", samples as f64, "at least 2"));
        }
        let field = self.rolling(&[])?;
        let last = (samples - 1) as f64;
        let times: Vec<f64> = (0..samples).map(|i| duration * (i as f64 / last)).collect();
        let reserve = |state: &[f64]| {
            let force = self.rolling_contact_force(&as_array(state));
            // Squares keep the function smooth where the force vanishes.
            force.limit * force.limit.abs() - force.longitudinal.powi(2) - force.lateral.powi(2)
        };
        let mut events = [Event::new(|_, state| reserve(state)).falling()];
        let solution = Integrator::with_tolerance(SIMULATION_TOLERANCE).with_events(
            autonomous(&field, &[]),
            0.0,
            initial,
            duration,
            &times,
            &mut events,
        )?;
        let states: Vec<[f64; 5]> = solution.samples().map(|(_, state)| as_array(state)).collect();
        let lost_at_once = reserve(initial) <= 0.0;
        let first_loss = solution.crossings.first().map(|crossing| crossing.time);
        Ok(TimeHistory {
            contact_forces: states.iter().map(|state| self.rolling_contact_force(state)).collect(),
            states,
            rolling_lost_at: if lost_at_once { Some(0.0) } else { first_loss },
            times: solution.times,
            statistics: solution.statistics,
        })
    }
}

/// The five states of a slice that has five.
fn as_array(state: &[f64]) -> [f64; 5] {
    std::array::from_fn(|index| state[index])
}
