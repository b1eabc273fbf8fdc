//! Where a branch leaves its start: directions, branch points, and the special points at the start itself.
//!
//! Both directions search for special points from a little beyond the start, so that rounding at the start decides nothing.
//! The gap between them is searched here.

use super::branch::BranchDirection;
use super::branch_point::BranchPoint;
use super::curve::{EquilibriumCurve, Inspection, reversed};
use super::events::{beyond, search};
use super::fold::null_vectors;
use super::problem::EquilibriumProblem;
use crate::algebraic::{Differentiator, length, position};
use crate::continuation::{Origin, Solution};
use crate::error::Error;
use crate::linear::eigenvalues::eigenvalues;

/// An eigenvalue, and the rate at which a parameter pushes across the branch, count as zero below this part of the fastest
/// rate: the start is a branch point.
const SINGULAR: f64 = 1e-8;
/// Distance from the start, in the metric, and difference of the parameter, as part of its range, below which a special point
/// is the start.
const SAME_PLACE: f64 = 1e-8;
const SAME_PARAMETER: f64 = 1e-14;

type Node = Solution<Inspection>;

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

/// Special points at the start and close to it, in the order of the curve.
///
/// `first_beyond` are the solutions from which on the directions, backward and forward, were searched.
pub(super) fn at_start(
    curve: &mut EquilibriumCurve<'_>,
    directions: &[BranchDirection; 2],
    first_beyond: [Option<Node>; 2],
) -> Result<Vec<Node>, Error> {
    let first = |index: usize| -> Option<Node> { Some(directions[index].solutions.first()?.0.clone()) };
    let mut ends = [None, None];
    for (index, known) in first_beyond.into_iter().enumerate() {
        // A direction that has no step ends at the start; the other one knows the start as well.
        let start = || first(index).or_else(|| first(1 - index).map(reversed));
        ends[index] = match known {
            Some(node) => Some(node),
            None => start().and_then(|node| beyond(curve, &node, 0, f64::INFINITY)),
        };
    }
    let [Some(backward), Some(forward)] = ends else { return Ok(Vec::new()) };
    search(curve, &reversed(backward), &forward)
}

/// Puts special points where they belong at the start, `solutions[start]`; one that is the start takes its place. Returns the
/// new place of the start.
pub(super) fn insert(
    solutions: &mut Vec<(Node, Origin)>,
    mut start: usize,
    special: Vec<Node>,
    scales: &[f64],
) -> usize {
    let Some((origin, _)) = solutions.get(start).cloned() else { return start };
    let (mut before, mut after) = (Vec::new(), Vec::new());
    let mut at = None;
    for mut node in special {
        let last = node.unknown.len() - 1;
        let offset: Vec<f64> = node.unknown.iter().zip(&origin.unknown).map(|(a, b)| a - b).collect();
        let same =
            length(&offset, scales) < SAME_PLACE && offset[last].abs() <= SAME_PARAMETER * scales[last];
        // A start on another branch is the branch point between the two directions.
        if same && origin.point.special.is_some() {
            continue;
        }
        if same && at.is_none() {
            node.unknown[last] = origin.unknown[last];
            at = Some(node);
        } else if at.is_none() && position(&origin, &node.unknown, scales) < 0.0 {
            before.push((node, Origin::Special));
        } else {
            after.push((node, Origin::Special));
        }
    }
    solutions.splice(start + 1..start + 1, after);
    if let Some(node) = at {
        solutions[start] = (node, Origin::Special);
    }
    let count = before.len();
    solutions.splice(start..start, before);
    start += count;
    start
}
