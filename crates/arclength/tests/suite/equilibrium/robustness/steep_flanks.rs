//! Fields that are flat, to the last digit, where a branch starts, and steep elsewhere: the derivatives at the start say that nothing ever
//! changes, which is no reason to step over the flank.

use super::kinds;
use arclength::equilibrium::Equilibria;
use arclength::{Scalar, VectorField};
use proptest::prelude::*;

/// `x' = p - x + height / (1 + exp(-steepness (x - middle)))`, in a unit of the state, with a state `y` that follows.
#[derive(Debug, Clone)]
struct Flank {
    height: f64,
    steepness: f64,
    middle: f64,
    unit: f64,
}

impl VectorField for Flank {
    fn state_names(&self) -> Vec<String> {
        vec!["x".into(), "y".into()]
    }

    fn parameter_names(&self) -> Vec<String> {
        vec!["p".into()]
    }

    fn evaluate<T: Scalar>(&self, state: &[T], p: &[T], derivative: &mut [T]) {
        let x = state[0] / self.unit;
        let rise = ((x - self.middle) * (-self.steepness)).exp() + 1.0;
        derivative[0] = (p[0] - x + rise.recip() * self.height) * self.unit;
        derivative[1] = (x - state[1] / self.unit) * (2.0 * self.unit);
    }
}

impl Flank {
    /// The folds, at which the slope `height steepness s (1 - s)` is one, in the order in which they are met.
    fn folds(&self) -> [f64; 2] {
        let root = (0.25 - 1.0 / (self.height * self.steepness)).sqrt();
        [0.5 - root, 0.5 + root].map(|s| {
            let x = self.middle + (s / (1.0 - s)).ln() / self.steepness;
            x - self.height * s
        })
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(48))]

    #[test]
    fn both_folds_of_a_steep_flank_are_found(
        height in 0.1_f64..1.0,
        steepness in (20.0_f64.ln()..5e3_f64.ln()).prop_map(f64::exp),
        middle in -0.4_f64..0.9,
        unit in prop::sample::select(vec![1e-6, 1.0, 1e3]),
        start in prop::sample::select(vec![-1.0, -0.7, 2.0]),
    ) {
        prop_assume!(height * steepness > 5.0);
        let flank = Flank { height, steepness, middle, unit };
        prop_assume!(flank.folds().iter().all(|fold| (-0.99..1.99).contains(fold)));
        let first = if start > 0.0 { start + height } else { start };
        let branch = Equilibria::of(&flank)
            .start(&[first * unit, first * unit])
            .parameters(&[start])
            .along("p", -1.0..=2.0)
            .run()
            .unwrap();
        prop_assert!(branch.unlocated.is_empty(), "{:?}", branch.unlocated);
        // Between them the growing state and the one that follows may make neutral saddles.
        let others: Vec<String> = kinds(&branch).into_iter().filter(|kind| !kind.starts_with("NS")).collect();
        prop_assert!(others == ["LP1", "LP2"], "{others:?}");
        for (fold, right) in branch.folds().zip(flank.folds()) {
            prop_assert!((fold.value - right).abs() < 1e-10, "{} {right}", fold.value);
        }
    }
}
