//! Time histories of the wheel that rolls ideally, with dry friction about the king pin.

use super::{SIMULATION_TOLERANCE, SimulationError, TimeHistory};
use crate::sliding::{Piece, as_slip_state};
use crate::swinging::Stretch;
use crate::{ContactForce, Key, Wheel};
use arclength::control::Control;
use arclength::integration::Statistics;

impl Wheel {
    /// Simulates from a state `(u, q, psi, V, Omega)` over `times`, which begin with 0.
    ///
    /// # Errors
    /// As [`simulate_from`](Self::simulate_from).
    pub(super) fn simulate_with_dry_friction(
        &self,
        initial: &[f64; 5],
        times: &[f64],
        control: &Control<'_>,
    ) -> Result<TimeHistory, SimulationError> {
        if self.has_lateral_elasticity_only() {
            return self.simulate_lateral_with_dry_friction(initial, times, control);
        }
        let rolling = self.always_rolling()?.tolerance(SIMULATION_TOLERANCE);
        let normal = self.normal_force();
        let limit = self.get(Key::MuS) * normal;
        let mut history = TimeHistory {
            times: Vec::with_capacity(times.len()),
            states: Vec::with_capacity(times.len()),
            contact_forces: Vec::with_capacity(times.len()),
            rolling_lost_at: (limit < 0.0).then_some(0.0),
            friction_moment: Vec::with_capacity(times.len()),
            dry_friction_work: 0.0,
            phases: Vec::new(),
            statistics: Statistics::default(),
        };
        let duration = times.last().copied().unwrap_or(0.0);
        let mut present = rolling.rolling_state(initial).state;
        rolling.follow(rolling.rolling_state(initial), duration, times, control, |piece| {
            let &Piece { phase, mode, solution, .. } = &piece;
            history.dry_friction_work += piece.dry_friction_work(present[2]);
            let equations = rolling.equations_in(mode);
            if history.rolling_lost_at.is_none() {
                // The force jumps where the caster begins to swing or to stick.
                let at_once = equations.static_reserve(&present) <= 0.0;
                let later = solution.crossings.iter().find(|crossing| crossing.event == 0);
                history.rolling_lost_at =
                    if at_once { Some(phase.start) } else { later.map(|crossing| crossing.time) };
            }
            for (time, state) in solution.samples() {
                let [u, q, psi, speed, _, yaw, _] = as_slip_state(state);
                let [longitudinal, lateral] = equations.holding_force(state);
                history.times.push(time);
                history.states.push([u, q, psi, speed, yaw]);
                history.contact_forces.push(ContactForce { longitudinal, lateral, normal, limit });
                history.friction_moment.push(equations.friction_moment(state, [longitudinal, lateral]));
            }
            if phase.end > phase.start {
                history.phases.push(phase);
            }
            present = as_slip_state(&solution.state);
            true
        })?;
        Ok(history)
    }

    /// The same with lateral elasticity only.
    fn simulate_lateral_with_dry_friction(
        &self,
        initial: &[f64; 5],
        times: &[f64],
        control: &Control<'_>,
    ) -> Result<TimeHistory, SimulationError> {
        let wheel = self.swinging(SIMULATION_TOLERANCE)?.beyond_the_border().reporting_slip();
        let mut history = TimeHistory {
            times: Vec::with_capacity(times.len()),
            states: Vec::with_capacity(times.len()),
            contact_forces: Vec::with_capacity(times.len()),
            rolling_lost_at: None,
            friction_moment: Vec::with_capacity(times.len()),
            dry_friction_work: 0.0,
            phases: Vec::new(),
            statistics: Statistics::default(),
        };
        let duration = times.last().copied().unwrap_or(0.0);
        wheel.follow(&wheel.free_state(initial), duration, times, control, |stretch| {
            let Stretch { phase, friction_moment, initial, solution } = &stretch;
            history.dry_friction_work += wheel.dry_friction_work(&stretch);
            if history.rolling_lost_at.is_none() {
                let moment = wheel.moment(*friction_moment, &initial[..]);
                let at_once = wheel.contact_force(moment, &initial[..]).static_reserve() <= 0.0;
                history.rolling_lost_at = if at_once { Some(phase.start) } else { stretch.slips_at() };
            }
            for (time, free) in solution.samples() {
                let moment = wheel.moment(*friction_moment, free);
                history.times.push(time);
                history.states.push(wheel.reduced(free));
                history.contact_forces.push(wheel.contact_force(moment, free));
                history.friction_moment.push(moment);
            }
            if phase.end > phase.start {
                history.phases.push(*phase);
            }
        })?;
        Ok(history)
    }
}
