//! Integration against published values, closed forms and conserved quantities.

use super::*;
use crate::control::{Control, Interrupted, Progress};
use crate::{Scalar, VectorField};
use proptest::prelude::*;
use std::f64::consts::{PI, TAU};

struct VanDerPol;

impl VectorField for VanDerPol {
    fn state_names(&self) -> Vec<String> {
        vec!["x".into(), "y".into()]
    }
    fn parameter_names(&self) -> Vec<String> {
        vec!["mu".into()]
    }
    fn evaluate<T: Scalar>(&self, state: &[T], parameters: &[T], derivative: &mut [T]) {
        let (x, y, mu) = (state[0], state[1], parameters[0]);
        derivative[0] = y;
        derivative[1] = mu * (-(x * x) + 1.0) * y - x;
    }
}

/// The Kepler problem in the plane; from the pericentre of eccentricity e the period is 2 pi.
fn kepler(_time: f64, x: &[f64], derivative: &mut [f64]) {
    let cube = (x[0] * x[0] + x[1] * x[1]).powf(1.5);
    derivative.copy_from_slice(&[x[2], x[3], -x[0] / cube, -x[1] / cube]);
}

fn pericentre(eccentricity: f64) -> [f64; 4] {
    [1.0 - eccentricity, 0.0, 0.0, ((1.0 + eccentricity) / (1.0 - eccentricity)).sqrt()]
}

fn distance(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max)
}

/// Maximum of x on the cycle of van der Pol's oscillator and the times of passing it.
fn van_der_pol_cycle(mu: f64) -> (Vec<f64>, f64) {
    let integrator = Integrator::with_tolerance(1e-13);
    let parameters = [mu];
    let mut maxima = [Event::new(|_, x| x[1]).falling()];
    let solution = integrator
        .with_events(autonomous(VanDerPol, &parameters), 0.0, &[2.0, 0.0], 200.0, &[], &mut maxima)
        .unwrap();
    let [.., before, last] = solution.crossings.as_slice() else { panic!("two maxima are needed") };
    (last.state.clone(), last.time - before.time)
}

#[test]
fn period_of_van_der_pol() {
    assert!((van_der_pol_cycle(1.0).1 - 6.663_286_859_323).abs() < 2e-12);
    assert!((van_der_pol_cycle(5.0).1 - 11.612_230_668).abs() < 1e-9);
}

#[test]
fn arenstorf_orbit_closes() {
    // Hairer, Norsett and Wanner (1993), II.0, equations (0.1) and (0.2).
    let mu = 0.012_277_471;
    let system = from_fn(4, |_, y, f| {
        let d1 = ((y[0] + mu).powi(2) + y[1] * y[1]).powf(1.5);
        let d2 = ((y[0] - 1.0 + mu).powi(2) + y[1] * y[1]).powf(1.5);
        f[0] = y[2];
        f[1] = y[3];
        f[2] = y[0] + 2.0 * y[3] - (1.0 - mu) * (y[0] + mu) / d1 - mu * (y[0] - 1.0 + mu) / d2;
        f[3] = y[1] - 2.0 * y[2] - (1.0 - mu) * y[1] / d1 - mu * y[1] / d2;
    });
    let initial = [0.994, 0.0, 0.0, -2.001_585_106_379_082_5];
    let period = 17.065_216_560_157_96;
    let solution = Integrator::with_tolerance(1e-13).integrate(system, 0.0, &initial, period).unwrap();
    // The orbit multiplies errors by 1e6 to 1e7.
    assert!(distance(&solution.state[..2], &initial[..2]) < 1e-6, "{:?}", solution.state);
}

