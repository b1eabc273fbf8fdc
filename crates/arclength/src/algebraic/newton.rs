//! Newton's method on a square system, run until rounding stops it.

use super::{AlgebraicProblem, Differentiator, ScaledLu};
use crate::error::CorrectionFailure;

/// A solution and the size of the last update of every unknown, an estimate of its error.
#[derive(Clone, Debug)]
pub(crate) struct Solved {
    pub unknown: Vec<f64>,
    pub last_update: Vec<f64>,
}

/// Most updates. Quadratic convergence needs about six.
const MOST_UPDATES: usize = 25;
/// Updates (relative to the scales) below which convergence has happened and only rounding is left.
const CONVERGED: f64 = 1e-9;
/// Slow updates (no quadratic convergence although close) after which the solution counts as singular.
const MOST_SLOW_UPDATES: usize = 4;
/// An update below this cannot be improved on.
const ROUNDING: f64 = 4.0 * f64::EPSILON;

/// Solves `F(z) = 0` from `start`; `scales` are the sizes of the unknowns.
///
/// Iterates until the updates stop becoming smaller, so that the last one measures how far rounding
/// moves the solution.
///
/// # Errors
/// The cause, when the updates do not become small.
pub(crate) fn solve_square<P: AlgebraicProblem>(
    problem: &P,
    start: &[f64],
    scales: &[f64],
) -> Result<Solved, CorrectionFailure> {
    let n = problem.unknowns();
    let mut differentiator = Differentiator::default();
    let mut lu = ScaledLu::default();
    let mut matrix = vec![0.0; n * n];
    let mut update = vec![0.0; n];
    let mut unknown = start.to_vec();
    let mut best: Option<(f64, Solved)> = None;
    let mut previous = f64::INFINITY;
    let mut slow = 0;
    for _ in 0..MOST_UPDATES {
        differentiator.jacobian(problem, &unknown, &mut update, &mut matrix, n);
        if update.iter().chain(&matrix).any(|entry| !entry.is_finite()) {
            return best.map(|(_, solved)| solved).ok_or(CorrectionFailure::NotFinite);
        }
        if lu.factorize(n, &matrix, scales) == 0.0 {
            return best.map(|(_, solved)| solved).ok_or(CorrectionFailure::Singular);
        }
        lu.solve(&mut update);
        let size = update
            .iter()
            .zip(scales)
            .fold(0.0_f64, |largest, (step, scale)| largest.max((step / scale).abs()));
        if !size.is_finite() {
            return best.map(|(_, solved)| solved).ok_or(CorrectionFailure::NotFinite);
        }
        for (entry, step) in unknown.iter_mut().zip(&update) {
            *entry -= step;
        }
        if previous < 1e-2 && size > 0.2 * previous && size > CONVERGED {
            slow += 1;
            if slow > MOST_SLOW_UPDATES {
                return Err(CorrectionFailure::Diverged);
            }
        }
        if size < CONVERGED {
            if best.as_ref().is_none_or(|(smallest, _)| size < *smallest) {
                best = Some((size, Solved { unknown: unknown.clone(), last_update: update.clone() }));
            }
            if size < ROUNDING || size > 0.5 * previous {
                break;
            }
        }
        previous = size;
    }
    best.map(|(_, solved)| solved).ok_or(CorrectionFailure::Diverged)
}
