//! The run itself: predict, correct, adapt, inspect, locate, repeat.

use super::bracket::locate;
use super::closure::Closure;
use super::corrector::{inner, norm};
use super::{Adaptation, CorrectionFailure, Curve, Ending, Settings, Solution, Stop, correct};
use crate::error::Error;
use std::ops::ControlFlow;

/// A range in which one of the unknowns has to stay.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bound {
    /// Index from the end among the unknowns: 1 is the last. (The unknowns before a parameter can
    /// change in number when a mesh adapts.)
    pub from_end: usize,
    /// Smallest value.
    pub lower: f64,
    /// Largest value.
    pub upper: f64,
}

/// What is asked of a run.
#[derive(Clone, Debug, Default)]
pub struct Request {
    /// Ranges of the parameters; the run ends where the curve leaves one of them.
    pub bounds: Vec<Bound>,
    /// Values of the first bounded parameter at which a solution is wanted exactly.
    pub values: Vec<f64>,
    /// Settings.
    pub settings: Settings,
}

/// What a run found.
#[derive(Debug)]
pub struct Followed<P> {
    /// The solutions in the order of the curve, special and requested ones among them.
    pub solutions: Vec<(Solution<P>, Origin)>,
    /// Why the run ended.
    pub stop: Stop,
}

/// How a solution came to be part of a run.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Origin {
    /// A step of the continuation.
    Step,
    /// Located by [`Curve::special_points`].
    Special,
    /// A parameter value that was asked for.
    Requested,
    /// The end of a range.
    End,
}

/// Largest growth and strongest reduction of the step from one point to the next.
const STEP_GROWTH: f64 = 2.0;
const STEP_REDUCTION: f64 = 0.4;
/// Smallest cosine allowed between consecutive tangents.
const TANGENT_COSINE: f64 = 0.9;
/// The next step aims at this part of the angle allowed.
const ANGLE_PART: f64 = 0.8;
/// Largest angle, in radians, by which a curve in two parameters turns in their plane in one step, unless it moves by less than
/// this part of their ranges: drawn as a polygon it is smooth.
const PLANE_ANGLE: f64 = 0.2;
const PLANE_DISTANCE: f64 = 0.005;
/// Corrections after a change of mesh that may follow each other at one point.
const MOST_ADAPTATIONS: usize = 12;
/// Times that a discretisation is made finer at one point because it does not resolve what was found out there.
const MOST_REFINEMENTS: usize = 6;
/// Part of a step to which the place of a parameter value is narrowed down for a second attempt.
const CLOSE: f64 = 1e-3;
/// Special points this close to the start, in the metric, to which a closed curve comes back are that start.
const AT_START: f64 = 1e-8;
/// Part of its range by which a parameter of the start may move by rounding.
const START_ROUNDING: f64 = 1e-13;

