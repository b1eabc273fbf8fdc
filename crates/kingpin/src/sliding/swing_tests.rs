//! Dry friction about the king pin: swings and rests against closed forms, energy, limits and a second formulation.

use super::model::FrictionMoment;
use super::*;
use crate::Key;
use arclength::control::Control;
use proptest::prelude::*;

fn wheel(changes: &[(Key, f64)]) -> Wheel {
    changes.iter().try_fold(Wheel::default(), |wheel, &(key, value)| wheel.with(key, value)).unwrap()
}

/// The paper's wheel towed straight.
fn straight(changes: &[(Key, f64)]) -> Wheel {
    changes
        .iter()
        .try_fold(wheel(&[(Key::Curvature, 0.0)]), |wheel, &(key, value)| wheel.with(key, value))
        .unwrap()
}

/// Angles at which the caster sticks, one after the other, from a small angle.
fn resting_angles(wheel: &Wheel, psi: f64, duration: f64) -> Vec<f64> {
    let rolling = wheel.always_rolling().unwrap();
    let start = wheel.perturbed_uniform_motion(&[("psi", psi)]).unwrap();
    let mut angles = Vec::new();
    rolling
        .follow(rolling.rolling_state(&start), duration, &[], &Control::none(), |piece| {
            if piece.phase.king_pin == KingPin::Sticking && piece.phase.end > piece.phase.start {
                angles.push(piece.solution.state[2]);
            }
            true
        })
        .unwrap();
    angles
}

#[test]
fn every_swing_multiplies_small_angles_by_the_factor_of_theory() {
    for (values, moments, count) in [
        (&[(Key::L, 0.04), (Key::V, 0.3)][..], [1e-4, 1e-3], 5),
        (&[(Key::L, 0.08), (Key::V, 2.0)], [1e-4, 1e-2], 2),
        (&[(Key::L, 0.04), (Key::V, 7.0)], [1e-4, 1e-3], 2),
        (
            &[(Key::L, 0.04), (Key::V, 2.0), (Key::CPsi, 2e-4), (Key::CQ, 0.3), (Key::KPsi, 0.05)],
            [1e-4, 1e-2],
            2,
        ),
    ] {
        for moment in moments {
            let wheel = straight(values).with(Key::MF, moment).unwrap();
            let factor = wheel.swing_factor().unwrap();
            let angles = resting_angles(&wheel, 1e-5, 1e3);
            assert!(angles.len() >= count, "{values:?} {moment}: {angles:?}");
            for pair in angles[..count].windows(2) {
                let measured = pair[1] / pair[0];
                assert!((measured - factor).abs() < 1e-6, "{values:?} {moment}: {measured} {factor}");
            }
        }
    }
}

#[test]
fn swings_from_the_largest_returning_angle_just_end_at_rest() {
    for values in [
        &[(Key::L, 0.04), (Key::V, 0.3)][..],
        &[(Key::L, 0.08), (Key::V, 2.0)],
        &[(Key::L, 0.04), (Key::V, 2.0), (Key::CPsi, 2e-4), (Key::CQ, 0.3), (Key::KPsi, 0.05)],
    ] {
        let wheel = straight(values).with(Key::MF, 1e-5).unwrap();
        let rolling = wheel.always_rolling().unwrap();
        let largest = wheel.largest_returning_angle().unwrap();
        let rests_after_a_swing = |angle: f64| {
            // Where no moment is needed yet.
            let damper = wheel.get(Key::CQ) * wheel.get(Key::V);
            let q = (damper + wheel.get(Key::KPsi) / wheel.get(Key::L)) * angle / wheel.get(Key::KQ);
            let start = wheel.perturbed_uniform_motion(&[("psi", angle), ("q", q)]).unwrap();
            let mut phases = Vec::new();
            let visit = |piece: Piece<'_>| {
                phases.push(piece.phase.king_pin);
                phases.len() < 3
            };
            rolling.follow(rolling.rolling_state(&start), 1e3, &[], &Control::none(), visit).unwrap();
            assert_eq!(phases[..2], [KingPin::Sticking, KingPin::Swinging]);
            phases[2] == KingPin::Sticking
        };
        for part in [-0.999, 0.5, 0.999] {
            assert!(rests_after_a_swing(part * largest), "{values:?} {part}");
        }
        for part in [-1.001, 1.001, 1.2] {
            assert!(!rests_after_a_swing(part * largest), "{values:?} {part}");
        }
    }
}

