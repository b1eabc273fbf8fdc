//! How a motion depends on its initial state and on a parameter: variational equations along each passage and the
//! jumps between them.
//!
//! At an event `h(x) = 0` where the field changes from `f` to `g` and the state is mapped by `P`, a neighbouring motion meets
//! the event at a time that differs by `dt = -(h' dx)/(h' f)`, so that (Aizerman and Gantmacher 1958; Leine and
//! Nijmeijer, *Dynamics and Bifurcations of Non-Smooth Mechanical Systems*, 2004, chapter 7)
//!
//! ```text
//! dx_after = P (dx + f dt) - g dt
//! ```
//!
//! Where slip vanishes `P` removes both components of it: neighbouring motions all arrive along the limit direction, so that their
//! slip, which has two components, vanishes at one time. Two directions of the state space are lost there.
//! Where a swing about the king pin ends in a rest the yaw rate is forgotten in the same way, by the formula itself.
//! All derivatives, those of the events and of the limit direction included, come from dual numbers.

use super::error::Refusal;
use super::passage::Passage;
use crate::parameters::Key;
use crate::sliding::Regime;
use crate::sliding::model::{Equations, FrictionMoment, S1, S2, slip_squared};
use crate::sliding::{ONSET_SLIP, VANISHING_SLIP};
use crate::wheel::Wheel;
use arclength::differentiation::{Dual, Scalar};
use arclength::integration::{Integrator, Stepper, from_rates};

/// Number of states.
pub(super) const STATES: usize = 7;
/// Directions in which derivatives are carried: every state and a parameter.
pub(super) const DIRECTIONS: usize = STATES + 1;
/// Direction of the parameter.
pub(super) const PARAMETER: usize = STATES;
/// Length of the state with its derivatives.
const EXTENDED: usize = STATES * (1 + DIRECTIONS);

/// A number with its derivatives in all directions.
pub(super) type Varied = Dual<f64, DIRECTIONS>;
/// `columns[i][j]` is the derivative of state `i` in direction `j`.
pub(super) type Columns = [[f64; DIRECTIONS]; STATES];

/// The equations with their derivatives with respect to a parameter; `scale` is its unit.
pub(super) fn varied_equations(wheel: &Wheel, parameter: Option<(Key, f64)>) -> Equations<Varied> {
    Equations::with(|key| {
        let mut value = Varied::from(wheel.get(key));
        if let Some((active, scale)) = parameter {
            value.derivatives[PARAMETER] = scale * derivative_of(wheel, key, active);
        }
        value
    })
}

/// Derivative of one parameter with respect to another.
fn derivative_of(wheel: &Wheel, key: Key, active: Key) -> f64 {
    let follows = key == Key::MuD && active == Key::MuS && wheel.sliding_friction_follows_static();
    match (key, active) {
        (Key::Curvature, Key::TurningRadius) => -wheel.get(Key::Curvature).powi(2),
        _ if key == active || active.sets().contains(&key) || follows => 1.0,
        _ => 0.0,
    }
}

/// Carries `columns` from the start to the end of the passages. `scales` are the sizes of the states.
///
/// # Errors
/// A motion that cannot be followed.
pub(super) fn carry(
    equations: &Equations<Varied>,
    passages: &[Passage],
    columns: &mut Columns,
    scales: &[f64; STATES],
    tolerance: f64,
) -> Result<(), Refusal> {
    let mut absolute = [0.0; EXTENDED];
    for i in 0..STATES {
        let slip = i == S1 || i == S2;
        absolute[i] = if slip { 1e-4 * VANISHING_SLIP } else { 0.01 * tolerance };
        absolute[STATES + DIRECTIONS * i..][..DIRECTIONS].fill(tolerance * scales[i]);
    }
    let integrator = Integrator::default().relative_tolerance(tolerance).absolute_tolerances(&absolute);
    let mut extended = [0.0; EXTENDED];
    for (index, passage) in passages.iter().enumerate() {
        let equations = &under(equations, passage);
        extended[..STATES].copy_from_slice(&passage.initial);
        extended[STATES..].as_chunks_mut().0.copy_from_slice(columns);
        let end = passage.vanishing.map_or(passage.end, |(time, _)| time);
        let regime = passage.mode.regime;
        let system = from_rates(EXTENDED, |extended: &[f64], derivative: &mut [f64]| {
            let state = varied_state(extended);
            let mut rate = [Varied::zero(); STATES];
            regime.field(equations, &state, &mut rate);
            for (i, rate) in rate.iter().enumerate() {
                derivative[i] = rate.value;
                derivative[STATES + DIRECTIONS * i..][..DIRECTIONS].copy_from_slice(&rate.derivatives);
            }
        });
        let mut stepper = Stepper::new(system, &integrator, passage.start, &extended, end)?;
        while !stepper.is_finished() {
            stepper.advance()?;
            let vanished = passage.vanishing.is_some()
                && slip_squared(&stepper.state()[..STATES]) < VANISHING_SLIP * VANISHING_SLIP;
            if vanished {
                break;
            }
        }
        let mut state = varied_state(stepper.state());
        if let Some(next) = passages.get(index + 1) {
            jump([equations, &under(equations, next)], [passage, next], &mut state);
        }
        for (column, varied) in columns.iter_mut().zip(&state) {
            *column = varied.derivatives;
        }
    }
    Ok(())
}

