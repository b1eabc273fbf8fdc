//! The ensemble against the Runge-Kutta integrator and against itself in other company.

use super::*;
use crate::Key;
use arclength::control::Control;
use arclength::integration::{Integrator, autonomous};
use std::ops::ControlFlow;

/// Initial states around the uniform motion, from a low-discrepancy sequence.
fn initial_states(wheel: &Wheel, count: usize) -> Vec<[f64; 5]> {
    let [u, q, psi, speed, yaw] = wheel.uniform_motion().unwrap().state();
    let spread = |index: usize, step: f64| 2.0 * (index as f64 * step).fract() - 1.0;
    (0..count)
        .map(|i| {
            [u, q, psi + 0.3 * spread(i + 1, 0.754_877_666), speed, yaw + 10.0 * spread(i + 1, 0.569_840_291)]
        })
        .collect()
}

fn largest_difference(one: &[f64; 5], other: &[f64; 5]) -> f64 {
    one.iter().zip(other).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max)
}

#[test]
fn agrees_with_runge_kutta_and_converges() {
    let wheels = [
        Wheel::default(),
        Wheel::default().with(Key::Curvature, 0.0).unwrap(),
        [(Key::CU, 0.1), (Key::CQ, 0.1), (Key::CPsi, 1e-4), (Key::KPsi, 0.02)]
            .into_iter()
            .try_fold(Wheel::default(), |wheel, (key, value)| wheel.with(key, value))
            .unwrap(),
    ];
    for wheel in &wheels {
        let field = wheel.rolling(&[]).unwrap();
        let initial = initial_states(&Wheel::default(), 11);
        let exact: Vec<[f64; 5]> = initial
            .iter()
            .map(|start| {
                let end = Integrator::with_tolerance(1e-13)
                    .integrate(autonomous(&field, &[]), 0.0, start, 1.0)
                    .unwrap();
                std::array::from_fn(|i| end.state[i])
            })
            .collect();
        let mut last = f64::INFINITY;
        for tolerance in [1e-6, 1e-9, 1e-12] {
            let ends = Ensemble::new(wheel)
                .unwrap()
                .tolerance(tolerance)
                .integrate(&initial, 1.0, &Control::none())
                .unwrap();
            let error = ends
                .iter()
                .zip(&exact)
                .map(|(end, exact)| largest_difference(&end.state, exact))
                .fold(0.0, f64::max);
            assert!(error < 1e4 * tolerance && error < last, "{error} at {tolerance}");
            assert!(ends.iter().all(|end| end.ending == Ending::Completed && end.time == 1.0));
            last = error;
        }
        assert!(last < 2e-10, "{last}");
    }
}

#[test]
fn a_trajectory_does_not_depend_on_its_company() {
    let wheel = Wheel::default();
    let initial = initial_states(&wheel, 600);
    let ensemble = Ensemble::new(&wheel).unwrap();
    let stop = |trajectory: usize| {
        move |progress: Progress<'_>| {
            assert_eq!(progress.trajectory, trajectory);
            if progress.time > 0.1 && trajectory.is_multiple_of(3) {
                ControlFlow::Break(())
            } else {
                ControlFlow::Continue(())
            }
        }
    };
    let run = |threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| ensemble.integrate_watched(&initial, 0.3, &Control::none(), stop)).unwrap()
    };
    let together = run(1);
    assert_eq!(together, run(3));
    for index in [0, 1, 7, 300, 599] {
        let alone = ensemble.integrate(&initial[index..=index], 0.3, &Control::none()).unwrap();
        let expected = if index % 3 == 0 { Ending::Stopped } else { Ending::Completed };
        assert_eq!(together[index].ending, expected);
        if expected == Ending::Completed {
            assert_eq!(alone[0], together[index]);
        }
    }
}

#[test]
fn endings_are_told_apart() {
    let wheel = Wheel::default();
    let state = wheel.uniform_motion().unwrap().state();
    let ensemble = Ensemble::new(&wheel).unwrap();
    let ending =
        |ensemble: &Ensemble, state| ensemble.integrate(&[state], 1.0, &Control::none()).unwrap()[0].ending;
    assert_eq!(ending(&ensemble, [f64::NAN, 0.0, 0.0, 1.0, 0.0]), Ending::NotFinite);
    assert_eq!(ending(&ensemble, [0.0, 0.0, 0.0, 1.0, 1e300]), Ending::NotFinite);
    assert_eq!(ending(&ensemble.clone().maximum_steps(3), state), Ending::TooManySteps);
    assert_eq!(ending(&ensemble, state), Ending::Completed);
    assert_eq!(ensemble.integrate(&[state], 0.0, &Control::none()).unwrap()[0].time, 0.0);
    assert!(ensemble.integrate(&[], 1.0, &Control::none()).unwrap().is_empty());
}

#[test]
fn bad_input_is_refused() {
    let wheel = Wheel::default();
    let ensemble = Ensemble::new(&wheel).unwrap();
    assert!(ensemble.integrate(&[], -1.0, &Control::none()).is_err());
    assert!(ensemble.clone().tolerance(f64::NAN).integrate(&[], 1.0, &Control::none()).is_err());
    for key in [Key::KU, Key::CU] {
        let error = Ensemble::new(&wheel.with(key, 1.0).unwrap()).unwrap_err();
        assert!(error.to_string().contains("equal to"));
    }
}
