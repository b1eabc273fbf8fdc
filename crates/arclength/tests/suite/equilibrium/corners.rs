//! Branches of equilibria through kinks and borders of a field, against polygons in closed form.

// Rows and columns of matrices.
#![allow(clippy::needless_range_loop)]

use arclength::branch::{SpecialKind, Stability};
use arclength::continuation::Stop;
use arclength::equilibrium::{Equilibria, EquilibriumBranch, EquilibriumEnd, SpecialPoint};
use arclength::{Scalar, Threshold, VectorField};

/// Numbers of the generator of Knuth's MMIX.
struct Random(u64);

impl Random {
    fn new(seed: u64) -> Self {
        Self(seed)
    }

    fn next_unit(&mut self) -> f64 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 11) as f64 / (1_u64 << 53) as f64
    }
}

/// `x' = A x + sum of column_k max(normal_k . x - offset_k, 0) + b p + c`.
#[derive(Clone, Debug)]
struct Kinked {
    matrix: Vec<Vec<f64>>,
    kinks: Vec<Kink>,
    forcing: Vec<f64>,
    constant: Vec<f64>,
}

#[derive(Clone, Debug)]
struct Kink {
    normal: Vec<f64>,
    offset: f64,
    column: Vec<f64>,
}

impl VectorField for Kinked {
    fn state_names(&self) -> Vec<String> {
        (0..self.constant.len()).map(|index| format!("x{index}")).collect()
    }
    fn parameter_names(&self) -> Vec<String> {
        vec!["p".into()]
    }
    fn evaluate<T: Scalar>(&self, x: &[T], p: &[T], result: &mut [T]) {
        let n = self.constant.len();
        for row in 0..n {
            result[row] = p[0] * self.forcing[row] + self.constant[row];
            for column in 0..n {
                result[row] += x[column] * self.matrix[row][column];
            }
        }
        for (index, kink) in self.kinks.iter().enumerate() {
            let mut height = T::from(-kink.offset);
            for column in 0..n {
                height += x[column] * kink.normal[column];
            }
            let part = match p.get(1 + index) {
                Some(sign) => (*sign + 1.0) * height * 0.5,
                None => height.max(T::zero()),
            };
            for row in 0..n {
                result[row] += part * kink.column[row];
            }
            if let Some(switch) = result.get_mut(n + index) {
                *switch = height;
            }
        }
    }
    fn thresholds(&self) -> Vec<Threshold> {
        vec![Threshold::Zero; self.kinks.len()]
    }
}

/// One edge of the polygon that the equilibria of a [`Kinked`] field are.
struct Edge {
    /// Where it ends: states and parameter.
    end: Vec<f64>,
    /// Whether the parameter grows on it.
    grows: bool,
    unstable: usize,
}

impl Kinked {
    fn height(&self, kink: &Kink, x: &[f64]) -> f64 {
        kink.normal.iter().zip(x).map(|(a, x)| a * x).sum::<f64>() - kink.offset
    }

    fn jacobian(&self, above: &[bool]) -> Vec<Vec<f64>> {
        let mut matrix = self.matrix.clone();
        for (kink, _) in self.kinks.iter().zip(above).filter(|(_, above)| **above) {
            for (row, factor) in matrix.iter_mut().zip(&kink.column) {
                row.iter_mut().zip(&kink.normal).for_each(|(entry, normal)| *entry += factor * normal);
            }
        }
        matrix
    }

    /// The number of unstable directions: the first two states are on their own, the others follow with the rate -1. `None` close to a
    /// change.
    fn unstable(&self, above: &[bool]) -> Option<usize> {
        let matrix = self.jacobian(above);
        let trace = matrix[0][0] + matrix[1][1];
        let determinant = matrix[0][0] * matrix[1][1] - matrix[0][1] * matrix[1][0];
        if determinant.abs() < 0.05 || trace.abs() < 0.05 {
            return None;
        }
        Some(if determinant < 0.0 { 1 } else { 2 * usize::from(trace > 0.0) })
    }

