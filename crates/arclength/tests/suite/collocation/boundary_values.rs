//! Boundary value problems, followed from outside the crate and against closed forms.

#[path = "../../../examples/bratu.rs"]
#[allow(missing_docs)]
mod example;

use approx::assert_relative_eq;
use arclength::Scalar;
use arclength::branch::SpecialKind;
use arclength::collocation::{
    BoundaryValueCurve, BoundaryValuePoint, BoundaryValueProblem, Collocation, Reference, Resolution,
};
use arclength::continuation::{Bound, Followed, Origin, Request, Settings, follow};
use arclength::integration::{Integrator, from_fn};
use proptest::prelude::*;
use std::convert::Infallible;
use std::f64::consts::PI;
use std::ops::ControlFlow;

/// What is found along a curve of solutions.
type Branch = Followed<BoundaryValuePoint, SpecialKind, Infallible>;

/// Follows the solutions of a problem in the direction in which the parameter grows, with solutions at some values.
fn followed<P: BoundaryValueProblem>(
    problem: P,
    sizes: &[f64],
    start: (impl Fn(f64) -> Vec<f64>, &[f64]),
    [lower, upper]: [f64; 2],
    values: &[f64],
) -> Branch {
    let mut curve = BoundaryValueCurve::new(problem, sizes, Resolution::with_tolerance(1e-9)).expect("fits");
    let unknown = curve.start(start.0, start.1);
    let mut forward = vec![0.0; unknown.len()];
    forward[unknown.len() - 1] = 1.0;
    let range = Bound { from_end: 1, lower, upper };
    let request = Request { values: values.to_vec(), ..Request::within(&[range], Settings::default()) };
    follow(&mut curve, unknown, forward, &request, &mut |_, _| ControlFlow::Continue(())).expect("a branch")
}

/// The folds; nothing may have been noticed and not located.
fn folds(branch: &Branch) -> Vec<&BoundaryValuePoint> {
    assert!(branch.unlocated.is_empty(), "{:?}", branch.unlocated);
    of_origin(branch, Origin::Special(SpecialKind::Fold))
}

fn of_origin(branch: &Branch, origin: Origin<SpecialKind>) -> Vec<&BoundaryValuePoint> {
    let solutions = branch.solutions.iter().filter(|(_, other)| *other == origin);
    solutions.map(|(solution, _)| &solution.point).collect()
}

fn requested(branch: &Branch) -> Vec<&BoundaryValuePoint> {
    of_origin(branch, Origin::Requested)
}

/// Zero of an increasing or decreasing function in an interval.
fn zero(function: impl Fn(f64) -> f64, [mut left, mut right]: [f64; 2]) -> f64 {
    for _ in 0..200 {
        let middle = 0.5 * (left + right);
        if function(left) * function(middle) <= 0.0 { right = middle } else { left = middle }
    }
    0.5 * (left + right)
}

#[test]
fn the_bratu_problem() {
    // u(t) = 2 ln(cosh(theta) / cosh(theta (1 - 2 t))), lambda = 8 theta^2 / cosh^2 theta; the fold where theta tanh(theta) = 1.
    let critical = zero(|theta| theta * theta.tanh() - 1.0, [1.0, 1.5]);
    let lambda = |theta: f64| 8.0 * (theta / theta.cosh()).powi(2);
    let branch = example::branch(&[1.0, 2.0, 3.0]).expect("a branch");
    let folds = folds(&branch);
    assert_eq!(folds.len(), 1);
    assert_relative_eq!(lambda(critical), 3.513_830_719_125_16, max_relative = 1e-14);
    assert_relative_eq!(folds[0].scalars[0], lambda(critical), max_relative = 1e-12);
    assert_relative_eq!(folds[0].components.at(0.5)[0], 2.0 * critical.cosh().ln(), max_relative = 1e-9);
    let solutions = requested(&branch);
    assert_eq!(solutions.len(), 6);
    for (point, value) in solutions.iter().zip([1.0, 2.0, 3.0, 3.0, 2.0, 1.0]) {
        assert_eq!(point.scalars, [value]);
        let small = point.components.at(0.5)[0] < 2.0 * critical.cosh().ln();
        let theta =
            zero(|theta| lambda(theta) - value, if small { [0.0, critical] } else { [critical, 5.0] });
        for time in [0.1, 0.25, 0.5, 0.9] {
            let exact = 2.0 * (theta.cosh() / (theta * (1.0 - 2.0 * time)).cosh()).ln();
            assert_relative_eq!(point.components.at(time)[0], exact, max_relative = 1e-9);
        }
    }
    let order: Vec<bool> = solutions.iter().map(|point| point.components.at(0.5)[0] < 1.0).collect();
    assert_eq!(order, [true, true, true, false, false, false]);
}

