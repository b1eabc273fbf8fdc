//! Time histories of the rolling wheel.
//!
//! A motion starts from the uniform motion with some states perturbed, or from any state, and is sampled at
//! equal intervals from the dense output of the integration, with the contact force at every sample. The
//! first time at which the ground can no longer supply the friction force that rolling needs, `|T| = mu_s N`, is
//! located as an event; the history goes on as if the wheel kept rolling. With dry friction about the king pin the caster swings
//! and sticks by turns.

mod dry_friction;
mod error;
mod sampling;
#[cfg(test)]
mod tests;

pub use error::SimulationError;
pub(crate) use sampling::sampling_times;

use crate::motion_integrator::motion_integrator;
use crate::rolling::STATE_NAMES;
use crate::sliding::{KingPin, Phase, phase_at};
use crate::{ContactForce, Key, Wheel};
use arclength::control::Control;
use arclength::integration::{Event, Statistics, autonomous};

/// Relative tolerance of a simulation; the absolute one is a hundredth of it in SI units.
pub const SIMULATION_TOLERANCE: f64 = 1e-11;

/// States that follow from others may differ from what follows by this, relative to caster length and speed.
const CONSTRAINT_TOLERANCE: f64 = 1e-9;

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
    /// Moment of dry friction about the king pin in N m, one for each time; empty without it.
    pub friction_moment: Vec<f64>,
    /// Work in J that it took: `M_f` times the angle through which the caster swung to and fro.
    pub dry_friction_work: f64,
    /// What the caster does, in order; empty without dry friction about the king pin.
    pub phases: Vec<Phase>,
    /// Work done by the integration.
    pub statistics: Statistics,
}

impl TimeHistory {
    /// The samples of one state, by the name it has in [`STATE_NAMES`].
    pub fn state(&self, name: &str) -> Option<Vec<f64>> {
        let index = STATE_NAMES.iter().position(|&candidate| candidate == name)?;
        Some(self.states.iter().map(|state| state[index]).collect())
    }

    /// What the caster does at a time: where two phases meet, the later one. Nothing without dry friction about the king pin.
    pub fn king_pin_at(&self, time: f64) -> Option<KingPin> {
        phase_at(&self.phases, time).map(|phase| phase.king_pin)
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
    /// The uniform motion with some of its [free states](Self::free_states), given by name, changed by some amount.
    ///
    /// # Errors
    /// A name that is unknown or of a state that is not free, an amount that is not finite, or no uniform motion.
    pub fn perturbed_uniform_motion(
        &self,
        perturbations: &[(&str, f64)],
    ) -> Result<[f64; 5], SimulationError> {
        self.check_rigid()?;
        let state = self.perturbed_states(perturbations)?;
        Ok(std::array::from_fn(|index| state[index]))
    }

    /// As [`perturbed_uniform_motion`](Self::perturbed_uniform_motion), in [all states](Self::states) of any wheel.
    pub(crate) fn perturbed_states(
        &self,
        perturbations: &[(&str, f64)],
    ) -> Result<Vec<f64>, SimulationError> {
        let model = self.rolling_model(&[])?;
        let names = self.free_states();
        let mut state = model.free_state(&self.uniform_motion()?.states());
        for &(name, amount) in perturbations {
            let index = names.iter().position(|&candidate| candidate == name).ok_or_else(|| {
                let (given, allowed) = (name.to_owned(), names.join(", "));
                if self.states().contains(&name) {
                    SimulationError::DependentState { given, allowed }
                } else {
                    SimulationError::UnknownState { given, allowed }
                }
            })?;
            if !amount.is_finite() {
                return Err(SimulationError::out_of_range(name, amount, "a finite change"));
            }
            state[index] += amount;
        }
        Ok(model.full_state(&state, &[]))
    }

    /// Simulates from the uniform motion with some states perturbed, sampled at `samples` equidistant times
    /// from 0 to `duration`, both included.
    ///
    /// # Errors
    /// A perturbation, duration or number of samples that is not allowed, no uniform motion, or a motion that
    /// grows without bound before the end; [`SimulationError::Interrupted`].
    ///
    /// ```
    /// use arclength::control::Control;
    /// use kingpin::Wheel;
    ///
    /// let history = Wheel::default().simulate(10.0, &[("psi", 0.1)], 1001, &Control::none())?;
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
        control: &Control<'_>,
    ) -> Result<TimeHistory, SimulationError> {
        self.simulate_from(&self.perturbed_uniform_motion(perturbations)?, duration, samples, control)
    }

    /// Simulates from a state `(u, q, psi, V, Omega)`; otherwise like [`simulate`](Self::simulate).
    ///
    /// # Errors
    /// As [`simulate`](Self::simulate); with lateral elasticity only also a `u` or `V` that breaks the constraints.
    pub fn simulate_from(
        &self,
        initial: &[f64; 5],
        duration: f64,
        samples: usize,
        control: &Control<'_>,
    ) -> Result<TimeHistory, SimulationError> {
        let times = sampling_times(duration, samples)?;
        self.check_rigid()?;
        let model = self.rolling_model(&[])?;
        let free = model.free_state(initial);
        let full_state =
            |state: &[f64]| -> [f64; 5] { std::array::from_fn(|index| model.full_state(state, &[])[index]) };
        self.check_constraints(initial, &full_state(&free))?;
        if self.get(Key::MF) > 0.0 {
            return self.simulate_with_dry_friction(initial, &times, control);
        }
        let reserve = |state: &[f64]| self.contact_force(&full_state(state)).static_reserve();
        let mut events = [Event::new(|_, state| reserve(state)).falling()];
        let solution = motion_integrator(SIMULATION_TOLERANCE).under(control).with_events(
            autonomous(&model, &[]),
            0.0,
            &free,
            duration,
            &times,
            &mut events,
        )?;
        let states: Vec<[f64; 5]> = solution.samples().map(|(_, state)| full_state(state)).collect();
        let lost_at_once = reserve(&free) <= 0.0;
        let first_loss = solution.crossings.first().map(|crossing| crossing.time);
        Ok(TimeHistory {
            contact_forces: states.iter().map(|state| self.contact_force(state)).collect(),
            states,
            rolling_lost_at: if lost_at_once { Some(0.0) } else { first_loss },
            times: solution.times,
            friction_moment: Vec::new(),
            dry_friction_work: 0.0,
            phases: Vec::new(),
            statistics: solution.statistics,
        })
    }

    /// That states which follow from others do so, and were given as they follow.
    fn check_constraints(&self, given: &[f64; 5], following: &[f64; 5]) -> Result<(), SimulationError> {
        let scale = [self.get(Key::L), 1.0, 1.0, self.get(Key::V).abs() + following[3].abs(), 1.0];
        for (((name, given), following), scale) in STATE_NAMES.iter().zip(given).zip(following).zip(scale) {
            if (given - following).abs() > CONSTRAINT_TOLERANCE * scale {
                let allowed =
                    "with lateral elasticity only, k_u = inf, u = 0 and V follows from q, psi and Omega";
                return Err(SimulationError::out_of_range(name, *given, allowed));
            }
        }
        if self.has_lateral_elasticity_only() && given[2].cos().abs() < CONSTRAINT_TOLERANCE {
            let allowed = "with lateral elasticity only, k_u = inf, not pi/2, where V does not follow from q, psi and Omega";
            return Err(SimulationError::out_of_range("psi", given[2], allowed));
        }
        Ok(())
    }
}