/// Follows the curve from `start` (not necessarily converged) in the direction of `tangent`.
///
/// `observer` is told every accepted solution and may end the run.
///
/// # Errors
/// When no solution is found from the start. Failures later end the run with a [`Stop`].
pub fn follow<C: Curve>(
    curve: &mut C,
    start: Vec<f64>,
    tangent: Vec<f64>,
    request: &Request,
    observer: &mut dyn FnMut(&Solution<C::Point>) -> ControlFlow<()>,
) -> Result<Followed<C::Point>, Error> {
    let settings = &request.settings;
    let asked = start.clone();
    let mut current = converge(curve, start, tangent, settings, &mut [])?;
    // A start on the curve stays exactly at its parameter values.
    for bound in &request.bounds {
        let value = asked[asked.len() - bound.from_end];
        let place = current.unknown.len() - bound.from_end;
        if (current.unknown[place] - value).abs() <= START_ROUNDING * (bound.upper - bound.lower) {
            current.unknown[place] = value;
        }
    }
    let closure = request.bounds.first().map(|bound| Closure::at(curve, &current, *bound));
    let mut solutions = vec![(current.clone(), Origin::Step)];
    let mut previous: Option<(Vec<f64>, f64)> = None;
    let mut step = settings.initial_step;
    if observer(&current).is_break() {
        return Ok(Followed { solutions, stop: Stop::Interrupted });
    }
    for _ in 0..settings.most_steps {
        let advanced = match advance(curve, &mut current, &mut previous, &mut step, request) {
            Ok(next) => next,
            Err(stop) => return Ok(Followed { solutions, stop }),
        };
        let ending = match curve.ending(&current, &advanced) {
            Some(Ending::Between(stop)) => return Ok(Followed { solutions, stop }),
            Some(Ending::After(stop)) => Some(stop),
            None => None,
        };
        let mut special = match curve.special_points(&current, &advanced) {
            Ok(special) => special,
            Err(Error::OtherBranch) => {
                step = STEP_REDUCTION * along(curve, &current, &advanced.unknown);
                previous = None;
                continue;
            }
            Err(error) => return Ok(Followed { solutions, stop: Stop::Failed(error) }),
        };
        let position = |solution: &Solution<C::Point>| along(curve, &current, &solution.unknown);
        special.sort_by(|one, other| position(one).total_cmp(&position(other)));
        let mut between: Vec<(Solution<C::Point>, Origin)> =
            special.into_iter().map(|solution| (solution, Origin::Special)).collect();
        let passed = between.iter().map(|(solution, _)| solution);
        let leaves =
            passed.chain([&advanced]).find_map(|solution| first_exit(&solution.unknown, &request.bounds));
        match requested_values(curve, &current, &mut between, &advanced, request) {
            Ok(()) => {}
            Err(error) => return Ok(Followed { solutions, stop: Stop::Failed(error) }),
        }
        if let Some((bound, value)) = leaves {
            let from_end = request.bounds[bound].from_end;
            // Past a fold outside the range the curve comes back: the end lies before it.
            let outside =
                |solution: &Solution<C::Point>| first_exit(&solution.unknown, &request.bounds).is_some();
            let first_outside = between.iter().position(|(solution, _)| outside(solution));
            let beyond = first_outside.map_or(&advanced, |index| &between[index].0).clone();
            between.truncate(first_outside.unwrap_or(between.len()));
            let near = between.last().map_or(&current, |(solution, _)| solution).clone();
            match fix(curve, &near, &beyond, from_end, value, settings) {
                Ok(end) => between.push((end, Origin::End)),
                Err(Error::NotFound { cause, .. }) => {
                    solutions.extend(between);
                    return Ok(Followed { solutions, stop: Stop::StepTooSmall { cause } });
                }
                Err(error) => return Ok(Followed { solutions, stop: Stop::Failed(error) }),
            }
            for (solution, _) in &between {
                if observer(solution).is_break() {
                    break;
                }
            }
            solutions.extend(between);
            return Ok(Followed { solutions, stop: Stop::RangeEnd { bound, value } });
        }
        if let Some(closure) = &closure
            && solutions.len() > 1
            && let Some(end) = closure.reached(curve, &current, &advanced, settings)
        {
            let place = |solution: &Solution<C::Point>| along(curve, &current, &solution.unknown);
            let reached = place(&end);
            // A special start is found again.
            between.retain(|(solution, _)| place(solution) < reached - AT_START);
            solutions.extend(between);
            solutions.push((solutions[0].0.clone(), Origin::End));
            return Ok(Followed { solutions, stop: Stop::Closed });
        }
        between.push((advanced, Origin::Step));
        for (solution, _) in &between {
            if observer(solution).is_break() {
                solutions.extend(between);
                return Ok(Followed { solutions, stop: Stop::Interrupted });
            }
        }
        let Some((next, _)) = between.last() else { continue };
        let next = next.clone();
        solutions.extend(between);
        if let Some(stop) = ending {
            return Ok(Followed { solutions, stop });
        }
        current = next;
    }
    Ok(Followed { solutions, stop: Stop::MostSteps })
}

/// Corrects a start, adapts the discretisation to it and computes tangent and point.
fn converge<C: Curve>(
    curve: &mut C,
    mut unknown: Vec<f64>,
    mut tangent: Vec<f64>,
    settings: &Settings,
    carried: &mut [&mut Vec<f64>],
) -> Result<Solution<C::Point>, Error> {
    for _ in 0..MOST_ADAPTATIONS {
        let border = metric_image(curve, &tangent);
        correct(curve, &mut unknown, &border, settings)
            .map_err(|cause| Error::NotFound { sought: "solution", cause })?;
        let mut vectors: Vec<&mut Vec<f64>> = vec![&mut tangent];
        vectors.extend(carried.iter_mut().map(|vector| &mut **vector));
        if curve.adapt(&mut unknown, &mut vectors)? == Adaptation::Unchanged {
            break;
        }
    }
    finish(curve, unknown, &tangent)
}

