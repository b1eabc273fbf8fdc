//! One step: predict, correct, adapt the discretisation, shorten where the corrector fails or the curve turns too much.

use super::corrector::{correct, finish_measured, renormalise};
use super::curve::{Adaptation, Curve};
use super::metric::{inner, metric_image, norm};
use super::settings::Settings;
use super::solution::{Bound, Solution};
use super::stop::Stop;
use crate::error::{CorrectionFailure, Error};

/// Largest growth and strongest reduction of the step from one point to the next.
const STEP_GROWTH: f64 = 2.0;
pub(super) const STEP_REDUCTION: f64 = 0.4;
/// Reduction of the step where the corrector fails or the curve turns too much.
const STEP_HALVING: f64 = 0.5;
/// Smallest cosine allowed between consecutive tangents.
const TANGENT_COSINE: f64 = 0.9;
/// The next step aims at this part of the angle allowed.
const ANGLE_PART: f64 = 0.8;
/// Steps shorter than this many times the smallest one are taken however much the curve turns.
const TURNING_LIMIT: f64 = 1e3;
/// A correction longer than this many times what is aimed at, or than this part of the step if that is more, has led elsewhere.
const FAR_CORRECTION: f64 = 10.0;
const FAR_CORRECTION_PART: f64 = 0.1;
/// Largest angle, in radians, by which a curve in two parameters turns in their plane in one step, unless it moves by less than
/// this part of their ranges: drawn as a polygon it is smooth.
const PLANE_ANGLE: f64 = 0.2;
const PLANE_DISTANCE: f64 = 0.005;
/// Part of a parameter's range by which a step is predicted to leave it at most.
const OVERSHOOT: f64 = 0.01;
/// Corrections after a change of mesh that may follow each other at one point.
const MOST_ADAPTATIONS: usize = 12;
/// Times that a discretisation is made finer at one point because it does not resolve what was found out there.
const MOST_REFINEMENTS: usize = 6;

/// Corrects a start, adapts the discretisation to it and computes tangent and point.
pub(crate) fn converge<C: Curve>(
    curve: &mut C,
    mut unknown: Vec<f64>,
    mut tangent: Vec<f64>,
    settings: &Settings,
) -> Result<Solution<C::Point>, Error> {
    for _ in 0..MOST_ADAPTATIONS {
        let border = metric_image(curve, &tangent);
        correct(curve, &mut unknown, &border, settings)
            .map_err(|cause| Error::NotFound { sought: "solution", cause })?;
        if curve.adapt(&mut unknown, &mut [&mut tangent])? == Adaptation::Unchanged {
            break;
        }
    }
    finish_measured(curve, unknown, &tangent)
}