#[test]
fn error_falls_with_the_tolerance() {
    let initial = pericentre(0.5);
    let mut last = (f64::INFINITY, 0);
    for exponent in [4, 6, 8, 10, 12] {
        let tolerance = 10f64.powi(-exponent);
        let solution =
            Integrator::with_tolerance(tolerance).integrate(from_fn(4, kepler), 0.0, &initial, TAU).unwrap();
        let error = distance(&solution.state, &initial);
        assert!(error < 50.0 * tolerance, "error {error} at tolerance {tolerance}");
        assert!(error < 0.2 * last.0, "{error} after {}", last.0);
        assert!(solution.statistics.accepted_steps > last.1);
        last = (error, solution.statistics.accepted_steps);
    }
    assert!(last.1 < 120, "order 8 needs few steps, not {}", last.1);
}

#[test]
fn order_of_method_and_of_dense_output() {
    // One step of size h: the local errors are of order 9 and 8.
    let errors = |step: f64| {
        let system = from_fn(1, |t: f64, x, f| f[0] = x[0] * t.cos());
        let settings = Integrator::with_tolerance(1e-3).initial_step(step);
        let mut stepper = Stepper::new(system, &settings, 0.0, &[1.0], step).unwrap();
        stepper.advance().unwrap();
        assert!(stepper.is_finished());
        stepper.prepare_dense_output();
        let mut dense = [0.0];
        let mut worst = 0.0_f64;
        for i in 0..=10 {
            let t = step * f64::from(i) / 10.0;
            stepper.interpolate(t, &mut dense);
            worst = worst.max((dense[0] - t.sin().exp()).abs());
        }
        ((stepper.state()[0] - step.sin().exp()).abs(), worst)
    };
    let (coarse, fine) = (errors(0.8), errors(0.4));
    let order = (coarse.0 / fine.0).log2();
    let dense_order = (coarse.1 / fine.1).log2();
    assert!(order > 8.5, "{order}");
    assert!(dense_order > 7.5, "{dense_order}");
}

#[test]
fn dense_output_is_as_accurate_as_the_solution() {
    let initial = pericentre(0.3);
    let times: Vec<f64> = (0..=1000).map(|i| TAU * f64::from(i) / 1000.0).collect();
    let tolerance = 1e-10;
    let solution =
        Integrator::with_tolerance(tolerance).sample(from_fn(4, kepler), &initial, &times).unwrap();
    assert_eq!(solution.times, times);
    for (time, state) in solution.samples() {
        // Kepler's equation by Newton's method.
        let mut anomaly = time;
        for _ in 0..50 {
            anomaly -= (anomaly - 0.3 * anomaly.sin() - time) / (1.0 - 0.3 * anomaly.cos());
        }
        let exact = [anomaly.cos() - 0.3, (1.0f64 - 0.09).sqrt() * anomaly.sin()];
        assert!(distance(&state[..2], &exact) < 100.0 * tolerance, "at {time}");
    }
    assert!(solution.statistics.accepted_steps < 60);
}

#[test]
fn backwards_and_forwards_return() {
    let integrator = Integrator::with_tolerance(1e-13);
    let initial = pericentre(0.5);
    let there = integrator.integrate(from_fn(4, kepler), 1.0, &initial, 4.0).unwrap();
    let back = integrator.integrate(from_fn(4, kepler), 4.0, &there.state, 1.0).unwrap();
    assert!(distance(&back.state, &initial) < 1e-11);
}

#[test]
fn floquet_multipliers_of_van_der_pol() {
    let (state, period) = van_der_pol_cycle(1.0);
    let transition =
        state_transition_matrix(&Integrator::with_tolerance(1e-13), VanDerPol, &[1.0], &state, period)
            .unwrap();
    assert!(distance(&transition.state, &state) < 1e-11);
    let m = &transition.matrix;
    // One multiplier is 1, so the other is the determinant; Liouville: exp of the integral of the trace.
    let (determinant, trace) = (m[0] * m[3] - m[1] * m[2], m[0] + m[3]);
    assert!((trace - determinant - 1.0).abs() < 1e-10);
    let with_trace = from_fn(3, |_, x: &[f64], f: &mut [f64]| {
        f[0] = x[1];
        f[1] = (1.0 - x[0] * x[0]) * x[1] - x[0];
        f[2] = 1.0 - x[0] * x[0];
    });
    let initial = [state[0], state[1], 0.0];
    let end = Integrator::with_tolerance(1e-13).integrate(with_trace, 0.0, &initial, period).unwrap();
    assert!((determinant - end.state[2].exp()).abs() < 1e-12);
}

