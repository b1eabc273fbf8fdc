//! Starts that are far from an equilibrium, values that are asked for, and requests that make no sense.

use approx::assert_relative_eq;
use arclength::equilibrium::{Equilibria, find_equilibrium};
use arclength::{Error, Scalar, VectorField};

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
