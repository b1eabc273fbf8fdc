//! Errors of cycles as they are told along a branch, against cycles that are known in closed form.

use arclength::cycle::{CycleBranch, CycleStart, Cycles, Orbit};
use arclength::{Scalar, VectorField};
use std::f64::consts::TAU;

/// A circle of radius `size` in the logarithm of `x`, and `v`: `x = exp(size cos t)`, with the period `2 pi`. The flow depends on
/// the logarithm where `x` is next to nothing compared with its amplitude.
struct Logarithmic;

impl VectorField for Logarithmic {
    fn state_names(&self) -> Vec<String> {
        vec!["x".into(), "v".into()]
    }
    fn parameter_names(&self) -> Vec<String> {
        vec!["size".into()]
    }
    fn evaluate<T: Scalar>(&self, s: &[T], p: &[T], d: &mut [T]) {
        let u = s[0].ln();
        let growth = (p[0] * p[0] - u * u - s[1] * s[1]) / (p[0] * p[0]);
        d[0] = s[0] * (growth * u - s[1]);
        d[1] = growth * s[1] + u;
    }
}

fn branch() -> CycleBranch {
    let start = Orbit::from_function(TAU, |time| vec![time.cos().exp(), time.sin()]);
    Cycles::of(&Logarithmic, CycleStart::Orbit(start))
        .parameters(&[1.0])
        .along("size", 1.0..=8.0)
        .at(&[5.0])
        .run()
        .unwrap()
}

#[test]
fn errors_that_the_flow_multiplies_are_told_and_kept_small() {
    let branch = branch();
    assert!(branch.points.last().unwrap().value > 7.9, "{:?}", branch.stops);
    assert!(branch.points.len() > 10);
    for point in &branch.points {
        let error = (point.period / TAU - 1.0).abs();
        let size = point.value.exp();
        let largest = (point.max[0] / size - 1.0).abs();
        let allowed = (3.0 * point.error_estimate).max(1e-9);
        assert!(
            error.max(largest) <= allowed,
            "{}: {error:e}, {largest:e}, told {:e}",
            point.value,
            point.error_estimate
        );
        assert!(point.error_estimate < 2e-7, "{}: {:e}", point.value, point.error_estimate);
    }
}

#[test]
fn the_multiplier_in_the_plane_is_known() {
    // The growth rate of the radius is -2.
    for point in branch().points.iter().filter(|point| point.label.is_some()) {
        let multiplier = point.multipliers.iter().map(|value| value.norm()).fold(f64::INFINITY, f64::min);
        assert!((multiplier.ln() / (-2.0 * TAU) - 1.0).abs() < 1e-6, "{}: {multiplier:e}", point.value);
        assert_eq!(point.stable, Some(true));
    }
}