/// `-u'' = (lambda + p t) u`, `u(0) = u(1) = 0`, mean square of `u` one half: eigenvalues of a particle in a box with a field.
struct Well;

impl BoundaryValueProblem for Well {
    fn dimension(&self) -> usize {
        2
    }
    fn scalars(&self) -> usize {
        2
    }
    fn integral_conditions(&self) -> usize {
        1
    }
    fn field<T: Scalar>(&self, time: f64, state: &[T], scalars: &[T], derivative: &mut [T]) {
        derivative[0] = state[1];
        derivative[1] = -((scalars[0] + scalars[1] * time) * state[0]);
    }
    fn boundary_conditions<T: Scalar>(&self, start: &[T], end: &[T], _scalars: &[T], values: &mut [T]) {
        values[0] = start[0];
        values[1] = end[0];
    }
    fn integrands<T: Scalar>(&self, state: &[T], _scalars: &[T], _: Reference<'_>, values: &mut [T]) {
        values[0] = state[0] * state[0] - 0.5;
    }
}

#[test]
fn eigenvalues_with_an_integral_condition_and_a_field_that_depends_on_the_time() {
    for mode in 1..=3 {
        let k = PI * f64::from(mode);
        let sizes = [1.0, k, k * k, 2.0];
        let start = |t: f64| vec![(k * t).sin(), k * (k * t).cos()];
        let branch = followed(Well, &sizes, (start, &[k * k + 0.5, -1.0]), [-1.0, 1.0], &[-1e-3, 0.0, 1e-3]);
        let [before, here, after] = requested(&branch)[..] else { panic!("{}", branch.stop) };
        assert_relative_eq!(here.scalars[0], k * k, max_relative = 1e-12);
        for time in [0.2, 0.37, 0.8] {
            assert!((here.components.at(time)[0] - (k * time).sin()).abs() < 1e-9);
        }
        // By symmetry the derivative with respect to p is minus the mean of t, one half.
        let slope = (after.scalars[0] - before.scalars[0]) / 2e-3;
        assert!((slope + 0.5).abs() < 1e-8, "{slope}");
    }
}

/// A rod under pressure, `u'' + p sin u = 0`, `u(0) = u(1) = 0`, which buckles at `p = pi^2`.
struct Rod;

impl BoundaryValueProblem for Rod {
    fn dimension(&self) -> usize {
        2
    }
    fn scalars(&self) -> usize {
        1
    }
    fn field<T: Scalar>(&self, _time: f64, state: &[T], scalars: &[T], derivative: &mut [T]) {
        derivative[0] = state[1];
        derivative[1] = -(scalars[0] * state[0].sin());
    }
    fn boundary_conditions<T: Scalar>(&self, start: &[T], end: &[T], _scalars: &[T], values: &mut [T]) {
        values[0] = start[0];
        values[1] = end[0];
    }
}

#[test]
fn a_branch_point_is_noticed() {
    let straight = (|_| vec![0.0; 2], &[5.0][..]);
    let branch = followed(Rod, &[1.0, 1.0, 20.0], straight, [5.0, 25.0], &[]);
    let [noticed] = &branch.unlocated[..] else { panic!("{:?}", branch.unlocated) };
    assert_eq!(noticed.kind, Some(SpecialKind::BranchPoint));
    assert!(noticed.between[0][0] < PI * PI && noticed.between[1][0] > PI * PI, "{noticed:?}");
}

