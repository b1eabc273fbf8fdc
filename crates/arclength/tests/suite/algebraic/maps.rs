//! Fixed points of maps, their folds and period doublings, followed from outside the crate and against closed forms.

#[path = "../../../examples/map.rs"]
#[allow(missing_docs)]
mod example;

use approx::assert_relative_eq;
use arclength::algebraic::{AlgebraicCurve, AlgebraicPoint, AlgebraicProblem, solve_square};
use arclength::branch::SpecialKind;
use arclength::continuation::events::{Spectrum, TestFunction};
use arclength::continuation::{Bound, Followed, Origin, Request, Settings, Solution, follow};
use arclength::linear::eigenvalues::eigenvalues;
use arclength::linear::eigenvectors::right_eigenvector;
use arclength::{Dual, Error, Scalar};
use num_complex::Complex64;
use proptest::prelude::*;
use std::convert::Infallible;
use std::ops::ControlFlow;

#[test]
fn the_logistic_map_doubles_its_period_at_three() {
    let [[x, a]] = example::period_doublings(1, [0.6, 2.5]).expect("a branch")[..] else {
        panic!("not one period doubling")
    };
    assert_relative_eq!(a, 3.0, max_relative = 1e-15);
    assert_relative_eq!(x, 2.0 / 3.0, max_relative = 1e-15);
}

#[test]
fn the_cycle_of_period_two_does_so_at_one_plus_the_root_of_six() {
    let points =
        |a: f64| [1.0, -1.0].map(|sign| (a + 1.0 + sign * ((a - 3.0) * (a + 1.0)).sqrt()) / (2.0 * a));
    for start in points(3.2) {
        let found = example::period_doublings(2, [start, 3.2]).expect("a branch");
        let [[x, a]] = found[..] else { panic!("not one period doubling: {found:?}") };
        assert_relative_eq!(a, 1.0 + 6.0_f64.sqrt(), max_relative = 1e-15);
        assert!(points(a).iter().any(|exact| (x - exact).abs() < 1e-14), "{x}");
    }
}

#[test]
fn what_does_not_fit_is_refused() {
    let map = || FixedPoints(Henon { b: 0.3 });
    let refused = |scales: &[f64]| AlgebraicCurve::new(map(), scales).err().expect("refused").to_string();
    assert!(refused(&[1.0, 1.0]).contains("2 numbers"));
    assert!(refused(&[1.0, 0.0, 1.0]).contains("positive"));
    let alone = AlgebraicCurve::new(PeriodDoublings(Henon { b: 0.3 }), &[1.0; 5]).err();
    assert!(alone.expect("refused").to_string().contains("one fewer"));
    let curve = solve_square(&map(), &[0.6, 0.2, 1.0], &[1.0; 3]).err();
    assert!(curve.expect("refused").to_string().contains("equations"));
}

/// A map of `N` states with one parameter.
trait Map<const N: usize>: Clone {
    fn image<T: Scalar>(&self, state: &[T], parameter: T) -> [T; N];
}

/// `f(x, p) - x = 0`.
struct FixedPoints<M, const N: usize>(M);

impl<M: Map<N>, const N: usize> AlgebraicProblem for FixedPoints<M, N> {
    fn unknowns(&self) -> usize {
        N + 1
    }
    fn equations(&self) -> usize {
        N
    }
    fn evaluate<T: Scalar>(&self, unknown: &[T], residual: &mut [T]) {
        let image = self.0.image(&unknown[..N], unknown[N]);
        for ((value, image), &state) in residual.iter_mut().zip(image).zip(unknown) {
            *value = image - state;
        }
    }
}

/// `f(x, p) - x = 0`, `f_x v + v = 0`, `v . v = 1` with the unknowns `(x, v, p)`.
struct PeriodDoublings<M, const N: usize>(M);

