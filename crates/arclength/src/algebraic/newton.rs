//! Newton's method on a square system, run until rounding stops it.

use super::{AlgebraicEquations, Differentiator, ScaledLu};
use crate::error::{CorrectionFailure, Error};

/// A solution and the size of the last update of every unknown, an estimate of its error.
#[derive(Clone, Debug)]
pub struct Solved {
    /// The unknowns.
    pub unknown: Vec<f64>,
    /// The last update of each.
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

/// Solves `F(z) = 0`, with as many equations as unknowns, from `start` by Newton's method; `scales` are the sizes of the
/// unknowns.
///
/// Iterates until the updates stop becoming smaller, so that the last one measures how far rounding
/// moves the solution.
///
/// ```
/// use arclength::Scalar;
/// use arclength::algebraic::{AlgebraicProblem, solve_square};
///
/// /// A circle and a line.
/// struct Crossing;
/// impl AlgebraicProblem for Crossing {
///     fn unknowns(&self) -> usize { 2 }
///     fn equations(&self) -> usize { 2 }
///     fn evaluate<T: Scalar>(&self, z: &[T], residual: &mut [T]) {
///         residual[0] = z[0] * z[0] + z[1] * z[1] - 25.0;
///         residual[1] = z[0] * 4.0 - z[1] * 3.0;
///     }
/// }
/// let solved = solve_square(&Crossing, &[2.0, 5.0], &[1.0, 1.0])?;
/// assert_eq!(solved.unknown, [3.0, 4.0]);
/// # Ok::<(), arclength::Error>(())
/// ```
///
/// # Errors
/// [`Error::NotFound`] with the cause when the updates do not become small, [`Error::Invalid`] when the numbers of equations,
/// entries of `start` and scales are not that of the unknowns.
pub fn solve_square<P: AlgebraicEquations>(
    problem: &P,
    start: &[f64],
    scales: &[f64],
) -> Result<Solved, Error> {
    let n = problem.unknowns();
    let given = [("equations", problem.equations()), ("start values", start.len()), ("scales", scales.len())];
    if let Some((name, number)) = given.into_iter().find(|(_, number)| *number != n) {
        return Err(Error::Invalid {
            name: format!("number of {name}"),
            value: number.to_string(),
            allowed: format!("{n}, that of the unknowns"),
        });
    }
    newton(problem, start, scales).map_err(|cause| Error::NotFound { sought: "solution", cause })
}

fn newton<P: AlgebraicEquations>(
    problem: &P,
    start: &[f64],
    scales: &[f64],
) -> Result<Solved, CorrectionFailure> {
    let n = start.len();
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
