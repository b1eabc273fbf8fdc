//! Time histories of a wheel with a tyre.
//!
//! The model is valid while the wheel rolls forwards. A motion in which `V1` falls to zero ends there, and what becomes of it is
//! undecided.

use super::field::TYRE_STATE_NAMES;
use crate::simulation::{SIMULATION_TOLERANCE, SimulationError, sampling_times};
use crate::{ContactForce, Key, Wheel};
use arclength::control::Control;
use arclength::integration::{Event, Integrator, Statistics, autonomous};

/// The forward speed, as a part of the towing speed, that counts as none: at zero the moment of the tread width is infinite.
const STANDSTILL: f64 = 1e-9;

/// A motion of a wheel with a tyre, sampled at equal intervals. Everything is SI.
#[derive(Clone, Debug, PartialEq)]
pub struct TyreHistory {
    /// Times in s.
    pub times: Vec<f64>,
    /// States `(u, q, psi, V1, V2, Omega, y_t)`, one for each time.
    pub states: Vec<[f64; 7]>,
    /// Force of the ground on the wheel, one for each time.
    pub contact_forces: Vec<ContactForce>,
    /// First time at which the force on the wheel exceeds the static friction: 0 if it does so from the start.
    pub friction_exceeded_at: Option<f64>,
    /// Time at which the wheel stopped rolling forwards, `V1 = 0`, where the history ends.
    pub stopped_at: Option<f64>,
    /// Work done by the integration.
    pub statistics: Statistics,
}

impl TyreHistory {
    /// The samples of one state, by its name.
    pub fn state(&self, name: &str) -> Option<Vec<f64>> {
        let index = TYRE_STATE_NAMES.iter().position(|&candidate| candidate == name)?;
        Some(self.states.iter().map(|state| state[index]).collect())
    }
}

impl Wheel {
    /// Simulates a wheel with a tyre from the uniform motion with some of its [free states](Self::free_states) perturbed, sampled at
    /// `samples` equidistant times from 0 to `duration`, both included, or until the wheel stops.
    ///
    /// # Errors
    /// As [`simulate`](Self::simulate); [`NeedsTyre`](crate::KingpinError::NeedsTyre), and a start in which the wheel does not roll forwards.
    ///
    /// ```
    /// use arclength::control::Control;
    /// use kingpin::Wheel;
    /// let text = "tyre = \"linear\"\nsigma = 0.05\na = 0.02\nC_alpha = 500.0\nl = 0.12\nk = inf\nr = inf";
    /// let history = Wheel::from_toml(text)?.simulate_with_tyre(5.0, &[("psi", 0.1)], 501, &Control::none())?;
    /// // Stable, as l > sigma + a.
    /// assert!(history.states[500][2].abs() < 0.05 && history.stopped_at.is_none());
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn simulate_with_tyre(
        &self,
        duration: f64,
        perturbations: &[(&str, f64)],
        samples: usize,
        control: &Control<'_>,
    ) -> Result<TyreHistory, SimulationError> {
        let times = sampling_times(duration, samples)?;
        let model = self.with_tyre(&[])?;
        let start = self.perturbed_states(perturbations)?;
        let free: Vec<f64> = model.free().iter().map(|&index| start[index]).collect();
        let slowest = STANDSTILL * self.get(Key::V);
        if start[3] <= slowest {
            let allowed = "positive: with a tyre the wheel has to roll forwards";
            return Err(SimulationError::out_of_range("V1", start[3], allowed));
        }
        let reserve = |free: &[f64]| self.tyre_contact_force(&model.full_state(free, &[])).static_reserve();
        let forward = |free: &[f64]| model.full_state(free, &[])[3] - slowest;
        let mut events = [
            Event::new(|_, state| reserve(state)).falling(),
            Event::new(|_, state| forward(state)).falling().terminal(),
        ];
        let solution = Integrator::with_tolerance(SIMULATION_TOLERANCE).under(control).with_events(
            autonomous(&model, &[]),
            0.0,
            &free,
            duration,
            &times,
            &mut events,
        )?;
        let states: Vec<[f64; 7]> =
            solution.samples().map(|(_, state)| model.full_state(state, &[])).collect();
        let exceeded = solution.crossings.iter().find(|crossing| crossing.event == 0);
        Ok(TyreHistory {
            contact_forces: states.iter().map(|state| self.tyre_contact_force(state)).collect(),
            states,
            friction_exceeded_at: if reserve(&free) <= 0.0 {
                Some(0.0)
            } else {
                exceeded.map(|crossing| crossing.time)
            },
            stopped_at: solution.ended_by.map(|_| solution.time),
            times: solution.times,
            statistics: solution.statistics,
        })
    }
}
