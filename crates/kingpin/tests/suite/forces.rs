//! Forces along cycles and at Hopf points, from the springs, the momentum of the wheel and the balance of energy.

use arclength::control::Control;
use arclength::cycle::CyclePoint;
use kingpin::branches::{Along, CycleOptions, HopfPoint, Mode};
use kingpin::{Key, Wheel};
use std::ops::ControlFlow;

/// Samples of a period: a mean over them is exact to rounding for a smooth motion.
const SAMPLES: usize = 4000;

fn wheel(text: &str) -> Wheel {
    Wheel::from_toml(text).unwrap()
}

fn hopf_points(wheel: &Wheel, speeds: (f64, f64)) -> Vec<HopfPoint> {
    let along = Along::new(Key::V, speeds.0, speeds.1).unwrap();
    wheel.hopf_points(along, &Control::none()).unwrap().points
}

/// The cycles from the first Hopf point.
fn cycles(wheel: &Wheel, speeds: (f64, f64), at: &[f64]) -> Vec<CyclePoint> {
    let along = Along::new(Key::V, speeds.0, speeds.1).unwrap();
    let options = CycleOptions::default().at(at);
    let points = hopf_points(wheel, speeds);
    assert!(!points.is_empty(), "{wheel:?}");
    points[0].cycles(along, &options, |_| ControlFlow::Continue(())).unwrap().points
}

/// That at a speed.
fn cycle_at(wheel: &Wheel, speeds: (f64, f64), speed: f64) -> CyclePoint {
    let found = cycles(wheel, speeds, &[speed]);
    found.into_iter().find(|cycle| cycle.value == speed).unwrap()
}

/// What is known of a cycle from its states: the largest friction and king-pin force, the mean power of the dampers and of the
/// towing point.
struct Sampled {
    friction: f64,
    king_pin: f64,
    damping: f64,
    towing: f64,
}

fn sampled(wheel: &Wheel, cycle: &CyclePoint) -> Sampled {
    let wheel = wheel.with(Key::V, cycle.value).unwrap();
    let get = |key| wheel.get(key);
    let (v, l, omega) = (get(Key::V), get(Key::L), wheel.towing_yaw_rate());
    let mut all = Sampled { friction: 0.0, king_pin: 0.0, damping: 0.0, towing: 0.0 };
    for (_, state) in cycle.orbit.sample(SAMPLES) {
        let [u, q, psi, forward, yaw_rate] = state[..] else { panic!("five states") };
        let (sine, cosine) = psi.sin_cos();
        let u_rate = forward * cosine + l * yaw_rate * sine - v + omega * q;
        let q_rate = -forward * sine + l * yaw_rate * cosine - omega * u;
        let force_x = -get(Key::KU) * u - get(Key::CU) * u_rate;
        let force_y = -get(Key::KQ) * q - get(Key::CQ) * q_rate;
        let turning = yaw_rate - omega;
        let moment = get(Key::KPsi) * psi - get(Key::CPsi) * turning;
        let contact = wheel.contact_force(&[u, q, psi, forward, yaw_rate]);
        all.friction = all.friction.max(contact.friction());
        all.king_pin = all.king_pin.max(force_x.hypot(force_y));
        all.damping += get(Key::CU) * u_rate * u_rate
            + get(Key::CQ) * q_rate * q_rate
            + get(Key::CPsi) * turning * turning;
        all.towing += force_x * (v - omega * q) + force_y * omega * u + moment * omega;
    }
    all.damping /= SAMPLES as f64;
    all.towing /= SAMPLES as f64;
    all
}

#[test]
fn friction_of_the_unstable_cycles_of_the_papers_wheel() {
    let wheel = Wheel::default();
    // From single shooting at a tolerance of 3e-14.
    for (speed, expected) in [(3.0, 33.90), (5.0, 53.18), (7.0, 59.80)] {
        let cycle = cycle_at(&wheel, (1.0, 12.0), speed);
        let forces = wheel.with(Key::V, speed).unwrap().cycle_forces(&cycle.orbit).unwrap();
        assert!((forces.friction_max - expected).abs() < 0.005, "{} {}", cycle.value, forces.friction_max);
        assert!((forces.static_limit - 9.81 * 0.4187).abs() < 1e-12);
        assert_eq!(forces.rolls(), Some(false));
        assert!((forces.friction_ratio_max().unwrap() - expected / 4.107447).abs() < 0.01);
        assert_eq!(forces.damper_power, 0.0);
    }
}