impl<M: Map<N>, const N: usize> AlgebraicProblem for PeriodDoublings<M, N> {
    fn unknowns(&self) -> usize {
        2 * N + 1
    }
    fn equations(&self) -> usize {
        2 * N + 1
    }
    fn evaluate<T: Scalar>(&self, unknown: &[T], residual: &mut [T]) {
        let (state, vector) = (&unknown[..N], &unknown[N..2 * N]);
        let along = |(&value, &slope): (&T, &T)| Dual { value, derivatives: [slope] };
        let lifted: Vec<Dual<T, 1>> = state.iter().zip(vector).map(along).collect();
        let image = self.0.image(&lifted, Dual::constant(unknown[2 * N]));
        for index in 0..N {
            residual[index] = image[index].value - state[index];
            residual[N + index] = image[index].derivatives[0] + vector[index];
        }
        residual[2 * N] = vector.iter().map(|&entry| entry * entry).sum::<T>() - 1.0;
    }
}

/// `f_x` from the linearisation of `f(x, p) - x`.
fn derivative<const N: usize>(jacobian: &[f64]) -> Vec<f64> {
    let mut matrix = jacobian[..N * N].to_vec();
    matrix.iter_mut().step_by(N + 1).for_each(|entry| *entry += 1.0);
    matrix
}

fn multipliers<const N: usize>(jacobian: &[f64]) -> Vec<Complex64> {
    eigenvalues(&derivative::<N>(jacobian), N).expect("finite")
}

/// Logarithms of the multipliers.
fn growth<const N: usize>(jacobian: &[f64]) -> Spectrum {
    let multipliers = multipliers::<N>(jacobian);
    let exponents: Vec<_> = multipliers.iter().map(|multiplier| multiplier.ln()).collect();
    let unstable = exponents.iter().filter(|exponent| exponent.re > 0.0).count();
    let decided = exponents.iter().all(|exponent| exponent.re.abs() > 1e-9);
    Spectrum { exponents, unstable, decided, noise: 1e-12, is_periodic: true }
}

/// Product of `1 + mu` over the multipliers: the determinant of `1 + f_x`.
fn doubling_test<const N: usize>(at: &Solution<AlgebraicPoint>) -> f64 {
    let factors = multipliers::<N>(&at.point.jacobian).into_iter().map(|multiplier| multiplier + 1.0);
    factors.product::<Complex64>().re
}

fn locate_doubling<M: Map<N>, const N: usize>(
    map: &M,
    near: &Solution<AlgebraicPoint>,
) -> Result<Vec<f64>, Error> {
    let matrix = derivative::<N>(&near.point.jacobian);
    let critical = multipliers::<N>(&near.point.jacobian)
        .into_iter()
        .min_by(|one, other| (one + 1.0).norm().total_cmp(&(other + 1.0).norm()))
        .expect("a multiplier");
    let vector = right_eigenvector(&matrix, N, critical).expect("finite").vector;
    let mut start = near.unknown[..N].to_vec();
    start.extend(vector.iter().map(|entry| entry.re));
    start.push(near.unknown[N]);
    let solved = solve_square(&PeriodDoublings(map.clone()), &start, &vec![1.0; 2 * N + 1])?;
    Ok([&solved.unknown[..N], &solved.unknown[2 * N..]].concat())
}

/// What is found along a curve of fixed points.
type Branch = Followed<AlgebraicPoint, SpecialKind, Infallible>;

/// Fixed points from `start` (state and parameter) in the direction `ahead` of the parameter, or of its decrease.
fn fixed_points<M: Map<N>, const N: usize>(
    map: &M,
    start: Vec<f64>,
    ahead: f64,
    [lower, upper]: [f64; 2],
) -> Branch {
    let mut scales = vec![1.0; N];
    scales.push(upper - lower);
    let doubling = TestFunction::new(SpecialKind::PeriodDoubling).changing(&[1]);
    let mut curve = AlgebraicCurve::new(FixedPoints(map.clone()), &scales)
        .expect("fits")
        .test_function(doubling, doubling_test::<N>, |near| locate_doubling(map, near))
        .spectrum(|jacobian| Ok(growth::<N>(jacobian)));
    let request = Request::within(&[Bound { from_end: 1, lower, upper }], Settings::default());
    let mut tangent = vec![0.0; N + 1];
    tangent[N] = ahead;
    follow(&mut curve, start, tangent, &request, &mut |_, _| ControlFlow::Continue(())).expect("a branch")
}

/// The unknowns at the special points of a kind; nothing may have been noticed and not located.
fn located(branch: &Branch, kind: SpecialKind) -> impl Iterator<Item = &[f64]> {
    assert!(branch.unlocated.is_empty(), "{:?}", branch.unlocated);
    let special = branch.solutions.iter().filter(move |(_, origin)| *origin == Origin::Special(kind));
    special.map(|(solution, _)| solution.unknown.as_slice())
}