#[test]
fn deflections_up_to_the_limit_are_at_rest_and_those_beyond_are_not() {
    for wheel in [
        straight(&[(Key::MF, 0.02)]),
        straight(&[(Key::MF, 0.02), (Key::KU, 300.0), (Key::CQ, 0.1), (Key::KPsi, 0.1)]),
        wheel(&[(Key::MF, 0.02)]),
        wheel(&[(Key::MF, 0.5), (Key::V, 5.0), (Key::CU, 0.2), (Key::CPsi, 1e-3), (Key::KPsi, 0.1)]),
    ] {
        let rolling = wheel.always_rolling().unwrap();
        let [low, high] = wheel.resting_deflections().unwrap().unwrap();
        let [_, q0, psi, _, _] = wheel.uniform_motion().unwrap().state();
        let (v, l, omega) = (wheel.get(Key::V), wheel.get(Key::L), wheel.towing_yaw_rate());
        let rests = |q: f64| {
            // On a circle the speed follows from u' = 0, and u from q' = 0.
            let speed = (v - omega * q - l * omega * psi.sin()) / psi.cos();
            let u = if omega == 0.0 { 0.0 } else { (l * omega * psi.cos() - speed * psi.sin()) / omega };
            let start = rolling.rolling_state(&[u, q, psi, speed, omega]);
            let rate = {
                let mut rate = [0.0; 7];
                let mode = Mode { regime: Regime::Rolling, friction_moment: FrictionMoment::Sticking };
                Regime::Rolling.field(&rolling.equations_in(mode), &start.state, &mut rate);
                rate
            };
            assert!(rate.iter().all(|rate| rate.abs() < 1e-10), "{rate:?}");
            let mut swings = false;
            let end = rolling.follow(start, 2.0, &[], &Control::none(), |piece| {
                swings |= piece.phase.king_pin == KingPin::Swinging;
                true
            });
            (!swings, end.unwrap())
        };
        let half = 0.5 * (high - low);
        assert!((0.5 * (high + low) - q0).abs() < 1e-9 && half > 0.0);
        for part in [-1.0, -0.5, 0.0, 0.7, 1.0] {
            assert!(rests(q0 + part * half * (1.0 - 1e-6)).0, "{part}");
        }
        for part in [-1.0, 1.0] {
            assert!(!rests(q0 + part * half * (1.0 + 1e-6)).0, "{part}");
        }
    }
}

#[test]
fn a_caster_that_slides_rests_where_its_friction_takes_the_moment_of_the_ground() {
    // l mu_d N = 0.08 m 0.8 14.1 N = 0.903 N m.
    let held = |moment: f64, k_psi: f64, psi: f64| {
        let wheel = straight(&[
            (Key::MF, moment),
            (Key::FAz, -10.0),
            (Key::KPsi, k_psi),
            (Key::CU, 2.0),
            (Key::CQ, 2.0),
        ]);
        // Where the springs balance the friction of the ground.
        let deflection = -0.8 * wheel.normal_force() / 100.0;
        let [u, q] = [deflection * psi.sin(), deflection * psi.cos()];
        let start = [u, q, psi, 4.0 * psi.cos(), 4.0 * psi.sin(), 0.0, 4.0 * psi.cos()];
        let history = wheel.sliding().unwrap().simulate_from(&start, 4.0, 2, &Control::none()).unwrap();
        let last = history.phases.last().unwrap();
        let stays = (last.contact, last.king_pin) == (Contact::Sliding, KingPin::Sticking)
            && (history.states[1][2] - psi).abs() < 1e-12;
        (wheel.largest_resting_angle_while_sliding(), stays)
    };
    let taken = 0.08 * 0.8 * straight(&[(Key::FAz, -10.0)]).normal_force();
    assert_eq!(held(0.98 * taken, 0.0, 0.5), (None, false));
    assert_eq!(held(1.2 * taken, 0.0, 0.5), (Some(std::f64::consts::PI), true));
    let (largest, _) = held(1.5 * taken, 1.0, 0.1);
    let largest = largest.unwrap();
    assert!((largest - 0.5 * taken).abs() < 1e-12);
    assert!(held(1.5 * taken, 1.0, 0.8 * largest).1 && !held(1.5 * taken, 1.0, 1.3 * largest).1);
}

#[test]
fn a_wheel_whose_swings_shrink_comes_to_rest() {
    // The factor is 0.27, so that swings in the same sense follow each other faster than the angle falls.
    let wheel = straight(&[(Key::L, 0.04), (Key::V, 0.3), (Key::MF, 1e-3)]);
    let start = wheel.perturbed_uniform_motion(&[("psi", 0.02)]).unwrap();
    let history = wheel.simulate_from(&start, 100.0, 3, &Control::none()).unwrap();
    assert!((5..60).contains(&history.phases.len()), "{}", history.phases.len());
    let [u, q, psi, _, yaw] = history.states[2];
    assert_eq!((psi, yaw), (0.0, 0.0));
    assert_eq!((psi, q), (history.states[1][2], history.states[1][1]));
    let held = wheel.resting_deflections().unwrap().unwrap()[1];
    assert!((q.abs() - held).abs() < 1e-6 * held, "at the limit at which the last swing left it");
    // Without c_u the longitudinal oscillation goes on for ever.
    assert!(u != history.states[1][0]);
}

