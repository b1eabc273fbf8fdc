//! The hybrid model against energy, its limits of friction, and itself at other tolerances.

use super::model::Equations;
use super::*;
use crate::Key;
use arclength::control::Control;
use arclength::integration::{Integrator, from_fn};
use proptest::prelude::*;

fn wheel(changes: &[(Key, f64)]) -> Wheel {
    changes.iter().try_fold(Wheel::default(), |wheel, &(key, value)| wheel.with(key, value)).unwrap()
}

/// A wheel that slides now and then: a load of 20 N, both coefficients of friction given.
fn loaded(mu_s: f64, mu_d: f64) -> Wheel {
    wheel(&[(Key::FAz, -20.0), (Key::MuS, mu_s), (Key::MuD, mu_d)])
}

fn loaded_by_20(key: Key, value: f64) -> Wheel {
    wheel(&[(Key::FAz, -20.0), (key, value)])
}

/// Slip that passes close by zero turns within a time that late times do not resolve; such motions ended with an error.
#[test]
fn slip_passes_close_by_zero_however_late_it_is() {
    let office = Wheel::from_toml(include_str!("../../examples/wheels/office.toml")).unwrap();
    let ends_at_one = |wheel: &Wheel, duration: f64| {
        let start = wheel.perturbed_uniform_motion(&[("psi", 1.2)]).unwrap();
        let history = wheel.sliding().unwrap().simulate(&start, duration, 11, &Control::none()).unwrap();
        assert_eq!((history.times.len(), history.times[10]), (11, duration));
        assert_eq!(history.phases.last().unwrap().end, duration);
        assert!(history.phases.windows(2).all(|pair| pair[0].end == pair[1].start));
    };
    for tenths in 30..=50 {
        ends_at_one(&office.with(Key::V, 0.1 * f64::from(tenths)).unwrap(), 0.5);
    }
    ends_at_one(&wheel(&[(Key::V, 3.0)]), 42.0);
}

fn start(wheel: &Wheel) -> [f64; 5] {
    wheel.perturbed_uniform_motion(&[("psi", 0.6)]).unwrap()
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    /// Rate of energy = power of the towing point - power of dampers and friction, at any state.
    #[test]
    fn energy_balance_of_the_equations(
        state in prop::array::uniform7(-1.0..1.0f64), c in 0.0..1.0f64, k_psi in 0.0..1.0f64,
        friction in prop::array::uniform2(-5.0..5.0f64),
    ) {
        let wheel = wheel(&[(Key::CU, c), (Key::CQ, 0.5 * c), (Key::CPsi, 0.01 * c), (Key::KPsi, k_psi), (Key::KU, 150.0)]);
        let equations = Equations::new(&wheel).unwrap();
        let mut rate = [0.0; 7];
        equations.derivative(&state, friction, &mut rate);
        // The energy is a polynomial of degree two, so central differences are exact.
        let shifted = |sign: f64| equations.energy(&std::array::from_fn(|i| state[i] + sign * 1e-4 * rate[i]));
        let found = (shifted(1.0) - shifted(-1.0)) / 2e-4;
        let (towing, dissipated) = equations.power(&state, friction);
        prop_assert!((found - (towing - dissipated)).abs() < 1e-8 * (1.0 + towing.abs() + dissipated.abs()));
    }

    /// The slip starts along a direction that the flow keeps, and nearby directions turn towards it.
    #[test]
    fn limit_direction(force in prop::array::uniform2(-30.0..30.0f64)) {
        let equations = Equations::new(&loaded(1.0, 0.8)).unwrap();
        let wheel_state = [0.0, 0.0, 0.0, 4.0, 0.0, 0.0, 0.0];
        prop_assume!(force[0].hypot(force[1]) > 1.001 * equations.sliding_friction);
        let limit = equations.limit_direction(force);
        prop_assert!(limit.growth > 0.0);
        // Slip acceleration under friction: linear in the force, with the holding force as its zero.
        let slip_rate = |friction: [f64; 2]| {
            let held = equations.holding_force(&wheel_state);
            let (mut rate, mut rest) = ([0.0; 7], [0.0; 7]);
            equations.derivative(&wheel_state, std::array::from_fn(|i| held[i] + friction[i] - force[i]), &mut rate);
            equations.derivative(&wheel_state, held, &mut rest);
            [rate[S1] - rest[S1], rate[S2] - rest[S2]]
        };
        let rate = slip_rate(limit.direction.map(|e| -equations.sliding_friction * e));
        let scale = limit.growth + 1.0;
        prop_assert!((rate[0] - limit.growth * limit.direction[0]).abs() < 1e-9 * scale);
        prop_assert!((rate[1] - limit.growth * limit.direction[1]).abs() < 1e-9 * scale);
        // Slip starts against the force.
        prop_assert!(limit.direction[0] * force[0] + limit.direction[1] * force[1] < 0.0);
        for turn in [-0.1f64, 0.1] {
            let [e1, e2] = limit.direction;
            let turned = [e1 * turn.cos() - e2 * turn.sin(), e2 * turn.cos() + e1 * turn.sin()];
            let rate = slip_rate(turned.map(|e| -equations.sliding_friction * e));
            prop_assert!((turned[0] * rate[1] - turned[1] * rate[0]) * turn < 0.0);
        }
    }
}

