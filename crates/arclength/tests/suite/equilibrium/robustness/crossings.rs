//! Branches that cross: a step does not lead from one to the other, however small the angle between them.

use arclength::continuation::Stop;
use arclength::equilibrium::{Equilibria, EquilibriumBranch};
use arclength::{Scalar, VectorField};
use proptest::prelude::*;

/// `x' = (x - a(p)) (x - b(p))` with `a`, `b` of the form `c0 + c1 p + c2 p^2 + c3 sin 3p`.
#[derive(Clone, Debug)]
struct Product(Vec<[f64; 4]>);

fn at<T: Scalar>(factor: &[f64; 4], p: T) -> T {
    p * factor[1] + p * p * factor[2] + (p * 3.0).sin() * factor[3] + factor[0]
}

impl VectorField for Product {
    fn state_names(&self) -> Vec<String> {
        vec!["x".into()]
    }
    fn parameter_names(&self) -> Vec<String> {
        vec!["p".into()]
    }
    fn evaluate<T: Scalar>(&self, x: &[T], p: &[T], d: &mut [T]) {
        d[0] = self.0.iter().fold(T::from(1.0), |product, factor| product * (x[0] - at(factor, p[0])));
    }
}

fn branch(field: &Product) -> EquilibriumBranch {
    let start = at(&field.0[0], -1.0);
    Equilibria::of(field).start(&[start]).parameters(&[-1.0]).along("p", -1.0..=1.0).run().unwrap()
}

/// Largest distance from the first factor's branch.
fn departure(field: &Product, branch: &EquilibriumBranch) -> f64 {
    let points = branch.points.iter();
    points.map(|point| (point.state[0] - at(&field.0[0], point.value)).abs()).fold(0.0, f64::max)
}

fn stays_on_its_branch(field: &Product, crossings: &[f64]) {
    let branch = branch(field);
    let off = departure(field, &branch);
    assert!(off < 1e-8, "{field:?}: {off}");
    assert!(matches!(branch.stops[1], Some(Stop::RangeEnd { value: 1.0, .. })), "{:?}", branch.stops);
    let found: Vec<f64> = branch.special_points().map(|special| special.value()).collect();
    assert_eq!(found.len(), crossings.len(), "{found:?}");
    for (found, exact) in found.iter().zip(crossings) {
        assert!((found - exact).abs() < 1e-9, "{found}, {exact}");
    }
}

#[test]
fn a_step_over_a_branch_point_stays_on_its_branch() {
    // The step landed on the other branch behind the branch point,
    let behind = Product(vec![[-1.3, 0.0, 1.0, -0.8], [-0.5, -1.1, 0.0, -1.4]]);
    stays_on_its_branch(&behind, &[0.268_448_503_781_437]);
    // before it, which made a degenerate branch point of the jump,
    let before = Product(vec![[0.0, 1.0, 1.0, 0.0], [0.0, 0.9, 0.6, 0.0]]);
    stays_on_its_branch(&before, &[-0.25, 0.0]);
    // and turned round there, which made a fold of it.
    let round = Product(vec![[-0.4, -0.9, -1.3, -0.3], [-0.2, 0.2, 1.2, 0.7]]);
    stays_on_its_branch(&round, &[-0.749_298_767_125, -0.050_474_956_731_9]);
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(300))]

    /// Crossings at angles of at least a tenth.
    #[test]
    fn random_crossings_are_passed(
        coefficients in prop::array::uniform4(-1.5..1.5_f64),
        place in -0.8..0.8_f64,
        slope in 0.2..2.0_f64,
    ) {
        let one = coefficients;
        // The other is a line beside it through one crossing.
        let other = [one[0] - slope * place, one[1] + slope, one[2], one[3]];
        stays_on_its_branch(&Product(vec![one, other]), &[place]);
    }
}
