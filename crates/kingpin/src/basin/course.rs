//! A motion followed piece by piece, with the slope and the curvature of the caster angle at many times.

use super::fate::Target;
use crate::motion_integrator::motion_integrator;
use crate::rolling::RollingWheel;
use crate::shimmy::passage::passages;
use crate::simulation::{SIMULATION_TOLERANCE, SimulationError};
use crate::sliding::{HybridState, SlidingWheel};
use crate::swinging::{FreeState, Stretch, SwingingWheel};
use crate::wheel::Wheel;
use arclength::VectorField;
use arclength::control::Control;
use arclength::integration::autonomous;
use std::f64::consts::TAU;

/// The motion at one time.
#[derive(Clone, Copy, Debug)]
pub(super) struct Node {
    /// Time in s since the piece began.
    pub time: f64,
    /// Caster angle and its first two derivatives.
    pub angle: [f64; 3],
    /// `(u, q, psi, V, Omega)`; with slip, `V` is the speed of the wheel centre.
    pub state: [f64; 5],
}

/// Where a motion is, and how it goes on.
#[derive(Clone, Debug)]
pub(super) enum Course<'a> {
    Rolling { field: Box<RollingWheel>, state: [f64; 5] },
    Hybrid { wheel: &'a SlidingWheel, state: HybridState },
    Swinging { wheel: &'a SwingingWheel, state: FreeState },
}

impl<'a> Course<'a> {
    pub(super) fn rolling(wheel: &Wheel, state: [f64; 5]) -> Result<Self, SimulationError> {
        Ok(Self::Rolling { field: Box::new(wheel.rolling(&[])?), state })
    }

    pub(super) fn hybrid(wheel: &'a SlidingWheel, state: HybridState) -> Self {
        Self::Hybrid { wheel, state }
    }

    /// Of a wheel with a tyre, or with lateral elasticity only, from all its states.
    pub(super) fn swinging(wheel: &'a SwingingWheel, states: &[f64]) -> Self {
        Self::Swinging { wheel, state: wheel.free_state(states) }
    }

    /// The state `(u, q, psi, V, Omega)`.
    pub(super) fn state(&self) -> [f64; 5] {
        match self {
            Self::Rolling { state, .. } => *state,
            Self::Hybrid { state, .. } => reduced(&state.public()),
            Self::Swinging { wheel, state } => wheel.reduced(state),
        }
    }

    /// The state `(u, q, psi, V, Omega)` of the steady sliding next to where a wheel that slides is, if small disturbances of it die out.
    pub(super) fn steady_sliding(&self) -> Option<[f64; 5]> {
        match self {
            Self::Hybrid { wheel, state } => {
                wheel.steady_sliding_near(state).map(|steady| reduced(&steady.public()))
            }
            _ => None,
        }
    }

    /// Goes on for `duration`, with nodes at multiples of `spacing` and wherever the equations change.
    pub(super) fn follow(
        &mut self,
        duration: f64,
        spacing: f64,
        nodes: &mut Vec<Node>,
        control: &Control<'_>,
    ) -> Result<(), SimulationError> {
        let count = (duration / spacing).round().max(1.0) as usize;
        let times: Vec<f64> = (0..=count).map(|index| duration * (index as f64 / count as f64)).collect();
        nodes.clear();
        match self {
            Self::Rolling { field, state } => {
                let field = &**field;
                let integrator = motion_integrator(SIMULATION_TOLERANCE);
                let solution = integrator.under(control).sample(autonomous(field, &[]), &*state, &times)?;
                nodes.extend(solution.samples().map(|(time, state)| {
                    let mut rate = [0.0; 5];
                    field.evaluate(state, &[], &mut rate);
                    let state = std::array::from_fn(|i| state[i]);
                    Node { time, angle: [state[2], rate[2], -rate[4]], state }
                }));
                *state = std::array::from_fn(|i| solution.state[i]);
            }
            Self::Hybrid { wheel, state } => {
                let (passages, end) = passages(wheel, *state, duration, &times[1..count], control)?;
                for passage in &passages {
                    let equations = wheel.equations_in(passage.mode);
                    nodes.extend(passage.nodes().map(|(time, inside)| {
                        let mut rate = [0.0; 7];
                        passage.mode.regime.field(&equations, inside, &mut rate);
                        let present = HybridState { contact: passage.mode.regime.contact(), state: *inside };
                        Node {
                            time,
                            angle: [inside[2], rate[2], -rate[5]],
                            state: reduced(&present.public()),
                        }
                    }));
                }
                *state = end;
            }
            Self::Swinging { wheel, state } => {
                let reached = wheel.follow(&*state, duration, &times[1..count], control, |stretch| {
                    let Stretch { phase, friction_moment, initial, solution } = stretch;
                    let mut add = |time: f64, free: &[f64]| {
                        let angle = wheel.angle(friction_moment, free);
                        nodes.push(Node { time, angle, state: wheel.reduced(free) });
                    };
                    add(phase.start, initial);
                    let inside = solution.samples();
                    inside
                        .filter(|(time, _)| phase.start < *time && *time < phase.end)
                        .for_each(|(time, free)| add(time, free));
                    add(phase.end, &solution.state);
                })?;
                if let Some(time) = reached.border {
                    return Err(SimulationError::ModelEnds { time, what: wheel.at_the_border() });
                }
                *state = reached.state;
            }
        }
        Ok(())
    }

    /// The same with the deviation from the uniform motion multiplied by a factor.
    pub(super) fn pushed(&self, target: &Target, factor: f64) -> Self {
        let mut pushed = self.clone();
        let [u, q, psi, speed, yaw] = *target.state();
        let stretch = |value: &mut f64, centre: f64| *value = centre + factor * (*value - centre);
        let turned = |angle: f64| psi + TAU * ((angle - psi) / TAU).round();
        match &mut pushed {
            Self::Rolling { state, .. } => {
                let centre = [u, q, turned(state[2]), speed, yaw];
                state.iter_mut().zip(centre).for_each(|(value, centre)| stretch(value, centre));
            }
            Self::Hybrid { state, .. } => {
                let centre = [u, q, turned(state.state[2]), speed, 0.0, yaw, 0.0];
                state.state.iter_mut().zip(centre).for_each(|(value, centre)| stretch(value, centre));
            }
            Self::Swinging { wheel, state } => {
                let mut centre = wheel.free_state(target.states());
                if let Some(place) = wheel.position(2) {
                    centre[place] = turned(state[place]);
                }
                state.iter_mut().zip(centre).for_each(|(value, centre)| stretch(value, centre));
            }
        }
        pushed
    }
}

impl Course<'_> {
    /// The same with one of the states `(u, q, psi, V, Omega)` changed.
    pub(super) fn displaced(&self, state: usize, amount: f64) -> Self {
        let mut displaced = self.clone();
        match &mut displaced {
            Self::Rolling { state: states, .. } => states[state] += amount,
            Self::Hybrid { state: present, .. } => {
                present.state[if state == 4 { 5 } else { state }] += amount
            }
            // A state that is not free stays as it follows.
            Self::Swinging { wheel, state: free } => {
                if let Some(place) = wheel.place_of(state) {
                    free[place] += amount;
                }
            }
        }
        displaced
    }
}

/// What is told of the seven states of a wheel that slides.
fn reduced(&[u, q, psi, forward, lateral, yaw, _]: &[f64; 7]) -> [f64; 5] {
    [u, q, psi, forward.hypot(lateral).copysign(forward), yaw]
}
