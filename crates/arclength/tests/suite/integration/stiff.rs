//! Stiff problems against closed forms and against SciPy (`solve_ivp`, method Radau, relative tolerance 1e-13, absolute 1e-16).

use arclength::integration::{Event, Integrator, Method, Stepper, System, autonomous, from_fn};
use arclength::{Scalar, VectorField};

const ROBERTSON: [f64; 3] = [0.017865921142103947, 7.274751468438169e-08, 0.9821340061103824];
const HIRES: [f64; 8] = [
    0.0007371312573325495,
    0.00014424857263161506,
    5.8887297409672526e-05,
    0.0011756513432831168,
    0.002386356198830812,
    0.00623896825274118,
    0.002849998395185396,
    0.00285000160481459,
];
const VAN_DER_POL: [f64; 2] = [1.7061677321704356, -0.8928097010248481];
const OREGONATOR: [f64; 3] = [1.0013479384127426, 742.8670930896278, 6.417160469773771];

const METHODS: [Method; 2] = [Method::Implicit, Method::Automatic];

fn integrator(method: Method) -> Integrator {
    Integrator::default().relative_tolerance(1e-10).absolute_tolerance(1e-14).method(method)
}

fn assert_ends_at<S: System>(system: impl Fn() -> S, start: &[f64], time: f64, expected: &[f64], error: f64) {
    for method in METHODS {
        let solution = integrator(method).integrate(system(), 0.0, start, time).unwrap();
        for (found, expected) in solution.state.iter().zip(expected) {
            let difference = (found - expected).abs();
            assert!(difference <= error * expected.abs(), "{method:?}: {found} {expected}");
        }
        assert!(solution.statistics.accepted_steps < 60_000, "{:?}", solution.statistics);
    }
}

/// Robertson's reactions.
struct Robertson;

impl VectorField for Robertson {
    fn state_names(&self) -> Vec<String> {
        ["x", "y", "z"].map(String::from).to_vec()
    }
    fn parameter_names(&self) -> Vec<String> {
        Vec::new()
    }
    fn evaluate<T: Scalar>(&self, x: &[T], _: &[T], derivative: &mut [T]) {
        let (slow, fast, faster) = (x[0] * 0.04, x[1] * x[2] * 1e4, x[1] * x[1] * 3e7);
        derivative[0] = fast - slow;
        derivative[1] = slow - fast - faster;
        derivative[2] = faster;
    }
}

#[test]
fn robertson() {
    let expected = ROBERTSON;
    assert_ends_at(|| autonomous(&Robertson, &[]), &[1.0, 0.0, 0.0], 1e5, &expected, 1e-9);
    // Difference quotients instead of the exact Jacobian.
    let by_differences = || from_fn(3, |_, x, f| Robertson.evaluate(x, &[], f));
    assert_ends_at(by_differences, &[1.0, 0.0, 0.0], 1e5, &expected, 1e-9);
}

#[test]
fn hires() {
    let system = || {
        from_fn(8, |_, y, f| {
            let a = 280.0 * y[5] * y[7] - 1.81 * y[6];
            f[0] = -1.71 * y[0] + 0.43 * y[1] + 8.32 * y[2] + 0.0007;
            f[1] = 1.71 * y[0] - 8.75 * y[1];
            f[2] = -10.03 * y[2] + 0.43 * y[3] + 0.035 * y[4];
            f[3] = 8.32 * y[1] + 1.71 * y[2] - 1.12 * y[3];
            f[4] = -1.745 * y[4] + 0.43 * y[5] + 0.43 * y[6];
            f[5] = -280.0 * y[5] * y[7] + 0.69 * y[3] + 1.71 * y[4] - 0.43 * y[5] + 0.69 * y[6];
            f[6] = a;
            f[7] = -a;
        })
    };
    assert_ends_at(system, &[1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0057], 321.8122, &HIRES, 1e-8);
}

#[test]
fn van_der_pol_with_a_million() {
    let system =
        || from_fn(2, |_, x, f| f.copy_from_slice(&[x[1], ((1.0 - x[0] * x[0]) * x[1] - x[0]) * 1e6]));
    assert_ends_at(system, &[2.0, 0.0], 2.0, &VAN_DER_POL, 1e-8);
}

