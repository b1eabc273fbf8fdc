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
/// Part of a step that counts as an error that is aimed at, where corrections are too long.
const AIMED_PART: f64 = 0.01;
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
    *step = within_bounds(*step, current, bounds, settings);
    let kept = keep(curve, current, previous);
    loop {
        let length = *step;
        let Corrected { unknown, growth } =
            match correct_prediction(curve, current, previous.as_ref(), length, settings) {
                Ok(corrected) => corrected,
                Err(Rejected { cause, reduction }) => {
                    *step = length * reduction.min(STEP_HALVING);
                    if *step < settings.smallest_step {
                        return Err(Stop::StepTooSmall { cause });
                    }
                    continue;
                }
            };
        let mut before = previous.take();
        let solution = match settle_both_ends(curve, unknown, (current, &mut before), settings) {
            Ok(solution) => solution,
            Err(Error::NotFound { cause, .. }) => {
                *previous = before;
                *step = length * STEP_REDUCTION;
                if *step < settings.smallest_step {
                    return Err(Stop::StepTooSmall { cause });
                }
                return_to(curve, (current, previous), kept.as_ref(), settings).map_err(stopped)?;
                continue;
            }
            Err(error) => return Err(Stop::Failed(error)),
        };
        let turn = Turn::between(curve, current, &solution, bounds);
        if turn.is_too_large() && length > TURNING_LIMIT * settings.smallest_step {
            *previous = before;
            *step = length * STEP_HALVING;
            return_to(curve, (current, previous), kept.as_ref(), settings).map_err(stopped)?;
            continue;
        }
        let stretch = turn.stretch;
        *previous = Some((current.tangent.iter().map(|entry| entry / stretch).collect(), length * stretch));
        *step = (length * turn.limit(growth).max(STEP_REDUCTION)).min(settings.largest_step);
        return Ok(solution);
    }
}

/// The step, shortened where the parameters would change by more than is allowed or leave their ranges.
fn within_bounds<P>(mut step: f64, current: &Solution<P>, bounds: &[Bound], settings: &Settings) -> f64 {
    for bound in bounds {
        let slope = current.tangent[current.tangent.len() - bound.from_end];
        let rate = slope.abs();
        let most = settings.largest_parameter_change * bound.width();
        if step * rate > most {
            step = most / rate;
        }
        // The problem need not make sense far outside the range.
        let value = bound.value(&current.unknown);
        let left = if slope > 0.0 { bound.upper - value } else { value - bound.lower };
        let to_end = (left + OVERSHOOT * bound.width()) / rate;
        if to_end > 0.0 && step > to_end {
            step = to_end;
        }
    }
    step
}

/// A prediction that was corrected.
struct Corrected {
    unknown: Vec<f64>,
    /// By which factor the next step may be longer, as far as the correction tells.
    growth: f64,
}

/// A prediction that could not be corrected, or led elsewhere.
struct Rejected {
    cause: CorrectionFailure,
    /// By which factor the step is to be shortened at least.
    reduction: f64,
}

/// The point of the curve next to the one predicted at the distance `length`.
fn correct_prediction<C: Curve>(
    curve: &mut C,
    current: &Solution<C::Point>,
    previous: Option<&Before>,
    length: f64,
    settings: &Settings,
) -> Result<Corrected, Rejected> {
    let mut unknown = predict(current, previous, length);
    let border = metric_image(curve, &current.tangent);
    let correction = correct(curve, &mut unknown, &border, settings)
        .map_err(|cause| Rejected { cause, reduction: STEP_REDUCTION })?;
    let ratio = settings.predictor_error / correction.distance.max(1e-300);
    // The predictor's error grows with the square of the step at least.
    let growth = ratio.sqrt().clamp(STEP_REDUCTION, STEP_GROWTH);
    if correction.distance > settings.largest_correction * settings.predictor_error.max(AIMED_PART * length) {
        return Err(Rejected { cause: CorrectionFailure::Diverged, reduction: growth });
    }
    Ok(Corrected { unknown, growth })
}

/// Settles the end of a step and carries the solution from which it was made over to the discretisation there, with what was before
/// that: both ends of a step have one normalisation.
fn settle_both_ends<C: Curve>(
    curve: &mut C,
    unknown: Vec<f64>,
    (current, before): (&mut Solution<C::Point>, &mut Option<Before>),
    settings: &Settings,
) -> Result<Solution<C::Point>, Error> {
    let mut carried = vec![&mut current.unknown, &mut current.tangent];
    carried.extend(before.as_mut().map(|(tangent, _)| tangent));
    let settled = settle(curve, unknown, &mut carried, settings);
    curve.carry_over(&mut current.point);
    let (solution, adaptation) = settled?;
    if adaptation == Adaptation::Renormalised {
        renormalise(curve, current, settings)?;
        *before = None;
    }
    Ok(solution)
}

/// How much a curve turns over a step.
struct Turn {
    cosine: f64,
    /// Angle in the plane of two parameters.
    plane_angle: f64,
    /// Length of the tangent at the beginning, in the metric at the end.
    stretch: f64,
}

impl Turn {
    fn between<C: Curve>(
        curve: &C,
        current: &Solution<C::Point>,
        next: &Solution<C::Point>,
        bounds: &[Bound],
    ) -> Self {
        let image = metric_image(curve, &next.tangent);
        let mut scratch = vec![0.0; image.len()];
        // The metric may have changed with the discretisation: lengths behind are measured anew.
        let stretch = norm(curve, &current.tangent, &mut scratch);
        let cosine = inner(&current.tangent, &image) / stretch;
        Self { cosine, plane_angle: angle_in_plane(current, next, bounds), stretch }
    }

    fn is_too_large(&self) -> bool {
        self.cosine < TANGENT_COSINE || self.plane_angle > PLANE_ANGLE
    }

    /// The growth of the step, at most that at which the curve turns in the next as is aimed at.
    fn limit(&self, growth: f64) -> f64 {
        let angle = self.cosine.min(1.0).acos();
        growth
            .min(ANGLE_PART * TANGENT_COSINE.acos() / angle.max(f64::MIN_POSITIVE))
            .min(ANGLE_PART * PLANE_ANGLE / self.plane_angle.max(f64::MIN_POSITIVE))
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