#[test]
fn energy_balance_along_the_motion() {
    let wheel = loaded(1.0, 0.8);
    let sliding = wheel.sliding().unwrap();
    let duration = 0.5;
    let count = 200_000;
    let history = sliding.simulate(&start(&wheel), duration, count + 1, &Control::none()).unwrap();
    assert!(history.phases.len() > 4, "{:?}", history.phases);
    // Trapezoidal rule; the power has a few jumps.
    let mut work = 0.0;
    for (i, (towing, dissipated)) in history.towing_power.iter().zip(&history.dissipated_power).enumerate() {
        assert!(*dissipated >= -1e-9);
        let weight = if i == 0 || i == count { 0.5 } else { 1.0 };
        work += weight * duration / count as f64 * (towing - dissipated);
    }
    assert!(
        (work - history.energy_gained).abs() < 1e-4 * work.abs().max(1.0),
        "{work} {}",
        history.energy_gained
    );
}

#[test]
fn rolling_and_sliding_limits_are_kept() {
    let wheel = loaded(1.0, 0.8);
    let history = wheel.sliding().unwrap().simulate(&start(&wheel), 1.0, 5001, &Control::none()).unwrap();
    let normal = history.normal_force;
    let mut kinds = [0, 0];
    for (time, (slip, friction)) in history.times.iter().zip(history.slip().iter().zip(&history.friction)) {
        let size = friction[0].hypot(friction[1]);
        let phase = history.phases.iter().find(|phase| phase.start <= *time && *time <= phase.end).unwrap();
        match phase.contact {
            Contact::Rolling => assert!(*slip < 1e-8 && size <= normal * (1.0 + 1e-8), "{slip} {size}"),
            Contact::Sliding if *slip > 0.0 => assert!((size - 0.8 * normal).abs() < 1e-9),
            Contact::Sliding => {}
        }
        kinds[usize::from(phase.contact == Contact::Sliding)] += 1;
    }
    assert!(kinds.iter().all(|&count| count > 100), "{kinds:?}");
    assert!(history.phases.windows(2).all(|pair| pair[0].end == pair[1].start));
    assert!(history.phases.iter().all(|phase| phase.end > phase.start));
}

#[test]
fn converges_with_the_tolerance() {
    for mu_d in [0.8, 1.0] {
        let wheel = loaded(1.0, mu_d);
        let run = |tolerance: f64| {
            let history = wheel
                .sliding()
                .unwrap()
                .tolerance(tolerance)
                .simulate(&start(&wheel), 0.4, 2, &Control::none())
                .unwrap();
            (history.states[1], history.phases.len())
        };
        let (exact, phases) = run(1e-12);
        assert!(phases > 3);
        let mut errors = Vec::new();
        for tolerance in [1e-6, 1e-8, 1e-10] {
            let (state, count) = run(tolerance);
            assert_eq!(count, phases);
            errors.push(state.iter().zip(exact).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max));
        }
        assert!(errors[2] < 1e-8 && errors[2] < 0.01 * errors[0], "{errors:?}");
    }
}

