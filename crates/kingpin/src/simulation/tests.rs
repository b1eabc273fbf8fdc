//! Simulated motions against conservation laws, symmetry and the linear theory.

use crate::{Key, Wheel};
use arclength::VectorField;
use arclength::control::Control;
use arclength::integration::{Integrator, from_fn};
use proptest::prelude::*;

fn wheel(changes: &[(Key, f64)]) -> Wheel {
    changes.iter().try_fold(Wheel::default(), |wheel, &(key, value)| wheel.with(key, value)).unwrap()
}

/// Kinetic energy of wheel and caster and energy of the springs, in J.
fn energy(wheel: &Wheel, [u, q, psi, forward, yaw]: [f64; 5]) -> f64 {
    let get = |key| wheel.get(key);
    let arm = get(Key::L) - get(Key::LC);
    let mass = get(Key::MW) + get(Key::MC) + get(Key::JWxi) / get(Key::WheelRadius).powi(2);
    let inertia = get(Key::JCz) + get(Key::JWzeta) + get(Key::MC) * arm * arm;
    0.5 * (mass * forward.powi(2) + inertia * yaw.powi(2))
        + 0.5 * (get(Key::KU) * u * u + get(Key::KQ) * q * q + get(Key::KPsi) * psi * psi)
}

/// Power of the towing point and of the dampers in W: theory of the model, energy balance.
fn power(wheel: &Wheel, state: [f64; 5], rate: [f64; 5]) -> f64 {
    let get = |key| wheel.get(key);
    let [u, q, psi, _, yaw] = state;
    let (v, omega) = (get(Key::V), wheel.towing_yaw_rate());
    let spring = (-get(Key::KU) * u, -get(Key::KQ) * q);
    let damper = (-get(Key::CU) * rate[0], -get(Key::CQ) * rate[1]);
    // The towing frame drives the springs, the dampers and the spring about the king pin.
    let towing = (spring.0 + damper.0) * (v - omega * q) + (spring.1 + damper.1) * omega * u;
    let about_king_pin = (get(Key::KPsi) * psi - get(Key::CPsi) * (yaw - omega)) * omega;
    let dissipated = damper.0 * rate[0] + damper.1 * rate[1] - get(Key::CPsi) * (yaw - omega).powi(2);
    towing + about_king_pin + dissipated
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(32))]

    /// The rate of kinetic and spring energy is the power of the towing point less that of the dampers.
    #[test]
    fn energy_balance(
        v in 0.5..8.0f64, curvature in 0.0..2.0f64, k_u in 50.0..300.0f64, c in 0.0..0.5f64,
        c_psi in 0.0..1e-3f64, k_psi in 0.0..0.1f64, psi in -0.4..0.4f64, yaw in -8.0..8.0f64,
    ) {
        let wheel = wheel(&[
            (Key::V, v), (Key::Curvature, curvature), (Key::KU, k_u), (Key::CU, c), (Key::CQ, 0.5 * c),
            (Key::CPsi, c_psi), (Key::KPsi, k_psi),
        ]);
        let field = wheel.rolling(&[]).unwrap();
        let start = [0.01, -0.02, psi, v, yaw];
        let with_work = from_fn(6, |_, state, derivative| {
            field.evaluate(&state[..5], &[], &mut derivative[..5]);
            let of = |x: &[f64]| std::array::from_fn(|i| x[i]);
            derivative[5] = power(&wheel, of(state), of(derivative));
        });
        let initial = [start[0], start[1], start[2], start[3], start[4], 0.0];
        let end = Integrator::with_tolerance(1e-12).integrate(with_work, 0.0, &initial, 0.5).unwrap().state;
        let gained = energy(&wheel, [end[0], end[1], end[2], end[3], end[4]]) - energy(&wheel, start);
        prop_assert!((gained - end[5]).abs() < 1e-9 * energy(&wheel, start).max(1.0), "{gained} {}", end[5]);
    }

    /// Run forwards, turned round (t -> -t, V -> -V, u -> -u, psi -> pi - psi) and run again, the undamped
    /// wheel comes back to where it started.
    #[test]
    fn time_reversal(v in 1.0..6.0f64, curvature in 0.0..1.5f64, psi in -0.3..0.3f64, yaw in -3.0..3.0f64) {
        let wheel = wheel(&[(Key::V, v), (Key::Curvature, curvature)]);
        let field = wheel.rolling(&[]).unwrap();
        let reverse = |x: &[f64]| [-x[0], x[1], std::f64::consts::PI - x[2], -x[3], x[4]];
        let start = [0.005, -0.01, psi, v, yaw];
        // The field itself obeys the symmetry to rounding.
        let (mut rate, mut reversed_rate) = ([0.0; 5], [0.0; 5]);
        field.evaluate(&start, &[], &mut rate);
        field.evaluate(&reverse(&start), &[], &mut reversed_rate);
        let expected = [rate[0], -rate[1], rate[2], rate[3], -rate[4]];
        for (found, expected) in reversed_rate.iter().zip(expected) {
            prop_assert!((found - expected).abs() < 1e-12 * (1.0 + expected.abs() + v));
        }
        let integrator = Integrator::with_tolerance(1e-13);
        let system = || from_fn(5, |_, x: &[f64], f: &mut [f64]| field.evaluate(x, &[], f));
        let there = integrator.integrate(system(), 0.0, &start, 0.02).unwrap().state;
        let back = integrator.integrate(system(), 0.0, &reverse(&there), 0.02).unwrap().state;
        for (found, expected) in reverse(&back).iter().zip(start) {
            prop_assert!((found - expected).abs() < 1e-11 * (1.0 + v), "{found} {expected}");
        }
    }
}

