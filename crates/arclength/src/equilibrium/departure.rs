//! Whether more than one branch passes through a start, and which branch is followed then.

use super::branch_point::BranchPoint;
use super::fold::null_vectors;
use super::problem::EquilibriumProblem;
use crate::algebraic::Differentiator;
use crate::error::Error;

/// Smallest pivot of the scaled Jacobian that may be rounding of zero, and one below which it may be zero at an equilibrium that
/// is known to no more than the root of that, as Newton's method leaves it at a singular one.
const ROUNDING: f64 = 1e-13;
const SINGULAR: f64 = 1e-8;
/// Displacement, in the sizes of the unknowns, and growth of the smallest pivot over it that a zero shows: that of a stiff field
/// is small everywhere.
const DISPLACEMENT: f64 = 1e-3;
const GROWTH: f64 = 100.0;

/// Ways along a null vector, in the sizes of the states, and parts of the rates without cancellation there that are rounding: where the
/// field vanishes all along, the equilibrium lies on a line of them.
const WAYS: [f64; 4] = [-0.1, -0.01, 0.01, 0.1];
const VANISHING: f64 = 1e-10;

/// Whether more than one branch passes through an equilibrium, or its Jacobian is degenerate in another way: whether the
/// Jacobian with respect to states and parameter has not the full rank.
///
/// # Errors
/// [`Error::Eigenvalues`] when the Jacobian is not finite.
pub(super) fn is_branching(
    problem: &EquilibriumProblem<'_>,
    unknown: &[f64],
    scales: &[f64],
) -> Result<bool, Error> {
    let mut rank = Rank { problem, scales, differentiator: Differentiator::default() };
    let here = rank.matrix(unknown);
    if here.iter().any(|entry| !entry.is_finite()) {
        return Err(Error::Eigenvalues { quantity: "rank of the Jacobian" });
    }
    let sizes = rank.row_sizes(unknown, &here);
    let pivot = smallest_pivot(here, &sizes);
    if pivot < ROUNDING {
        return Ok(true);
    }
    if pivot > SINGULAR {
        return Ok(false);
    }
    let displaced: Vec<f64> =
        unknown.iter().zip(scales).map(|(value, scale)| value + DISPLACEMENT * scale).collect();
    let there = smallest_pivot(rank.matrix(&displaced), &sizes);
    Ok(there.is_finite() && there > GROWTH * pivot)
}

struct Rank<'p, 'f> {
    problem: &'p EquilibriumProblem<'f>,
    scales: &'p [f64],
    differentiator: Differentiator,
}

impl Rank<'_, '_> {
    /// The Jacobian in the sizes of the unknowns, `n` by `n + 1`, column-major.
    fn matrix(&mut self, unknown: &[f64]) -> Vec<f64> {
        let n = self.problem.dimension;
        let mut matrix = vec![0.0; n * (n + 1)];
        let mut residual = vec![0.0; n];
        self.differentiator.jacobian(self.problem, unknown, &mut residual, &mut matrix, n);
        for (column, scale) in matrix.chunks_exact_mut(n).zip(self.scales) {
            column.iter_mut().for_each(|entry| *entry *= scale);
        }
        matrix
    }

    /// What counts as one in every equation: its largest derivative, or how much that changes over the size of an unknown.
    /// Stiffness makes equations large, and at a singular equilibrium one may vanish but for rounding.
    fn row_sizes(&mut self, unknown: &[f64], here: &[f64]) -> Vec<f64> {
        let n = self.problem.dimension;
        let mut sizes = vec![0.0_f64; n];
        let mut count = |entries: &mut dyn Iterator<Item = f64>| {
            for (index, entry) in entries.enumerate().filter(|(_, entry)| entry.is_finite()) {
                sizes[index % n] = sizes[index % n].max(entry.abs());
            }
        };
        count(&mut here.iter().copied());
        // All together, with signs that do not cancel in general, and the parameter alone.
        let signs: [fn(usize, usize) -> f64; 3] = [
            |_, _| 1.0,
            |index, _| if index % 2 == 0 { 1.0 } else { -1.0 },
            |index, last| if index == last { 1.0 } else { 0.0 },
        ];
        for sign in signs {
            let mut displaced = unknown.to_vec();
            for (index, (value, scale)) in displaced.iter_mut().zip(self.scales).enumerate() {
                *value += sign(index, n) * DISPLACEMENT * scale;
            }
            let there = self.matrix(&displaced);
            count(&mut there.iter().zip(here).map(|(there, here)| (there - here) / DISPLACEMENT));
        }
        sizes.into_iter().map(|size| if size > 0.0 { size } else { 1.0 }).collect()
    }
}