    /// Slope of the states over the parameter in a piece.
    fn slope(&self, above: &[bool]) -> Vec<f64> {
        let mut matrix = self.jacobian(above);
        let mut right: Vec<f64> = self.forcing.iter().map(|entry| -entry).collect();
        let n = right.len();
        for pivot in 0..n {
            let best = (pivot..n)
                .max_by(|&a, &b| matrix[a][pivot].abs().total_cmp(&matrix[b][pivot].abs()))
                .unwrap();
            matrix.swap(pivot, best);
            right.swap(pivot, best);
            for row in 0..n {
                if row != pivot {
                    let factor = matrix[row][pivot] / matrix[pivot][pivot];
                    for column in 0..n {
                        matrix[row][column] -= factor * matrix[pivot][column];
                    }
                    right[row] -= factor * right[pivot];
                }
            }
        }
        (0..n).map(|row| right[row] / matrix[row][row]).collect()
    }

    /// The edges from an equilibrium at p = -1 on, up to p = 1 or back to -1. `None` for a polygon that is not generic.
    fn polygon(&self, start: &[f64]) -> Option<Vec<Edge>> {
        let mut here = [start, &[-1.0]].concat();
        let n = start.len();
        let mut above: Vec<bool> = self.kinks.iter().map(|kink| self.height(kink, start) > 0.0).collect();
        let mut sense = 1.0;
        let mut edges = Vec::new();
        let mut crossed = None;
        for _ in 0..50 {
            let unstable = self.unstable(&above)?;
            let slope = self.slope(&above);
            let rate = |kink: &Kink| kink.normal.iter().zip(&slope).map(|(a, b)| a * b).sum::<f64>();
            if let Some(index) = crossed {
                // Into the new piece.
                let into: f64 = if above[index] { 1.0 } else { -1.0 };
                sense = into * rate(&self.kinks[index]).signum();
            }
            let mut nearest = (1.0 - sense * here[n], None);
            for (index, kink) in self.kinks.iter().enumerate() {
                let time = -self.height(kink, &here[..n]) / (sense * rate(kink));
                if crossed != Some(index) && time > 0.0 && time < nearest.0 {
                    nearest = (time, Some(index));
                }
            }
            let (time, next) = nearest;
            for (value, slope) in here.iter_mut().zip(slope.iter().chain([&1.0])) {
                *value += sense * time * slope;
            }
            let largest = here.iter().fold(0.0_f64, |most, value| most.max(value.abs()));
            if time < 1e-3 || largest > 30.0 {
                return None;
            }
            edges.push(Edge { end: here.clone(), grows: sense > 0.0, unstable });
            let Some(index) = next else { return Some(edges) };
            above[index] = !above[index];
            crossed = Some(index);
        }
        None
    }

    /// A random field with the equilibrium `start` at p = -1.
    fn random(random: &mut Random, n: usize, kinks: usize) -> (Self, Vec<f64>) {
        let mut next = || 2.0 * random.next_unit() - 1.0;
        let mut vector = |count: usize| -> Vec<f64> { (0..count).map(|_| next()).collect() };
        let mut matrix: Vec<Vec<f64>> = (0..n).map(|_| vector(n)).collect();
        let mut all = Vec::new();
        for _ in 0..kinks {
            let (mut normal, mut column, offset) = (vector(n), vector(n), 0.7 * vector(1)[0]);
            normal[2..].fill(0.0);
            column.iter_mut().for_each(|entry| *entry *= 2.0);
            all.push(Kink { normal, offset, column });
        }
        for row in 0..n {
            for column in 2..n {
                matrix[row][column] = if row == column { -1.0 } else { 0.0 };
            }
        }
        let (forcing, start) = (vector(n), vector(n));
        let mut field = Self { matrix, kinks: all, forcing, constant: vec![0.0; n] };
        let mut residual = vec![0.0; n];
        field.evaluate(&start, &[-1.0], &mut residual);
        field.constant = residual.iter().map(|entry| -entry).collect();
        (field, start)
    }
}

fn run(field: &Kinked, start: &[f64]) -> EquilibriumBranch {
    Equilibria::of(field).start(start).parameters(&[-1.0]).along("p", -1.0..=1.0).run().unwrap()
}

fn labels(branch: &EquilibriumBranch) -> Vec<(SpecialKind, f64)> {
    let special =
        branch.points.iter().filter_map(|point| Some((point.special.as_ref()?.kind(), point.value)));
    special.collect()
}

fn plane(matrix: [[f64; 2]; 2], kink: ([f64; 2], f64, [f64; 2]), forcing: [f64; 2]) -> Kinked {
    let (normal, offset, column) = kink;
    Kinked {
        matrix: matrix.map(|row| row.to_vec()).to_vec(),
        kinks: vec![Kink { normal: normal.to_vec(), offset, column: column.to_vec() }],
        forcing: forcing.to_vec(),
        constant: vec![0.0; 2],
    }
}