#[test]
fn the_uniform_motion_stays() {
    let wheel = Wheel::default();
    let motion = wheel.uniform_motion().unwrap();
    let history = wheel.simulate(5.0, &[], 11, &Control::none()).unwrap();
    assert_eq!((history.times.len(), history.times[10]), (11, 5.0));
    for (state, force) in history.states.iter().zip(history.friction_force()) {
        for (found, expected) in state.iter().zip(motion.state()) {
            assert!((found - expected).abs() < 1e-9, "{found} {expected}");
        }
        assert!((force - motion.contact_force().friction()).abs() < 1e-8);
    }
    // |T2| = (m_w + m_c l_c/l) V0 omega = 5.75 N is more than mu_s (m_w + m_c) g = 4.1 N.
    assert_eq!(history.rolling_lost_at, Some(0.0));
}

#[test]
fn a_known_limit_cycle_closes() {
    // The cycle at v = 6 m/s, l = 0.08 m, r = 1 m from single shooting with a tolerance of 3e-14.
    let period = 0.149_818_258_550_394_1;
    let start = [
        0.006_788_672_435_187_814_5,
        -0.063_185_309_027_484_69,
        0.513_078_505_728_634_6,
        6.416_290_737_262_749,
        6.0,
    ];
    let history = wheel(&[(Key::V, 6.0)]).simulate_from(&start, period, 1001, &Control::none()).unwrap();
    for (found, expected) in history.states[1000].iter().zip(start) {
        assert!((found - expected).abs() < 1e-9, "{found} {expected}");
    }
    let angle = history.state("psi").unwrap();
    let smallest = angle.iter().copied().fold(f64::INFINITY, f64::min);
    assert!((smallest + 0.376_304_724_096_338_9).abs() < 1e-5);
}

#[test]
fn the_loss_of_rolling_is_located() {
    let loaded = wheel(&[(Key::FAz, -20.0)]);
    let history = loaded.simulate(1.0, &[("psi", 0.6)], 20_001, &Control::none()).unwrap();
    let lost = history.rolling_lost_at.unwrap();
    let first = history.contact_forces.iter().position(|force| !force.rolls()).unwrap();
    assert!(first > 0 && history.times[first - 1] < lost && lost <= history.times[first]);
    assert!(loaded.simulate(1.0, &[("psi", 0.01)], 3, &Control::none()).unwrap().rolling_lost_at.is_none());
}

#[test]
fn bad_input_is_refused() {
    let wheel = Wheel::default();
    let message =
        |result: Result<super::TimeHistory, super::SimulationError>| result.unwrap_err().to_string();
    assert!(
        message(wheel.simulate(1.0, &[("phi", 0.1)], 11, &Control::none())).contains("u, q, psi, V, Omega")
    );
    assert!(message(wheel.simulate(1.0, &[("psi", f64::NAN)], 11, &Control::none())).contains("psi = NaN"));
    assert!(message(wheel.simulate(0.0, &[], 11, &Control::none())).contains("duration = 0"));
    assert!(message(wheel.simulate(f64::INFINITY, &[], 11, &Control::none())).contains("duration = inf"));
    assert!(message(wheel.simulate(1.0, &[], 1, &Control::none())).contains("samples = 1"));
    assert!(
        message(wheel.simulate(1.0, &[("Omega", 1e200)], 2, &Control::none())).contains("cannot be followed")
    );
}