/// The logistic map `x -> a x (1 - x)`.
#[derive(Clone)]
struct Logistic;

impl Map<1> for Logistic {
    fn image<T: Scalar>(&self, state: &[T], a: T) -> [T; 1] {
        [a * state[0] * (-state[0] + 1.0)]
    }
}

#[test]
fn a_branch_point_is_noticed() {
    // The fixed points x = 0 and x = 1 - 1 / a cross at a = 1.
    let branch = fixed_points(&Logistic, vec![0.0, 0.5], 1.0, [0.0, 1.7]);
    // By the orientation and by the number of unstable multipliers.
    let kinds: Vec<_> = branch.unlocated.iter().map(|change| change.kind).collect();
    assert_eq!(kinds, [Some(SpecialKind::BranchPoint), None]);
    for change in &branch.unlocated {
        assert!(change.between[0][0] < 1.0 && change.between[1][0] > 1.0, "{change:?}");
    }
    let end = branch.solutions.last().expect("a solution");
    assert_eq!(end.0.unknown, [0.0, 1.7]);
}

/// The Hénon map `(x, y) -> (1 - a x^2 + y, b x)` along `a`.
#[derive(Clone)]
struct Henon {
    b: f64,
}

impl Map<2> for Henon {
    fn image<T: Scalar>(&self, state: &[T], a: T) -> [T; 2] {
        [state[1] - a * state[0] * state[0] + 1.0, state[0] * self.b]
    }
}

#[test]
fn folds_and_period_doublings_of_the_henon_map() {
    for b in [-0.8, -0.3, 0.0, 0.3, 0.9] {
        // The fixed points are a x^2 + (1 - b) x = 1, their multipliers mu^2 + 2 a x mu = b.
        let loss = 1.0 - b;
        let fixed = |a: f64| 2.0 / (loss + (loss * loss + 4.0 * a).sqrt());
        let square = loss * loss;
        let start = |a: f64| vec![fixed(a), b * fixed(a), a];
        let branch = fixed_points(&Henon { b }, start(0.1 * square), 1.0, [0.0, 4.0]);
        let doublings: Vec<&[f64]> = located(&branch, SpecialKind::PeriodDoubling).collect();
        assert_eq!(doublings.len(), 1, "{b}");
        let a = 0.75 * square;
        assert_relative_eq!(doublings[0][2], a, max_relative = 1e-14);
        assert_relative_eq!(doublings[0][0], loss / (2.0 * a), max_relative = 1e-14);
        let branch = fixed_points(&Henon { b }, start(-0.1 * square), -1.0, [-square, -1e-2 * square]);
        let folds: Vec<&[f64]> = located(&branch, SpecialKind::Fold).collect();
        assert_eq!(folds.len(), 1, "{b}");
        assert_relative_eq!(folds[0][2], -0.25 * square, max_relative = 1e-14);
        assert_relative_eq!(folds[0][0], 2.0 / loss, max_relative = 1e-7);
    }
}

/// `(x, y) -> (p + g(x), b y + x^2)` in turned coordinates, `g` a polynomial: fixed points at `p = x - g(x)`, with the
/// multipliers `g'(x)` and `b`.
#[derive(Clone, Debug)]
struct Turned {
    /// Coefficients of `g`, the constant one first.
    coefficients: Vec<f64>,
    b: f64,
    angle: f64,
}

impl Turned {
    fn polynomial<T: Scalar>(&self, x: T) -> T {
        self.coefficients.iter().rev().fold(T::zero(), |sum, coefficient| sum * x + *coefficient)
    }

    fn fixed_point(&self, x: f64) -> Vec<f64> {
        let y = x * x / (1.0 - self.b);
        let (sine, cosine) = self.angle.sin_cos();
        vec![cosine * x - sine * y, sine * x + cosine * y, x - self.polynomial(x)]
    }

    /// `x` of a fixed point.
    fn first(&self, unknown: &[f64]) -> f64 {
        let (sine, cosine) = self.angle.sin_cos();
        cosine * unknown[0] + sine * unknown[1]
    }
}

