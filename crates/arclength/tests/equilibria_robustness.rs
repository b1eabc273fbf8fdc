//! Branches of equilibria that are hard to follow: units, close special points, degenerate fields, random fields.

use approx::assert_relative_eq;
use arclength::branch::Stability;
use arclength::continuation::Stop;
use arclength::equilibrium::{Equilibria, EquilibriumBranch, SpecialPoint, find_equilibrium};
use arclength::linear::eigenvalues::eigenvalues;
use arclength::{Dual, Error, Scalar, VectorField};
use proptest::prelude::*;

#[macro_use]
#[path = "common/field.rs"]
mod field;

fn kinds(branch: &EquilibriumBranch) -> Vec<String> {
    branch.points.iter().filter_map(|point| Some(point.label?.to_string())).collect()
}

/// The chemical reaction of AUTO's demo `ab` in other units.
struct Reaction {
    units: [f64; 2],
    parameter_unit: f64,
    time_unit: f64,
}

impl VectorField for Reaction {
    fn state_names(&self) -> Vec<String> {
        vec!["conversion".into(), "temperature".into()]
    }
    fn parameter_names(&self) -> Vec<String> {
        vec!["D".into()]
    }
    fn evaluate<T: Scalar>(&self, x: &[T], p: &[T], d: &mut [T]) {
        let (conversion, temperature) = (x[0] / self.units[0], x[1] / self.units[1]);
        let rate = p[0] / self.parameter_unit * (-conversion + 1.0) * temperature.exp();
        d[0] = (rate - conversion) * (self.units[0] / self.time_unit);
        d[1] = (rate * 18.0 - temperature * 4.0) * (self.units[1] / self.time_unit);
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(24))]

    #[test]
    fn units_do_not_matter(exponents in prop::collection::vec(-9.0..9.0f64, 4)) {
        let run = |exponents: &[f64]| {
            let field = Reaction {
                units: [10f64.powf(exponents[0]), 10f64.powf(exponents[1])],
                parameter_unit: 10f64.powf(exponents[2]),
                time_unit: 10f64.powf(exponents[3]),
            };
            let range = 0.0..=0.4 * field.parameter_unit;
            Equilibria::of(&field).parameters(&[0.0]).along("D", range).run().unwrap()
        };
        let (reference, scaled) = (run(&[0.0; 4]), run(&exponents));
        prop_assert_eq!(kinds(&reference), ["HB1", "LP1", "LP2", "HB2"]);
        prop_assert_eq!(kinds(&scaled), kinds(&reference));
        prop_assert!(scaled.points.len().abs_diff(reference.points.len()) < 3);
        for (one, other) in reference.special_points().zip(scaled.special_points()) {
            let ratio = other.value() / (one.value() * 10f64.powf(exponents[2]));
            prop_assert!((ratio - 1.0).abs() < 1e-12);
        }
    }
}

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

field!(ZeroHopf, ["x", "y", "z"], ["p"], |x, p, d| {
    let growth = p[0] + x[2] * 0.5;
    d[0] = growth * x[0] - x[1];
    d[1] = x[0] + growth * x[1];
    d[2] = p[0] - x[2] * x[2] - x[0] * x[0] - x[1] * x[1];
});

field!(Pendulum, ["angle", "rate"], ["p"], |x, p, d| {
    d[0] = x[1];
    d[1] = p[0] - x[0].sin();
});

field!(Circle, ["x"], ["p"], |x, p, d| {
    d[0] = p[0] * p[0] + x[0] * x[0] - 1.0;
});

field!(Explosion, ["x"], ["p"], |x, p, d| {
    d[0] = p[0] * p[0] + x[0] * x[0] + 1.0;
});

field!(Arctangent, ["x"], ["p"], |x, p, d| {
    d[0] = p[0] - x[0].atan();
});

field!(Root, ["x"], ["p"], |x, p, d| {
    d[0] = p[0] - x[0].sqrt();
});

field!(Pitchfork, ["x", "y"], ["p"], |x, p, d| {
    d[0] = p[0] * x[0] - x[0].powi(3) + x[1] * x[0];
    d[1] = -x[1];
});

