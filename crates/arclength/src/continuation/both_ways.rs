//! A curve followed both ways from its start, as one list.

use super::curve::Curve;
use super::events::{Event, Events, Unlocated};
use super::follow::Followed;
use super::metric::{along, distance};
use super::requested::Origin;
use super::solution::Solution;
use super::stop::Stop;
use crate::error::Error;

/// Distance from the start, in the metric, and difference of the parameter, as part of its range, below which a special point
/// is the start.
const SAME_PLACE: f64 = 1e-8;
const SAME_PARAMETER: f64 = 1e-14;

/// A curve that was followed both ways.
pub(crate) struct BothWays<P, K, R> {
    /// The solutions in the order of the curve, from its backward to its forward end; tangents point forward.
    pub solutions: Vec<(Solution<P>, Origin<K>)>,
    /// Index of the start.
    pub start: usize,
    /// Why the curve ends backward and forward; `None` where it was not followed.
    pub stops: [Option<Stop<R>>; 2],
    /// What was noticed and could not be located.
    pub unlocated: Vec<Unlocated<K>>,
}

/// Follows a curve forward and, unless it closes or is interrupted, backward.
///
/// # Errors
/// When no solution is found from the start.
pub(crate) fn both_ways<P: Clone, K, R: Clone>(
    mut run: impl FnMut(f64) -> Result<Followed<P, K, R>, Error>,
) -> Result<[Followed<P, K, R>; 2], Error> {
    let forward = run(1.0)?;
    let backward = match forward.stop {
        Stop::Closed => Followed::nothing(Stop::Closed),
        Stop::Interrupted => Followed::nothing(Stop::Interrupted),
        _ => run(-1.0)?,
    };
    Ok([backward, forward])
}

impl<P: Clone, K: Copy + PartialEq, R> BothWays<P, K, R> {
    /// Joins what was found backward and forward from the same start, with a special point `middle` from which both leave, where
    /// there is one.
    pub(crate) fn join(
        [backward, forward]: [Followed<P, K, R>; 2],
        middle: Option<(Solution<P>, Origin<K>)>,
    ) -> Self {
        let mut solutions = backward.solutions;
        // Both directions begin with the start.
        let repeated = middle.is_none() && !forward.solutions.is_empty() && !solutions.is_empty();
        if repeated {
            solutions.remove(0);
        }
        solutions.reverse();
        solutions = solutions.into_iter().map(|(solution, origin)| (solution.reversed(), origin)).collect();
        let start = if repeated || middle.is_some() || solutions.is_empty() {
            solutions.len()
        } else {
            solutions.len() - 1
        };
        solutions.extend(middle);
        solutions.extend(forward.solutions);
        let mut unlocated = backward.unlocated;
        unlocated.reverse();
        unlocated.iter_mut().for_each(|change| change.between.reverse());
        unlocated.extend(forward.unlocated);
        Self { solutions, start, stops: [Some(backward.stop), Some(forward.stop)], unlocated }
    }

    /// A curve that was followed one way only, from a start that is a point of another one.
    pub(crate) fn one_way(forward: Followed<P, K, R>, first: Option<(Solution<P>, Origin<K>)>) -> Self {
        let solutions = first.into_iter().chain(forward.solutions).collect();
        Self { solutions, start: 0, stops: [None, Some(forward.stop)], unlocated: forward.unlocated }
    }

    /// Puts special points where they belong at the start; one that is the start takes its place.
    pub(crate) fn insert_at_start<C: Curve<Point = P, Kind = K>>(&mut self, curve: &C, events: Events<C>) {
        let Some((origin, start_origin)) = self.solutions.get(self.start).cloned() else { return };
        let (mut before, mut after) = (Vec::new(), Vec::new());
        let mut at = None;
        for Event { kind, mut solution, .. } in events.found {
            let last = solution.unknown.len() - 1;
            let parameter = (solution.unknown[last] - origin.unknown[last]).abs();
            let mut unit = vec![0.0; last + 1];
            unit[last] = parameter;
            let same = distance(curve, &origin.unknown, &solution.unknown) < SAME_PLACE
                && distance(curve, &vec![0.0; last + 1], &unit) <= SAME_PARAMETER;
            // A start on another branch is the branch point between the two directions.
            if same && matches!(start_origin, Origin::Special(_)) {
                continue;
            }
            if same && at.is_none() {
                solution.unknown[last] = origin.unknown[last];
                at = Some((solution, Origin::Special(kind)));
            } else if at.is_none() && along(curve, &origin, &solution.unknown) < 0.0 {
                before.push((solution, Origin::Special(kind)));
            } else {
                after.push((solution, Origin::Special(kind)));
            }
        }
        self.solutions.splice(self.start + 1..self.start + 1, after);
        if let Some(at) = at {
            self.solutions[self.start] = at;
        }
        let count = before.len();
        self.solutions.splice(self.start..self.start, before);
        self.start += count;
        self.unlocated.extend(events.unlocated);
    }

    /// Marks solutions at values of the first bounded parameter that were asked for as such: the start or an end of the range may
    /// have one. `value` is the value of a solution.
    pub(crate) fn mark_requested(&mut self, requested: &[f64], value: impl Fn(&Solution<P>) -> f64) {
        for (solution, origin) in &mut self.solutions {
            if !matches!(origin, Origin::Special(_)) && requested.contains(&value(solution)) {
                *origin = Origin::Requested;
            }
        }
        let mut removed = 0;
        let (mut index, start) = (0, self.start);
        let mut previous: Option<f64> = None;
        self.solutions.retain(|(solution, origin)| {
            let here = (*origin == Origin::Requested).then(|| value(solution));
            let repeated = here.is_some() && here == previous;
            previous = here;
            if repeated && index <= start {
                removed += 1;
            }
            index += 1;
            !repeated
        });
        self.start -= removed.min(self.start);
    }
}

/// A [`BothWays`] of a curve `C`.
pub(crate) type BothWaysOf<C> = BothWays<<C as Curve>::Point, <C as Curve>::Kind, <C as Curve>::Reason>;