#[test]
fn oregonator() {
    let system = || {
        from_fn(3, |_, x, f| {
            f[0] = 77.27 * (x[1] - x[0] * x[1] + x[0] - 8.375e-6 * x[0] * x[0]);
            f[1] = (-x[1] - x[0] * x[1] + x[2]) / 77.27;
            f[2] = 0.161 * (x[0] - x[2]);
        })
    };
    assert_ends_at(system, &[1.0, 1.0, 1.0], 360.0, &OREGONATOR, 1e-7);
}

/// `x' = -k (x - cos t) - sin t` has the solution `cos t` however large `k` is (Prothero and Robinson).
#[test]
fn samples_and_events_are_as_exact_as_asked_for_at_any_stiffness() {
    for stiffness in [1e3, 1e6, 1e9, 1e12] {
        for method in METHODS {
            let system = || {
                from_fn(1, move |t: f64, x: &[f64], f: &mut [f64]| {
                    f[0] = -stiffness * (x[0] - t.cos()) - t.sin();
                })
            };
            let times: Vec<f64> = (0..=1000).map(|index| 0.02 * f64::from(index)).collect();
            let mut events = [Event::new(|_, x: &[f64]| x[0])];
            let solution =
                integrator(method).with_events(system(), 0.0, &[1.0], 20.0, &times, &mut events).unwrap();
            for (time, state) in solution.samples() {
                assert!((state[0] - time.cos()).abs() < 1e-9, "{stiffness} {method:?} {time}");
            }
            assert_eq!(solution.crossings.len(), 6);
            for (index, crossing) in solution.crossings.iter().enumerate() {
                let expected = std::f64::consts::PI * (index as f64 + 0.5);
                assert!((crossing.time - expected).abs() < 1e-9, "{stiffness} {method:?} {index}");
            }
            assert!(solution.statistics.accepted_steps < 20_000);
        }
    }
}

/// Backwards in time `x' = k x` is as stiff as `x' = -k x` is forwards.
#[test]
fn backwards() {
    let system = || from_fn(1, |t: f64, x: &[f64], f: &mut [f64]| f[0] = 1e8 * (x[0] - t.sin()) + t.cos());
    for method in METHODS {
        let solution = integrator(method).integrate(system(), 3.0, &[3_f64.sin()], -3.0).unwrap();
        assert!((solution.state[0] - (-3_f64).sin()).abs() < 1e-9);
    }
}

/// A problem that is stiff for some time only: `x' = -k(t) (x - cos t) - sin t`, with a rate `k` that falls from 1e6 to 1.
#[test]
fn the_method_follows_the_problem() {
    let rate = |t: f64| if t < 10.0 { 1e6 } else { 1.0 };
    let system = from_fn(1, move |t: f64, x: &[f64], f: &mut [f64]| {
        f[0] = -rate(t) * (x[0] - t.cos()) - t.sin();
    });
    let mut stepper = Stepper::new(system, &integrator(Method::Automatic), 0.0, &[1.0], 100.0).unwrap();
    let (mut implicit_early, mut implicit_late) = (0, 0);
    while !stepper.is_finished() {
        stepper.advance().unwrap();
        if stepper.is_implicit() {
            *(if stepper.time() < 10.0 { &mut implicit_early } else { &mut implicit_late }) += 1;
        }
    }
    assert!(implicit_early > 50 && implicit_late < 30, "{implicit_early} {implicit_late}");
    assert!((stepper.state()[0] - 100_f64.cos()).abs() < 1e-9);
}

/// What is not stiff is followed by the very steps of the explicit method.
#[test]
fn a_problem_that_is_not_stiff_is_not_taken_for_one() {
    let kepler = || {
        from_fn(4, |_, x: &[f64], f: &mut [f64]| {
            let cube = x[0].hypot(x[1]).powi(3);
            f.copy_from_slice(&[x[2], x[3], -x[0] / cube, -x[1] / cube]);
        })
    };
    let start = [0.1, 0.0, 0.0, 19_f64.sqrt()];
    let explicit = integrator(Method::Explicit).integrate(kepler(), 0.0, &start, 100.0).unwrap();
    assert_eq!(integrator(Method::Automatic).integrate(kepler(), 0.0, &start, 100.0).unwrap(), explicit);
}
