//! The contact force: closed form in the uniform motion, and energy balance in any motion.

use approx::assert_relative_eq;
use arclength::VectorField;
use arclength::control::Control;
use kingpin::basin::{ClassificationSettings, ContactModel, Disturbance, SafeKick};
use kingpin::sliding::Contact;
use kingpin::{Key, Wheel};
use proptest::prelude::*;

proptest! {
    /// F_f = (m_w + m_c l_c/l) V0 omega, theory and the paper's equation (9), in which u0 = 0 makes the first term vanish.
    #[test]
    fn friction_in_the_uniform_motion(v in 0.1..6.0, l in 0.03..0.2, r in 0.5..5.0) {
        let wheel = Wheel::default().with(Key::V, v).unwrap().with(Key::L, l).unwrap()
            .with(Key::TurningRadius, r).unwrap();
        let motion = wheel.uniform_motion().unwrap();
        let force = motion.contact_force();
        let (m_w, m_c, l_c) = (0.3519, 0.0668, 0.012);
        let closed_form = (m_w + m_c * l_c / l) * motion.forward_speed() * motion.yaw_rate();
        prop_assert!((force.friction() - closed_form).abs() < 1e-12 * closed_form);
        prop_assert!(force.longitudinal.abs() < 1e-14);
        let (psi, q) = (motion.psi(), motion.q());
        let paper = v * v / (r * r * psi.cos()) * ((m_w * l + m_c * l_c) / l * (q - r + l * psi.sin())).abs();
        prop_assert!((paper - closed_form).abs() < 1e-12 * closed_form, "{} {}", paper, closed_form);
    }

    /// The ground does no work on a rolling wheel: the rate of the energy is the power at the king pin, in any motion.
    #[test]
    fn newton_for_the_whole_body(
        u in -0.05..0.05, q in -0.05..0.05, psi in -3.0..3.0, forward_speed in -5.0..5.0, yaw_rate in -40.0..40.0,
        c_u in 0.0..2.0, c_q in 0.0..2.0, c_psi in 0.0..0.1, k_psi in 0.0..1.0,
    ) {
        let mut wheel = Wheel::default();
        for (key, value) in [(Key::CU, c_u), (Key::CQ, c_q), (Key::CPsi, c_psi), (Key::KPsi, k_psi), (Key::KU, 60.0)] {
            wheel.set_value(key, value).unwrap();
        }
        let state = [u, q, psi, forward_speed, yaw_rate];
        let mut rate = [0.0; 5];
        wheel.rolling(&[]).unwrap().evaluate(&state, &[], &mut rate);
        let force = wheel.contact_force(&state);
        // Momentum of the two bodies in an inertial frame that coincides with the body frame: the wheel's centre has
        // the velocity (V, 0), C has (V, d Omega).
        let (m_w, m_c, d) = (0.3519, 0.0668, 0.08 - 0.012);
        let momentum_rate = [
            m_w * rate[3] + m_c * (rate[3] - d * yaw_rate * yaw_rate),
            m_w * forward_speed * yaw_rate + m_c * (d * rate[4] + forward_speed * yaw_rate),
        ];
        let at_king_pin = [-60.0 * u - c_u * rate[0], -100.0 * q - c_q * rate[1]];
        let (s, c) = psi.sin_cos();
        let total = [
            at_king_pin[0] * c - at_king_pin[1] * s + force.longitudinal,
            at_king_pin[0] * s + at_king_pin[1] * c + force.lateral,
        ];
        for (total, rate) in total.into_iter().zip(momentum_rate) {
            prop_assert!((total - rate).abs() < 1e-11 * (1.0 + rate.abs()), "{} {}", total, rate);
        }
        // Angular momentum about C: the ground acts at distance d behind it, the king pin l_c ahead of it. The wheel
        // spins about a horizontal axis and has its own inertia about the vertical; its momentum acts at distance d.
        let moment = 0.012 * (at_king_pin[0] * s + at_king_pin[1] * c) - d * force.lateral
            + k_psi * psi - c_psi * (yaw_rate - 4.0);
        let angular_rate = (3.48e-6 + 2.38e-5) * rate[4] - d * m_w * forward_speed * yaw_rate;
        prop_assert!((moment - angular_rate).abs() < 1e-11 * (1.0 + angular_rate.abs()), "{} {}", moment, angular_rate);
    }
}