#[test]
fn a_zero_hopf_point_on_the_way_is_survived() {
    let branch = Equilibria::of(&ZeroHopf).start(&[0.0, 0.0, 1.0]).parameters(&[1.0]).along("p", -1.0..=1.0);
    let branch = branch.run().unwrap();
    assert!(branch.folds().any(|fold| fold.value.abs() < 1e-10) || branch.special_points().count() > 0);
    assert!(branch.points.iter().all(|point| point.state.iter().all(|entry| entry.is_finite())));
}

#[test]
fn centres_are_neither_stable_nor_hopf_points() {
    let branch = Equilibria::of(&Pendulum).parameters(&[0.0]).along("p", -2.0..=2.0).run().unwrap();
    assert!(branch.hopf_points().next().is_none());
    for point in branch.points.iter().filter(|point| point.state[0].cos() > 0.1) {
        assert_eq!(point.stability, Stability::Undecided);
    }
    let folds: Vec<_> = branch.folds().collect();
    assert!(folds.iter().all(|fold| (fold.value.abs() - 1.0).abs() < 1e-12));
    assert!(folds.len() > 1);
}

/// Wherever on the circle it starts: on a fold, next to it before or behind it, or far from it.
#[test]
fn a_closed_branch_ends_after_one_lap() {
    for angle in [0.0, 1e-6, -1e-6, 1e-3, -1e-3, 0.04, -0.04, 1.0, 2.0, 3.0, 3.1, -3.1, std::f64::consts::PI]
    {
        let (state, parameter) = (f64::sin(angle), f64::cos(angle));
        let branch = Equilibria::of(&Circle)
            .start(&[state])
            .parameters(&[parameter])
            .along("p", -2.0..=2.0)
            .run()
            .unwrap();
        assert!(
            matches!(branch.stops[1], Some(Stop::Closed)) && matches!(branch.stops[0], Some(Stop::Closed))
        );
        let folds: Vec<f64> = branch.folds().map(|fold| fold.value).collect();
        assert_eq!(folds.len(), 2, "{angle}: {folds:?}");
        assert_relative_eq!(folds[0] * folds[1], -1.0, epsilon = 1e-12);
        assert_eq!(kinds(&branch).len(), 2);
        let length: f64 = branch
            .points
            .windows(2)
            .map(|pair| (pair[1].value - pair[0].value).hypot(pair[1].state[0] - pair[0].state[0]))
            .sum();
        assert!((length - std::f64::consts::TAU).abs() < 0.02, "{angle}: {length}");
    }
}

#[test]
fn both_branches_of_a_pitchfork_are_found_from_either() {
    let branch = Equilibria::of(&Pitchfork).parameters(&[-1.0]).along("p", -1.0..=0.9).run().unwrap();
    assert_eq!(kinds(&branch), ["BP1"]);
    let side = Equilibria::of(&Pitchfork)
        .start(&[1.0, 0.0])
        .parameters(&[1.0])
        .along("p", -1.0..=2.0)
        .run()
        .unwrap();
    assert_eq!(kinds(&side), ["BP1"], "the turning branch has no fold at the pitchfork");
    let point = side.branch_points().next().unwrap();
    assert!(point.value.abs() < 1e-14);
    let back = Equilibria::of(&Pitchfork).from_branch_point(point).along("p", -1.0..=2.0).run().unwrap();
    assert!(back.points.iter().all(|point| point.state[0] == 0.0));
    assert_eq!((back.points[0].value, back.points[back.points.len() - 1].value), (-1.0, 2.0));
}

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

/// The Brusselator in a row of cells with closed ends, or in a ring, both species diffusing equally fast: as many Hopf points
/// as cells.
struct Cells {
    count: usize,
    ring: bool,
}

impl VectorField for Cells {
    fn state_names(&self) -> Vec<String> {
        (0..2 * self.count)
            .map(|index| format!("{}{}", if index % 2 == 0 { "x" } else { "y" }, index / 2))
            .collect()
    }
    fn parameter_names(&self) -> Vec<String> {
        vec!["b".into(), "diffusion".into()]
    }
    fn evaluate<T: Scalar>(&self, x: &[T], p: &[T], d: &mut [T]) {
        for cell in 0..self.count {
            let (one, other) = (x[2 * cell], x[2 * cell + 1]);
            let square = one * one * other;
            d[2 * cell] = -(p[0] + 1.0) * one + square + 1.0;
            d[2 * cell + 1] = p[0] * one - square;
            let left = if cell > 0 { Some(cell - 1) } else { self.ring.then_some(self.count - 1) };
            let right = if cell + 1 < self.count { Some(cell + 1) } else { self.ring.then_some(0) };
            for neighbour in left.into_iter().chain(right) {
                d[2 * cell] += p[1] * (x[2 * neighbour] - one);
                d[2 * cell + 1] += p[1] * (x[2 * neighbour + 1] - other);
            }
        }
    }
}