#[test]
fn transition_matrix_of_many_columns_matches_differences() {
    /// Coupled oscillators, more of them than columns in one evaluation.
    struct Ring;
    impl VectorField for Ring {
        fn state_names(&self) -> Vec<String> {
            (0..7).map(|i| format!("x{i}")).collect()
        }
        fn parameter_names(&self) -> Vec<String> {
            Vec::new()
        }
        fn evaluate<T: Scalar>(&self, x: &[T], _: &[T], f: &mut [T]) {
            for i in 0..7 {
                f[i] = (x[(i + 1) % 7] - x[i]).sin() - x[i] * 0.1;
            }
        }
    }
    let initial = [0.3, -0.2, 0.9, 1.4, -1.0, 0.1, 0.5];
    let integrator = Integrator::with_tolerance(1e-12);
    let transition = state_transition_matrix(&integrator, Ring, &[], &initial, 3.0).unwrap();
    for j in 0..7 {
        let shifted = |shift: f64| {
            let mut start = initial;
            start[j] += shift;
            integrator.integrate(autonomous(Ring, &[]), 0.0, &start, 3.0).unwrap().state
        };
        let (plus, minus) = (shifted(1e-5), shifted(-1e-5));
        for i in 0..7 {
            let difference = (plus[i] - minus[i]) / 2e-5;
            assert!((difference - transition.matrix[7 * j + i]).abs() < 1e-8);
        }
    }
}

#[test]
fn terminal_event_ends_and_a_restart_does_not_find_it_again() {
    let oscillator = |_: f64, x: &[f64], f: &mut [f64]| f.copy_from_slice(&[x[1], -x[0]]);
    let integrator = Integrator::default();
    let mut time = 0.0;
    let mut state = vec![0.0, 1.0];
    for passage in 1..=20 {
        let mut events = [Event::new(|_, x| x[0]).terminal(), Event::new(|_, x| x[1])];
        let solution =
            integrator.with_events(from_fn(2, oscillator), time, &state, 1e3, &[], &mut events).unwrap();
        assert_eq!(solution.ended_by, Some(0));
        assert_eq!(solution.crossings.len(), 2);
        assert!((solution.time - f64::from(passage) * PI).abs() < 1e-8);
        (time, state) = (solution.time, solution.state);
    }
}

#[test]
fn direction_filters() {
    let mut events = [
        Event::new(|t: f64, _: &[f64]| t.sin()).rising(),
        Event::new(|t: f64, _: &[f64]| t.sin()).falling(),
        Event::new(|t: f64, _: &[f64]| t.sin()),
    ];
    let still = from_fn(1, |_, _, f| f[0] = 0.0);
    let solution = Integrator::default().with_events(still, 0.5, &[1.0], 20.0, &[], &mut events).unwrap();
    let counts = [0, 1, 2].map(|event| solution.crossings.iter().filter(|c| c.event == event).count());
    assert_eq!(counts, [3, 3, 6]);
    assert!(solution.crossings.is_sorted_by(|a, b| a.time <= b.time));
}

/// A corner of width 1e-12 in a field takes steps that a late time does not resolve, and they are taken: the motion is the same however
/// late it begins, and backwards too.
#[test]
fn autonomous_steps_are_resolved_however_late_it_is() {
    let corner = |x: f64| 1.0 - 0.5 * x / x.hypot(1e-12);
    let integrator = Integrator::default().absolute_tolerance(1e-16);
    for sense in [1.0, -1.0] {
        for start in [0.0, 1.0, 41.7, -300.0, 1e6] {
            let system = from_rates(1, |x: &[f64], f: &mut [f64]| f[0] = sense * corner(x[0]));
            let end = start + 2.0 * sense;
            let solution = integrator.integrate(system, start, &[-1.0], end).unwrap();
            assert_eq!(solution.time, end);
            // At a rate of 3/2 to zero, at 1/2 from there; the end is known to the rounding of the time.
            let rounding = 2.0 * f64::EPSILON * start.abs();
            assert!((solution.state[0] - 2.0 / 3.0).abs() < 1e-9 + rounding, "{start}: {:?}", solution.state);
        }
    }
}

