//! Steady sliding: the wheel slides all the time and the caster keeps its angle in the towing frame.
//!
//! Where a wheel that was kicked, or towed too fast, does not find back to rolling, it may come to this second kind of uniform motion:
//! dragged along at an angle, with no slip along the caster and the sliding friction across it. With dry friction about the king pin the
//! caster sticks, at any angle at which that suffices.

use super::model::{Equations, FrictionMoment, S1, S2, SlipState, slips};
use super::{Contact, HybridState, SlidingWheel};
use crate::parameters::Key;
use crate::wheel::Wheel;
use arclength::Scalar;
use arclength::algebraic::{AlgebraicProblem, Differentiator, solve_square};
use arclength::linear::eigenvalues::eigenvalues;

/// States that are sought: all, or those that a caster which sticks leaves free.
const FREE: [usize; 7] = [0, 1, 2, 3, S2, 5, S1];
const FREE_WHILE_STICKING: [usize; 5] = [0, 1, 3, S2, S1];
/// Real parts above this part of the largest modulus may be rounding.
const ROUNDING: f64 = 1e-10;

/// The rates of the free states of a wheel that slides, the others being those of `state`.
struct SlidingRates<'a> {
    wheel: &'a Wheel,
    friction_moment: FrictionMoment<f64>,
    state: SlipState,
    free: &'a [usize],
}

impl AlgebraicProblem for SlidingRates<'_> {
    fn unknowns(&self) -> usize {
        self.free.len()
    }

    fn equations(&self) -> usize {
        self.free.len()
    }

    fn evaluate<T: Scalar>(&self, unknown: &[T], residual: &mut [T]) {
        let equations: Equations<T> = Equations::with(|key| T::from(self.wheel.get(key)));
        let equations = equations.under(match self.friction_moment {
            FrictionMoment::Sticking => FrictionMoment::Sticking,
            _ => FrictionMoment::Absent,
        });
        let mut state = self.state.map(T::from);
        for (place, value) in self.free.iter().zip(unknown) {
            state[*place] = *value;
        }
        let mut rates = [T::zero(); 7];
        equations.derivative(&state, equations.sliding_force(&state), &mut rates);
        for (entry, place) in residual.iter_mut().zip(self.free) {
            *entry = rates[*place];
        }
    }
}