/// Tangents of both sides that differ by more than a right angle: the branch went back and forth over the kink, and ended there.
#[test]
fn a_sharp_kink_is_passed_and_nothing_is_found_there() {
    for (left, right) in [(-0.4, 1.0), (-0.1, 0.3), (-5.0, 10.0), (3.0, -7.0)] {
        for offset in [0.0, 0.1] {
            let field = plane([[-1.0, 0.0], [left, -1.0]], ([1.0, 0.0], offset, [0.0, right]), [1.0, 0.0]);
            let branch = run(&field, &[-1.0, -left]);
            assert_eq!(labels(&branch), [], "{left} {right}");
            assert!(branch.points.iter().all(|point| point.stability == Stability::Stable));
            assert!(branch.points.len() < 200);
            for point in &branch.points {
                let expected = left * point.value + right * (point.value - offset).max(0.0);
                assert!((point.state[1] - expected).abs() < 1e-9, "{point:?}");
            }
            let last = branch.points.last().unwrap();
            assert_eq!(last.value, 1.0);
        }
    }
}

/// Polygons with several corners: folds where the parameter turns, pairs where two eigenvalues cross, and nothing else.
#[test]
fn random_polygons_have_their_corners_and_no_others() {
    let mut random = Random::new(11);
    let (mut judged, mut folds, mut pairs) = (0, 0, 0);
    for case in 0..600 {
        let (field, start) = Kinked::random(&mut random, 2 + case % 3, 1 + case % 4);
        let Some(edges) = field.polygon(&start) else { continue };
        let branch = run(&field, &start);
        let mut expected = Vec::new();
        for pair in edges.windows(2) {
            let value = pair[0].end[start.len()];
            let turns = pair[0].grows != pair[1].grows;
            let change = pair[0].unstable.abs_diff(pair[1].unstable);
            if turns {
                expected.push((SpecialKind::Fold, value));
            }
            if change - usize::from(turns) >= 2 {
                expected.push((SpecialKind::Hopf, value));
            }
        }
        let found = labels(&branch);
        let same = |(one, other): (&(SpecialKind, f64), &(SpecialKind, f64))| {
            one.0 == other.0 && (one.1 - other.1).abs() < 1e-9
        };
        assert!(
            found.len() == expected.len() && found.iter().zip(&expected).all(same),
            "case {case}: {found:?} instead of {expected:?} {field:?}"
        );
        let (last, end) = (branch.points.last().unwrap(), &edges.last().unwrap().end);
        for (value, expected) in last.state.iter().chain([&last.value]).zip(end) {
            assert!(
                (value - expected).abs() < 1e-8 * (1.0 + expected.abs()),
                "case {case}: {last:?} {end:?}"
            );
        }
        let stable = |unstable: usize| {
            if unstable == 0 { Stability::Stable } else { Stability::Unstable { dimension: Some(unstable) } }
        };
        assert_eq!(last.stability, stable(edges.last().unwrap().unstable), "case {case}");
        assert_eq!(branch.points[0].stability, stable(edges[0].unstable), "case {case}");
        judged += 1;
        folds += found.iter().filter(|(kind, _)| *kind == SpecialKind::Fold).count();
        pairs += found.iter().filter(|(kind, _)| *kind == SpecialKind::Hopf).count();
    }
    assert!(judged > 100 && folds > 20 && pairs > 5, "{judged} {folds} {pairs}");
}

/// A focus that is unstable left of the kink and a stable node right of it: no eigenvalue is zero in between, whatever the side on
/// which the other one lies.
#[test]
fn two_eigenvalues_that_jump_over_the_axis_are_no_branch_point() {
    // x' = .5 x - 1.5 max(x, 0) - y + p, y' = .1 (x - .5 y), and its mirror image.
    for sign in [1.0, -1.0] {
        let column = [-1.5, 0.0];
        let first = if sign > 0.0 { 0.5 } else { -1.0 };
        let field = plane([[first, -1.0], [0.1, -0.05]], ([sign, 0.0], 0.0, column), [1.0, 0.0]);
        let branch = run(&field, &[-1.0, -1.0]);
        let found = labels(&branch);
        assert!(matches!(found[..], [(SpecialKind::Hopf, value)] if value.abs() < 1e-12), "{found:?}");
        let special = branch.special_points().next().unwrap();
        assert!(matches!(special, SpecialPoint::Degenerate { at_border: true, .. }));
    }
}