fn varied_state(extended: &[f64]) -> [Varied; STATES] {
    std::array::from_fn(|i| {
        let mut varied = Varied::from(extended[i]);
        varied.derivatives.copy_from_slice(&extended[STATES + DIRECTIONS * i..][..DIRECTIONS]);
        varied
    })
}

/// The equations that hold along a passage: the moment of dry friction about the king pin is that of its swing or rest.
fn under(equations: &Equations<Varied>, passage: &Passage) -> Equations<Varied> {
    equations.under(match passage.mode.friction_moment {
        FrictionMoment::Absent => FrictionMoment::Absent,
        FrictionMoment::Sticking => FrictionMoment::Sticking,
        FrictionMoment::Swinging(moment) => {
            FrictionMoment::Swinging(equations.largest_friction_moment * moment.signum())
        }
    })
}

/// The event that ends a passage.
fn event(equations: &Equations<Varied>, passage: &Passage, state: &[Varied; STATES]) -> Varied {
    /// The onset of slip ends at [`ONSET_SLIP`] unless the slip shrinks again before.
    const NEARLY: f64 = 0.999;
    let regime = passage.mode.regime;
    if passage.ends_about_king_pin {
        return match passage.mode.friction_moment {
            FrictionMoment::Sticking => {
                let moment = equations.friction_moment(state, regime.friction(equations, state));
                equations.largest_friction_moment.powi(2) - moment.powi(2)
            }
            _ => equations.swing_rate(state),
        };
    }
    match regime {
        Regime::Rolling => equations.static_reserve(state),
        Regime::Onset if slip_squared(state).value < (NEARLY * ONSET_SLIP).powi(2) => {
            equations.slip_along_limit_direction(state)
        }
        Regime::Onset | Regime::Sliding => slip_squared(state),
    }
}

/// Turns the derivatives at the end of a passage into those at the start of the next.
fn jump(
    [equations, equations_after]: [&Equations<Varied>; 2],
    [before, after]: [&Passage; 2],
    state: &mut [Varied; STATES],
) {
    let values = state.map(|varied| Varied::from(varied.value));
    let rate_of = |equations: &Equations<Varied>, regime: Regime, state: &[Varied; STATES]| {
        let mut rate = [Varied::zero(); STATES];
        regime.field(equations, state, &mut rate);
        rate.map(|component| component.value)
    };
    let rate_before = rate_of(equations, before.mode.regime, &values);
    // The event along the motion: the first direction is that of the flow, free of the parameter.
    let mut along = values;
    for (varied, rate) in along.iter_mut().zip(rate_before) {
        varied.derivatives[0] = rate;
    }
    let event_rate = event(equations, before, &along).derivatives[0];
    let delay = event(equations, before, state).derivatives.map(|change| -change / event_rate);
    let rate_after = rate_of(equations_after, after.mode.regime, &after.initial.map(Varied::from));
    for i in 0..STATES {
        // No slip is left where the passage after begins without.
        let kept = if (i == S1 || i == S2) && after.mode.regime != Regime::Sliding { 0.0 } else { 1.0 };
        for (derivative, delay) in state[i].derivatives.iter_mut().zip(delay) {
            *derivative = kept * (*derivative + rate_before[i] * delay) - rate_after[i] * delay;
        }
    }
}