#[test]
fn forces_are_those_of_springs_and_momentum_and_the_dampers_take_what_the_towing_gives() {
    let wheels = [
        ("", (1.0, 12.0)),
        ("c_q = 0.01\nc_u = 0.02\nr = 2.0", (1.0, 30.0)),
        ("c_q = 0.01\nc_u = 0.02\nk_u = 300.0\nl = 0.1\nr = 1.5", (1.0, 20.0)),
        ("c_psi = 1e-4\nk_psi = 0.02\nr = 1.0", (1.0, 20.0)),
        ("l = 0.04\nr = inf\nc_u = 0.1\nc_q = 0.05", (0.3, 6.0)),
        ("l = 0.04\nr = inf\nc_u = 0.05\nc_q = 0.02\nc_psi = 1e-4\nk_q = 80.0", (0.05, 30.0)),
    ];
    let mut checked = 0;
    for (text, speeds) in wheels {
        let wheel = wheel(text);
        for cycle in cycles(&wheel, speeds, &[]).into_iter().step_by(7) {
            checked += 1;
            let speed = cycle.value;
            let forces = wheel.with(Key::V, speed).unwrap().cycle_forces(&cycle.orbit).unwrap();
            let sampled = sampled(&wheel, &cycle);
            // A sample misses the largest value by the curvature over its distance at most.
            for (found, seen) in
                [(forces.friction_max, sampled.friction), (forces.king_pin_force_max, sampled.king_pin)]
            {
                assert!(found > seen * (1.0 - 1e-9) && found < seen * (1.0 + 2e-5), "{text}: {found} {seen}");
            }
            let size = forces.king_pin_force_max * speed;
            assert!((forces.damper_power - sampled.damping).abs() < 1e-9 * size, "{text}");
            assert!(
                (forces.damper_power - sampled.towing).abs() < 1e-7 * size,
                "{text}: {} {}",
                forces.damper_power,
                sampled.towing
            );
        }
    }
    assert!(checked > 20, "{checked}");
}

#[test]
fn a_stiff_king_pin_has_the_forces_of_a_rigid_one() {
    let rigid = wheel("k_u = inf\nl = 0.04\nr = inf\nc_q = 0.05");
    let (speeds, speed) = ((0.3, 6.0), 0.75);
    let cycle = cycle_at(&rigid, speeds, speed);
    let limit = rigid.with(Key::V, speed).unwrap().cycle_forces(&cycle.orbit).unwrap();
    let mut last = f64::INFINITY;
    for stiffness in [1e5, 1e6] {
        let elastic = rigid.with(Key::KU, stiffness).unwrap();
        let cycle = cycle_at(&elastic, speeds, speed);
        let forces = elastic.with(Key::V, speed).unwrap().cycle_forces(&cycle.orbit).unwrap();
        let difference = (forces.friction_max / limit.friction_max - 1.0)
            .abs()
            .max((forces.king_pin_force_max / limit.king_pin_force_max - 1.0).abs())
            .max((forces.damper_power / limit.damper_power - 1.0).abs());
        assert!(difference < 0.2 * last, "{difference} after {last}");
        last = difference;
    }
    assert!(last < 1e-2, "{last}");
}