/// How the phase of a cycle is fixed.
#[derive(Clone, Copy, PartialEq)]
enum Phase {
    /// The derivative of the first state is zero at the start: three boundary conditions for two components.
    AtStart,
    /// Orthogonal to a reference, on average.
    OnAverage,
}

/// Cycles `y' = T f(y, p)` with the scalars `(T, p)` of a planar field `f`.
struct PlanarCycle<F> {
    field: F,
    phase: Phase,
}

/// A planar field with one parameter.
trait Planar {
    fn at<T: Scalar>(&self, state: &[T], parameter: T) -> [T; 2];
}

impl<F: Planar> BoundaryValueProblem for PlanarCycle<F> {
    fn dimension(&self) -> usize {
        2
    }
    fn scalars(&self) -> usize {
        2
    }
    fn integral_conditions(&self) -> usize {
        usize::from(self.phase == Phase::OnAverage)
    }
    fn field<T: Scalar>(&self, _time: f64, state: &[T], scalars: &[T], derivative: &mut [T]) {
        derivative.copy_from_slice(&self.field.at(state, scalars[1]).map(|slope| slope * scalars[0]));
    }
    fn boundary_conditions<T: Scalar>(&self, start: &[T], end: &[T], scalars: &[T], values: &mut [T]) {
        values[0] = end[0] - start[0];
        values[1] = end[1] - start[1];
        if self.phase == Phase::AtStart {
            values[2] = self.field.at(start, scalars[1])[0];
        }
    }
    fn integrands<T: Scalar>(&self, state: &[T], _scalars: &[T], reference: Reference<'_>, values: &mut [T]) {
        if self.phase == Phase::OnAverage {
            values[0] = (0..2).map(|k| (state[k] - reference.state[k]) * reference.slope[k]).sum();
        }
    }
}

struct VanDerPol;

impl Planar for VanDerPol {
    fn at<T: Scalar>(&self, state: &[T], mu: T) -> [T; 2] {
        [state[1], mu * (-(state[0] * state[0]) + 1.0) * state[1] - state[0]]
    }
}

#[test]
fn more_boundary_conditions_than_components() {
    for phase in [Phase::AtStart, Phase::OnAverage] {
        let circle = |t: f64| vec![2.0 * (2.0 * PI * t).cos(), -2.0 * (2.0 * PI * t).sin()];
        let problem = PlanarCycle { field: VanDerPol, phase };
        let branch = followed(problem, &[2.0, 2.0, 6.0, 1.0], (circle, &[2.0 * PI, 0.1]), [0.1, 1.2], &[1.0]);
        let [point] = requested(&branch)[..] else { panic!("{}", branch.stop) };
        // The period at mu = 1 is published to 12 digits.
        assert_relative_eq!(point.scalars[0], 6.663_286_859_323, max_relative = 1e-11);
    }
}

/// Circles of radius `s` with `a + s^2 - s^4 = 0`, traversed at the speed `1 + s^2`: a fold at `a = -1/4`.
struct Bautin;

impl Planar for Bautin {
    fn at<T: Scalar>(&self, state: &[T], a: T) -> [T; 2] {
        let [x, y] = [state[0], state[1]];
        let square = x * x + y * y;
        let growth = a + square - square * square;
        let speed = square + 1.0;
        [growth * x - speed * y, growth * y + speed * x]
    }
}

