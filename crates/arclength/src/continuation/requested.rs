//! Solutions that were asked for: at values of the parameter, where a monitor has a value, at the ends of ranges.

use super::bracket::{locate, locate_value};
use super::corrector::{between as solution_between, correct, finish_measured};
use super::curve::Curve;
use super::metric::along;
use super::settings::Settings;
use super::solution::{Bound, Solution, interpolate};
use crate::error::{CorrectionFailure, Error};
use std::fmt;

/// How a solution came to be part of a run.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Origin<K> {
    /// A step of the continuation.
    Step,
    /// A special point.
    Special(K),
    /// A parameter value that was asked for.
    Requested,
    /// A value of a monitor that was asked for: the index of the target.
    Target(usize),
    /// The end of a range.
    End,
}

/// What a run does at a value of a monitor.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Purpose {
    /// It has a solution there.
    Point,
    /// It has one if one can be computed there, and goes on without it otherwise.
    Mark,
    /// It ends there.
    End,
}

/// A value of a monitor at which a solution is wanted.
pub struct Target<'f, P> {
    /// Index of the monitor.
    pub monitor: usize,
    /// The value.
    pub value: f64,
    /// What the run does there.
    pub purpose: Purpose,
    /// The monitor; `None` where it does not exist.
    #[allow(clippy::type_complexity)]
    pub function: Box<dyn Fn(&Solution<P>) -> Option<f64> + 'f>,
}

impl<P> fmt::Debug for Target<'_, P> {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { monitor, value, purpose, .. } = self;
        write!(formatter, "monitor {monitor} at {value}, {purpose:?}")
    }
}

/// Part of a step to which the place of a parameter value is narrowed down for a second attempt.
const CLOSE: f64 = 1e-3;
/// Part of a step to which the place of a target is narrowed down, unless the monitor has its value to this part of itself before.
const TARGET_BRACKET: f64 = 1e-13;
const TARGET_VALUE: f64 = 1e-11;

/// Parabolas that are tried for an extreme value of a monitor, the part of what one spans by which it may be wrong, and the difference of
/// two places in a step that are the same.
const MOST_PARABOLAS: usize = 8;
const UNCERTAIN_PART: f64 = 0.1;
const SAME_FRACTION: f64 = 1e-6;

/// Solutions between two neighbours, in order.
pub(super) type Between<C> = Vec<(Solution<<C as Curve>::Point>, Origin<<C as Curve>::Kind>)>;

/// Inserts a converged solution wherever the first bounded parameter passes a requested value. Whether all were found: none can be told
/// from a branch point that has that value, and where the curve bends sharply within a step none may be found from its ends.
///
/// # Errors
/// When eigenvalues of a solution cannot be computed.
pub(super) fn insert_values<C: Curve>(
    curve: &mut C,
    current: &Solution<C::Point>,
    between: &mut Between<C>,
    advanced: &Solution<C::Point>,
    (bound, values): (Bound, &[f64]),
    settings: &Settings,
) -> Result<bool, Error> {
    let mut all_found = true;
    for &value in values {
        let test = |_: &mut C, solution: &Solution<C::Point>| Some(bound.value(&solution.unknown) - value);
        all_found &= insert_passages(curve, current, between, advanced, test, |curve, left, right| {
            let found = fix(curve, left, right, bound.from_end, value, settings).or_else(|error| {
                fix_closely(curve, left, right, bound.from_end, value, settings)?.ok_or(error)
            });
            let found = match found {
                // At a turning point or a branch point the value does not determine the solution: its place along the curve does.
                Err(Error::NotFound { .. }) => {
                    let tolerances = (TARGET_BRACKET, TARGET_VALUE * value.abs());
                    match locate_value(curve, [left, right], &settings.for_locating(), tolerances, test) {
                        Err(Error::NotFound { .. }) => None,
                        found => found?,
                    }
                }
                found => Some(found?),
            };
            Ok(found.map(|solution| (solution, Origin::Requested)))
        })?;
    }
    Ok(all_found)
}