#[test]
fn without_friction_energy_is_conserved() {
    // At rest in the ground frame nothing tows: v = 0.
    let wheel = wheel(&[(Key::V, 0.0), (Key::Curvature, 0.0), (Key::MuS, 0.0), (Key::MuD, 0.0)]);
    let sliding = wheel.sliding().unwrap().tolerance(1e-12);
    let initial = [0.01, -0.02, 0.7, 0.3, -0.2, 5.0, 0.1];
    let history = sliding.simulate_from(&initial, 5.0, 3, &Control::none()).unwrap();
    let equations = Equations::new(&wheel).unwrap();
    let energy = equations.energy(&[0.01, -0.02, 0.7, 0.3, -0.2, 5.0, 0.2]);
    assert!(history.energy_gained.abs() < 1e-9 * energy, "{}", history.energy_gained);
    assert!((history.states[2][6] - 0.1).abs() < 1e-12, "nothing turns the wheel");
}

#[test]
fn large_friction_is_rolling() {
    let sticky = loaded(100.0, 100.0);
    let hybrid = sticky.sliding().unwrap().simulate(&start(&sticky), 1.0, 11, &Control::none()).unwrap();
    assert_eq!(hybrid.phases.len(), 1);
    let rolling = sticky.simulate_from(&start(&sticky), 1.0, 11, &Control::none()).unwrap();
    for (hybrid, rolling) in hybrid.states.iter().zip(&rolling.states) {
        for (a, b) in [0, 1, 2, 3, 5].into_iter().zip(0..5) {
            assert!((hybrid[a] - rolling[b]).abs() < 1e-7);
        }
    }
}

#[test]
fn sliding_without_the_wheel_turning_away_stops_at_a_known_time() {
    // On rails: towed straight, caster straight, only W differs from V: W' = mu_d N R^2/J, V' = -mu_d N/m.
    let wheel = wheel(&[(Key::Curvature, 0.0), (Key::K, 1e-3), (Key::FAz, -5.0)]);
    let initial = [0.0, 0.0, 0.0, 4.0, 0.0, 0.0, 3.9];
    let history = wheel.sliding().unwrap().simulate_from(&initial, 0.01, 2, &Control::none()).unwrap();
    let force = 0.8 * wheel.normal_force();
    let (mass, rim) = (0.3519 + 0.0668, 4.63e-5 / 0.04f64.powi(2));
    let expected = 0.1 / (force / mass + force / rim);
    assert_eq!(history.phases.len(), 2);
    assert!(
        (history.phases[0].end - expected).abs() < 1e-9 * expected.max(1.0),
        "{} {expected}",
        history.phases[0].end
    );
    assert_eq!(history.phases[1].contact, Contact::Rolling);
    assert_eq!(history.slip()[1], 0.0);
}

#[test]
fn onset_agrees_with_strongly_smoothed_friction() {
    // Friction rising over a small slip speed, from the same state: first order in that speed.
    let wheel = loaded(1.0, 0.8);
    let equations = Equations::new(&wheel).unwrap();
    let history = wheel.sliding().unwrap().simulate(&start(&wheel), 0.2, 20_001, &Control::none()).unwrap();
    let first = history.phases.iter().find(|phase| phase.contact == Contact::Sliding).unwrap();
    let roll =
        wheel.sliding().unwrap().simulate(&start(&wheel), first.start, 2, &Control::none()).unwrap().states
            [1];
    let initial = [roll[0], roll[1], roll[2], roll[3], roll[4], roll[5], 0.0];
    let later = 0.5 * (first.end - first.start);
    let exact = wheel
        .sliding()
        .unwrap()
        .simulate(&start(&wheel), first.start + later, 2, &Control::none())
        .unwrap()
        .states[1];
    let mut errors = Vec::new();
    for smoothing in [1e-3, 1e-4] {
        let system = from_fn(7, |_, x: &[f64], f: &mut [f64]| {
            let factor =
                -equations.sliding_friction / (x[S1].powi(2) + x[S2].powi(2) + smoothing * smoothing).sqrt();
            equations.derivative(x, [factor * x[S1], factor * x[S2]], f);
        });
        let end = Integrator::with_tolerance(1e-9).integrate(system, 0.0, &initial, later).unwrap().state;
        let public = [end[0], end[1], end[2], end[3], end[4], end[5], end[3] - end[6]];
        errors.push(public.iter().zip(exact).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max));
    }
    assert!(errors[1] < 2e-2 && errors[1] < 0.2 * errors[0], "{errors:?}");
}

