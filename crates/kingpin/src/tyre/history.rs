//! Time histories of a wheel with a tyre.
//!
//! The model is valid while the wheel rolls forwards. A motion in which `V1` falls to zero ends there, and what becomes of it is
//! undecided. With dry friction about the king pin the caster swings and sticks by turns.

use super::field::TYRE_STATE_NAMES;
use crate::simulation::{SIMULATION_TOLERANCE, SimulationError, sampling_times};
use crate::sliding::{KingPin, Phase, phase_at};
use crate::swinging::Stretch;
use crate::{ContactForce, KingpinError, Tyre, Wheel};
use arclength::control::Control;
use arclength::integration::Statistics;

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
    /// Moment of dry friction about the king pin in N m, one for each time; empty without it.
    pub friction_moment: Vec<f64>,
    /// Work in J that it took: `M_f` times the angle through which the caster swung to and fro.
    pub dry_friction_work: f64,
    /// What the caster does, in order; empty without dry friction about the king pin.
    pub phases: Vec<Phase>,
    /// Work done by the integration.
    pub statistics: Statistics,
}

impl TyreHistory {
    /// The samples of one state, by its name.
    pub fn state(&self, name: &str) -> Option<Vec<f64>> {
        let index = TYRE_STATE_NAMES.iter().position(|&candidate| candidate == name)?;
        Some(self.states.iter().map(|state| state[index]).collect())
    }

    /// What the caster does at a time: where two phases meet, the later one. Nothing without dry friction about the king pin.
    pub fn king_pin_at(&self, time: f64) -> Option<KingPin> {
        phase_at(&self.phases, time).map(|phase| phase.king_pin)
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
        if self.tyre() == Tyre::Rigid {
            return Err(KingpinError::NeedsTyre.into());
        }
        let start = self.perturbed_states(perturbations)?;
        self.simulate_with_tyre_from(&std::array::from_fn(|index| start[index]), duration, samples, control)
    }

    /// The same from a state `(u, q, psi, V1, V2, Omega, y_t)`, of which what a rigid king pin does not leave free follows.
    ///
    /// # Errors
    /// As [`simulate_with_tyre`](Self::simulate_with_tyre).
    pub fn simulate_with_tyre_from(
        &self,
        initial: &[f64; 7],
        duration: f64,
        samples: usize,
        control: &Control<'_>,
    ) -> Result<TyreHistory, SimulationError> {
        let times = sampling_times(duration, samples)?;
        if self.tyre() == Tyre::Rigid {
            return Err(KingpinError::NeedsTyre.into());
        }
        let wheel = self.swinging(SIMULATION_TOLERANCE)?;
        let start = wheel.free_state(initial);
        let forward = wheel.full_state(&start)[3];
        if !wheel.is_inside(&start) {
            let allowed = "positive: with a tyre the wheel has to roll forwards";
            return Err(SimulationError::out_of_range("V1", forward, allowed));
        }
        let mut history = TyreHistory {
            times: Vec::with_capacity(samples),
            states: Vec::with_capacity(samples),
            contact_forces: Vec::with_capacity(samples),
            friction_exceeded_at: None,
            stopped_at: None,
            friction_moment: Vec::new(),
            dry_friction_work: 0.0,
            phases: Vec::new(),
            statistics: Statistics::default(),
        };
        let reached = wheel.reporting_slip().follow(&start, duration, &times, control, |stretch| {
            let Stretch { phase, friction_moment, initial, solution } = &stretch;
            history.dry_friction_work += wheel.dry_friction_work(&stretch);
            if history.friction_exceeded_at.is_none() {
                let moment = wheel.moment(*friction_moment, &initial[..]);
                let at_once = wheel.contact_force(moment, &initial[..]).static_reserve() <= 0.0;
                history.friction_exceeded_at = if at_once { Some(phase.start) } else { stretch.slips_at() };
            }
            for (time, free) in solution.samples() {
                let moment = wheel.moment(*friction_moment, free);
                history.times.push(time);
                history.states.push(wheel.full_state(free));
                history.contact_forces.push(wheel.contact_force(moment, free));
                if wheel.has_dry_friction() {
                    history.friction_moment.push(moment);
                }
            }
            if phase.end > phase.start && wheel.has_dry_friction() {
                history.phases.push(*phase);
            }
            history.statistics.accepted_steps += solution.statistics.accepted_steps;
            history.statistics.rejected_steps += solution.statistics.rejected_steps;
            history.statistics.evaluations += solution.statistics.evaluations;
        })?;
        history.stopped_at = reached.border;
        Ok(history)
    }
}
