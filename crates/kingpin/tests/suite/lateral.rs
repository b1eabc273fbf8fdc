//! The wheel with lateral elasticity only: limit of the five-state model, energy balance, known Hopf points.

use approx::assert_relative_eq;
use arclength::control::Control;
use arclength::{Dual, VectorField};
use kingpin::basin::{ContactModel, Disturbance};
use kingpin::{Key, KingpinError, Wheel};
use proptest::prelude::*;

fn wheel(settings: &[(Key, f64)]) -> Wheel {
    let lateral = Wheel::default().with(Key::KU, f64::INFINITY).unwrap();
    settings.iter().fold(lateral, |wheel, &(key, value)| wheel.with(key, value).unwrap())
}

/// Zero of the growth rate in the speed.
fn hopf_speed(wheel: &Wheel, mut low: f64, mut high: f64) -> f64 {
    let growth_rate = |v: f64| wheel.with(Key::V, v).unwrap().uniform_motion().unwrap().growth_rate();
    assert!(growth_rate(low) * growth_rate(high) < 0.0);
    while high - low > 1e-15 * high {
        let middle = 0.5 * (low + high);
        if growth_rate(middle) * growth_rate(low) > 0.0 {
            low = middle
        } else {
            high = middle
        }
        if (low + high) * 0.5 == middle {
            break;
        }
    }
    low
}

/// In straight running `(m v + c_q l^2)(c_q v + l k) = k v J` at a Hopf point: a quadratic in the speed. Its roots, in
/// 40-digit arithmetic, are also where AUTO-07p finds them, within the tolerance with which it locates them.
#[test]
fn hopf_points_of_straight_running() {
    let straight = [(Key::L, 0.04), (Key::TurningRadius, f64::INFINITY), (Key::CQ, 0.05)];
    let lateral = wheel(&straight);
    let (slow, fast) = (0.788_629_146_247_029_7, 4.338_830_220_750_628);
    assert_relative_eq!(hopf_speed(&lateral, 0.5, 1.0), slow, max_relative = 1e-10);
    assert_relative_eq!(hopf_speed(&lateral, 3.0, 6.0), fast, max_relative = 1e-10);
    assert_relative_eq!(slow, 0.788628788, max_relative = 5e-7);
    assert_relative_eq!(fast, 4.33883022, max_relative = 5e-9);
    // The lateral motion is decoupled from the longitudinal: with any k_u the first is at the same speed.
    let elastic = lateral.with(Key::KU, 30.0).unwrap().critical_speed().unwrap();
    assert_relative_eq!(elastic.speed, slow, max_relative = 1e-10);
    // Twice the damping: stable at every speed.
    for v in 1..200 {
        let damped = lateral.with(Key::CQ, 0.1).unwrap().with(Key::V, 0.1 * f64::from(v)).unwrap();
        assert_eq!(damped.uniform_motion().unwrap().is_stable(), Some(true));
    }
}

/// Three eigenvalues of the five-state model tend to those of this one, the differences as 1/k_u.
#[test]
fn limit_of_large_longitudinal_stiffness() {
    for settings in
        [&[(Key::CQ, 0.05)][..], &[(Key::CQ, 0.2), (Key::KPsi, 0.2), (Key::CPsi, 1e-3), (Key::V, 3.0)]]
    {
        let rigid = wheel(settings);
        let motion = rigid.uniform_motion().unwrap();
        let differences = [1e5, 1e6].map(|k_u| {
            // Longitudinal damping that lets the fast motion decay does not enter the limit.
            let elastic = rigid.with(Key::KU, k_u).unwrap().uniform_motion().unwrap();
            let [_, q, psi, _, omega] = motion.state();
            let shift =
                (elastic.q() - q).abs() + (elastic.psi() - psi).abs() + (elastic.yaw_rate() - omega).abs();
            let of_eigenvalues: f64 = motion
                .eigenvalues()
                .iter()
                .map(|one| {
                    elastic
                        .eigenvalues()
                        .iter()
                        .map(|other| (one - other).norm())
                        .fold(f64::INFINITY, f64::min)
                })
                .sum();
            shift + of_eigenvalues
        });
        assert!(differences[0] < 0.1, "{differences:?}");
        assert_relative_eq!(differences[0] / differences[1], 10.0, max_relative = 0.02);
    }
}