#[test]
fn little_friction_is_the_wheel_without_and_much_lets_nothing_swing() {
    for start in [[0.0, 0.001, 0.4, 3.8, -3.0], [0.0, 0.0, 0.0, 4.0, 30.0]] {
        let run = |moment: f64| {
            let wheel = wheel(&[(Key::FAz, -20.0), (Key::MF, moment)]);
            wheel.sliding().unwrap().simulate(&start, 0.3, 31, &Control::none()).unwrap()
        };
        let without = run(0.0);
        assert!(without.phases.iter().all(|phase| phase.king_pin == KingPin::Swinging));
        let distance = |moment: f64| {
            let with = run(moment);
            let states = with.states.iter().zip(&without.states);
            let distances = states.flat_map(|(a, b)| a.iter().zip(b).map(|(a, b)| (a - b).abs()));
            distances.fold(0.0, f64::max)
        };
        let distances = [1e-4, 1e-5, 1e-6].map(distance);
        assert!(distances[2] < 1e-2 && distances[2] > 0.0, "{distances:?}");
        assert!(distances.windows(2).all(|pair| pair[1] < 0.3 * pair[0]), "{distances:?}");
    }
    let stiff = wheel(&[(Key::FAz, -20.0), (Key::MF, 1e6)]);
    let start = stiff.perturbed_uniform_motion(&[("psi", 0.7)]).unwrap();
    let history = stiff.sliding().unwrap().simulate(&start, 2.0, 101, &Control::none()).unwrap();
    assert!(history.phases.iter().all(|phase| phase.king_pin == KingPin::Sticking));
    assert!(history.states.iter().all(|state| state[2] == start[2]));
}

#[test]
fn ideal_rolling_with_friction_is_the_limit_of_much_ground_friction() {
    let sticky = straight(&[
        (Key::L, 0.04),
        (Key::MuS, 100.0),
        (Key::MuD, 100.0),
        (Key::FAz, -900.0),
        (Key::MF, 0.01),
    ]);
    let start = sticky.perturbed_uniform_motion(&[("psi", 0.2)]).unwrap();
    let hybrid = sticky.sliding().unwrap().simulate(&start, 1.0, 11, &Control::none()).unwrap();
    let rolling = sticky.simulate_from(&start, 1.0, 11, &Control::none()).unwrap();
    assert!(hybrid.phases.len() > 3 && rolling.phases.len() == hybrid.phases.len());
    assert!(rolling.phases.iter().any(|phase| phase.king_pin == KingPin::Sticking));
    for (hybrid, rolling) in hybrid.states.iter().zip(&rolling.states) {
        for (a, b) in [0, 1, 2, 3, 5].into_iter().zip(0..5) {
            assert!((hybrid[a] - rolling[b]).abs() < 1e-7);
        }
    }
    let lateral = sticky.with(Key::KU, f64::INFINITY).unwrap();
    let resting = lateral.simulate(1.0, &[], 11, &Control::none()).unwrap();
    assert!(resting.states.iter().all(|state| state[2] == 0.0));
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(256))]

    /// In every mode the energy changes by the power of the towing less what is dissipated, and dry friction dissipates M_f |psi'|.
    #[test]
    fn energy_balance_in_every_mode(
        state in prop::array::uniform7(-1.0..1.0f64), friction in prop::array::uniform2(-5.0..5.0f64), moment in -0.1..0.1f64,
    ) {
        let wheel = wheel(&[(Key::CU, 0.1), (Key::CQ, 0.2), (Key::CPsi, 1e-3), (Key::KPsi, 0.1), (Key::KU, 150.0)]);
        let free = Equations::new(&wheel).unwrap();
        let mut state = state;
        for friction_moment in [FrictionMoment::Swinging(moment), FrictionMoment::Sticking] {
            if friction_moment == FrictionMoment::Sticking {
                state[5] = free.towing_yaw_rate();
            }
            let equations = free.under(friction_moment);
            let mut rate = [0.0; 7];
            equations.derivative(&state, friction, &mut rate);
            let shifted = |sign: f64| equations.energy(&std::array::from_fn(|i| state[i] + sign * 1e-4 * rate[i]));
            let found = (shifted(1.0) - shifted(-1.0)) / 2e-4;
            let (towing, dissipated) = equations.power(&state, friction);
            let scale = 1.0 + towing.abs() + dissipated.abs();
            prop_assert!((found - (towing - dissipated)).abs() < 1e-8 * scale);
            let (_, without) = free.power(&state, friction);
            let by_friction = equations.friction_moment(&state, friction) * equations.swing_rate(&state);
            prop_assert!((dissipated - without - by_friction).abs() < 1e-9 * scale);
        }
    }
}