/// A start on a kink, on which the parameter turns, too: both ways are followed.
#[test]
fn a_branch_starts_on_a_corner() {
    let field = plane([[-1.0, 0.0], [-0.4, -1.0]], ([1.0, 0.0], 0.0, [0.0, 1.0]), [1.0, 0.0]);
    let branch =
        Equilibria::of(&field).start(&[0.0, 0.0]).parameters(&[0.0]).along("p", -1.0..=1.0).run().unwrap();
    assert_eq!(labels(&branch), []);
    assert_eq!([branch.points[0].value, branch.points.last().unwrap().value], [-1.0, 1.0]);
    // x' = p - x + 2 max(x, 0): equilibria at p = x for x < 0, p = -x for x > 0.
    let field = plane([[-1.0, 0.0], [0.0, -1.0]], ([1.0, 0.0], 0.0, [2.0, 0.0]), [1.0, 0.0]);
    let branch =
        Equilibria::of(&field).start(&[0.0, 0.0]).parameters(&[0.0]).along("p", -1.0..=1.0).run().unwrap();
    let found = labels(&branch);
    assert!(matches!(found[..], [(SpecialKind::Fold, value)] if value == 0.0), "{found:?}");
    assert_eq!([branch.points[0].value, branch.points.last().unwrap().value], [-1.0, -1.0]);
}

/// `x' = p - x - sign(x)`.
struct Jump;
impl VectorField for Jump {
    fn state_names(&self) -> Vec<String> {
        vec!["x".into()]
    }
    fn parameter_names(&self) -> Vec<String> {
        vec!["p".into()]
    }
    fn evaluate<T: Scalar>(&self, x: &[T], p: &[T], result: &mut [T]) {
        let sign = p.get(1).copied().unwrap_or_else(|| T::from(if x[0].value() < 0.0 { -1.0 } else { 1.0 }));
        result[0] = p[0] - x[0] - sign;
        if let Some(switch) = result.get_mut(1) {
            *switch = x[0];
        }
    }
    fn thresholds(&self) -> Vec<Threshold> {
        vec![Threshold::Zero]
    }
}

#[test]
fn a_border_at_which_the_field_jumps_ends_a_branch_and_says_so() {
    let branch =
        Equilibria::of(&Jump).start(&[-1.0]).parameters(&[-2.0]).along("p", -2.0..=2.0).run().unwrap();
    let last = branch.points.last().unwrap();
    assert!((last.value + 1.0).abs() < 1e-12 && last.state[0].abs() < 1e-12);
    assert!(matches!(
        branch.stops[1],
        Some(Stop::Problem(EquilibriumEnd::Border { parameter })) if (parameter + 1.0).abs() < 1e-12
    ));
}

/// `x' = p - x`, `y' = -.4 x + x sqrt(x) - y` with the root for positive `x` only: beyond its border a piece has no values, and on it
/// no derivatives.
struct Root;
impl VectorField for Root {
    fn state_names(&self) -> Vec<String> {
        vec!["x".into(), "y".into()]
    }
    fn parameter_names(&self) -> Vec<String> {
        vec!["p".into()]
    }
    fn evaluate<T: Scalar>(&self, x: &[T], p: &[T], result: &mut [T]) {
        let above = p.get(1).map_or(x[0].value() > 0.0, |sign| sign.value() > 0.0);
        result[0] = p[0] - x[0];
        result[1] = -x[1] - x[0] * 0.4;
        if above {
            result[1] += x[0] * x[0].sqrt();
        }
        if let Some(switch) = result.get_mut(2) {
            *switch = x[0];
        }
    }
    fn thresholds(&self) -> Vec<Threshold> {
        vec![Threshold::Zero]
    }
}

#[test]
fn a_piece_without_values_beyond_its_border_does_not_end_a_branch() {
    for start in [-1.0_f64, 1.0] {
        let state = [start, -0.4 * start + start.max(0.0)];
        let branch =
            Equilibria::of(&Root).start(&state).parameters(&[start]).along("p", -1.0..=1.0).run().unwrap();
        assert_eq!([branch.points[0].value, branch.points.last().unwrap().value], [-1.0, 1.0]);
        assert_eq!(labels(&branch), []);
    }
}