#[test]
fn a_fold_with_several_scalars_and_conditions_of_every_kind() {
    for phase in [Phase::AtStart, Phase::OnAverage] {
        // From the unstable cycle of a = -0.1 forward in its other direction, over the fold.
        let square = zero(|s| -0.1 + s - s * s, [0.0, 0.5]);
        let start = |t: f64| {
            // The first state is largest at the start.
            let angle = 2.0 * PI * t;
            vec![square.sqrt() * angle.cos(), square.sqrt() * angle.sin()]
        };
        let problem = PlanarCycle { field: Bautin, phase };
        let mut curve =
            BoundaryValueCurve::new(problem, &[0.5, 0.5, 5.0, 0.5], Resolution::with_tolerance(1e-9))
                .unwrap();
        let unknown = curve.start(start, &[2.0 * PI / (1.0 + square), -0.1]);
        let mut back = vec![0.0; unknown.len()];
        back[unknown.len() - 1] = -1.0;
        let range = Bound { from_end: 1, lower: -0.4, upper: 0.1 };
        let request = Request { values: vec![-0.1], ..Request::within(&[range], Settings::default()) };
        let branch =
            follow(&mut curve, unknown, back, &request, &mut |_, _| ControlFlow::Continue(())).unwrap();
        let folds = folds(&branch);
        assert_eq!(folds.len(), 1, "{}", branch.stop);
        // As accurate as the mesh, whose error estimate is below 1e-9.
        assert_relative_eq!(folds[0].scalars[1], -0.25, max_relative = 1e-9);
        assert_relative_eq!(folds[0].scalars[0], 2.0 * PI / 1.5, max_relative = 1e-6);
        let other = requested(&branch).into_iter().next().expect("the stable cycle");
        assert_relative_eq!(other.scalars[0], 2.0 * PI / (2.0 - square), max_relative = 1e-9);
    }
}

#[test]
fn what_does_not_fit_is_refused() {
    let refused = |sizes: &[f64], resolution: Resolution| {
        BoundaryValueCurve::new(Well, sizes, resolution).err().expect("refused").to_string()
    };
    let sizes = [1.0; 4];
    assert!(refused(&sizes[..3], Resolution::default()).contains("3 numbers"));
    assert!(refused(&[1.0, -1.0, 1.0, 1.0], Resolution::default()).contains("positive"));
    assert!(refused(&sizes, Resolution { degree: 17, ..Resolution::default() }).contains("2 to 16"));
    for mesh in [vec![], vec![0.0], vec![0.0, 0.5, 0.5, 1.0], vec![0.1, 1.0]] {
        let error = Collocation::try_new(Well, mesh, 4).err().expect("refused").to_string();
        assert!(error.contains("ascending"), "{error}");
    }
}

/// A wave `mean + size sin(rate t + phase)`.
#[derive(Clone, Copy, Debug)]
struct Wave([f64; 4]);

impl Wave {
    fn at(self, time: f64) -> f64 {
        let Self([mean, size, rate, phase]) = self;
        mean + size * (rate * time + phase).sin()
    }
    fn slope(self, time: f64) -> f64 {
        let Self([_, size, rate, phase]) = self;
        size * rate * (rate * time + phase).cos()
    }
}

/// `y' = A(t) y + p (w' - A w)`, `B_0 y(0) + B_1 y(1) = p (B_0 w(0) + B_1 w(1))` with the solution `y = p w`.
#[derive(Clone, Debug)]
struct Linear {
    matrix: Vec<Wave>,
    boundary: [Vec<f64>; 2],
    solution: Vec<Wave>,
}

impl Linear {
    fn matrix_at(&self, time: f64) -> Vec<f64> {
        self.matrix.iter().map(|wave| wave.at(time)).collect()
    }

    fn solution_at(&self, time: f64) -> Vec<f64> {
        self.solution.iter().map(|wave| wave.at(time)).collect()
    }
}

/// Adds a matrix times a vector, row by row.
fn multiply_add<T: Scalar>(matrix: &[f64], vector: &[T], sum: &mut [T]) {
    for (row, entry) in matrix.chunks_exact(vector.len()).zip(sum) {
        *entry += row.iter().zip(vector).map(|(factor, &value)| value * *factor).sum();
    }
}

impl BoundaryValueProblem for Linear {
    fn dimension(&self) -> usize {
        self.solution.len()
    }
    fn scalars(&self) -> usize {
        1
    }
    fn field<T: Scalar>(&self, time: f64, state: &[T], scalars: &[T], derivative: &mut [T]) {
        let matrix = self.matrix_at(time);
        let mut forcing = vec![0.0; state.len()];
        multiply_add(&matrix, &self.solution_at(time), &mut forcing);
        for ((slope, wave), forcing) in derivative.iter_mut().zip(&self.solution).zip(forcing) {
            *slope = scalars[0] * (wave.slope(time) - forcing);
        }
        multiply_add(&matrix, state, derivative);
    }
    fn boundary_conditions<T: Scalar>(&self, start: &[T], end: &[T], scalars: &[T], values: &mut [T]) {
        let mut constants = vec![0.0; values.len()];
        for (matrix, time) in self.boundary.iter().zip([0.0, 1.0]) {
            multiply_add(matrix, &self.solution_at(time), &mut constants);
        }
        for (value, constant) in values.iter_mut().zip(constants) {
            *value = -(scalars[0] * constant);
        }
        multiply_add(&self.boundary[0], start, values);
        multiply_add(&self.boundary[1], end, values);
    }
}

