//! Random fields lose no special point, nor those whose branches nearly meet.

use super::kinds;
use approx::assert_relative_eq;
use arclength::continuation::Stop;
use arclength::equilibrium::{Equilibria, SpecialPoint};
use arclength::linear::eigenvalues::eigenvalues;
use arclength::{Dual, Scalar, VectorField};
use proptest::prelude::*;

/// A random polynomial field of degree three.
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
        vec!["p".into()]
    }
    fn evaluate<T: Scalar>(&self, x: &[T], p: &[T], d: &mut [T]) {
        let n = self.dimension;
        let mut coefficients = self.coefficients.iter().copied();
        let mut next = || coefficients.next().unwrap_or(0.0);
        for row in 0..n {
            let mut sum = p[0] * next() + next() - x[row] * x[row] * x[row];
            for i in 0..n {
                sum += x[i] * next() + x[i] * p[0] * next();
                for j in 0..n {
                    sum += x[i] * x[j] * next();
                }
            }
            d[row] = sum;
        }
    }
}

fn spectrum(field: &Polynomial, state: &[f64], parameter: f64) -> Vec<num_complex::Complex64> {
    let n = field.dimension;
    let mut matrix = vec![0.0; n * n];
    for column in 0..n {
        let mut lifted: Vec<Dual<f64, 1>> = state.iter().map(|&value| Dual::constant(value)).collect();
        lifted[column] = Dual::variable(state[column], 0);
        let mut image = vec![Dual::constant(0.0); n];
        field.evaluate(&lifted, &[Dual::constant(parameter)], &mut image);
        for (row, value) in image.iter().enumerate() {
            matrix[row + n * column] = value.derivatives[0];
        }
    }
    eigenvalues(&matrix, n).unwrap()
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(60))]

    #[test]
    fn random_fields_lose_no_special_point(
        dimension in 1usize..5,
        coefficients in prop::collection::vec(-2.0..2.0f64, 4 * (2 + 4 * 6)),
    ) {
        let field = Polynomial { dimension, coefficients };
        let start = vec![0.3; dimension];
        let Ok(branch) = Equilibria::of(&field).start(&start).parameters(&[0.0]).along("p", -2.0..=2.0).run() else {
            return Ok(());
        };
        for stop in branch.stops.iter().flatten() {
            prop_assert!(matches!(stop, Stop::RangeEnd { .. } | Stop::Closed), "{:?}", stop);
        }
        let mut regular: Option<(usize, usize)> = None;
        for (index, point) in branch.points.iter().enumerate() {
            let values = spectrum(&field, &point.state, point.value);
            let largest = values.iter().map(|value| value.norm()).fold(1.0, f64::max);
            match point.special.as_deref() {
                Some(SpecialPoint::Fold(_) | SpecialPoint::BranchPoint(_)) => {
                    let least = values.iter().map(|value| value.norm()).fold(f64::INFINITY, f64::min);
                    prop_assert!(least < 1e-9 * largest, "{:?} {:?}", point.special, values);
                }
                Some(SpecialPoint::Hopf(hopf)) => {
                    let found = values.iter().any(|value| {
                        value.re.abs() < 1e-9 * largest && (value.im - hopf.frequency).abs() < 1e-9 * largest
                    });
                    prop_assert!(found, "{:?} {:?}", hopf, values);
                }
                Some(SpecialPoint::NeutralSaddle(saddle)) => {
                    let near = |sign: f64| values.iter().any(|value| {
                        value.im == 0.0 && (value.re - sign * saddle.eigenvalue).abs() < 1e-8 * largest
                    });
                    prop_assert!(near(1.0) && near(-1.0), "{:?} {:?}", saddle, values);
                }
                Some(SpecialPoint::Degenerate { .. }) => prop_assert!(false, "{:?}", point),
                None => {
                    // Between regular neighbours without a special point the number of unstable eigenvalues is the same.
                    let unstable = point.stability.unstable_dimension();
                    if let (Some((before, count)), Some(unstable)) = (regular, unstable)
                        && before + 1 == index
                    {
                        prop_assert_eq!(count, unstable, "between points {} and {}", before, index);
                    }
                    regular = unstable.map(|unstable| (index, unstable));
                }
            }
        }
    }
}

/// Two branches pass each other so closely that a step leads from one to the other: none of them has a branch point.
#[test]
fn branches_that_pass_each_other_closely_are_told_apart() {
    let coefficients = [
        -1.9074235995883173,
        -0.699464759864915,
        -1.5641848636893616,
        1.3328961579178547,
        -1.9509314304711056,
        0.5523640341704192,
        -1.9917973542497072,
        -1.960599467783581,
        0.4562250116582117,
        1.4334043275794528,
        0.9126585359546365,
        0.3435030717737226,
        0.500982231420059,
        -0.5738345830999323,
        -0.270291045140513,
        -1.3736343768839636,
        1.207477369104842,
        -0.4675772352177823,
        0.4981840613230374,
        -0.2262323227419247,
    ];
    let field = Polynomial { dimension: 2, coefficients: coefficients.to_vec() };
    let branch =
        Equilibria::of(&field).start(&[0.3; 2]).parameters(&[0.0]).along("p", -2.0..=2.0).run().unwrap();
    assert_eq!(kinds(&branch), ["HB1", "HB2", "LP1", "LP2"]);
    // The second fold is where the other branch passes.
    let folds: Vec<f64> = branch.folds().map(|fold| fold.value).collect();
    assert_relative_eq!(folds[1], -0.137595554245, epsilon = 1e-12);
    // The closer they pass, the shorter the steps have to be.
    for gap in [1e-2, 1e-4, 1e-6, 1e-7] {
        let field = NearlyMeeting(gap);
        let branch =
            Equilibria::of(&field).start(&[-1.0]).parameters(&[-1.0]).along("p", -1.0..=1.0).run().unwrap();
        assert_eq!(kinds(&branch), ["LP1"], "{gap}");
        assert!((branch.folds().next().unwrap().value + 2.0 * gap.sqrt()).abs() < 1e-12);
    }
}

/// `x' = x (p - x) - gap`: two branches that meet only at `gap = 0`, turning at `p^2 = 4 gap`.
struct NearlyMeeting(f64);

impl VectorField for NearlyMeeting {
    fn state_names(&self) -> Vec<String> {
        vec!["x".into()]
    }
    fn parameter_names(&self) -> Vec<String> {
        vec!["p".into()]
    }
    fn evaluate<T: Scalar>(&self, x: &[T], p: &[T], d: &mut [T]) {
        d[0] = x[0] * (p[0] - x[0]) - self.0;
    }
}
