//! The neighbourhood of a solution that is a special point itself, and of the start of a curve.

use super::node::{Node, undecided};
use super::search::{Events, Memory, search};
use crate::continuation::solution::{Bound, across};
use crate::continuation::{Curve, Settings, Solution};
use crate::error::Error;

/// Distances, in the metric, to the solution that stands for one that is a special point itself.
const BEYOND: [f64; 2] = [1e-6, 1e-4];
/// The step is this many times as long at least.
const STEP_BEYOND: f64 = 10.0;

/// A solution a little further along, with no more than `least` undecided signs if there is one within `reach`.
pub(super) fn beyond<C: Curve>(
    curve: &mut C,
    solution: &Solution<C::Point>,
    least: usize,
    reach: f64,
    settings: &Settings,
) -> Option<Solution<C::Point>> {
    let mut first = None;
    for distance in BEYOND.into_iter().filter(|distance| STEP_BEYOND * distance < reach) {
        if let Ok(there) = across(curve, solution, solution.ahead(distance), settings) {
            if undecided(curve, &there) <= least {
                return Some(there);
            }
            first.get_or_insert(there);
        }
    }
    first
}

/// Special points at the start of a curve that is followed both ways, and close to it.
///
/// `first` are the unknowns from which on the directions, backward and forward, were searched; `None` for one that was not
/// followed.
///
/// # Errors
/// As [`Curve::locate`].
pub(crate) fn around_start<C: Curve>(
    curve: &mut C,
    start: &Solution<C::Point>,
    first: [Option<Vec<f64>>; 2],
    bounds: &[Bound],
    settings: &Settings,
) -> Result<Events<C>, Error> {
    let backward = start.clone().reversed();
    let mut ends = [None, None];
    for ((end, from), known) in ends.iter_mut().zip([&backward, start]).zip(first) {
        *end = match known {
            Some(unknown) if unknown == from.unknown => Some(from.clone()),
            // On another mesh it is another one.
            Some(unknown) if unknown.len() == from.unknown.len() => {
                across(curve, from, unknown, settings).ok()
            }
            _ => beyond(curve, from, 0, f64::INFINITY, settings),
        };
    }
    let [Some(behind), Some(ahead)] = ends else { return Ok(Events::default()) };
    let mut left = Node::new(curve, behind.reversed());
    let mut right = Node::new(curve, ahead);
    search(curve, [&mut left, &mut right], &Memory::default(), bounds, settings)
}
