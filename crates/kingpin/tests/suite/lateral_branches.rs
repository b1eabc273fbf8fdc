//! Everything that is asked of a wheel, asked of one with lateral elasticity only: Hopf points, cycles, charts, boundaries
//! and motions, against published values, integration, and the five-state model with a stiff longitudinal spring.

use arclength::branch::SpecialKind;
use arclength::continuation::Stop;
use arclength::control::Control;
use arclength::cycle::CyclePoint;
use kingpin::branches::{Along, CycleOptions, WheelCycles};
use kingpin::simulation::SimulationError;
use kingpin::{Axis, Key, KingpinError, Plane, Wheel};
use std::ops::ControlFlow::Continue;

fn wheel(settings: &[(Key, f64)]) -> Wheel {
    let lateral = Wheel::default().with(Key::KU, f64::INFINITY).unwrap();
    settings.iter().fold(lateral, |wheel, &(key, value)| wheel.with(key, value).unwrap())
}

/// The wheel of the isola.
fn short_caster(damping: f64) -> Wheel {
    wheel(&[(Key::L, 0.04), (Key::TurningRadius, f64::INFINITY), (Key::CQ, damping)])
}

fn on_a_circle() -> Wheel {
    short_caster(0.05).with(Key::TurningRadius, 1.0).unwrap()
}

fn along(key: Key, start: f64, end: f64) -> Along {
    Along::new(key, start, end).unwrap()
}

fn cycles(wheel: &Wheel, along: Along, at: &[f64]) -> WheelCycles {
    let hopf = wheel.hopf_points(along, &Control::none()).unwrap().points.pop().unwrap();
    let options = CycleOptions::default().at(at);
    hopf.cycles(along, &options, |_| Continue(())).unwrap()
}

fn requested(branch: &WheelCycles) -> Vec<&CyclePoint> {
    branch
        .points
        .iter()
        .filter(|cycle| cycle.label.is_some_and(|label| label.kind == SpecialKind::Requested))
        .collect()
}

#[track_caller]
fn close(found: f64, expected: f64, tolerance: f64) {
    assert!((found - expected).abs() <= tolerance * expected.abs(), "{found}, not {expected}");
}

/// The roots of the quadratic for the speed in 40-digit arithmetic, and where AUTO-07p finds them.
#[test]
fn hopf_points_of_the_short_caster() {
    let interval = along(Key::V, 0.1, 20.0);
    let search = short_caster(0.05).hopf_points(interval, &Control::none()).unwrap();
    let [slow, fast] = &search.points[..] else { panic!("{} Hopf points", search.points.len()) };
    close(slow.value, 0.788_629_146_247_029_7, 1e-10);
    close(fast.value, 4.338_830_220_750_628, 1e-10);
    for hopf in [slow, fast] {
        let straight = [0.0, 0.0, 0.0, hopf.value, 0.0];
        assert!(hopf.state.iter().zip(straight).all(|(found, expected)| (found - expected).abs() < 1e-12));
        let motion = hopf.wheel.uniform_motion().unwrap();
        assert_eq!(motion.eigenvalues().len(), 3);
        assert!(motion.growth_rate().abs() < 1e-9);
        close(motion.eigenvalues()[0].im, hopf.frequency, 1e-10);
    }
    let damped = short_caster(0.1).hopf_points(interval, &Control::none()).unwrap();
    assert!(damped.points.is_empty());
    assert_eq!(damped.stable_at_ends, (Some(true), Some(true)));
}

/// AUTO-07p (collocation, 150 x 4) has the folds of the closed branch at c_q = 0.1 N s/m at these speeds.
#[test]
fn the_isola() {
    let from_hopf = cycles(&short_caster(0.05), along(Key::V, 0.015, 60.0), &[10.0]);
    let large = requested(&from_hopf).into_iter().max_by(|a, b| a.max[2].total_cmp(&b.max[2])).unwrap();
    let options = CycleOptions::default().at(&[0.1]);
    let bridge = short_caster(0.05)
        .with(Key::V, 10.0)
        .unwrap()
        .cycles_through(&large.orbit, along(Key::CQ, 0.03, 0.11), &options, |_| Continue(()))
        .unwrap();
    let start = requested(&bridge)[0];
    let isola = short_caster(0.1)
        .with(Key::V, 10.0)
        .unwrap()
        .cycles_through(&start.orbit, along(Key::V, 0.015, 60.0), &CycleOptions::default(), |_| Continue(()))
        .unwrap();
    assert!(matches!(isola.stops[1], Some(Stop::Closed)), "{:?}", isola.stops);
    let mut folds: Vec<&CyclePoint> = isola
        .points
        .iter()
        .filter(|cycle| cycle.label.is_some_and(|label| label.kind == SpecialKind::FoldOfCycles))
        .collect();
    folds.sort_by(|a, b| a.value.total_cmp(&b.value));
    let [slow, fast] = &folds[..] else { panic!("{} folds", folds.len()) };
    close(slow.value, 0.047780593, 2e-7);
    close(slow.period, 0.354463728, 2e-7);
    close(slow.max[2], 1.4021, 1e-4);
    close(fast.value, 14.0025055, 2e-7);
    close(fast.period, 0.217839059, 2e-7);
    close(fast.max[2], 0.78470, 1e-5);
    for cycle in &isola.points {
        assert_eq!((cycle.max.len(), cycle.min.len(), cycle.multipliers.len()), (5, 5, 3));
        assert_eq!((cycle.max[0], cycle.min[0]), (0.0, 0.0));
        // The mean of the speed along the path of the towing point is v: V cos psi + l Omega sin psi = v.
        assert!(cycle.min[3] < cycle.value && cycle.value < cycle.max[3]);
    }
}