#[test]
fn the_load_presses_the_wheel_down() {
    let wheel = Wheel::default().with(Key::FAz, -10.0).unwrap();
    assert_relative_eq!(wheel.normal_force(), 10.0 + 0.4187 * 9.81, max_relative = 1e-15);
    assert!(wheel.uniform_motion().unwrap().rolls());
    assert!(!wheel.with(Key::FAz, 10.0).unwrap().uniform_motion().unwrap().rolls());
}

/// The paper's wheel on little sliding friction, in a uniform motion that takes 1.446 N, between mu_d N = 0.821 N and mu_s N, and its seven
/// states with some slip.
fn between_the_limits(spin_inertia: f64, [along, across]: [f64; 2]) -> (Wheel, [f64; 7]) {
    let values = [(Key::V, 2.0), (Key::MuD, 0.2), (Key::CU, 0.5), (Key::CQ, 0.5), (Key::JWxi, spin_inertia)];
    let wheel =
        values.into_iter().fold(Wheel::default(), |wheel, (key, value)| wheel.with(key, value).unwrap());
    let motion = wheel.uniform_motion().unwrap();
    assert!(motion.rolls() && motion.contact_force().friction() > 0.2 * wheel.normal_force());
    let [u, q, psi, forward, yaw] = motion.state();
    (wheel, [u, q, psi, forward, across, yaw, forward - along])
}

/// Where rolling takes more than the sliding friction it depends on its direction and on the mobilities of the contact point whether
/// slip vanishes: against the sliding wheel in the ground frame (SciPy, DOP853, tolerance 1e-10), which knows no limit directions.
#[test]
fn slip_vanishes_where_that_of_the_ground_frame_does() {
    let history = |spin_inertia: f64, slip: [f64; 2], duration: f64| {
        let (wheel, start) = between_the_limits(spin_inertia, slip);
        wheel.sliding().unwrap().simulate_from(&start, duration, 3, &Control::none()).unwrap()
    };
    // Thirteen times as mobile along the caster as across it: slip along the force turns to where it shrinks, and vanishes.
    for (slip, time) in [([0.0, 1e-3], 1.572e-4), ([2e-4, 1e-3], 1.574e-4), ([2e-3, 1e-2], 1.5456e-3)] {
        let phases = history(4.63e-5, slip, 0.05).phases;
        assert_eq!([phases[0].contact, phases[1].contact], [Contact::Sliding, Contact::Rolling]);
        assert!((phases[0].end - time).abs() < 2e-7, "{slip:?}: {}", phases[0].end);
    }
    // The other way it grows, however small it is.
    for (across, reached) in [(-1e-3, -0.146_139_846_8), (-1e-2, -0.163_153_016_1)] {
        let history = history(4.63e-5, [0.0, across], 0.05);
        assert_eq!(history.phases.len(), 1);
        assert!((history.states[2][4] - reached).abs() < 1e-7, "{}", history.states[2][4]);
    }
    // With a heavy rim the mobilities are nearly the same: slip passes by zero, here at 5.06e-5 m/s, and grows again.
    let history = history(5e-3, [2e-4, 1e-3], 0.02);
    assert_eq!(history.phases.len(), 1);
    assert!((history.states[2][4] + 0.044_324_359_245).abs() < 1e-7, "{}", history.states[2][4]);
}

/// A blow outwards leaves such a uniform motion however small it is, one inwards does not, and that is told as it is.
#[test]
fn no_blow_outwards_is_safe_between_the_limits() {
    let (wheel, _) = between_the_limits(4.63e-5, [0.0, 0.0]);
    assert_eq!(wheel.uniform_motion().unwrap().is_stable(), Some(true));
    let settings = ClassificationSettings::with_duration(3.0);
    let edge = |largest: f64| {
        let kind = Disturbance::Impulse;
        SafeKick::find(&wheel, ContactModel::Sliding, settings, kind, largest, &Control::none()).unwrap()
    };
    let outwards = edge(-0.01).unwrap();
    assert!(outwards.returns == 0.0 && outwards.fails < 0.0 && outwards.fails > -1e-10, "{outwards:?}");
    assert!(edge(0.01).is_none_or(|inwards| inwards.returns > 1e-4));
}
