//! Special points that lie close together, and modes that ring beside them.

use super::kinds;
use approx::assert_relative_eq;
use arclength::equilibrium::Equilibria;
use arclength::{Scalar, VectorField};

/// A focus whose growth rate is `(p - 1/2)^2 - gap^2`: two Hopf points at the distance `2 gap`.
struct TwoHopfPoints(f64);

impl VectorField for TwoHopfPoints {
    fn state_names(&self) -> Vec<String> {
        vec!["x".into(), "y".into()]
    }
    fn parameter_names(&self) -> Vec<String> {
        vec!["p".into()]
    }
    fn evaluate<T: Scalar>(&self, x: &[T], p: &[T], d: &mut [T]) {
        let growth = (p[0] - 0.5).powi(2) - self.0 * self.0 - x[0] * x[0] - x[1] * x[1];
        d[0] = growth * x[0] - x[1];
        d[1] = x[0] + growth * x[1];
    }
}

/// `x' = p + gap x - x^3`: two folds at `x = +-sqrt(gap/3)`.
struct TwoFolds(f64);

impl VectorField for TwoFolds {
    fn state_names(&self) -> Vec<String> {
        vec!["x".into()]
    }
    fn parameter_names(&self) -> Vec<String> {
        vec!["p".into()]
    }
    fn evaluate<T: Scalar>(&self, x: &[T], p: &[T], d: &mut [T]) {
        d[0] = p[0] + x[0] * self.0 - x[0].powi(3);
    }
}

/// A branch point at 0.5 and a Hopf point at `0.5 + gap`.
struct BranchAndHopf(f64);

impl VectorField for BranchAndHopf {
    fn state_names(&self) -> Vec<String> {
        ["x", "y", "z"].map(String::from).to_vec()
    }
    fn parameter_names(&self) -> Vec<String> {
        vec!["p".into()]
    }
    fn evaluate<T: Scalar>(&self, x: &[T], p: &[T], d: &mut [T]) {
        let growth = p[0] - (0.5 + self.0) - x[0] * x[0] - x[1] * x[1];
        d[0] = growth * x[0] - x[1] * 2.0;
        d[1] = x[0] * 2.0 + growth * x[1];
        d[2] = (p[0] - 0.5 - x[2]) * x[2];
    }
}

#[test]
fn two_special_points_in_one_step_are_both_found() {
    for gap in [1e-1, 1e-2, 1e-3, 1e-4, 1e-5] {
        let branch =
            Equilibria::of(&TwoHopfPoints(gap)).parameters(&[0.0]).along("p", 0.0..=1.0).run().unwrap();
        let found: Vec<f64> = branch.hopf_points().map(|hopf| hopf.value).collect();
        assert_eq!(kinds(&branch), ["HB1", "HB2"], "{gap}");
        for (value, expected) in found.iter().zip([0.5 - gap, 0.5 + gap]) {
            assert!((value - expected).abs() < 1e-14 / gap, "{gap} {value}");
        }

        let field = TwoFolds(gap);
        let branch = Equilibria::of(&field).start(&[-1.0]).parameters(&[-1.0]).along("p", -1.0..=1.0);
        let branch = branch.run().unwrap();
        assert_eq!(kinds(&branch), ["LP1", "LP2"], "{gap}");
        let expected = 2.0 * (gap / 3.0).powf(1.5);
        for (fold, expected) in branch.folds().zip([expected, -expected]) {
            assert!((fold.value - expected).abs() < 1e-14, "{gap}");
        }

        for sign in [1.0, -1.0] {
            let field = BranchAndHopf(sign * gap);
            let branch = Equilibria::of(&field).parameters(&[0.0]).along("p", 0.0..=1.0).run().unwrap();
            let expected = if sign > 0.0 { ["BP1", "HB1"] } else { ["HB1", "BP1"] };
            assert_eq!(kinds(&branch), expected, "{gap}");
            assert_relative_eq!(branch.branch_points().next().unwrap().value, 0.5, max_relative = 1e-12);
            let hopf = branch.hopf_points().next().unwrap();
            assert_relative_eq!(hopf.value, 0.5 + sign * gap, max_relative = 1e-12);
        }
    }
}

/// Two oscillators whose damping vanishes together at `p = 0`.
struct TwoAtOnce;

impl VectorField for TwoAtOnce {
    fn state_names(&self) -> Vec<String> {
        ["x1", "y1", "x2", "y2"].map(String::from).to_vec()
    }
    fn parameter_names(&self) -> Vec<String> {
        vec!["p".into()]
    }
    fn evaluate<T: Scalar>(&self, x: &[T], p: &[T], d: &mut [T]) {
        for (at, frequency) in [(0, 1.0), (2, 1.3)] {
            d[at] = x[at + 1];
            d[at + 1] = p[0] * (T::one() - x[at] * x[at]) * x[at + 1] - x[at] * frequency * frequency
                + (x[2 - at] - x[at]) * 0.2;
        }
    }
}

#[test]
fn pairs_that_cross_together_are_found_wherever_the_steps_fall() {
    for start in [-1.0, -1.03, -0.7, -0.512] {
        let branch = Equilibria::of(&TwoAtOnce).parameters(&[start]).along("p", start..=1.0).run().unwrap();
        assert_eq!(kinds(&branch), ["HB1", "HB2"], "{start}");
        for hopf in branch.hopf_points() {
            assert!(hopf.value.abs() < 1e-12, "{start}: {hopf:?}");
        }
    }
}

/// A Hopf point at `p = 0.3` beside an oscillation that is damped at the rate `.0` for every `p`.
struct HopfBesideRinging(f64);

impl VectorField for HopfBesideRinging {
    fn state_names(&self) -> Vec<String> {
        ["x", "y", "u", "v"].map(String::from).to_vec()
    }
    fn parameter_names(&self) -> Vec<String> {
        vec!["p".into()]
    }
    fn evaluate<T: Scalar>(&self, x: &[T], p: &[T], d: &mut [T]) {
        let growth = p[0] - 0.3 - x[0] * x[0] - x[1] * x[1];
        d[0] = growth * x[0] - x[1] * 2.0;
        d[1] = x[0] * 2.0 + growth * x[1];
        d[2] = x[3];
        d[3] = x[2] * -25.0 - x[3] * self.0 + x[0] * x[0];
    }
}

#[test]
fn a_ringing_mode_hides_no_hopf_point() {
    for damping in [0.0, 1e-9, 1e-6, -1e-6, 1e-3] {
        let branch = Equilibria::of(&HopfBesideRinging(damping))
            .parameters(&[0.0])
            .along("p", 0.0..=1.0)
            .run()
            .unwrap();
        assert_eq!(kinds(&branch), ["HB1"], "{damping}");
        let hopf = branch.hopf_points().next().unwrap();
        assert_relative_eq!(hopf.value, 0.3, max_relative = 1e-12);
        assert_relative_eq!(hopf.frequency, 2.0, max_relative = 1e-12);
    }
}
