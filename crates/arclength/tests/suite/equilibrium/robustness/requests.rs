//! Starts that are far from an equilibrium, values that are asked for, and requests that make no sense.

use approx::assert_relative_eq;
use arclength::branch::Monitor;
use arclength::equilibrium::{Equilibria, EquilibriumPoint, find_equilibrium, seek_equilibrium};
use arclength::{Error, Scalar, VectorField};
use std::f64::consts::PI;

field!(Explosion, ["x"], ["p"], |x, p, d| {
    d[0] = p[0] * p[0] + x[0] * x[0] + 1.0;
});

field!(Arctangent, ["x"], ["p"], |x, p, d| {
    d[0] = p[0] - x[0].atan();
});

field!(Root, ["x"], ["p"], |x, p, d| {
    d[0] = p[0] - x[0].sqrt();
});

#[test]
fn newton_reaches_far_equilibria_and_says_why_it_does_not() {
    let state = find_equilibrium(&Arctangent, &[50.0], &[0.1]).unwrap();
    assert_relative_eq!(state[0], 0.1_f64.tan(), max_relative = 1e-14);
    assert_relative_eq!(find_equilibrium(&Root, &[1e-6], &[3.0]).unwrap()[0], 9.0, max_relative = 1e-14);
    let error = find_equilibrium(&Explosion, &[1.0], &[0.0]).unwrap_err();
    assert!(matches!(error, Error::NotFound { sought: "equilibrium", .. }), "{error}");
    assert!(find_equilibrium(&Root, &[-1.0], &[3.0]).is_err());
    assert!(find_equilibrium(&Root, &[1.0, 2.0], &[3.0]).is_err());
    assert!(seek_equilibrium(&Root, &[1.0, 2.0], &[3.0]).is_err());
    assert!(seek_equilibrium(&Root, &[f64::NAN], &[3.0]).is_err());
    assert!(find_equilibrium(&Root, &[f64::NAN], &[3.0]).is_err());
}

#[test]
fn requested_values_are_there_once_wherever_they_are() {
    let branch = Equilibria::of(&Root).start(&[1.0]).parameters(&[1.0]).along("p", 0.5..=2.0);
    let branch = branch.at(&[0.5, 0.7, 1.0, 1.25, 2.0]).run().unwrap();
    let requested: Vec<f64> =
        branch.points.iter().filter(|point| point.label.is_some()).map(|point| point.value).collect();
    assert_eq!(requested, [0.5, 0.7, 1.0, 1.25, 2.0]);
    for point in &branch.points {
        assert_relative_eq!(point.state[0], point.value.powi(2), max_relative = 1e-10);
    }
}

#[test]
fn bad_requests_are_refused() {
    let ask = || Equilibria::of(&Root).start(&[1.0]).parameters(&[1.0]);
    let message = |asked: Equilibria<'_>| asked.run().unwrap_err().to_string();
    assert!(message(ask()).contains("along"));
    assert!(message(ask().along("q", 0.0..=1.0)).contains("one of p"));
    assert!(message(ask().along("p", 2.0..=1.0)).contains("smaller one first"));
    assert!(message(ask().along("p", 0.0..=f64::INFINITY)).contains("finite"));
    assert!(message(ask().along("p", 0.0..=2.0).at(&[3.0])).contains("0 to 2"));
    assert!(message(ask().along("p", 0.0..=2.0).start(&[1.0, 2.0])).contains("dimension"));
    assert!(message(ask().along("p", 0.0..=2.0).parameters(&[])).contains("number of parameters"));
}

field!(Wave, ["x"], ["p"], |x, p, d| {
    d[0] = p[0].sin() - x[0];
});

#[test]
fn a_monitor_passes_its_value_and_comes_back_within_a_step() {
    for value in [0.999, 0.9999, 0.995, 0.999_99] {
        let monitor = || Monitor::new("x", |point: &EquilibriumPoint| Some(point.state[0]));
        let run = |monitor| {
            Equilibria::of(&Wave)
                .start(&[0.0])
                .parameters(&[0.0])
                .along("p", 0.0..=3.0)
                .monitor(monitor)
                .run()
        };
        let branch = run(monitor().at(&[value])).unwrap();
        let found: Vec<f64> =
            branch.points.iter().filter(|point| point.label.is_some()).map(|point| point.value).collect();
        let [one, other] = found[..] else { panic!("{value}: {found:?}") };
        assert_relative_eq!(one, value.asin(), epsilon = 1e-8);
        assert_relative_eq!(other, PI - value.asin(), epsilon = 1e-8);
        // What it never reaches is not found.
        let beyond = run(monitor().at(&[1.000_01])).unwrap();
        assert!(beyond.points.iter().all(|point| point.label.is_none()));
    }
}
