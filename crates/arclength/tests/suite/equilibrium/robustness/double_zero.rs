//! Two eigenvalues that come to zero together at a branch point or a fold: one special point, without coefficients.

use arclength::branch::SpecialKind;
use arclength::equilibrium::{Equilibria, EquilibriumBranch, SpecialPoint};
use arclength::{Scalar, VectorField};
use proptest::prelude::*;

/// `y1' = y2`, `y2' = p y1 + d p y2 + a y1^2 + b y1^3` (a branch point at 0) or `y2' = p + y1^2 + d y1 y2` (a fold at 0), beside
/// `y3' = p - c y3`, in coordinates `x` with `y = turned(x)`.
#[derive(Debug, Clone)]
struct DoubleZero {
    branches: bool,
    powers: [f64; 2],
    damping: f64,
    decay: f64,
    angles: [f64; 2],
}

impl VectorField for DoubleZero {
    fn state_names(&self) -> Vec<String> {
        ["x1", "x2", "x3"].map(String::from).to_vec()
    }

    fn parameter_names(&self) -> Vec<String> {
        vec!["p".into()]
    }

    fn evaluate<T: Scalar>(&self, x: &[T], p: &[T], derivative: &mut [T]) {
        let turn = |[a, b]: [T; 2], angle: f64| {
            let (sine, cosine) = angle.sin_cos();
            [a * cosine - b * sine, a * sine + b * cosine]
        };
        let [first, second] = self.angles;
        let [a, b] = turn([x[0], x[1]], first);
        let [b, c] = turn([b, x[2]], second);
        let inner = if self.branches {
            p[0] * a + p[0] * b * self.damping + a * a * self.powers[0] + a * a * a * self.powers[1]
        } else {
            p[0] + a * a + a * b * self.damping
        };
        let rates = [b, inner, p[0] - c * self.decay];
        let [middle, last] = turn([rates[1], rates[2]], -second);
        let [one, two] = turn([rates[0], middle], -first);
        derivative.copy_from_slice(&[one, two, last]);
    }
}

fn branch(field: &DoubleZero, [low, high]: [f64; 2]) -> EquilibriumBranch {
    let undone = |[a, b, c]: [f64; 3]| {
        let turn = |[a, b]: [f64; 2], angle: f64| {
            let (sine, cosine) = angle.sin_cos();
            [a * cosine - b * sine, a * sine + b * cosine]
        };
        let [b, c] = turn([b, c], -field.angles[1]);
        let [a, b] = turn([a, b], -field.angles[0]);
        [a, b, c]
    };
    let resting = if field.branches { 0.0 } else { (-low).sqrt() };
    Equilibria::of(field)
        .start(&undone([resting, 0.0, low / field.decay]))
        .parameters(&[low])
        .along("p", low..=high)
        .run()
        .unwrap()
}

/// Labels near 0 of what is more than a point on the way.
fn kinds_near_zero(branch: &EquilibriumBranch) -> Vec<SpecialKind> {
    let near = branch.points.iter().filter(|point| point.value.abs() < 0.05);
    near.filter_map(|point| Some(point.label?.kind)).collect()
}

fn angles() -> impl Strategy<Value = [f64; 2]> {
    [-3.0..3.0_f64, -3.0..3.0_f64]
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(200))]

    #[test]
    fn a_branch_point(
        powers in prop::sample::select(vec![[0.0, 0.0], [1.0, 0.0], [0.0, -1.0], [0.0, 2.0], [-0.3, 1.0]]),
        damping in -0.5..0.5_f64,
        decay in 0.7..50.0_f64,
        angles in angles(),
        ends in [-9.0..-0.2_f64, 0.2..9.0_f64],
    ) {
        let field = DoubleZero { branches: true, powers, damping, decay, angles };
        let branch = branch(&field, ends);
        prop_assert_eq!(kinds_near_zero(&branch), [SpecialKind::BranchPoint]);
        prop_assert!(branch.unlocated.is_empty(), "{:?}", branch.unlocated);
        let special = branch.points.iter().find_map(|point| match point.special.as_deref() {
            Some(SpecialPoint::BranchPoint(point)) => Some(point),
            _ => None,
        });
        let point = special.unwrap();
        prop_assert!(point.value.abs() < 1e-9, "{}", point.value);
        prop_assert_eq!((point.quadratic, point.mixed, point.cubic), (None, None, None));
    }

    #[test]
    fn a_fold(
        damping in prop::sample::select(vec![-1.0, -0.2, 0.3, 2.0]),
        decay in 1.5..50.0_f64,
        angles in angles(),
        low in -9.0..-0.2_f64,
    ) {
        let field = DoubleZero { branches: false, powers: [0.0; 2], damping, decay, angles };
        let branch = branch(&field, [low, 0.5]);
        prop_assert_eq!(kinds_near_zero(&branch), [SpecialKind::Fold]);
        let special = branch.points.iter().find_map(|point| match point.special.as_deref() {
            Some(SpecialPoint::Fold(point)) => Some(point),
            _ => None,
        });
        let point = special.unwrap();
        prop_assert!(point.value.abs() < 1e-9, "{}", point.value);
        prop_assert_eq!(point.quadratic, None);
    }
}