impl Map<2> for Turned {
    fn image<T: Scalar>(&self, state: &[T], parameter: T) -> [T; 2] {
        let (sine, cosine) = self.angle.sin_cos();
        let x = state[0] * cosine + state[1] * sine;
        let y = state[1] * cosine - state[0] * sine;
        let (x, y) = (parameter + self.polynomial(x), y * self.b + x * x);
        [x * cosine - y * sine, x * sine + y * cosine]
    }
}

/// Coefficients of the polynomial with the value 0 at 0 and the slope `factor (x - r_1) ... (x - r_k) - 1`.
fn integrated(roots: &[f64], factor: f64) -> Vec<f64> {
    let mut slope = vec![factor];
    for root in roots {
        slope.insert(0, 0.0);
        for index in 0..slope.len() - 1 {
            slope[index] -= root * slope[index + 1];
        }
    }
    slope[0] -= 1.0;
    let integrals = slope.iter().enumerate().map(|(power, value)| value / (power as f64 + 1.0));
    std::iter::once(0.0).chain(integrals).collect()
}

/// Zeros of a function between two values, at a distance of a thousandth of these at least.
fn zeros(function: impl Fn(f64) -> f64, [from, to]: [f64; 2]) -> Vec<f64> {
    let at = |index: i32| from + (to - from) * f64::from(index) / 1000.0;
    (0..1000)
        .filter(|&index| function(at(index)) * function(at(index + 1)) < 0.0)
        .map(|index| {
            let (mut left, mut right) = (at(index), at(index + 1));
            for _ in 0..60 {
                let middle = 0.5 * (left + right);
                if function(left) * function(middle) <= 0.0 { right = middle } else { left = middle }
            }
            0.5 * (left + right)
        })
        .collect()
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(300))]
    /// None is lost, none invented and none found twice.
    #[test]
    fn all_special_points_of_random_polynomial_maps(
        gaps in prop::collection::vec(0.15..0.8f64, 1..5), first in -1.0..0.0f64, factor in 0.5..3.0f64,
        negative in any::<bool>(), b in -0.7..0.7f64, angle in 0.0..6.0f64, start in -0.3..0.3f64,
    ) {
        let doublings: Vec<f64> =
            gaps.iter().scan(first, |place, gap| { *place += gap; Some(*place) }).collect();
        let factor = if negative { -factor } else { factor };
        let map = Turned { coefficients: integrated(&doublings, factor), b, angle };
        // The slope of g is one at a fold.
        let slope = |x: f64| doublings.iter().fold(factor, |product, root| product * (x - root)) - 1.0;
        let folds = zeros(|x| slope(x) - 1.0, [-3.0, 4.0]);
        prop_assume!(folds.windows(2).all(|pair| pair[1] - pair[0] > 0.05));
        // Next to a double zero nothing is certain.
        let extremes = zeros(|x| slope(x + 1e-5) - slope(x - 1e-5), [-3.0, 4.0]);
        prop_assume!(extremes.iter().all(|&x| (slope(x) - 1.0).abs() > 0.05 && (slope(x) + 1.0).abs() > 1e-3));
        let home = map.fixed_point(start);
        prop_assume!((slope(start).abs() - 1.0).abs() > 1e-3);
        for ahead in [1.0, -1.0] {
            let range = [home[2] - 2.0, home[2] + 2.0];
            let branch = fixed_points(&map, home.clone(), ahead, range);
            let visited: Vec<f64> = branch.solutions.iter().map(|(at, _)| map.first(&at.unknown)).collect();
            let ends = visited.iter().fold([start, start], |[low, high], x| [low.min(*x), high.max(*x)]);
            for (label, exact) in [(SpecialKind::PeriodDoubling, &doublings), (SpecialKind::Fold, &folds)] {
                let mut found: Vec<f64> = located(&branch, label).map(|unknown| map.first(unknown)).collect();
                found.sort_by(f64::total_cmp);
                let inside = exact.iter().filter(|x| ends[0] < **x && **x < ends[1]);
                let expected: Vec<f64> = inside.copied().collect();
                prop_assert_eq!(found.len(), expected.len(), "{} {:?} {:?}", label, found, expected);
                for (found, expected) in found.iter().zip(&expected) {
                    prop_assert!((found - expected).abs() < 1e-7, "{label}: {found} instead of {expected}");
                }
            }
        }
    }
}