/// One accepted step; shortens the step until the corrector succeeds.
pub(super) fn advance<C: Curve>(
    curve: &mut C,
    current: &mut Solution<C::Point>,
    previous: &mut Option<Before>,
    step: &mut f64,
    bounds: &[Bound],
    settings: &Settings,
) -> Result<Solution<C::Point>, Stop<C::Reason>> {
    for bound in bounds {
        let rate = current.tangent[current.tangent.len() - bound.from_end].abs();
        let most = settings.largest_parameter_change * bound.width();
        if *step * rate > most {
            *step = most / rate;
        }
        // The problem need not make sense far outside the range.
        let slope = current.tangent[current.tangent.len() - bound.from_end];
        let value = bound.value(&current.unknown);
        let left = if slope > 0.0 { bound.upper - value } else { value - bound.lower };
        let to_end = (left + OVERSHOOT * bound.width()) / rate;
        if to_end > 0.0 && *step > to_end {
            *step = to_end;
        }
    }
    let kept = keep(curve, current, previous);
    loop {
        let length = *step;
        let mut unknown = predict(current, previous.as_ref(), length);
        let border = metric_image(curve, &current.tangent);
        let corrected = correct(curve, &mut unknown, &border, settings);
        let (failure, slower) = match corrected {
            Err(cause) => (Some(cause), STEP_REDUCTION),
            Ok(correction) => {
                let ratio = settings.predictor_error / correction.distance.max(1e-300);
                // The predictor's error grows with the square of the step at least.
                let factor = ratio.sqrt().clamp(STEP_REDUCTION, STEP_GROWTH);
                let too_far = correction.distance
                    > FAR_CORRECTION * settings.predictor_error.max(FAR_CORRECTION_PART * length);
                (too_far.then_some(CorrectionFailure::Diverged), factor)
            }
        };
        if let Some(cause) = failure {
            *step = length * slower.min(STEP_HALVING);
            if *step < settings.smallest_step {
                return Err(Stop::StepTooSmall { cause });
            }
            continue;
        }
        let mut old_previous = previous.take();
        let mut unknown_now = std::mem::take(&mut current.unknown);
        let mut tangent_now = std::mem::take(&mut current.tangent);
        let mut carried: Vec<&mut Vec<f64>> = vec![&mut unknown_now, &mut tangent_now];
        if let Some((tangent, _)) = old_previous.as_mut() {
            carried.push(tangent);
        }
        let settled = settle(curve, unknown, &mut carried, settings);
        current.unknown = unknown_now;
        current.tangent = tangent_now;
        curve.carry_over(&mut current.point);
        // Both ends of a step have one normalisation.
        let settled = settled.and_then(|(solution, adaptation)| {
            if adaptation == Adaptation::Renormalised {
                renormalise(curve, current, settings)?;
                old_previous = None;
            }
            Ok(solution)
        });
        let solution = match settled {
            Ok(solution) => solution,
            Err(Error::NotFound { cause, .. }) => {
                *previous = old_previous;
                *step = length * STEP_REDUCTION;
                if *step < settings.smallest_step {
                    return Err(Stop::StepTooSmall { cause });
                }
                return_to(curve, (current, previous), kept.as_ref(), settings).map_err(stopped)?;
                continue;
            }
            Err(error) => return Err(Stop::Failed(error)),
        };
        let image = metric_image(curve, &solution.tangent);
        let mut scratch = vec![0.0; image.len()];
        // The metric may have changed with the discretisation: lengths behind are measured anew.
        let stretch = norm(curve, &current.tangent, &mut scratch);
        let cosine = inner(&current.tangent, &image) / stretch;
        let plane_angle = angle_in_plane(current, &solution, bounds);
        let turns = cosine < TANGENT_COSINE || plane_angle > PLANE_ANGLE;
        if turns && length > TURNING_LIMIT * settings.smallest_step {
            *previous = old_previous;
            *step = length * STEP_HALVING;
            return_to(curve, (current, previous), kept.as_ref(), settings).map_err(stopped)?;
            continue;
        }
        *previous = Some((current.tangent.iter().map(|entry| entry / stretch).collect(), length * stretch));
        let angle = cosine.min(1.0).acos();
        let growth = slower
            .min(ANGLE_PART * TANGENT_COSINE.acos() / angle.max(f64::MIN_POSITIVE))
            .min(ANGLE_PART * PLANE_ANGLE / plane_angle.max(f64::MIN_POSITIVE));
        *step = (length * growth.max(STEP_REDUCTION)).min(settings.largest_step);
        return Ok(solution);
    }
}

/// Adapts discretisation and normalisation once more to a solution from which a step was made that did not hold: they are those
/// of the end of that step, from which the solution differs by more than a distance along the curve.
///
/// # Errors
/// As [`Curve::adapt`], and when the corrector fails.
pub(super) fn return_to<C: Curve>(
    curve: &mut C,
    (solution, previous): (&mut Solution<C::Point>, &mut Option<Before>),
    kept: Option<&Kept<C::Point>>,
    settings: &Settings,
) -> Result<(), Error> {
    if let Some((kept, before)) = kept {
        curve.take_back(kept);
        (*solution, *previous) = (kept.clone(), before.clone());
        return Ok(());
    }
    let mut carried = vec![&mut solution.tangent];
    carried.extend(previous.as_mut().map(|(tangent, _)| tangent));
    curve.adapt(&mut solution.unknown, &mut carried)?;
    curve.carry_over(&mut solution.point);
    renormalise(curve, solution, settings)
}

