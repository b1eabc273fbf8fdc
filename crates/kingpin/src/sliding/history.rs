//! Sampled motions of the wheel that may slide.

use super::model::{SlipState, slips};
use super::{
    Contact, HybridState, KingPin, Phase, Piece, SLIDING_STATE_NAMES, SlidingWheel, as_slip_state, phase_at,
};
use crate::forces::KingPinLoad;
use crate::simulation::{SimulationError, sampling_times};
use crate::wheel::Wheel;
use arclength::control::Control;

/// A motion sampled at equal intervals. Everything is SI.
#[derive(Clone, Debug, PartialEq)]
pub struct SlidingHistory {
    /// Times in s.
    pub times: Vec<f64>,
    /// States [`SLIDING_STATE_NAMES`], one for each time.
    pub states: Vec<[f64; 7]>,
    /// Friction force along and across the caster in N, one for each time.
    pub friction: Vec<[f64; 2]>,
    /// Moment of dry friction about the king pin in N m, one for each time.
    pub friction_moment: Vec<f64>,
    /// Power of the towing frame in W, one for each time.
    pub towing_power: Vec<f64>,
    /// Power that friction and dampers dissipate in W, one for each time.
    pub dissipated_power: Vec<f64>,
    /// What the king pin bears and what the dampers take, one for each time.
    pub king_pin_loads: Vec<KingPinLoad>,
    /// Normal force in N.
    pub normal_force: f64,
    /// Phases in order; neighbours of the same kind are those between which the slip passed through zero.
    pub phases: Vec<Phase>,
    /// Work in J that dry friction about the king pin took: `M_f` times the angle through which the caster swung to and fro.
    pub dry_friction_work: f64,
    /// Kinetic and spring energy at the end less that at the start, in J.
    pub energy_gained: f64,
}

impl SlidingHistory {
    /// Slip speed `|s|` in m/s at each time.
    pub fn slip(&self) -> Vec<f64> {
        self.states.iter().map(|state| (state[3] - state[6]).hypot(state[4])).collect()
    }

    /// Part of the time in which the wheel slides.
    pub fn sliding_fraction(&self) -> f64 {
        let time = |wanted: &dyn Fn(&Phase) -> bool| {
            self.phases
                .iter()
                .filter(|phase| wanted(phase))
                .fold(0.0, |sum, phase| sum + phase.end - phase.start)
        };
        let (total, sliding) = (time(&|_| true), time(&|phase| phase.contact == Contact::Sliding));
        if total > 0.0 { sliding / total } else { 0.0 }
    }
}

impl Wheel {
    /// The rolling uniform motion as one of a wheel that may slide, with some of the states
    /// [`SLIDING_STATE_NAMES`], given by name, changed by some amount; `V` changes `V1` and `W`.
    ///
    /// # Errors
    /// An unknown name, an amount that is not finite, or no uniform motion.
    pub fn perturbed_sliding_motion(
        &self,
        perturbations: &[(&str, f64)],
    ) -> Result<[f64; 7], SimulationError> {
        let [u, q, psi, speed, yaw] = self.uniform_motion()?.state();
        let mut state = [u, q, psi, speed, 0.0, yaw, speed];
        for &(name, amount) in perturbations {
            if !amount.is_finite() {
                return Err(SimulationError::out_of_range(name, amount, "a finite change"));
            }
            let changed: &[&str] = if name == "V" { &["V1", "W"] } else { &[name] };
            for wanted in changed {
                let index = SLIDING_STATE_NAMES.iter().position(|candidate| candidate == wanted);
                let index = index.ok_or_else(|| SimulationError::UnknownState {
                    given: name.to_owned(),
                    allowed: format!("{}, V", SLIDING_STATE_NAMES.join(", ")),
                })?;
                state[index] += amount;
            }
        }
        Ok(state)
    }
}

impl SlidingHistory {
    /// What the wheel does at a time: where two phases meet, the later one.
    pub fn contact_at(&self, time: f64) -> Option<Contact> {
        phase_at(&self.phases, time).map(|phase| phase.contact)
    }

    /// What the caster does at a time: where two phases meet, the later one.
    pub fn king_pin_at(&self, time: f64) -> Option<KingPin> {
        phase_at(&self.phases, time).map(|phase| phase.king_pin)
    }
}

impl SlidingWheel {
    /// Simulates from a state `(u, q, psi, V, Omega)` without slip, sampled at `samples` equidistant times from 0
    /// to `duration`, both included.
    ///
    /// # Errors
    /// A duration or number of samples that is not allowed, or a motion that cannot be followed;
    /// [`SimulationError::Interrupted`].
    pub fn simulate(
        &self,
        initial: &[f64; 5],
        duration: f64,
        samples: usize,
        control: &Control<'_>,
    ) -> Result<SlidingHistory, SimulationError> {
        self.simulate_hybrid(self.rolling_state(initial), duration, samples, control)
    }

    /// Simulates from the states [`SLIDING_STATE_NAMES`]; otherwise like
    /// [`simulate`](Self::simulate). Without slip (`V1 = W`, `V2 = 0`) the wheel rolls if friction can hold it.
    ///
    /// # Errors
    /// As [`simulate`](Self::simulate).
    pub fn simulate_from(
        &self,
        initial: &[f64; 7],
        duration: f64,
        samples: usize,
        control: &Control<'_>,
    ) -> Result<SlidingHistory, SimulationError> {
        self.simulate_hybrid(self.slipping_state(initial), duration, samples, control)
    }

    pub(crate) fn simulate_hybrid(
        &self,
        initial: HybridState,
        duration: f64,
        samples: usize,
        control: &Control<'_>,
    ) -> Result<SlidingHistory, SimulationError> {
        let times = sampling_times(duration, samples)?;
        let mut history = SlidingHistory {
            times: Vec::with_capacity(samples),
            states: Vec::with_capacity(samples),
            friction: Vec::with_capacity(samples),
            friction_moment: Vec::with_capacity(samples),
            towing_power: Vec::with_capacity(samples),
            dissipated_power: Vec::with_capacity(samples),
            king_pin_loads: Vec::with_capacity(samples),
            normal_force: self.rolling.wheel().normal_force(),
            phases: Vec::new(),
            dry_friction_work: 0.0,
            energy_gained: 0.0,
        };
        let mut psi = initial.state[2];
        let end = self.follow(initial, duration, &times, control, |piece| {
            let &Piece { phase, mode, resumes, solution } = &piece;
            let equations = self.equations_in(mode);
            for (time, state) in solution.samples() {
                let state: SlipState = as_slip_state(state);
                history.times.push(time);
                history.states.push(HybridState { contact: phase.contact, state }.public());
                let friction = match phase.contact {
                    Contact::Sliding if slips(&state) => equations.sliding_force(&state),
                    _ => equations.holding_force(&state),
                };
                let (towing, dissipated) = equations.power(&state, friction);
                history.king_pin_loads.push(KingPinLoad {
                    components: equations.king_pin_force(&state),
                    damper_power: equations.power_of_damping(&state),
                });
                history.friction.push(friction);
                history.friction_moment.push(equations.friction_moment(&state, friction));
                history.towing_power.push(towing);
                history.dissipated_power.push(dissipated);
            }
            history.dry_friction_work += piece.dry_friction_work(psi);
            psi = solution.state[2];
            match history.phases.last_mut() {
                Some(before) if resumes => before.end = phase.end,
                Some(_) if phase.end == phase.start => {}
                _ => history.phases.push(phase),
            }
            true
        })?;
        let equations = &self.equations;
        history.energy_gained = equations.energy(&end.state) - equations.energy(&initial.state);
        Ok(history)
    }
}
