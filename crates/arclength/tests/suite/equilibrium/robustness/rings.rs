//! Rings of equal cells, in which symmetry takes two real eigenvalues through zero at once: solutions are known to the root of rounding
//! there, and the signs of all test functions around are rounding.

use arclength::branch::SpecialKind;
use arclength::equilibrium::{Equilibria, EquilibriumBranch, SpecialPoint, equilibrium_settings};
use arclength::{Scalar, VectorField};
use proptest::prelude::*;

/// `cells` Brusselators with `a = 1` on a ring, which exchange what is in them: the first kind at the rate `d`, the second five times as
/// fast.
#[derive(Debug, Clone)]
struct Ring {
    cells: usize,
    exchange: f64,
}

impl VectorField for Ring {
    fn state_names(&self) -> Vec<String> {
        let names = |kind: char| (1..=self.cells).map(move |cell| format!("{kind}{cell}"));
        names('u').chain(names('v')).collect()
    }

    fn parameter_names(&self) -> Vec<String> {
        vec!["b".into()]
    }

    fn evaluate<T: Scalar>(&self, x: &[T], p: &[T], derivative: &mut [T]) {
        let n = self.cells;
        for cell in 0..n {
            let [before, after] = [(cell + n - 1) % n, (cell + 1) % n];
            let (u, v) = (x[cell], x[n + cell]);
            let spread = |kind: usize| x[kind * n + before] + x[kind * n + after] - x[kind * n + cell] * 2.0;
            let reaction = u * u * v;
            derivative[cell] = -(p[0] + 1.0) * u + reaction + 1.0 + spread(0) * self.exchange;
            derivative[n + cell] = p[0] * u - reaction + spread(1) * (5.0 * self.exchange);
        }
    }
}

impl Ring {
    /// Values of `b` at which the pattern with wave number `k` is born at `u = 1, v = b`: where the determinant of its block of the
    /// Jacobian, of which the exchange is `s = 2 d (1 - cos(2 pi k/n))`, is zero.
    fn births(&self, wave_number: usize) -> f64 {
        let angle = std::f64::consts::TAU * wave_number as f64 / self.cells as f64;
        let s = 2.0 * self.exchange * (1.0 - angle.cos());
        (1.0 + s) * (1.0 + 5.0 * s) / (5.0 * s)
    }

    fn branch(&self, finer: f64, [low, high]: [f64; 2]) -> EquilibriumBranch {
        let start = [vec![1.0; self.cells], vec![low; self.cells]].concat();
        let settings = equilibrium_settings();
        let settings = settings
            .initial_step(settings.initial_step / finer)
            .largest_step(settings.largest_step / finer)
            .largest_parameter_change(settings.largest_parameter_change / finer)
            .predictor_error(settings.predictor_error / (finer * finer));
        Equilibria::of(self)
            .start(&start)
            .parameters(&[low])
            .along("b", low..=high)
            .settings(settings)
            .run()
            .unwrap()
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(24))]

    #[test]
    fn a_double_branch_point_is_one_point_within_its_error(
        cells in 3_usize..6,
        exchange in 0.05_f64..0.3,
        finer in prop::sample::select(vec![1.0, 3.0, 10.0]),
    ) {
        let ring = Ring { cells, exchange };
        let births: Vec<f64> = (1..=(cells - 1) / 2).map(|wave_number| ring.births(wave_number)).collect();
        let separated = |pair: &[f64]| (pair[0] - pair[1]).abs() > 0.01;
        prop_assume!(births.windows(2).all(separated));
        let other = (cells % 2 == 0).then(|| ring.births(cells / 2));
        prop_assume!(births.iter().chain(&other).all(|birth| (0.6..8.0).contains(birth)));
        prop_assume!(births.iter().zip(other.iter().cycle()).all(|(one, two)| (one - two).abs() > 0.01));
        let branch = ring.branch(finer, [0.5, 8.0]);
        let special: Vec<&SpecialPoint> = branch.special_points().collect();
        prop_assert!(branch.unlocated.is_empty(), "{:?}", branch.unlocated);
        for special in &special {
            // Uniform oscillations are born at 2, others farther on.
            prop_assert!(special.kind() != SpecialKind::Fold, "{special:?}");
        }
        let found: Vec<(f64, f64)> = special
            .iter()
            .filter(|special| special.kind() == SpecialKind::BranchPoint)
            .map(|special| (special.value(), special.location_error()))
            .collect();
        prop_assert!(found.len() == births.len() + other.iter().len(), "{found:?} {births:?}");
        for birth in births.iter().chain(&other) {
            let near = found.iter().any(|(value, error)| (value - birth).abs() <= error.max(1e-12));
            prop_assert!(near, "{birth}: {found:?}");
        }
    }
}