/// Crossings and samples within steps that are shorter than what rounding leaves of the time.
#[test]
fn events_and_samples_are_resolved_however_late_it_is() {
    for start in [0.0, 12.0, 1e5] {
        // An oscillation of 1e12 rad/s, of which a period at t = 1e5 is less than what time resolves.
        let rate = 1e12;
        let fast =
            from_rates(2, move |x: &[f64], f: &mut [f64]| f.copy_from_slice(&[rate * x[1], -rate * x[0]]));
        let mut stepper =
            Stepper::new(fast, &Integrator::default(), start, &[0.0, 1.0], start + 1.0).unwrap();
        let mut events = [Event::new(|_, x| x[0])];
        let mut locator = EventLocator::new(&mut events, start, &[0.0, 1.0]);
        let mut crossings = Vec::new();
        let mut state = [0.0; 2];
        let mut turned = 0.0;
        for _ in 0..200 {
            let before = stepper.state().to_vec();
            stepper.advance().unwrap();
            locator.locate(&mut stepper, &mut events, &mut crossings);
            stepper.interpolate(stepper.time(), &mut state);
            assert!(state.iter().all(|value| value.abs() < 1.01), "{state:?}");
            let now = stepper.state();
            let (across, along) =
                (before[1] * now[0] - before[0] * now[1], before[0] * now[0] + before[1] * now[1]);
            turned += across.atan2(along);
        }
        assert!(crossings.len().abs_diff((turned / PI) as usize) <= 1, "{} {turned}", crossings.len());
        assert!(crossings.len() > 10 && crossings.is_sorted_by(|a, b| a.time <= b.time));
        assert!(crossings.iter().all(|crossing| crossing.state[0].abs() < 1e-6));
        let elapsed = stepper.time() - start;
        assert!((elapsed - turned / rate).abs() <= 2.0 * f64::EPSILON * start + 1e-6 * turned / rate);
    }
}