#[test]
fn hopf_points_tell_the_stable_side_and_how_cycles_grow() {
    let wheels = [
        ("", (1.0, 12.0), Mode::Lateral),
        ("r = 2.0\nc_q = 0.01\nc_u = 0.02", (1.0, 30.0), Mode::Lateral),
        ("l = 0.04\nr = inf\nc_u = 0.1\nc_q = 0.05", (0.3, 6.0), Mode::Lateral),
        ("k_u = inf\nl = 0.04\nr = inf\nc_q = 0.05", (0.3, 6.0), Mode::Lateral),
        (
            "l = 0.08\nr = 1.0\nk_u = 760.0\nk_q = 25.0\nc_q = 0.5\nc_psi = 0.01",
            (1.0, 4.0),
            Mode::Longitudinal,
        ),
        (
            "tyre = \"linear\"\nC_alpha = 300.0\nsigma = 0.08\na = 0.01\nk = inf\nr = inf\nl = 0.05\nc_psi = 2e-3",
            (0.1, 40.0),
            Mode::Yaw,
        ),
    ];
    let mut seen = Vec::new();
    for (text, speeds, mode) in wheels {
        let wheel = wheel(text);
        for hopf in hopf_points(&wheel, speeds) {
            assert_eq!(hopf.birth.mode, mode, "{text} at {}", hopf.value);
            for (side, factor) in [(0, 1.0 - 1e-5), (1, 1.0 + 1e-5)] {
                let beside = wheel.with(Key::V, hopf.value * factor).unwrap().uniform_motion().unwrap();
                let unstable = beside.stability().unstable_dimension();
                assert_eq!(hopf.birth.unstable[side], unstable, "{text} at {}", hopf.value);
            }
            let along = Along::new(Key::V, speeds.0, speeds.1).unwrap();
            let slope = hopf.birth.psi_max_squared_slope.unwrap();
            let branch = hopf.cycles(along, &CycleOptions::default(), |_| ControlFlow::Continue(())).unwrap();
            let cycle = &branch.points[0];
            let value = cycle.value;
            let there = wheel.with(Key::V, value).unwrap();
            let motion = there.uniform_motion().unwrap();
            let amplitude = cycle.max[2] - motion.psi();
            let found = amplitude * amplitude / (value - hopf.value);
            assert!((found / slope - 1.0).abs() < 0.1, "{text} at {}: {found} {slope}", hopf.value);
            let excess = there.cycle_forces(&cycle.orbit).unwrap().friction_max
                - motion.forces().unwrap().friction_max;
            let growth = hopf.birth.friction_slope.unwrap();
            assert!(
                (excess / amplitude / growth - 1.0).abs() < 0.1,
                "{text}: {} {growth}",
                excess / amplitude
            );
            seen.push(mode);
        }
    }
    for mode in [Mode::Longitudinal, Mode::Lateral, Mode::Yaw] {
        assert!(seen.contains(&mode), "{seen:?}");
    }
}

#[test]
fn with_a_tyre_the_king_pin_bears_what_its_springs_give() {
    let text = "tyre = \"linear\"\nsigma = 0.03\na = 0.01\nC_alpha = 400.0\nkappa = 0.003\nF_Az = -20.0\nr = 1.0\nc_u = 0.02\nc_q = 0.03";
    let wheel = wheel(text);
    let mut checked = 0;
    for cycle in cycles(&wheel, (1.0, 40.0), &[]).iter().step_by(6) {
        let wheel = wheel.with(Key::V, cycle.value).unwrap();
        let forces = wheel.cycle_forces(&cycle.orbit).unwrap();
        let get = |key| wheel.get(key);
        let omega = wheel.towing_yaw_rate();
        let (mut force, mut friction, mut damping) = (0.0_f64, 0.0_f64, 0.0);
        for (_, state) in cycle.orbit.sample(SAMPLES) {
            let [u, q, psi, forward, lateral, yaw_rate, deflection] = state[..] else {
                panic!("seven states")
            };
            let (sine, cosine) = psi.sin_cos();
            let across = lateral + get(Key::L) * yaw_rate;
            let u_rate = forward * cosine + across * sine - get(Key::V) + omega * q;
            let q_rate = across * cosine - forward * sine - omega * u;
            let longitudinal = get(Key::KU) * u + get(Key::CU) * u_rate;
            force = force.max(longitudinal.hypot(get(Key::KQ) * q + get(Key::CQ) * q_rate));
            damping += get(Key::CU) * u_rate * u_rate + get(Key::CQ) * q_rate * q_rate;
            // The lateral force of the linear law is a lower bound of the friction.
            friction = friction.max((get(Key::CAlpha) * deflection / get(Key::Sigma)).abs());
        }
        assert!(
            (forces.king_pin_force_max / force - 1.0).abs() < 2e-5,
            "{} {force}",
            forces.king_pin_force_max
        );
        assert!((forces.damper_power / (damping / SAMPLES as f64) - 1.0).abs() < 1e-7);
        assert!(forces.friction_max >= friction && forces.friction_max < 1.1 * friction + 1.0);
        checked += 1;
    }
    assert!(checked > 2, "{checked}");
}