impl SlidingWheel {
    /// The steady sliding to which Newton's method leads from a state of a wheel that slides, where small disturbances of it die out.
    pub(crate) fn steady_sliding_near(&self, present: &HybridState) -> Option<HybridState> {
        let mut state = present.state;
        let friction_moment = match self.equations.largest_friction_moment {
            0.0 => FrictionMoment::Absent,
            // While the caster swings the friction about the king pin drives it to where it sticks.
            _ if self.equations.swing_rate(&state) == 0.0 => FrictionMoment::Sticking,
            _ => return None,
        };
        if present.contact != Contact::Sliding {
            return None;
        }
        let sticks = friction_moment == FrictionMoment::Sticking;
        let free: &[usize] = if sticks { &FREE_WHILE_STICKING } else { &FREE };
        let problem = SlidingRates { wheel: &self.wheel, friction_moment, state, free };
        let length = self.wheel.get(Key::L);
        let speed = state[3].hypot(state[S2]);
        let scales = [length, length, 1.0, speed, speed, speed / length, speed];
        let of_free = |values: &SlipState| free.iter().map(|place| values[*place]).collect::<Vec<f64>>();
        let solved = solve_square(&problem, &of_free(&state), &of_free(&scales)).ok()?;
        for (place, value) in free.iter().zip(&solved.unknown) {
            state[*place] = *value;
        }
        if !slips(&state) {
            return None;
        }
        let equations = self.equations.under(friction_moment);
        let needed = equations.friction_moment(&state, equations.sliding_force(&state));
        if sticks && needed.abs() > equations.largest_friction_moment {
            return None;
        }
        let count = free.len();
        let (mut residual, mut jacobian) = (vec![0.0; count], vec![0.0; count * count]);
        Differentiator::default().jacobian(&problem, &solved.unknown, &mut residual, &mut jacobian, count);
        let eigenvalues = eigenvalues(&jacobian, count).ok()?;
        let largest = eigenvalues.iter().map(|value| value.norm()).fold(0.0, f64::max);
        let dies_out = eigenvalues.iter().all(|value| value.re < -ROUNDING * largest);
        dies_out.then_some(HybridState { contact: Contact::Sliding, state })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::basin::{ClassificationSettings, ContactModel, Destinations, Fate};
    use arclength::control::Control;
    use proptest::prelude::*;

    fn office_chair(friction: f64) -> Wheel {
        let values = [
            (Key::V, 42.24),
            (Key::L, 0.022),
            (Key::TurningRadius, 2.0),
            (Key::MW, 0.06),
            (Key::MC, 0.07),
            (Key::JWxi, 1.9e-5),
            (Key::JWzeta, 1.5e-5),
            (Key::JCz, 1.2e-5),
            (Key::WheelRadius, 0.025),
            (Key::LC, 0.006),
            (Key::MuS, 0.5),
            (Key::MuD, 0.4),
            (Key::FAz, -140.0),
            (Key::K, 2e4),
            (Key::MF, friction),
        ];
        values.into_iter().fold(Wheel::default(), |wheel, (key, value)| wheel.with(key, value).unwrap())
    }

    /// What is left of the balance of forces, along and across the path, and of moments about the king pin, of a wheel and caster that turn
    /// as one body about the centre of the circle: in the ground frame, from the masses. Relative to the largest term.
    fn imbalance(wheel: &Wheel, state: &SlipState) -> [f64; 3] {
        let get = |key: Key| wheel.get(key);
        let [u, q, psi, forward, lateral, yaw, slip] = *state;
        let towing_rate = get(Key::V) * get(Key::Curvature);
        let mass = get(Key::MW) + get(Key::MC);
        // Mass times distance from the wheel centre, forwards along the caster.
        let static_moment = get(Key::MC) * (get(Key::L) - get(Key::LC));
        let along = [psi.cos(), -psi.sin()];
        let across = [psi.sin(), psi.cos()];
        let king_pin = [u, q - get(Key::TurningRadius)];
        let wheel_centre = [0, 1].map(|i| king_pin[i] - get(Key::L) * along[i]);
        let friction = get(Key::MuD) * wheel.normal_force() * -lateral.signum();
        let inertia =
            [0, 1].map(|i| -towing_rate.powi(2) * (mass * wheel_centre[i] + static_moment * along[i]));
        let spring = [-get(Key::KU) * u, -get(Key::KQ) * q];
        let force = [0, 1].map(|i| (spring[i] + friction * across[i] - inertia[i]) / friction.abs());
        let arm = static_moment - mass * get(Key::L);
        let of_inertia = -towing_rate.powi(2) * arm * (along[0] * king_pin[1] - along[1] * king_pin[0]);
        let moment = -get(Key::L) * friction - of_inertia + get(Key::KPsi) * psi;
        // The caster turns with the frame and its centre with the circle; the wheel rolls along itself.
        let velocity = [
            forward - towing_rate * (-wheel_centre[1] * along[0] + wheel_centre[0] * along[1]),
            lateral - towing_rate * (-wheel_centre[1] * across[0] + wheel_centre[0] * across[1]),
        ];
        assert!(velocity.iter().all(|rest| rest.abs() < 1e-7 * forward.hypot(lateral)), "{velocity:?}");
        assert!((yaw / towing_rate - 1.0).abs() < 1e-8 && slip.abs() < 1e-7 * lateral.abs());
        [force[0], force[1], moment / (get(Key::L) * friction.abs())]
    }

    #[test]
    fn motions_come_to_it() {
        let wheel = office_chair(0.0);
        let start = wheel.perturbed_uniform_motion(&[("psi", 0.5), ("Omega", 20.0)]).unwrap();
        let history = wheel.sliding().unwrap().simulate(&start, 40.0, 3, &Control::none()).unwrap();
        let end = history.states.last().unwrap();
        let sliding = wheel.sliding().unwrap();
        let present = sliding.slipping_state(&std::array::from_fn(|i| end[i]));
        let steady = sliding.steady_sliding_near(&present).unwrap();
        for (one, other) in steady.public().iter().zip(end) {
            assert!((one - other).abs() < 1e-5 * one.abs().max(1e-3), "{one} {other}");
        }
        let rest = imbalance(&wheel, &steady.state);
        assert!(rest.iter().all(|rest| rest.abs() < 1e-9), "{rest:?}");
    }

    #[test]
    fn it_is_what_becomes_of_kicked_motions() {
        for friction in [0.0, 0.005] {
            let wheel = office_chair(friction);
            let starts = [0.3, -0.9].map(|psi| wheel.perturbed_uniform_motion(&[("psi", psi)]).unwrap());
            let settings = ClassificationSettings::default();
            let destinations = Destinations::new(&wheel, ContactModel::Sliding, settings).unwrap();
            assert_eq!(destinations.of(&starts, &Control::none()).unwrap(), [Fate::SteadySliding; 2]);
        }
    }

    #[test]
    fn a_caster_sticks_at_any_angle_at_which_dry_friction_holds_it() {
        let steady = |friction: f64, aside: f64| {
            let wheel = office_chair(friction);
            let sliding = wheel.sliding().unwrap();
            let free = office_chair(0.0);
            let start = [-0.0017, -0.0036, -0.6435, 33.83, -25.88, 21.12, 33.83];
            let present = free.sliding().unwrap().slipping_state(&start);
            let mut present = free.sliding().unwrap().steady_sliding_near(&present).unwrap();
            present.state[2] += aside;
            present.state[5] = 21.12;
            sliding.steady_sliding_near(&present).map(|steady| imbalance(&wheel, &steady.state))
        };
        for aside in [0.0, 0.01, -0.01] {
            let [along, across, moment] = steady(0.05, aside).unwrap();
            assert!(along.abs() < 1e-9 && across.abs() < 1e-9);
            let held = 0.05 / (0.022 * 56.51012);
            assert!(moment.abs() < if aside == 0.0 { 1e-9 } else { held }, "{moment}");
        }
        assert!(steady(1e-6, 0.01).is_none());
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(64))]