/// The largest of samples over a period, refined by the parabola through it and its neighbours.
fn peak(samples: &[f64]) -> f64 {
    let last = samples.len() - 1;
    let place = (0..last).max_by(|&a, &b| samples[a].total_cmp(&samples[b])).unwrap();
    let [before, here, after] = [(place + last - 1) % last, place, place + 1].map(|index| samples[index]);
    let curvature = before - 2.0 * here + after;
    if curvature == 0.0 { here } else { here - (after - before).powi(2) / (8.0 * curvature) }
}

/// The motion from a point of a cycle is back after a period, and its largest and smallest values are those reported, `V`
/// among them, of which the cycle holds no samples.
#[test]
fn a_cycle_returns_and_its_extrema_are_those_of_the_motion() {
    for (start, interval, at) in [
        (short_caster(0.05), along(Key::V, 0.1, 20.0), [6.0, 10.0]),
        (on_a_circle(), along(Key::V, 1.0, 11.0), [4.0, 10.0]),
        (on_a_circle().with(Key::V, 4.0).unwrap(), along(Key::TurningRadius, 0.5, 20.0), [1.0, 3.0]),
        (on_a_circle().with(Key::V, 4.0).unwrap(), along(Key::L, 0.03, 0.05), [0.04, 0.0375]),
    ] {
        let branch = cycles(&start, interval, &at);
        let found = requested(&branch);
        assert!(found.len() >= 2, "{} at {interval:?}", found.len());
        for cycle in found {
            let wheel = branch.wheel.with(interval.key(), cycle.value).unwrap();
            let model = wheel.rolling_model(&[]).unwrap();
            let initial = model.full_state(&cycle.orbit.state_at(0.0), &[]).try_into().unwrap();
            let history = wheel.simulate_from(&initial, cycle.period, 20_001, &Control::none()).unwrap();
            // The estimate is that of the extremes; the state elsewhere is known to the tolerance, and returns multiplied.
            let allowed = f64::max(10.0 * cycle.error_estimate, 1e-7);
            for index in 0..5 {
                let values: Vec<f64> = history.states.iter().map(|state| state[index]).collect();
                let size = values.iter().fold(1e-3, |size: f64, value| size.max(value.abs()));
                let mirrored: Vec<f64> = values.iter().map(|value| -value).collect();
                let (largest, smallest) = (peak(&values), -peak(&mirrored));
                let found = [history.states[20_000][index], cycle.max[index], cycle.min[index]];
                for (found, expected) in found.into_iter().zip([initial[index], largest, smallest]) {
                    assert!((found - expected).abs() < allowed * size, "{index}: {found} {expected} {size}");
                }
            }
        }
    }
}

/// Growth rates on a grid tend to those of the five-state model as `1/k_u`, damped along the towing direction, so that the
/// fast motion there does not decide.
#[test]
fn growth_rates_are_the_limit_of_a_stiff_longitudinal_spring() {
    let plane =
        Plane::new(Axis::new(Key::V, 1.0..=9.0).unwrap(), Axis::new(Key::L, 0.03..=0.2).unwrap()).unwrap();
    let chart = |wheel: Wheel| wheel.growth_rate_chart(&plane, [12, 9], &Control::none()).unwrap();
    let rigid = wheel(&[(Key::CQ, 0.05), (Key::CPsi, 1e-4)]);
    let limit = chart(rigid);
    assert!([true, false].iter().all(|stable| limit.stable.contains(&Some(*stable))));
    let differences = [1e6, 1e7].map(|k_u| {
        let elastic = chart(rigid.with(Key::KU, k_u).unwrap().with(Key::CU, 300.0).unwrap());
        let pairs = limit.growth_rate.iter().zip(&elastic.growth_rate);
        pairs.map(|(one, other)| (one.unwrap() - other.unwrap()).abs()).fold(0.0, f64::max)
    });
    assert!(differences[0] < 0.1, "{differences:?}");
    close(differences[0] / differences[1], 10.0, 0.02);
}

