//! Whether more than one branch passes through a start, and which branch is followed then.

use super::branch_point::BranchPoint;
use super::fold::null_vectors;
use super::problem::EquilibriumProblem;
use crate::algebraic::Differentiator;
use crate::error::Error;
use crate::linear::eigenvalues::eigenvalues;

/// An eigenvalue, and the rate at which a parameter pushes across the branch, count as zero below this part of the fastest
/// rate: the start is a branch point.
const SINGULAR: f64 = 1e-8;
/// Whether more than one branch passes through an equilibrium, or its Jacobian is degenerate in another way.
pub(super) fn is_branching(
    problem: &EquilibriumProblem<'_>,
    unknown: &[f64],
    scales: &[f64],
) -> Result<bool, Error> {
    let n = problem.dimension;
    let mut matrix = vec![0.0; n * (n + 1)];
    let mut residual = vec![0.0; n];
    Differentiator::default().jacobian(problem, unknown, &mut residual, &mut matrix, n);
    let (jacobian, slope) = matrix.split_at(n * n);
    let eigenvalues = eigenvalues(jacobian, n).map_err(|_| Error::Eigenvalues { quantity: "eigenvalues" })?;
    let sizes = || eigenvalues.iter().map(|value| value.norm());
    let rate = sizes().fold(0.0, f64::max);
    if sizes().fold(f64::INFINITY, f64::min) > SINGULAR * rate {
        return Ok(false);
    }
    let (_, left, _) = null_vectors(problem, unknown)?;
    let size = left.iter().zip(scales).map(|(entry, scale)| (entry * scale).powi(2)).sum::<f64>().sqrt();
    let push = left.iter().zip(slope).map(|(p, entry)| p * entry).sum::<f64>() * scales[n];
    Ok(push.abs() <= SINGULAR * rate * size)
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