proptest! {
    /// The ground does no work: kinetic energy changes by the power at the king pin, M V V' + J Omega Omega' =
    /// F_x (v - omega q) + F_y q' + (moment about the king pin) Omega, and V' is the derivative of V along the motion.
    #[test]
    fn energy_balance(
        q in -0.1..0.1, psi in -1.4..1.4, yaw_rate in -30.0..30.0, r in 0.5..5.0, c_q in 0.0..1.0, c_psi in 0.0..0.05,
        k_psi in 0.0..0.5,
    ) {
        let wheel = wheel(&[(Key::TurningRadius, r), (Key::CQ, c_q), (Key::CPsi, c_psi), (Key::KPsi, k_psi)]);
        let field = wheel.lateral(&[]).unwrap();
        let state = [q, psi, yaw_rate];
        let mut rate = [0.0; 3];
        field.evaluate(&state, &[], &mut rate);
        let (v, l, omega) = (4.0, 0.08, 4.0 / r);
        let along: [Dual<f64, 1>; 3] = std::array::from_fn(|i| Dual { value: state[i], derivatives: [rate[i]] });
        use arclength::Scalar;
        let forward = (-(along[0] * omega) - along[2] * along[1].sin() * l + v) / along[1].cos();
        let (speed, acceleration) = (forward.value, forward.derivatives[0]);
        prop_assert!((speed - field.forward_speed(&state)).abs() < 1e-12 * (1.0 + speed.abs()));
        let (static_moment, mass) = (0.0668 * 0.068, 0.3519 + 0.0668 + 4.63e-5 / 0.0016);
        let inertia = 3.48e-6 + 2.38e-5 + static_moment * 0.068;
        let force_y = -100.0 * q - c_q * rate[0];
        let force_x = (mass * acceleration - static_moment * yaw_rate * yaw_rate + force_y * psi.sin()) / psi.cos();
        let moment = k_psi * psi - c_psi * (yaw_rate - omega);
        let power = force_x * (v - omega * q) + force_y * rate[0] + moment * yaw_rate;
        let energy_rate = mass * speed * acceleration + inertia * yaw_rate * rate[2];
        let scale = (force_x * v).abs() + (mass * speed * acceleration).abs() + 1.0;
        prop_assert!((energy_rate - power).abs() < 1e-11 * scale, "{} {}", energy_rate, power);
    }

    #[test]
    fn uniform_motion(v in 0.1..6.0, l in 0.03..0.2, curvature in 0.0..2.0, k_psi in 0.0..0.5) {
        let wheel = wheel(&[(Key::V, v), (Key::L, l), (Key::Curvature, curvature), (Key::KPsi, k_psi)]);
        if let Ok(motion) = wheel.uniform_motion() {
            prop_assert!(motion.residual() < 1e-10 * (1.0 + v / l), "{}", motion.residual());
            if motion.growth_rate().abs() > 1e-8 {
                prop_assert_eq!(motion.is_stable(), Some(motion.growth_rate() < 0.0));
            }
            let trace: f64 = (0..3).map(|index| motion.jacobian()[index][index]).sum();
            let sum: f64 = motion.eigenvalues().iter().map(|eigenvalue| eigenvalue.re).sum();
            prop_assert!((trace - sum).abs() < 1e-10 * (1.0 + trace.abs()));
        }
    }
}

/// In the uniform motion without a spring about the king pin the contact force does not depend on k_u.
#[test]
fn contact_force_in_the_uniform_motion() {
    let rigid = wheel(&[(Key::V, 5.0)]);
    let force = rigid.uniform_motion().unwrap().contact_force();
    let elastic = rigid.with(Key::KU, 50.0).unwrap().uniform_motion().unwrap().contact_force();
    assert_relative_eq!(force.lateral, elastic.lateral, max_relative = 1e-13);
    assert!(force.longitudinal.abs() < 1e-13);
    assert_eq!((force.normal, force.limit), (elastic.normal, elastic.limit));
}

#[test]
fn it_needs_an_infinite_stiffness() {
    for refused in [
        Wheel::default().lateral(&[]).map(|_| ()),
        Wheel::default().with(Key::KU, 1e9).unwrap().lateral(&[]).map(|_| ()),
    ] {
        assert!(matches!(refused, Err(KingpinError::LongitudinalElasticity { .. })));
    }
    for key in [Key::K, Key::KU, Key::CU] {
        assert!(wheel(&[]).rolling_model(&[key]).is_err());
    }
    assert!(matches!(wheel(&[]).rolling(&[]), Err(KingpinError::LateralElasticityOnly)));
    let field = wheel(&[]).lateral(&[Key::V, Key::MW]).unwrap();
    let mut derivative = [0.0; 3];
    let [_, q, psi, speed, yaw_rate] = wheel(&[]).uniform_motion().unwrap().state();
    field.evaluate(&[q, psi, yaw_rate], &field.parameters(), &mut derivative);
    assert_eq!(field.forward_speed(&[q, psi, yaw_rate]), speed);
    assert!(derivative.iter().all(|component| component.abs() < 1e-12));
}

/// With `k_u = inf` the speed follows from the angle and the yaw rate, which a kick changes: the state behind it is one of the wheel.
#[test]
fn states_behind_a_kick_fulfil_the_constraint() {
    let toml = include_str!("../wheels/lateral_on_a_circle.toml");
    for (disturbance, magnitude, settings) in [
        (Disturbance::Impulse, 0.3, &[][..]),
        (Disturbance::ReleaseAngle, 0.4, &[]),
        (Disturbance::ReleaseAngle, 0.4, &[(Key::TurningRadius, f64::INFINITY)]),
        (Disturbance::Jolt, 0.5, &[]),
        (Disturbance::StepSteer, 0.5, &[]),
    ] {
        let wheel = settings
            .iter()
            .fold(Wheel::from_toml(toml).unwrap(), |wheel, &(key, value)| wheel.with(key, value).unwrap());
        let (kicked, state) = disturbance.apply(&wheel, ContactModel::Rolling, magnitude).unwrap();
        let [u, q, psi, speed, lateral, yaw, rim] = state;
        let follows = kicked.lateral(&[]).unwrap().forward_speed(&[q, psi, yaw]);
        assert_eq!((u, speed, lateral, rim), (0.0, follows, 0.0, follows), "{disturbance:?}");
        let history =
            disturbance.history(&wheel, ContactModel::Rolling, magnitude, 0.1, 11, &Control::none()).unwrap();
        assert_eq!(history.states[0], state, "{disturbance:?}");
    }
}
