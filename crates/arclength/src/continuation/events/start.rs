//! The neighbourhood of the start of a curve.

use super::found::{Events, search};
use super::memory::Memory;
use super::neighbour::beyond;
use super::node::Node;
use crate::continuation::corrector::across;
use crate::continuation::solution::Bound;
use crate::continuation::{Curve, Settings, Solution};
use crate::error::Error;

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
    let mut events = search(curve, [&mut left, &mut right], &Memory::default(), bounds, settings)?;
    // The neighbourhood of a start at the end of a range lies outside in part.
    events.found.retain(|event| {
        bounds.iter().all(|bound| bound.holds(bound.value(&event.solution.unknown), ROUNDING))
    });
    events.unlocated.retain(|change| {
        let ends = change.between.iter();
        ends.flat_map(|values| values.iter().zip(bounds)).any(|(value, bound)| bound.holds(*value, ROUNDING))
    });
    Ok(events)
}

/// Part of its range by which a parameter may lie outside by rounding.
const ROUNDING: f64 = 1e-12;
