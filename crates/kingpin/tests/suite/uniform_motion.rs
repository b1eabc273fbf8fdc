//! The uniform motion: closed form against Newton's method, and its limits.

use approx::assert_relative_eq;
use arclength::VectorField;
use kingpin::{Key, KingpinError, NoUniformMotion, Wheel};
use proptest::prelude::*;

fn wheel(settings: &[(Key, f64)]) -> Wheel {
    settings.iter().fold(Wheel::default(), |wheel, &(key, value)| wheel.with(key, value).unwrap())
}

proptest! {
    #[test]
    fn newton_and_closed_form_agree(
        v in 0.05..12.0, l in 0.02..0.3, curvature in 0.0..3.0, k in 20.0..500.0, k_psi in 0.0..0.5, c in 0.0..2.0,
    ) {
        let wheel = wheel(&[
            (Key::V, v), (Key::L, l), (Key::Curvature, curvature), (Key::K, k), (Key::KPsi, k_psi), (Key::CQ, c),
            (Key::CPsi, 0.01 * c),
        ]);
        if let Ok(motion) = wheel.uniform_motion() {
            prop_assert!(motion.residual() < 1e-10 * (1.0 + v / l), "{}", motion.residual());
            // Near the ends of the range the motion is ill-conditioned: do not start Newton's method across them.
            let (sine, rho) = (motion.psi().sin(), motion.spring_deflection_along_caster() / l);
            if sine.abs() < 0.9 && rho < 0.8 {
                let start = motion.state().map(|value| value * 1.001 + 1e-5);
                let solved = wheel.uniform_motion_near(&start).expect("converges");
                for (solved, closed) in solved.state().into_iter().zip(motion.state()) {
                    prop_assert!((solved - closed).abs() < 1e-11 * (1.0 + closed.abs()), "{solved} {closed}");
                }
            }
        }
    }

    /// Without a spring about the king pin `u0 = 0`, and `k_u` and the dampers do not matter.
    #[test]
    fn the_longitudinal_direction_does_not_matter(v in 0.1..6.0, k_u in 5.0..1e4, c_u in 0.0..3.0) {
        let other = wheel(&[(Key::V, v), (Key::KU, k_u), (Key::CU, c_u)]);
        let motion = other.uniform_motion().unwrap();
        prop_assert_eq!(motion.state(), wheel(&[(Key::V, v)]).uniform_motion().unwrap().state());
        prop_assert_eq!(motion.u(), 0.0);
        let solved = other.uniform_motion_near(&motion.state().map(|value| 1.001 * value + 1e-4)).unwrap();
        for (solved, closed) in solved.state().into_iter().zip(motion.state()) {
            prop_assert!((solved - closed).abs() < 1e-12 * (1.0 + closed.abs()), "{solved} {closed}");
        }
    }

    /// In steady motion the forces at the king pin do no work: k_psi psi0 omega = k_u u0 v - (k_u - k_q) omega u0 q0.
    #[test]
    fn anisotropic_wheel_with_a_spring_about_the_king_pin(
        v in 0.1..5.0, k_u in 30.0..1e3, k_psi in 0.001..0.3,
    ) {
        let wheel = wheel(&[(Key::V, v), (Key::KU, k_u), (Key::KPsi, k_psi)]);
        let motion = wheel.uniform_motion().unwrap();
        prop_assert!(motion.residual() < 1e-10);
        let [u, q, psi, _, omega] = motion.state();
        let springs = k_u * u * v - (k_u - 100.0) * omega * u * q;
        prop_assert!((springs - k_psi * psi * omega).abs() < 1e-12 * (1.0 + springs.abs()));
    }
}

/// An equilibrium of the vector field, whichever parameters are active.
#[test]
fn it_is_an_equilibrium_of_the_vector_field() {
    let wheel = wheel(&[(Key::KU, 300.0), (Key::KPsi, 0.1), (Key::CU, 0.3), (Key::CPsi, 0.01)]);
    let motion = wheel.uniform_motion().unwrap();
    for active in [
        &[Key::V][..],
        &[Key::V, Key::L],
        &[Key::Curvature],
        &[Key::TurningRadius, Key::KQ, Key::MW],
        &Key::ALL[..20],
    ] {
        let field = wheel.rolling(active).unwrap();
        let mut derivative = [0.0; 5];
        field.evaluate(&motion.state(), &field.parameters(), &mut derivative);
        assert!(derivative.iter().all(|component| component.abs() < 1e-11), "{active:?} {derivative:?}");
    }
}

#[test]
fn rectilinear_towing_is_the_limit_of_wide_circles() {
    let straight = wheel(&[(Key::TurningRadius, f64::INFINITY)]).uniform_motion().unwrap();
    assert_eq!(straight.state(), [0.0, 0.0, 0.0, 4.0, 0.0]);
    let wide = wheel(&[(Key::TurningRadius, 1e6)]).uniform_motion().unwrap();
    assert_relative_eq!(wide.psi(), 0.08e-6, max_relative = 1e-9);
}

#[test]
fn the_condition_that_fails_is_named() {
    let reason = |wheel: Wheel| match wheel.uniform_motion() {
        Err(KingpinError::NoUniformMotion { reason, .. }) => reason,
        other => panic!("{other:?}"),
    };
    assert_eq!(reason(wheel(&[(Key::V, 0.0)])), NoUniformMotion::Standstill);
    let NoUniformMotion::SpringTooSoft { inertial, elastic } = reason(wheel(&[(Key::V, 50.0)])) else {
        panic!()
    };
    assert_relative_eq!(inertial, 0.0668 * 0.068 * 2500.0, max_relative = 1e-14);
    assert_relative_eq!(elastic, 8.0);
    let small = wheel(&[(Key::TurningRadius, 0.08), (Key::V, 0.01)]);
    let NoUniformMotion::CircleTooSmall { effective_length, radius } =
        reason(small.with(Key::TurningRadius, 0.05).unwrap())
    else {
        panic!()
    };
    assert!(effective_length < 0.08 && effective_length > 0.079);
    assert_eq!(radius, 0.05);
    let message = small.with(Key::TurningRadius, 0.05).unwrap().uniform_motion().unwrap_err().to_string();
    assert!(message.contains("|l - a0| < r fails") && message.contains("r = 0.05 m"), "{message}");
}