#[test]
fn bad_input_is_refused() {
    let message = |wheel: &Wheel| wheel.sliding().unwrap_err().to_string();
    assert!(loaded_by_20(Key::MuS, 0.5).sliding().is_ok());
    assert!(message(&loaded(0.5, 0.8)).contains("mu_d = 0.8"));
    assert!(message(&wheel(&[(Key::FAz, 10.0)])).contains("F_Az = 10"));
    assert!(message(&wheel(&[(Key::KU, f64::INFINITY)])).contains("k_u = inf"));
    let sliding = Wheel::default().sliding().unwrap();
    assert!(sliding.simulate(&[0.0; 5], -1.0, 10, &Control::none()).is_err());
    assert!(sliding.simulate(&[0.0; 5], 1.0, 1, &Control::none()).is_err());
    assert!(sliding.simulate(&[f64::NAN; 5], 1.0, 2, &Control::none()).is_err());
}

/// The largest rolling force, relative to the normal force, of a motion that would roll for 0.2 s, and when.
fn largest_rolling_force(wheel: &Wheel) -> (f64, f64) {
    let history = wheel.simulate_from(&start(wheel), 0.2, 2_000_001, &Control::none()).unwrap();
    let forces = history.contact_forces.iter().map(|force| force.friction() / force.normal);
    let (index, force) = forces.enumerate().max_by(|a, b| a.1.total_cmp(&b.1)).unwrap();
    (force, history.times[index])
}

#[test]
fn a_force_that_just_misses_or_just_touches_the_static_limit() {
    let (needed, time) = largest_rolling_force(&loaded(100.0, 100.0));
    assert!(time > 0.001 && time < 0.199);
    let run = |mu_s: f64, mu_d: f64| {
        let wheel = loaded(mu_s, mu_d);
        wheel.sliding().unwrap().simulate(&start(&wheel), 0.2, 2, &Control::none()).unwrap()
    };
    let rolling = run(100.0, 100.0);
    for distance in [1e-4, 1e-6, 1e-8] {
        let missed = run(needed * (1.0 + distance), needed * (1.0 + distance));
        assert_eq!(missed.phases.len(), 1);
        assert_eq!(missed.states[1], rolling.states[1]);
        // Equal coefficients: slip for a moment of the order of the root of the distance, and next to no effect.
        let touched = run(needed * (1.0 - distance), needed * (1.0 - distance));
        let kinds: Vec<Contact> = touched.phases.iter().map(|phase| phase.contact).collect();
        assert_eq!(
            kinds,
            [Contact::Rolling, Contact::Sliding, Contact::Rolling],
            "{distance}: {:?}",
            touched.phases
        );
        let slip = touched.phases[1];
        assert!(slip.start < time && slip.end > time - 1e-6);
        assert!(slip.end - slip.start < 0.2 * distance.sqrt(), "{distance}: {slip:?}");
        let effect = touched.states[1].iter().zip(&rolling.states[1]);
        let effect = effect.map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
        assert!(effect < 300.0 * distance, "{distance}: {effect}");
    }
    // A smaller coefficient of sliding: once it slips, it slips for a finite time; no chattering.
    let torn = run(needed * (1.0 - 1e-8), 0.8 * needed);
    assert!(torn.phases.len() <= 5, "{:?}", torn.phases);
    assert!((torn.phases[0].end - time).abs() < 1e-4);
    assert!(torn.phases[1].end - torn.phases[1].start > 1e-3);
}

