//! Solutions that were asked for: at values of the parameter, where a monitor has a value, at the ends of ranges.

use super::bracket::{locate, locate_value};
use super::corrector::{correct, finish_measured};
use super::curve::Curve;
use super::metric::along;
use super::settings::Settings;
use super::solution::{Bound, Solution, interpolate};
use crate::error::Error;
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

/// Solutions between two neighbours, in order.
pub(super) type Between<C> = Vec<(Solution<<C as Curve>::Point>, Origin<<C as Curve>::Kind>)>;

/// Inserts a converged solution wherever the first bounded parameter passes a requested value; none where a branch point has that value
/// and none can be told from it.
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
) -> Result<(), Error> {
    for &value in values {
        let test = |_: &mut C, solution: &Solution<C::Point>| Some(bound.value(&solution.unknown) - value);
        insert_passages(curve, current, between, advanced, test, |curve, left, right| {
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
    Ok(())
}

/// Inserts a solution wherever a monitor passes the value of a target.
///
/// # Errors
/// When a solution between two others cannot be computed.
pub(super) fn insert_targets<C: Curve>(
    curve: &mut C,
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
        insert_passages(curve, current, between, advanced, test, |curve, left, right| {
            let found = match locate_value(curve, [left, right], &settings, tolerances, test) {
                Err(Error::NotFound { .. }) if target.purpose == Purpose::Mark => None,
                found => found?,
            };
            Ok(found.map(|solution| (solution, Origin::Target(index))))
        })?;
    }
    Ok(())
}

/// Inserts what `find` finds between neighbours at which a test has different signs.
fn insert_passages<C: Curve>(
    curve: &mut C,
    current: &Solution<C::Point>,
    between: &mut Between<C>,
    advanced: &Solution<C::Point>,
    test: impl Fn(&mut C, &Solution<C::Point>) -> Option<f64>,
    mut find: impl FnMut(
        &mut C,
        &Solution<C::Point>,
        &Solution<C::Point>,
    ) -> Result<Option<(Solution<C::Point>, Origin<C::Kind>)>, Error>,
) -> Result<(), Error> {
    let mut index = 0;
    while index <= between.len() {
        let left = if index == 0 { current } else { &between[index - 1].0 };
        let right = between.get(index).map_or(advanced, |(solution, _)| solution);
        if let (Some(before), Some(after)) = (test(curve, left), test(curve, right)) {
            let passes = (before < 0.0) != (after < 0.0) || after == 0.0;
            if passes
                && before != 0.0
                && let Some(found) = find(curve, left, right)?
            {
                between.insert(index, found);
                index += 1;
            }
        }
        index += 1;
    }
    Ok(())
}

/// The solution between two neighbours at which the unknown `from_end` has the given value.
pub(super) fn fix<C: Curve>(
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
    correct(curve, &mut unknown, &border, settings)
        .map_err(|cause| Error::NotFound { sought: "solution at the value asked for", cause })?;
    unknown[index] = value;
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

/// First bound that `unknown` violates and the end that was passed.
pub(super) fn first_exit(unknown: &[f64], bounds: &[Bound]) -> Option<(usize, f64)> {
    bounds.iter().enumerate().find_map(|(index, bound)| {
        let value = bound.value(unknown);
        if value > bound.upper {
            Some((index, bound.upper))
        } else if value < bound.lower {
            Some((index, bound.lower))
        } else {
            None
        }
    })
}