#[test]
fn every_mode_of_a_row_of_cells_has_its_hopf_point() {
    let (cells, diffusion) = (12, 0.4);
    let field = Cells { count: cells, ring: false };
    let branch = Equilibria::of(&field).start(&[1.0; 24]).parameters(&[1.5, diffusion]).along("b", 1.5..=6.0);
    let branch = branch.run().unwrap();
    let found: Vec<f64> = branch.hopf_points().map(|hopf| hopf.value).collect();
    // Mode m decays with rate mu = 4 sin^2(pi m/(2 cells)) times the diffusion; its trace vanishes at b = 2 + 2 mu, where the
    // determinant 1 - mu^2 is positive for slow modes.
    let rate = |mode: usize| {
        4.0 * diffusion * (std::f64::consts::PI * mode as f64 / (2 * cells) as f64).sin().powi(2)
    };
    let expected: Vec<f64> = (0..cells).map(rate).filter(|mu| *mu < 1.0).map(|mu| 2.0 + 2.0 * mu).collect();
    assert_eq!(found.len(), expected.len(), "{found:?} {expected:?}");
    for (value, expected) in found.iter().zip(expected) {
        assert_relative_eq!(*value, expected, max_relative = 1e-11);
    }
}

#[test]
fn hopf_points_that_symmetry_makes_double_are_reported() {
    let field = Cells { count: 4, ring: true };
    let branch =
        Equilibria::of(&field).start(&[1.0; 8]).parameters(&[1.5, 0.1]).along("b", 1.5..=3.0).run().unwrap();
    // Modes 0, 1, 1, 2 with the rates 0, 2, 2, 4 times the diffusion.
    assert_eq!(kinds(&branch), ["HB1", "HB2", "HB3"]);
    let found: Vec<_> = branch.special_points().collect();
    for (special, expected) in found.iter().zip([2.0, 2.4, 2.8]) {
        assert!((special.value() - expected).abs() < 1e-9, "{special:?}");
    }
    assert!(matches!(found[1], SpecialPoint::Degenerate { location_error, .. } if *location_error < 1e-9));
    assert_eq!(branch.points[0].stability, Stability::Stable);
    assert_eq!(branch.points[branch.points.len() - 1].stability, Stability::Unstable { dimension: 8 });
}

/// Three equal cells, each coupled with the others: eigenvalues `p` and twice `p - 3 k`.
struct Triangle(f64);

impl VectorField for Triangle {
    fn state_names(&self) -> Vec<String> {
        ["x", "y", "z"].map(String::from).to_vec()
    }
    fn parameter_names(&self) -> Vec<String> {
        vec!["p".into()]
    }
    fn evaluate<T: Scalar>(&self, x: &[T], p: &[T], d: &mut [T]) {
        for cell in 0..3 {
            let others = x[(cell + 1) % 3] + x[(cell + 2) % 3] - x[cell] * 2.0;
            d[cell] = x[cell] * p[0] - x[cell].powi(3) + others * self.0;
        }
    }
}

#[test]
fn two_real_eigenvalues_that_vanish_together_are_no_hopf_point() {
    for coupling in [0.05, 0.1, 0.2, 0.3, 0.4, 0.6] {
        let field = Triangle(coupling);
        let run = Equilibria::of(&field).start(&[0.0; 3]).parameters(&[-1.0]).along("p", -1.0..=2.0).run();
        let branch = run.unwrap();
        let labels = kinds(&branch);
        assert!(labels.iter().all(|label| !label.starts_with("HB")), "{coupling}: {labels:?}");
        let near =
            |value: f64| branch.special_points().filter(|point| (point.value() - value).abs() < 1e-9).count();
        assert_eq!((near(0.0), near(3.0 * coupling)), (1, 1), "{coupling}: {labels:?}");
        assert_eq!(branch.points[branch.points.len() - 1].stability, Stability::Unstable { dimension: 3 });
    }
}

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