/// Smallest pivot of Gaussian elimination with complete pivoting of a matrix with more columns than rows, whose rows are divided
/// by their sizes.
fn smallest_pivot(mut matrix: Vec<f64>, sizes: &[f64]) -> f64 {
    let n = sizes.len();
    let columns = matrix.len() / n;
    for column in matrix.chunks_exact_mut(n) {
        column.iter_mut().zip(sizes).for_each(|(entry, size)| *entry /= size);
    }
    let mut smallest = f64::INFINITY;
    for step in 0..n {
        let places = (step..columns).flat_map(|column| (step..n).map(move |row| row + n * column));
        let largest = places.max_by(|&one, &other| matrix[one].abs().total_cmp(&matrix[other].abs()));
        let Some(place) = largest else { break };
        let (row, column) = (place % n, place / n);
        (0..n).for_each(|index| matrix.swap(index + n * step, index + n * column));
        (0..columns).for_each(|index| matrix.swap(step + n * index, row + n * index));
        let pivot = matrix[step + n * step];
        smallest = smallest.min(pivot.abs());
        if pivot == 0.0 {
            break;
        }
        for row in step + 1..n {
            let factor = matrix[row + n * step] / pivot;
            (step..columns).for_each(|index| matrix[row + n * index] -= factor * matrix[step + n * index]);
        }
    }
    smallest
}

/// The branch point at an equilibrium through which branches of this parameter pass, `known` along another one: the branch that
/// it calls its own is the one closer to the own branch of `known`. `None` where it is not regular.
pub(super) fn branch_point_along(
    problem: &EquilibriumProblem<'_>,
    unknown: &[f64],
    known: &BranchPoint,
    scales: &[f64],
) -> Result<Option<BranchPoint>, Error> {
    let mut tangent = known.tangents[0].clone();
    if let (Some(last), Some(range)) = (tangent.last_mut(), scales.last()) {
        *last = *range;
    }
    BranchPoint::at(problem, unknown, &tangent, scales, 0.0)
}

/// The direction of the line of equilibria, for one and the same value of the parameter, on which an equilibrium lies, as one does where a
/// symmetry shifts states; `None` where it does not.
pub(super) fn line_through(
    problem: &EquilibriumProblem<'_>,
    unknown: &[f64],
    scales: &[f64],
) -> Option<Vec<f64>> {
    let n = problem.dimension;
    let direction = null_vectors(problem, unknown, scales).ok()?.right;
    let largest =
        direction.iter().zip(scales).map(|(entry, scale)| (entry / scale).abs()).fold(0.0, f64::max);
    let mut rank = Rank { problem, scales, differentiator: Differentiator::default() };
    let matrix = rank.matrix(unknown);
    let parameters = problem.parameters_at(&unknown[n..]);
    let mut rates = vec![0.0; n];
    let is_line = WAYS.into_iter().all(|way| {
        let step: Vec<f64> = direction.iter().map(|entry| way * entry / largest).collect();
        let state: Vec<f64> = unknown.iter().zip(&step).map(|(value, step)| value + step).collect();
        problem.field.evaluate(&state, &parameters, &mut rates);
        rates.iter().enumerate().all(|(row, rate)| {
            let terms = step.iter().zip(scales).enumerate();
            let size: f64 =
                terms.map(|(column, (step, scale))| (matrix[row + n * column] * step / scale).abs()).sum();
            rate.abs() <= VANISHING * size
        })
    });
    is_line.then_some(direction)
}