/// Inserts a solution wherever a monitor passes the value of a target; `earlier` is the solution before `current`, if there is one.
///
/// # Errors
/// When a solution between two others cannot be computed.
pub(super) fn insert_targets<C: Curve>(
    curve: &mut C,
    earlier: Option<&Solution<C::Point>>,
    current: &Solution<C::Point>,
    between: &mut Between<C>,
    advanced: &Solution<C::Point>,
    targets: &[Target<'_, C::Point>],
    settings: &Settings,
) -> Result<(), Error> {
    let settings = settings.for_locating();
    for (index, target) in targets.iter().enumerate() {
        let test =
            |_: &mut C, solution: &Solution<C::Point>| Some((target.function)(solution)? - target.value);
        let tolerances = (TARGET_BRACKET, TARGET_VALUE * target.value.abs());
        let find = |curve: &mut C, left: &Solution<C::Point>, right: &Solution<C::Point>| {
            let found = match locate_value(curve, [left, right], &settings, tolerances, test) {
                Err(Error::NotFound { .. }) if target.purpose == Purpose::Mark => None,
                found => found?,
            };
            Ok(found.map(|solution| (solution, Origin::Target(index))))
        };
        insert_passages(curve, current, between, advanced, test, find)?;
        if let Some((place, beyond)) =
            beyond_extreme(curve, earlier, current, between, advanced, test, &settings)
        {
            // Both passages, there and back.
            let left = if place == 0 { current } else { &between[place - 1].0 };
            let right = between.get(place).map_or(advanced, |(solution, _)| solution);
            let pair = [find(curve, left, &beyond)?, find(curve, &beyond, right)?];
            between.splice(place..place, pair.into_iter().flatten());
        }
    }
    Ok(())
}

/// A solution at which a test has the other sign, where it has the same sign at all that are known of a step: it passes zero and comes
/// back around an extreme value. With the place in the list before which it lies.
///
/// An extreme value is looked for where the test is no farther from zero than it changed in the step or in the one before: of a
/// parabola that is resolved by the steps the extreme is no farther away.
fn beyond_extreme<C: Curve>(
    curve: &mut C,
    earlier: Option<&Solution<C::Point>>,
    current: &Solution<C::Point>,
    between: &Between<C>,
    advanced: &Solution<C::Point>,
    test: impl Fn(&mut C, &Solution<C::Point>) -> Option<f64>,
    settings: &Settings,
) -> Option<(usize, Solution<C::Point>)> {
    let known: Vec<&Solution<C::Point>> = std::iter::once(current)
        .chain(between.iter().map(|(solution, _)| solution))
        .chain([advanced])
        .collect();
    let values: Vec<f64> = known.iter().map(|solution| test(curve, solution)).collect::<Option<_>>()?;
    let sign = values[0].signum();
    let least = values.iter().map(|value| sign * value).fold(f64::INFINITY, f64::min);
    if least <= 0.0 {
        return None;
    }
    let before = earlier.and_then(|solution| test(curve, solution)).map(|value| (value - values[0]).abs());
    let changes = values.windows(2).map(|pair| (pair[1] - pair[0]).abs()).chain(before);
    if least > changes.fold(0.0, f64::max) && before.is_some() {
        return None;
    }
    (0..known.len() - 1).find_map(|place| {
        let ends = [known[place], known[place + 1]];
        let values = [values[place], values[place + 1]].map(|value| sign * value);
        let sought = |curve: &mut C, solution: &Solution<C::Point>| Some(sign * test(curve, solution)?);
        Some((place, least_by_parabolas(curve, ends, values, sought, settings)?))
    })
}

/// A solution between two others, at which a function has positive `values`, where it is not positive: sought at the least values of
/// parabolas through three solutions. `None` where the least value is positive.
fn least_by_parabolas<C: Curve>(
    curve: &mut C,
    ends: [&Solution<C::Point>; 2],
    values: [f64; 2],
    function: impl Fn(&mut C, &Solution<C::Point>) -> Option<f64>,
    settings: &Settings,
) -> Option<Solution<C::Point>> {
    let mut known = vec![(0.0, values[0]), (1.0, values[1])];
    let mut fraction = 0.5;
    for _ in 0..MOST_PARABOLAS {
        let trial = solution_between(curve, ends[0], ends[1], fraction, settings).ok()?;
        let value = function(curve, &trial)?;
        if value <= 0.0 {
            return Some(trial);
        }
        let place = known.partition_point(|(other, _)| *other < fraction);
        known.insert(place, (fraction, value));
        let lowest = (0..known.len()).min_by(|&one, &other| known[one].1.total_cmp(&known[other].1))?;
        let middle = lowest.clamp(1, known.len() - 2);
        let [(a, at_a), (b, at_b), (c, at_c)] = [known[middle - 1], known[middle], known[middle + 1]];
        let [first, second] = [(at_b - at_a) / (b - a), (at_c - at_b) / (c - b)];
        let curvature = (second - first) / (c - a);
        let vertex = 0.5 * (a + b) - 0.5 * first / curvature;
        let least = at_a + (vertex - a) * (first + curvature * (vertex - b));
        // The parabola is wrong by a part of what it spans.
        let spread = at_a.max(at_c) - at_b.min(at_a).min(at_c);
        let is_new = known.iter().all(|(other, _)| (vertex - other).abs() > SAME_FRACTION);
        if curvature <= 0.0 || !(0.0..=1.0).contains(&vertex) || least > UNCERTAIN_PART * spread || !is_new {
            return None;
        }
        fraction = vertex;
    }
    None
}

/// Inserts what `find` finds between neighbours at which a test has different signs; whether it found something between all of them.
fn insert_passages<C: Curve>(
    curve: &mut C,
    current: &Solution<C::Point>,
    between: &mut Between<C>,
    advanced: &Solution<C::Point>,
    test: impl Fn(&mut C, &Solution<C::Point>) -> Option<f64>,
    find: impl Fn(
        &mut C,
        &Solution<C::Point>,
        &Solution<C::Point>,
    ) -> Result<Option<(Solution<C::Point>, Origin<C::Kind>)>, Error>,
) -> Result<bool, Error> {
    let mut index = 0;
    let mut all_found = true;
    while index <= between.len() {
        let left = if index == 0 { current } else { &between[index - 1].0 };
        let right = between.get(index).map_or(advanced, |(solution, _)| solution);
        if let (Some(before), Some(after)) = (test(curve, left), test(curve, right)) {
            let passes = (before < 0.0) != (after < 0.0) || after == 0.0;
            if passes && before != 0.0 {
                if let Some(found) = find(curve, left, right)? {
                    between.insert(index, found);
                    index += 1;
                } else {
                    all_found = false;
                }
            }
        }
        index += 1;
    }
    Ok(all_found)
}

/// Distance, in the errors that steps aim at, of a solution at a value from where it is expected.
const FARTHEST: f64 = 10.0;

/// The solution between two neighbours at which the unknown `from_end` has the given value.
///
/// # Errors
/// [`Error::NotFound`] where Newton's method does not lead to one, others where it cannot be inspected.
pub(crate) fn fix<C: Curve>(
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
    let length = along(curve, before, &after.unknown);
    let mut unknown = interpolate(before, after, length, fraction);
    unknown[index] = value;
    let mut border = vec![0.0; unknown.len()];
    border[index] = 1.0;
    let failed = |cause| Error::NotFound { sought: "solution at the value asked for", cause };
    let correction = correct(curve, &mut unknown, &border, settings).map_err(failed)?;
    unknown[index] = value;
    // A solution farther away than the next one belongs to another branch.
    let leads_elsewhere = correction.distance > length.abs().max(FARTHEST * settings.predictor_error);
    if leads_elsewhere || !curve.holds(&unknown) {
        return Err(failed(CorrectionFailure::Diverged));
    }
    finish_measured(curve, unknown, &before.tangent)
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

/// Part of a range by which values beyond its ends may be rounding.
pub(super) const ON_END: f64 = 1e-10;

/// First bound that `unknown` violates by more than rounding and the end that was passed: a curve may lie on an end.
pub(super) fn first_exit(unknown: &[f64], bounds: &[Bound]) -> Option<(usize, f64)> {
    bounds.iter().enumerate().find_map(|(index, bound)| {
        let (value, margin) = (bound.value(unknown), ON_END * bound.width());
        if value > bound.upper + margin {
            Some((index, bound.upper))
        } else if value < bound.lower - margin {
            Some((index, bound.lower))
        } else {
            None
        }
    })
}