/// Cycles on a circle tend to those of the five-state model as `1/k_u`.
#[test]
fn cycles_are_the_limit_of_a_stiff_longitudinal_spring() {
    let interval = along(Key::V, 1.0, 7.0);
    let damped = on_a_circle().with(Key::CU, 20.0).unwrap();
    let values = |wheel: Wheel| {
        let branch = cycles(&wheel, interval, &[4.0]);
        let cycle = requested(&branch)[0];
        [cycle.period, cycle.max[1], cycle.max[2], cycle.min[2], cycle.max[3], cycle.min[3], cycle.max[4]]
    };
    let limit = values(damped);
    let differences = [1e5, 1e6].map(|k_u| {
        let stiff = values(damped.with(Key::KU, k_u).unwrap());
        let pairs = stiff.into_iter().zip(limit);
        pairs.map(|(one, other)| (one / other - 1.0).abs()).fold(0.0, f64::max)
    });
    assert!(differences[0] < 0.1, "{differences:?}");
    close(differences[0] / differences[1], 10.0, 0.2);
}

#[test]
fn boundaries_and_critical_speeds_are_zeros_of_the_growth_rate() {
    for damped in [short_caster(0.05), on_a_circle(), on_a_circle().with(Key::KPsi, 0.001).unwrap()] {
        let critical = damped.critical_speed().unwrap();
        assert!(
            damped.with(Key::V, critical.speed).unwrap().uniform_motion().unwrap().growth_rate().abs() < 1e-9
        );
        let keys = [Key::V, Key::CQ];
        let axes = [Axis::new(keys[0], 0.3..=9.0).unwrap(), Axis::new(keys[1], 0.01..=0.1).unwrap()];
        let curves =
            damped.stability_boundary(&Plane::new(axes[0], axes[1]).unwrap(), &Control::none()).unwrap();
        assert!(!curves.is_empty());
        for &[x, y] in curves.iter().flat_map(|curve| &curve.points) {
            let here = damped.with(keys[0], x).unwrap().with(keys[1], y).unwrap();
            let growth_rate = here.uniform_motion().unwrap().growth_rate();
            assert!(growth_rate.abs() < 1e-8, "{x} {y} {growth_rate}");
        }
    }
}

#[test]
fn states_that_follow_from_others_cannot_be_chosen() {
    let wheel = wheel(&[]);
    for name in ["u", "V"] {
        let error = wheel.simulate(1.0, &[(name, 0.1)], 11, &Control::none()).unwrap_err();
        assert!(matches!(error, SimulationError::DependentState { .. }));
        assert!(error.to_string().ends_with("q, psi, Omega"), "{error}");
    }
    assert!(matches!(
        wheel.simulate(1.0, &[("phi", 0.1)], 11, &Control::none()),
        Err(SimulationError::UnknownState { .. })
    ));
    let start = wheel.perturbed_uniform_motion(&[("psi", 0.1)]).unwrap();
    assert!(wheel.simulate_from(&start, 1.0, 11, &Control::none()).is_ok());
    let across = std::f64::consts::FRAC_PI_2 - start[2];
    assert!(wheel.perturbed_uniform_motion(&[("psi", 0.1 + across)]).is_ok_and(|state| {
        wheel.simulate_from(&state, 1.0, 11, &Control::none()).unwrap_err().to_string().contains("not pi/2")
    }));
    for index in [0, 3] {
        let mut other = start;
        other[index] += 0.01;
        assert!(matches!(
            wheel.simulate_from(&other, 1.0, 11, &Control::none()),
            Err(SimulationError::OutOfRange { .. })
        ));
    }
}

#[test]
fn what_needs_a_longitudinal_elasticity_says_so() {
    use kingpin::basin::{ClassificationSettings, ContactModel, Destinations};
    let wheel = wheel(&[]);
    let refused = |result: Result<(), SimulationError>| {
        assert!(matches!(result, Err(SimulationError::Wheel(KingpinError::LateralElasticityOnly))));
    };
    let destinations =
        |model| Destinations::new(&wheel, model, ClassificationSettings::default()).map(|_| ());
    refused(destinations(ContactModel::Sliding));
    assert!(destinations(ContactModel::Rolling).is_ok());
    refused(wheel.sliding().map(|_| ()));
    assert!(matches!(Along::new(Key::KU, 50.0, f64::INFINITY), Err(KingpinError::InfiniteEnd { .. })));
    let damping = wheel.hopf_points(along(Key::CU, 0.0, 1.0), &Control::none());
    assert!(matches!(damping, Err(KingpinError::NoLongitudinalMotion { key: Key::CU })));
}

/// On a circle the branch goes on to cycles across `psi = -pi/2`, where the states do not determine `V`.
#[test]
fn no_forward_speed_is_claimed_where_the_states_do_not_determine_it() {
    let branch = cycles(&on_a_circle(), along(Key::V, 1.0, 16.0), &[]);
    let across = |cycle: &CyclePoint| cycle.min[2] < 0.01 - std::f64::consts::FRAC_PI_2;
    assert!(branch.points.iter().any(across));
    for cycle in &branch.points {
        assert_eq!(cycle.max[3].is_nan(), across(cycle), "{} {}", cycle.value, cycle.min[2]);
        assert_eq!(cycle.min[3].is_nan(), across(cycle));
    }
}
