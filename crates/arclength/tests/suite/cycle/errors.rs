//! Errors of cycles as they are told along a branch, against cycles that are known in closed form.

use arclength::cycle::{CycleBranch, CycleStart, Cycles, Orbit};
use arclength::{Scalar, VectorField};
use proptest::prelude::*;
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

/// A circle of radius `sqrt(m)`, and beside it a direction that turns a thousand times as fast and dies out: on the cycle it rests,
/// so that no mesh of the cycle needs to see it.
struct Ringing;

const TURNS: f64 = 1300.1;

impl VectorField for Ringing {
    fn state_names(&self) -> Vec<String> {
        ["x", "y", "p", "q"].map(String::from).to_vec()
    }
    fn parameter_names(&self) -> Vec<String> {
        vec!["m".into()]
    }
    fn evaluate<T: Scalar>(&self, s: &[T], p: &[T], d: &mut [T]) {
        let growth = p[0] - s[0] * s[0] - s[1] * s[1];
        d[0] = growth * s[0] - s[1];
        d[1] = growth * s[1] + s[0];
        let (rate, turns) = (s[0] * 0.3 - 0.2, (s[1] * 0.5 + 1.0) * TURNS);
        d[2] = rate * s[2] - turns * s[3];
        d[3] = turns * s[2] + rate * s[3];
    }
}

#[test]
fn multipliers_of_a_direction_that_turns_fast_are_right() {
    let start = Orbit::from_function(TAU, |time| vec![time.cos(), time.sin(), 0.0, 0.0]);
    let cycles = Cycles::of(&Ringing, CycleStart::Orbit(start)).parameters(&[1.0]);
    let branch = cycles.along("m", 0.5..=2.0).at(&[1.5]).run().unwrap();
    // The means of the rates are -0.2 and 1300.1.
    let (modulus, argument) = ((-0.2 * TAU).exp(), 0.1 * TAU);
    let shown: Vec<_> = branch.points.iter().filter(|point| point.label.is_some()).collect();
    assert!(shown.iter().any(|point| point.value == 1.5));
    for point in shown {
        let ringing = point.multipliers.iter().zip(&point.multiplier_errors);
        let ringing: Vec<_> = ringing.filter(|(multiplier, _)| multiplier.im != 0.0).collect();
        assert_eq!(ringing.len(), 2, "{:?}", point.multipliers);
        for (multiplier, error) in ringing {
            let off =
                (multiplier.norm() / modulus - 1.0).abs().max((multiplier.arg().abs() - argument).abs());
            assert!(off <= error.max(1e-9) && *error < 1e-2, "{off:e}, told {error:e}");
        }
        assert_eq!(point.stable, Some(true));
    }
}

/// A circle of radius `sqrt(m)`, beside it a direction that turns and grows as slowly as it likes, and one that dies out as fast as it
/// likes while the cycle pushes it.
struct Beside {
    turns: f64,
    growth: f64,
    decay: f64,
}

impl VectorField for Beside {
    fn state_names(&self) -> Vec<String> {
        ["x", "y", "p", "q", "z"].map(String::from).to_vec()
    }
    fn parameter_names(&self) -> Vec<String> {
        vec!["m".into()]
    }
    fn evaluate<T: Scalar>(&self, s: &[T], p: &[T], d: &mut [T]) {
        let growth = p[0] - s[0] * s[0] - s[1] * s[1];
        d[0] = growth * s[0] - s[1];
        d[1] = growth * s[1] + s[0];
        let (rate, turns) = (s[0] * 0.3 + self.growth, (s[1] * 0.5 + 1.0) * self.turns);
        d[2] = rate * s[2] - turns * s[3];
        d[3] = turns * s[2] + rate * s[3];
        d[4] = (s[0] * s[0] - s[4]) * self.decay;
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 24, ..ProptestConfig::default() })]

    #[test]
    fn multipliers_of_all_cycles_are_right_whatever_happens_beside_them(
        turns in 0.0..4.0,
        growth in prop_oneof![-0.3..-0.01, 0.01..0.3],
        decay in 0.0..6.0,
    ) {
        let field = Beside { turns: 10f64.powf(turns), growth, decay: 10f64.powf(decay) };
        let settled = |time: f64| {
            // z' = decay (x x - z) with x = cos t.
            let lag = field.decay / (field.decay * field.decay + 4.0);
            0.5 + 0.5 * lag * (field.decay * (2.0 * time).cos() + 2.0 * (2.0 * time).sin())
        };
        let start = Orbit::from_function(TAU, |time| vec![time.cos(), time.sin(), 0.0, 0.0, settled(time)]);
        let cycles = Cycles::of(&field, CycleStart::Orbit(start)).parameters(&[1.0]);
        let branch = cycles.along("m", 0.8..=1.3).run().unwrap();
        prop_assert!(branch.points.len() > 3 && branch.unlocated.is_empty());
        for point in &branch.points {
            let known = [-2.0 * point.value, field.growth, field.growth, -field.decay].map(|rate| rate * TAU);
            let mut told: Vec<f64> = point.multipliers.iter().map(|value| value.norm().ln()).collect();
            let trivial = (0..5).min_by(|&a, &b| told[a].abs().total_cmp(&told[b].abs())).unwrap();
            told.remove(trivial);
            for exact in known.into_iter().filter(|exact| *exact > -15.0) {
                let nearest = told.iter().map(|one| (one - exact).abs()).fold(f64::INFINITY, f64::min);
                let largest = point.multiplier_errors.iter().copied().fold(0.0, f64::max);
                prop_assert!(nearest < largest.max(1e-3), "{}: {exact} among {told:?}, {largest}", point.value);
            }
            let alive = told.iter().filter(|one| **one > -14.0).count();
            prop_assert!(alive <= known.iter().filter(|exact| **exact > -15.0).count(), "{:?}", &told);
            prop_assert_eq!(point.stable, Some(field.growth < 0.0), "{}: {:?}", point.value, &told);
        }
    }
}
