//! Curves of random fields.

use super::labels;
use arclength::branch::SpecialKind;
use arclength::continuation::Stop;
use arclength::equilibrium::Equilibria;
use arclength::locus::EquilibriumLocus;
use arclength::{Scalar, VectorField};
use proptest::prelude::*;

/// A random polynomial field of degree three with two parameters.
#[derive(Debug)]
struct Polynomial {
    dimension: usize,
    coefficients: Vec<f64>,
}

impl VectorField for Polynomial {
    fn state_names(&self) -> Vec<String> {
        (0..self.dimension).map(|index| format!("x{index}")).collect()
    }
    fn parameter_names(&self) -> Vec<String> {
        vec!["p".into(), "q".into()]
    }
    fn evaluate<T: Scalar>(&self, x: &[T], p: &[T], d: &mut [T]) {
        let n = self.dimension;
        let mut coefficients = self.coefficients.iter().copied();
        let mut next = || coefficients.next().unwrap_or(0.0);
        for row in 0..n {
            let mut sum = p[0] * next() + p[1] * next() + next() - x[row] * x[row] * x[row];
            for i in 0..n {
                sum += x[i] * next() + x[i] * p[0] * next() + x[i] * p[1] * next();
                for j in 0..n {
                    sum += x[i] * x[j] * next();
                }
            }
            d[row] = sum;
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(30))]

    #[test]
    fn curves_of_random_fields_run_to_their_ends(
        dimension in 1usize..5,
        coefficients in prop::collection::vec(-2.0..2.0f64, 4 * (3 + 4 * 7)),
    ) {
        let field = Polynomial { dimension, coefficients };
        let start = vec![0.3; dimension];
        let Ok(branch) = Equilibria::of(&field).start(&start).parameters(&[0.0; 2]).along("p", -1.0..=1.0).run() else {
            return Ok(());
        };
        let ask = || EquilibriumLocus::of(&field).along("p", -1.0..=1.0).and("q", -1.0..=1.0);
        let folds = branch.folds().take(1).map(|fold| ask().from_fold(fold));
        let curves = folds.chain(branch.hopf_points().take(1).map(|hopf| ask().from_hopf(hopf)));
        for curve in curves {
            let locus = curve.run().unwrap();
            for stop in locus.stops.iter().flatten() {
                prop_assert!(matches!(stop, Stop::RangeEnd { .. } | Stop::Closed), "{} {:?}", stop, labels(&locus));
            }
            for point in locus.special_points() {
                let largest = point.eigenvalues.iter().map(|value| value.norm()).fold(1.0, f64::max);
                let on_axis = point.eigenvalues.iter().filter(|value| value.re.abs() < 1e-5 * largest).count();
                let expected = match point.kind {
                    SpecialKind::Cusp => 1,
                    SpecialKind::BogdanovTakens | SpecialKind::GeneralizedHopf => 2,
                    SpecialKind::ZeroHopf => 3,
                    _ => 4,
                };
                prop_assert!(on_axis >= expected, "{:?}", point);
                prop_assert!(point.regular, "{:?}", point);
            }
            for pair in locus.points.windows(2) {
                let change = pair[0].values.iter().zip(pair[1].values).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
                prop_assert!(change < 0.3, "a jump of {}", change);
            }
        }
    }
}