        #[test]
        fn forces_and_moments_balance_in_the_ground_frame(
            [v, l, r] in [0.5..60.0_f64, 0.02..0.3_f64, 0.5..20.0_f64],
            [m_w, m_c, stiffness] in [0.05..3.0_f64, 0.05..3.0_f64, 200.0..5e4_f64],
            [load, friction, part] in [0.0..500.0_f64, 0.1..0.9_f64, 0.0..1.0_f64],
            damping in 0.0..50.0_f64,
        ) {
            let mut wheel = Wheel::default();
            for (key, value) in [
                (Key::V, v), (Key::L, l), (Key::TurningRadius, r), (Key::MW, m_w), (Key::MC, m_c), (Key::LC, part * l),
                (Key::K, stiffness), (Key::FAz, -load), (Key::MuS, friction), (Key::CU, damping), (Key::CQ, damping),
            ] {
                wheel = wheel.with(key, value).unwrap();
            }
            let sliding = wheel.sliding().unwrap();
            for index in 0..12 {
                let psi = -3.0 + 0.5 * f64::from(index);
                let start = [0.0, 0.0, psi, v * psi.cos(), v * psi.sin(), v / r, v * psi.cos()];
                let present = sliding.slipping_state(&start);
                if let Some(steady) = sliding.steady_sliding_near(&present) {
                    let rest = imbalance(&wheel, &steady.state);
                    prop_assert!(rest.iter().all(|rest| rest.abs() < 1e-7), "{:?}", rest);
                }
            }
        }
    }
}