#[test]
fn errors_are_typed() {
    let integrator = Integrator::default();
    let explosion = from_fn(1, |_, x: &[f64], f: &mut [f64]| f[0] = x[0] * x[0]);
    let error = integrator.integrate(explosion, 0.0, &[1.0], 2.0).unwrap_err();
    let (IntegrationError::StepTooSmall { time, .. } | IntegrationError::NotFinite { time }) = error else {
        panic!("{error}")
    };
    assert!((time - 1.0).abs() < 1e-9);

    let wall = from_fn(1, |t: f64, _: &[f64], f: &mut [f64]| f[0] = (1.0 - t).sqrt());
    let error = integrator.integrate(wall, 0.0, &[0.0], 2.0).unwrap_err();
    assert!(
        matches!(error, IntegrationError::NotFinite { time } | IntegrationError::StepTooSmall { time, .. } if time < 1.0 && time > 0.9)
    );

    let stiff = from_fn(1, |_, x: &[f64], f: &mut [f64]| f[0] = -1e6 * x[0]);
    let error = integrator.clone().maximum_steps(100).integrate(stiff, 0.0, &[1.0], 2.0).unwrap_err();
    assert!(matches!(error, IntegrationError::TooManySteps { steps, .. } if steps <= 100));

    let still = || from_fn(1, |_, _, f: &mut [f64]| f[0] = 0.0);
    let bad = [
        integrator.integrate(still(), 0.0, &[1.0, 2.0], 1.0),
        integrator.integrate(still(), 0.0, &[f64::NAN], 1.0),
        integrator.integrate(still(), 0.0, &[1.0], f64::NAN),
        integrator.sample(still(), &[1.0], &[0.0, 1.0, 0.5, 2.0]),
        integrator.sample(still(), &[1.0], &[]),
        Integrator::with_tolerance(-1.0).integrate(still(), 0.0, &[1.0], 1.0),
        Integrator::with_tolerance(f64::NAN).integrate(still(), 0.0, &[1.0], 1.0),
        Integrator::default().initial_step(0.0).integrate(still(), 0.0, &[1.0], 1.0),
        Integrator::default().maximum_step(f64::NAN).integrate(still(), 0.0, &[1.0], 1.0),
        Integrator::default().absolute_tolerances(&[1.0, 1.0]).integrate(still(), 0.0, &[1.0], 1.0),
    ];
    assert!(bad.iter().all(Result::is_err), "{bad:?}");
    assert_eq!(integrator.integrate(still(), 1.0, &[3.0], 1.0).unwrap().state, [3.0]);
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    /// The event function oscillates many times within a step, with two frequencies.
    #[test]
    fn all_crossings_of_a_fast_event_are_found(
        frequency in 5.0..300.0f64, phase in 0.0..TAU, bias in -0.99..0.99f64,
    ) {
        let slow = from_fn(2, |_, x, f| f.copy_from_slice(&[x[1], -x[0]]));
        let mut events = [Event::new(move |t: f64, _: &[f64]| (frequency * t + phase).sin() - bias)];
        let solution =
            Integrator::with_tolerance(1e-6).with_events(slow, 0.0, &[1.0, 0.0], 10.0, &[], &mut events).unwrap();
        // Zeros: frequency t + phase = asin(bias) + 2 pi k or pi - asin(bias) + 2 pi k.
        let mut expected = Vec::new();
        for k in -2..(10.0 * frequency / TAU) as i32 + 3 {
            for angle in [bias.asin(), PI - bias.asin()] {
                let time = (angle + TAU * f64::from(k) - phase) / frequency;
                if time > 0.0 && time < 10.0 {
                    expected.push(time);
                }
            }
        }
        expected.sort_by(f64::total_cmp);
        prop_assert_eq!(solution.crossings.len(), expected.len());
        for (crossing, time) in solution.crossings.iter().zip(expected) {
            prop_assert!((crossing.time - time).abs() < 1e-11);
        }
    }

    /// The state itself dips below zero and comes back within a step.
    #[test]
    fn short_dips_are_found(depth in 1e-7..1e-2f64, phase in 0.0..TAU) {
        let slow = from_fn(2, |_, x, f| f.copy_from_slice(&[x[1], -x[0]]));
        let mut events = [Event::new(move |_, x: &[f64]| x[0] + 1.0 - depth)];
        let start = [phase.cos(), -phase.sin()];
        prop_assume!(phase.cos() + 1.0 > 2.0 * depth);
        let solution =
            Integrator::with_tolerance(1e-10).with_events(slow, 0.0, &start, 60.0, &[], &mut events).unwrap();
        let turns = ((60.0 + phase) / TAU + 0.5).floor() - (phase / TAU + 0.5).floor();
        prop_assume!((0.1..0.9).contains(&((60.0 + phase) / TAU + 0.5).fract()));
        prop_assert_eq!(solution.crossings.len(), 2 * turns as usize);
    }
}

#[test]
fn a_control_sees_the_time_pass_and_stops() {
    let told = std::sync::Mutex::new(Vec::new());
    let stop = std::sync::atomic::AtomicBool::new(false);
    let observer = |progress: Progress<'_>| {
        let Progress::Done(part) = progress else { panic!("{progress:?}") };
        told.lock().unwrap().push(part);
        stop.store(part > 0.7, std::sync::atomic::Ordering::Relaxed);
    };
    let control = Control::new(&stop, &observer);
    let integrator = Integrator::default();
    let run = |end| integrator.under(&control).integrate(from_fn(4, kepler), 0.0, &pericentre(0.5), end);
    assert_eq!(run(-1000.0), Err(IntegrationError::Interrupted(Interrupted)));
    let told = told.lock().unwrap();
    assert!(told.is_sorted() && told.len() > 50 && told[..told.len() - 1].iter().all(|&part| part <= 0.7));
}