#[test]
fn growing_friction_tends_to_rolling() {
    // The part of the time that is slid falls to zero and the motion becomes that of the rolling wheel.
    let rolling = loaded(100.0, 100.0)
        .simulate_from(&start(&loaded(100.0, 100.0)), 0.2, 2, &Control::none())
        .unwrap()
        .states[1];
    let mut before = f64::INFINITY;
    for mu in [1.0, 1.5, 2.0, 4.0] {
        let wheel = loaded(mu, mu);
        let end =
            wheel.sliding().unwrap().simulate(&start(&wheel), 0.2, 2, &Control::none()).unwrap().states[1];
        let distance = [0, 1, 2, 3, 5]
            .into_iter()
            .zip(0..5)
            .map(|(a, b)| (end[a] - rolling[b]).abs())
            .fold(0.0, f64::max);
        assert!(distance <= before, "{mu}: {distance} {before}");
        before = distance;
    }
    assert!(before < 1e-8, "{before}");
}

#[test]
fn smoothed_friction_dissipates_and_tends_to_coulomb_friction() {
    let wheel = loaded(0.8, 0.8);
    let state = [0.01, -0.02, 0.3, 3.0, 0.4, 2.0, 2.5];
    let sliding = wheel.sliding().unwrap();
    let inner = [0.01, -0.02, 0.3, 3.0, 0.4, 2.0, 0.5];
    let exact = sliding.rate(&HybridState { contact: Contact::Sliding, state: inner });
    let mut errors = Vec::new();
    for smoothing in [1e-2, 1e-3] {
        let smoothed = wheel.smoothed_sliding(&[Key::V], smoothing).unwrap();
        let mut rate = [0.0; 7];
        arclength::VectorField::evaluate(&smoothed, &state, &[4.0], &mut rate);
        let error = (0..6).map(|i| (rate[i] - exact[i]).abs()).fold(0.0, f64::max);
        errors.push(error.max((rate[3] - rate[6] - exact[6]).abs()));
    }
    // Away from zero slip the difference is of second order in the smoothing speed.
    assert!(errors[0] < 0.1 && (errors[0] / errors[1] - 100.0).abs() < 1.0, "{errors:?}");
    assert!(wheel.smoothed_sliding(&[], 0.0).is_err());
    assert!(loaded(0.5, 0.8).smoothed_sliding(&[], 1e-3).is_err());
}

/// A fit was given up there: the time was sampled in neither of the two pieces.
#[test]
fn times_on_the_straight_way_of_vanishing_slip_are_sampled() {
    let wheel = loaded(1.0, 0.8);
    let sliding = wheel.sliding().unwrap().slips(1e-4, 1e-4);
    let start = sliding.rolling_state(&start(&wheel));
    let mut straight = Vec::new();
    sliding
        .follow(start, 0.3, &[], &Control::none(), |piece| {
            let vanishing = piece.solution.crossings.first().filter(|_| piece.mode.regime == Regime::Sliding);
            straight.extend(vanishing.map(|crossing| (crossing.time, piece.solution.time)));
            true
        })
        .unwrap();
    assert!(!straight.is_empty());
    let wanted: Vec<f64> = straight.iter().map(|(from, to)| 0.5 * (from + to)).collect();
    let mut found = Vec::new();
    sliding
        .follow(start, 0.3, &wanted, &Control::none(), |piece| {
            let samples = piece.solution.samples();
            found.extend(samples.map(|(time, state)| (time, state[S1].hypot(state[S2]))));
            true
        })
        .unwrap();
    assert_eq!(found.iter().map(|(time, _)| *time).collect::<Vec<_>>(), wanted);
    // Half way the slip is half of that at which it is taken to vanish.
    assert!(found.iter().all(|(_, slip)| *slip > 0.0 && *slip < 0.51e-4), "{found:?}");
}