/// Tangent, orientation and point of a converged solution; the new tangent keeps the direction of the old.
pub(crate) fn finish<C: Curve>(
    curve: &mut C,
    unknown: Vec<f64>,
    old_tangent: &[f64],
) -> Result<Solution<C::Point>, Error> {
    let border = metric_image(curve, old_tangent);
    let mut tangent = vec![0.0; unknown.len()];
    let singular = Error::NotFound { sought: "tangent", cause: CorrectionFailure::Singular };
    let sign = curve.factorize(&unknown, &border, &mut tangent);
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
    let point = curve.inspect(&unknown, &tangent, sign)?;
    Ok(Solution { unknown, tangent, orientation: sign, point })
}

/// One accepted step; shortens the step until the corrector succeeds.
fn advance<C: Curve>(
    curve: &mut C,
    current: &mut Solution<C::Point>,
    previous: &mut Option<(Vec<f64>, f64)>,
    step: &mut f64,
    request: &Request,
) -> Result<Solution<C::Point>, Stop> {
    let settings = &request.settings;
    for bound in &request.bounds {
        let rate = current.tangent[current.tangent.len() - bound.from_end].abs();
        let most = settings.largest_parameter_change * (bound.upper - bound.lower);
        if *step * rate > most {
            *step = most / rate;
        }
    }
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
                let too_far = correction.distance > 10.0 * settings.predictor_error.max(0.1 * length);
                (too_far.then_some(CorrectionFailure::Diverged), factor)
            }
        };
        if let Some(cause) = failure {
            *step = length * slower.min(0.5);
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
        let solution = settle(curve, unknown, &mut carried, settings);
        current.unknown = unknown_now;
        current.tangent = tangent_now;
        let solution = match solution {
            Ok(solution) => solution,
            Err(Error::NotFound { cause, .. }) => {
                *previous = old_previous;
                *step = length * STEP_REDUCTION;
                if *step < settings.smallest_step {
                    return Err(Stop::StepTooSmall { cause });
                }
                continue;
            }
            Err(error) => return Err(Stop::Failed(error)),
        };
        let image = metric_image(curve, &solution.tangent);
        let mut scratch = vec![0.0; image.len()];
        // The metric may have changed with the discretisation: lengths behind are measured anew.
        let stretch = norm(curve, &current.tangent, &mut scratch);
        let cosine = inner(&current.tangent, &image) / stretch;
        let plane_angle = angle_in_plane(current, &solution, &request.bounds);
        let turns = cosine < TANGENT_COSINE || plane_angle > PLANE_ANGLE;
        if turns && length > 1e3 * settings.smallest_step {
            *previous = old_previous;
            *step = length * 0.5;
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

/// Angle between the tangents at two solutions in the plane of two bounded parameters; zero if there are not two or the curve
/// moves too little there to be seen.
fn angle_in_plane<P>(current: &Solution<P>, next: &Solution<P>, bounds: &[Bound]) -> f64 {
    let [one, other] = bounds else { return 0.0 };
    let part =
        |vector: &[f64], bound: &Bound| vector[vector.len() - bound.from_end] / (bound.upper - bound.lower);
    let [[a, b], [c, d]] =
        [current, next].map(|solution| [one, other].map(|bound| part(&solution.tangent, bound)));
    let [x, y] = [one, other].map(|bound| part(&next.unknown, bound) - part(&current.unknown, bound));
    if x.hypot(y) < PLANE_DISTANCE { 0.0 } else { (a * d - b * c).atan2(a * c + b * d).abs() }
}

/// Adapts the discretisation to a corrected solution until it holds, then finishes it.
///
/// `carried[1]` is the tangent of the solution before.
fn settle<C: Curve>(
    curve: &mut C,
    mut unknown: Vec<f64>,
    carried: &mut [&mut Vec<f64>],
    settings: &Settings,
) -> Result<Solution<C::Point>, Error> {
    let mut refinements = 0;
    loop {
        for _ in 0..MOST_ADAPTATIONS {
            if curve.adapt(&mut unknown, carried)? == Adaptation::Unchanged {
                break;
            }
            let border = metric_image(curve, carried[1]);
            correct(curve, &mut unknown, &border, settings)
                .map_err(|cause| Error::NotFound { sought: "solution on the adapted mesh", cause })?;
        }
        let tangent = carried[1].clone();
        let solution = finish(curve, unknown, &tangent)?;
        if curve.resolves(&solution.point) || refinements == MOST_REFINEMENTS {
            return Ok(solution);
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

/// First bound that `unknown` violates and the end that was passed.
fn first_exit(unknown: &[f64], bounds: &[Bound]) -> Option<(usize, f64)> {
    bounds.iter().enumerate().find_map(|(index, bound)| {
        let value = unknown[unknown.len() - bound.from_end];
        if value > bound.upper {
            Some((index, bound.upper))
        } else if value < bound.lower {
            Some((index, bound.lower))
        } else {
            None
        }
    })
}

/// Inserts a converged solution wherever the first bounded parameter passes a requested value.
fn requested_values<C: Curve>(
    curve: &mut C,
    current: &Solution<C::Point>,
    between: &mut Vec<(Solution<C::Point>, Origin)>,
    advanced: &Solution<C::Point>,
    request: &Request,
) -> Result<(), Error> {
    let Some(bound) = request.bounds.first() else { return Ok(()) };
    let value_of = |unknown: &[f64]| unknown[unknown.len() - bound.from_end];
    for &value in &request.values {
        let mut index = 0;
        while index <= between.len() {
            let left = if index == 0 { current } else { &between[index - 1].0 };
            let right = between.get(index).map_or(advanced, |(solution, _)| solution);
            let (before, after) = (value_of(&left.unknown) - value, value_of(&right.unknown) - value);
            let passes = (before < 0.0) != (after < 0.0) || after == 0.0;
            if passes && before != 0.0 {
                let settings = &request.settings;
                let found = fix(curve, left, right, bound.from_end, value, settings).or_else(|error| {
                    fix_closely(curve, left, right, bound.from_end, value, settings)?.ok_or(error)
                })?;
                between.insert(index, (found, Origin::Requested));
                index += 1;
            }
            index += 1;
        }
    }
    Ok(())
}

/// The solution between two neighbours at which the unknown `from_end` has the given value.
fn fix<C: Curve>(
    curve: &mut C,
    before: &Solution<C::Point>,
    after: &Solution<C::Point>,
    from_end: usize,
    value: f64,
    settings: &Settings,
) -> Result<Solution<C::Point>, Error> {
    let index = before.unknown.len() - from_end;
    let span = after.unknown[index] - before.unknown[index];
    let fraction = if span == 0.0 { 0.0 } else { ((value - before.unknown[index]) / span).clamp(0.0, 1.0) };
    let mut unknown = interpolate(curve, before, after, fraction);
    unknown[index] = value;
    let mut border = vec![0.0; unknown.len()];
    border[index] = 1.0;
    correct(curve, &mut unknown, &border, settings)
        .map_err(|cause| Error::NotFound { sought: "solution at the value asked for", cause })?;
    unknown[index] = value;
    finish(curve, unknown, &before.tangent)
}

/// As [`fix`], from a start for which the place of the value was narrowed down before: next to a turning point of the unknown
/// only a close start leads to the right one of two solutions. `None` where the value is not passed.
fn fix_closely<C: Curve>(
    curve: &mut C,
    before: &Solution<C::Point>,
    after: &Solution<C::Point>,
    from_end: usize,
    value: f64,
    settings: &Settings,
) -> Result<Option<Solution<C::Point>>, Error> {
    let test = |solution: &Solution<C::Point>| solution.unknown[solution.unknown.len() - from_end] - value;
    let near = locate(curve, before, after, settings, CLOSE, |_, solution| Some(test(solution)))?;
    near.map(|near| fix(curve, &near, &near, from_end, value, settings)).transpose()
}

/// Cubic interpolation between two neighbours.
pub(super) fn interpolate<C: Curve>(
    curve: &C,
    before: &Solution<C::Point>,
    after: &Solution<C::Point>,
    fraction: f64,
) -> Vec<f64> {
    let length = along(curve, before, &after.unknown);
    let s = fraction;
    let (h01, h10, h11) =
        (s * s * (3.0 - 2.0 * s), s * (1.0 - s) * (1.0 - s) * length, s * s * (s - 1.0) * length);
    (0..before.unknown.len())
        .map(|index| {
            before.unknown[index]
                + h01 * (after.unknown[index] - before.unknown[index])
                + h10 * before.tangent[index]
                + h11 * after.tangent[index]
        })
        .collect()
}

/// Position along the tangent at `origin`, in the metric of the curve.
pub(crate) fn along<C: Curve>(curve: &C, origin: &Solution<C::Point>, unknown: &[f64]) -> f64 {
    let image = metric_image(curve, &origin.tangent);
    unknown
        .iter()
        .zip(&origin.unknown)
        .zip(&image)
        .map(|((here, there), weight)| (here - there) * weight)
        .sum()
}

/// `W vector`.
pub(super) fn metric_image<C: Curve>(curve: &C, vector: &[f64]) -> Vec<f64> {
    let mut image = vec![0.0; vector.len()];
    curve.apply_metric(vector, &mut image);
    image
}
