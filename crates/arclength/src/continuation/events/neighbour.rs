//! The solution close by that stands for one that is a special point itself.

use super::node::undecided;
use crate::continuation::corrector::across;
use crate::continuation::{Curve, Settings, Solution};

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
