//! Newton's method on the bordered system, with chord steps while they contract well.

use super::curve::Curve;
use super::settings::Settings;
use crate::error::CorrectionFailure;

/// How a correction went.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Correction {
    /// Number of updates.
    pub iterations: usize,
    /// Distance from the start to the solution, in the curve's metric.
    pub distance: f64,
}

/// A chord step that shrinks the update less than this asks for a new Jacobian.
const CHORD_CONTRACTION: f64 = 0.05;
/// A chord step that shrinks it less than this is not made.
const CHORD_REJECTION: f64 = 0.5;
/// After a first update longer than this the Jacobian at the start is not used again.
const FAR: f64 = 0.03;
/// An update this much longer than the one before it counts as divergence.
const GROWTH_LIMIT: f64 = 2.0;
/// Updates below this may stagnate at the level of rounding and still count as converged.
const STAGNATION_LIMIT: f64 = 1e-7;

/// Solves `F(z) = 0`, `border . (z - start) = 0` from `unknown`, in place.
///
/// # Errors
/// The cause, when the updates do not shrink below the tolerance; `unknown` is then meaningless.
pub fn correct<C: Curve>(
    curve: &mut C,
    unknown: &mut [f64],
    border: &[f64],
    settings: &Settings,
) -> Result<Correction, CorrectionFailure> {
    let start = unknown.to_vec();
    let mut update = vec![0.0; unknown.len()];
    let mut image = vec![0.0; unknown.len()];
    let mut previous = f64::INFINITY;
    let mut previous_fresh = f64::INFINITY;
    let mut fresh_jacobian = true;
    for iteration in 1..=settings.corrector_iterations {
        if fresh_jacobian {
            if curve.factorize(unknown, border, &mut update) == 0.0 {
                return Err(CorrectionFailure::Singular);
            }
        } else {
            curve.residual(unknown, &mut update);
        }
        let last = update.len() - 1;
        update[last] = 0.0;
        curve.solve(&mut update);
        let length = norm(curve, &update, &mut image);
        if !length.is_finite() {
            return Err(CorrectionFailure::NotFinite);
        }
        let contraction = length / previous;
        let stagnates = iteration > 1 && contraction > CHORD_REJECTION && length < STAGNATION_LIMIT;
        if !fresh_jacobian && contraction > CHORD_REJECTION && !stagnates {
            fresh_jacobian = true;
            continue;
        }
        for (entry, step) in unknown.iter_mut().zip(&update) {
            *entry -= step;
        }
        // The error left is below length * contraction once the contraction is known.
        let converged = length < settings.corrector_tolerance
            || (iteration > 1
                && contraction < CHORD_CONTRACTION
                && length * contraction < settings.corrector_tolerance);
        if converged || stagnates {
            for (entry, origin) in update.iter_mut().zip(unknown.iter().zip(&start)) {
                *entry = origin.0 - origin.1;
            }
            let distance = norm(curve, &update, &mut image);
            return Ok(Correction { iterations: iteration, distance });
        }
        // An old Jacobian may not see an error that the new one sees, so updates of different ones are not compared.
        if fresh_jacobian {
            if length > GROWTH_LIMIT * previous_fresh {
                return Err(CorrectionFailure::Diverged);
            }
            previous_fresh = length;
        }
        fresh_jacobian = if iteration == 1 { length > FAR } else { contraction > CHORD_CONTRACTION };
        previous = length;
    }
    Err(CorrectionFailure::Diverged)
}

/// Length of a vector in the curve's metric; `image` is scratch memory.
pub(super) fn norm<C: Curve>(curve: &C, vector: &[f64], image: &mut [f64]) -> f64 {
    curve.apply_metric(vector, image);
    let square = inner(vector, image);
    // Rounding may make it negative; a number that is not finite stays one.
    if square < 0.0 { 0.0 } else { square.sqrt() }
}

/// Euclidean inner product.
pub(super) fn inner(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}