/// `B_0 + B_1 Y(1)`, row by row, with the fundamental matrix `Y`: the problem is well posed where it is regular.
fn shooting_matrix(problem: &Linear) -> Vec<f64> {
    let n = problem.solution.len();
    let columns: Vec<Vec<f64>> = (0..n)
        .map(|column| {
            let system = from_fn(n, |time, state: &[f64], slope: &mut [f64]| {
                slope.fill(0.0);
                multiply_add(&problem.matrix_at(time), state, slope);
            });
            let mut start = vec![0.0; n];
            start[column] = 1.0;
            let end =
                Integrator::with_tolerance(1e-9).integrate(system, 0.0, &start, 1.0).expect("linear").state;
            let mut image = vec![0.0; n];
            multiply_add(&problem.boundary[0], &start, &mut image);
            multiply_add(&problem.boundary[1], &end, &mut image);
            image
        })
        .collect();
    (0..n * n).map(|entry| columns[entry % n][entry / n]).collect()
}

/// Determinant over the product of the lengths of the rows, 1 for orthogonal rows.
fn regularity(matrix: &[f64], n: usize) -> f64 {
    let mut rows: Vec<Vec<f64>> = matrix.chunks_exact(n).map(<[f64]>::to_vec).collect();
    let mut product = 1.0;
    for index in 0..n {
        let length = |row: &[f64]| row.iter().map(|entry| entry * entry).sum::<f64>().sqrt();
        let whole = length(&matrix[index * n..(index + 1) * n]);
        product *= length(&rows[index]) / whole;
        let square: f64 = rows[index].iter().map(|entry| entry * entry).sum();
        for other in index + 1..n {
            let share = rows[other].iter().zip(&rows[index]).map(|(a, b)| a * b).sum::<f64>() / square;
            let here = rows[index].clone();
            rows[other].iter_mut().zip(here).for_each(|(entry, value)| *entry -= share * value);
        }
    }
    product
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(200))]
    #[test]
    fn random_linear_problems_with_a_known_solution(
        n in 1..=3_usize, waves in prop::collection::vec([-1.0..1.0f64, -1.0..1.0f64, 0.0..9.0f64, 0.0..6.0f64], 12),
        entries in prop::collection::vec(-1.0..1.0f64, 18), separated in any::<bool>(),
    ) {
        let mut boundary = [entries[..n * n].to_vec(), entries[9..9 + n * n].to_vec()];
        if separated {
            // The first conditions are at the start, the others at the end.
            boundary[0][n * n.div_ceil(2)..].fill(0.0);
            boundary[1][..n * n.div_ceil(2)].fill(0.0);
        }
        let problem = Linear {
            matrix: waves[..n * n].iter().copied().map(Wave).collect(),
            boundary,
            solution: waves[9..9 + n].iter().copied().map(Wave).collect(),
        };
        let regular = regularity(&shooting_matrix(&problem), n);
        prop_assume!(regular > 0.05);
        let mut sizes = vec![1.0; n];
        sizes.push(1.0);
        let branch = followed(problem.clone(), &sizes, (|_| vec![0.0; n], &[0.0]), [0.0, 1.0], &[]);
        prop_assert!(folds(&branch).is_empty());
        let (last, _) = branch.solutions.last().expect("a solution");
        prop_assert_eq!(last.point.scalars[0], 1.0);
        for index in 0..=20 {
            let time = f64::from(index) / 20.0;
            for (value, exact) in last.point.components.at(time).iter().zip(problem.solution_at(time)) {
                prop_assert!((value - exact).abs() < 1e-7 / regular, "{value} instead of {exact} at {time}");
            }
        }
    }
}
