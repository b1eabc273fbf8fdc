//! Newton's method on the bordered system, with chord steps while they contract well, and the solutions that it gives.

use super::curve::Curve;
use super::metric::{along, metric_image, norm};
use super::settings::Settings;
use super::solution::{Solution, interpolate};
use crate::error::{CorrectionFailure, Error};
use crate::random::Random;

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
/// Updates up to this may be measured to be rounding: those of a parameter on which the solutions hardly depend.
const ROUNDING_LIMIT: f64 = 1e-4;
/// An update is rounding where it is below this many times the update that rounding of the unknowns makes.
const ROUNDING_SHARE: f64 = 4.0;
/// Roundings of the unknowns that are tried.
const ROUNDINGS: usize = 3;

/// The largest update that is made by rounding the unknowns.
fn rounding_update<C: Curve>(curve: &mut C, unknown: &[f64]) -> f64 {
    let mut image = vec![0.0; unknown.len()];
    let updates = rounding_updates(curve, unknown);
    updates.iter().map(|update| norm(curve, update, &mut image)).fold(0.0, f64::max)
}

/// The updates that are made by rounding each unknown up or down by one unit in the last place, by pseudo-random choice; the Jacobian
/// is the one that was factorised last.
pub(crate) fn rounding_updates<C: Curve>(curve: &mut C, unknown: &[f64]) -> [Vec<f64>; ROUNDINGS] {
    let mut here = vec![0.0; unknown.len()];
    curve.residual(unknown, &mut here);
    let mut random = Random::new(1);
    std::array::from_fn(|_| {
        let rounded: Vec<f64> = unknown
            .iter()
            .map(|&value| if random.next_unit() < 0.5 { value.next_up() } else { value.next_down() })
            .collect();
        let mut update = vec![0.0; unknown.len()];
        curve.residual(&rounded, &mut update);
        for (there, here) in update.iter_mut().zip(&here) {
            *there -= here;
        }
        let last = update.len() - 1;
        update[last] = 0.0;
        curve.solve(&mut update);
        update
    })
}

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
            return Err(curve.why_not_finite(unknown));
        }
        let contraction = length / previous;
        let stands = iteration > 1 && contraction > CHORD_REJECTION;
        // An old Jacobian may contract slowly and still lead on.
        let stagnates = stands
            && fresh_jacobian
            && (length < STAGNATION_LIMIT
                || (curve.may_stagnate()
                    && length < ROUNDING_LIMIT
                    && length < ROUNDING_SHARE * rounding_update(curve, unknown)));
        if !fresh_jacobian && contraction > CHORD_REJECTION {
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

/// The solution with `unknown` up to a correction across the tangent of `origin`.
///
/// # Errors
/// [`Error::NotFound`] when the corrector fails.
pub(crate) fn across<C: Curve>(
    curve: &mut C,
    origin: &Solution<C::Point>,
    mut unknown: Vec<f64>,
    settings: &Settings,
) -> Result<Solution<C::Point>, Error> {
    let border = metric_image(curve, &origin.tangent);
    correct(curve, &mut unknown, &border, settings)
        .map_err(|cause| Error::NotFound { sought: "solution between two points", cause })?;
    finish(curve, unknown, &origin.tangent)
}

/// A solution between two neighbours, at a fraction of the way.
///
/// # Errors
/// [`Error::NotFound`] when the corrector fails.
pub(crate) fn between<C: Curve>(
    curve: &mut C,
    before: &Solution<C::Point>,
    after: &Solution<C::Point>,
    fraction: f64,
    settings: &Settings,
) -> Result<Solution<C::Point>, Error> {
    let length = along(curve, before, &after.unknown);
    across(curve, before, interpolate(before, after, length, fraction), settings)
}

/// Completes a corrected solution: tangent in the direction of `old_tangent`, orientation, point.
///
/// # Errors
/// When the bordered Jacobian is singular or the point cannot be inspected.
pub(crate) fn finish<C: Curve>(
    curve: &mut C,
    unknown: Vec<f64>,
    old_tangent: &[f64],
) -> Result<Solution<C::Point>, Error> {
    let (tangent, sign) = tangent_at(curve, &unknown, old_tangent)?;
    let point = curve.inspect(&unknown, &tangent, sign)?;
    Ok(Solution { unknown, tangent, orientation: sign, point })
}

/// Completes a corrected solution as [`finish`] does and measures its errors.
///
/// # Errors
/// As [`finish`].
pub(crate) fn finish_measured<C: Curve>(
    curve: &mut C,
    unknown: Vec<f64>,
    old_tangent: &[f64],
) -> Result<Solution<C::Point>, Error> {
    let mut solution = finish(curve, unknown, old_tangent)?;
    curve.measure(&mut solution);
    Ok(solution)
}

/// The unit tangent at a corrected solution in the direction of `old_tangent`, with the sign of the determinant.
fn tangent_at<C: Curve>(
    curve: &mut C,
    unknown: &[f64],
    old_tangent: &[f64],
) -> Result<(Vec<f64>, f64), Error> {
    let border = metric_image(curve, old_tangent);
    let mut tangent = vec![0.0; unknown.len()];
    let singular = Error::NotFound { sought: "tangent", cause: CorrectionFailure::Singular };
    let sign = curve.factorize(unknown, &border, &mut tangent);
    if sign == 0.0 {
        return Err(singular);
    }
    tangent.fill(0.0);
    if let Some(last) = tangent.last_mut() {
        *last = 1.0;
    }
    curve.solve(&mut tangent);
    let mut image = vec![0.0; tangent.len()];
    let length = norm(curve, &tangent, &mut image);
    if !(length.is_finite() && length > 0.0) {
        return Err(singular);
    }
    tangent.iter_mut().for_each(|entry| *entry /= length);
    Ok((tangent, sign))
}

/// Solves once more for a solution whose normalisation is that of another one; its point stays.
///
/// # Errors
/// [`Error::NotFound`] when the corrector fails; the solution is then what it was.
pub(crate) fn renormalise<C: Curve>(
    curve: &mut C,
    solution: &mut Solution<C::Point>,
    settings: &Settings,
) -> Result<(), Error> {
    let border = metric_image(curve, &solution.tangent);
    let mut unknown = solution.unknown.clone();
    correct(curve, &mut unknown, &border, settings)
        .map_err(|cause| Error::NotFound { sought: "solution in the new normalisation", cause })?;
    let (tangent, orientation) = tangent_at(curve, &unknown, &solution.tangent)?;
    *solution = Solution { unknown, tangent, orientation, point: solution.point.clone() };
    Ok(())
}