/// The tangent of the solution before and the length of the step from it.
type Before = (Vec<f64>, f64);

/// A solution as it was before the step from it, with what was before it.
pub(super) type Kept<P> = (Solution<P>, Option<Before>);

/// Keeps a solution where it would lose in being carried over to another discretisation.
pub(super) fn keep<C: Curve>(
    curve: &C,
    solution: &Solution<C::Point>,
    previous: &Option<Before>,
) -> Option<Kept<C::Point>> {
    curve.keeps_solutions().then(|| (solution.clone(), previous.clone()))
}

/// The end of a run whose last solution cannot be found again.
pub(super) fn stopped<R>(error: Error) -> Stop<R> {
    match error {
        Error::NotFound { cause, .. } => Stop::StepTooSmall { cause },
        error => Stop::Failed(error),
    }
}

/// Angle between the tangents at two solutions in the plane of two bounded parameters; zero if there are not two or the curve
/// moves too little there to be seen.
fn angle_in_plane<P>(current: &Solution<P>, next: &Solution<P>, bounds: &[Bound]) -> f64 {
    let [one, other] = bounds else { return 0.0 };
    let part = |vector: &[f64], bound: &Bound| vector[vector.len() - bound.from_end] / bound.width();
    let [[a, b], [c, d]] =
        [current, next].map(|solution| [one, other].map(|bound| part(&solution.tangent, bound)));
    let [x, y] = [one, other].map(|bound| part(&next.unknown, bound) - part(&current.unknown, bound));
    if x.hypot(y) < PLANE_DISTANCE { 0.0 } else { (a * d - b * c).atan2(a * c + b * d).abs() }
}

/// Adapts the discretisation to a corrected solution until it holds, then finishes it.
///
/// `carried[1]` is the tangent of the solution before. Of several adaptations the one that changed most is told.
fn settle<C: Curve>(
    curve: &mut C,
    mut unknown: Vec<f64>,
    carried: &mut [&mut Vec<f64>],
    settings: &Settings,
) -> Result<(Solution<C::Point>, Adaptation), Error> {
    let mut refinements = 0;
    let mut most = Adaptation::Unchanged;
    loop {
        for _ in 0..MOST_ADAPTATIONS {
            let adaptation = curve.adapt(&mut unknown, carried)?;
            if adaptation == Adaptation::Unchanged {
                break;
            }
            most = most.max(adaptation);
            let border = metric_image(curve, carried[1]);
            correct(curve, &mut unknown, &border, settings)
                .map_err(|cause| Error::NotFound { sought: "solution on the adapted mesh", cause })?;
        }
        let tangent = carried[1].clone();
        let solution = finish_measured(curve, unknown, &tangent)?;
        if curve.resolves(&solution.point) || refinements == MOST_REFINEMENTS {
            return Ok((solution, most));
        }
        unknown = solution.unknown;
        refinements += 1;
    }
}

/// Point predicted at the distance `length`: along the tangent, bent by the change of the tangent over
/// the step before where there was one.
fn predict<P>(current: &Solution<P>, previous: Option<&(Vec<f64>, f64)>, length: f64) -> Vec<f64> {
    let mut unknown = current.unknown.clone();
    for (entry, slope) in unknown.iter_mut().zip(&current.tangent) {
        *entry += length * slope;
    }
    if let Some((tangent, travelled)) = previous.filter(|(tangent, _)| tangent.len() == unknown.len()) {
        let bend = 0.5 * length * length / travelled;
        for (entry, (now, then)) in unknown.iter_mut().zip(current.tangent.iter().zip(tangent)) {
            *entry += bend * (now - then);
        }
    }
    unknown
}
