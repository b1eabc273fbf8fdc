//! Places between two solutions where the number of unstable directions changes, found by that number alone.
//!
//! Symmetry makes several exponents cross the axis at once, so that no test function changes sign, and points that lie close
//! together may exhaust the division of a step. The number of unstable directions still tells: bisection brackets every place
//! where it changes. What crosses there is located by the curve, one by one.

use super::event::Event;
use super::node::Node;
use crate::continuation::corrector::between;
use crate::continuation::metric::distance;
use crate::continuation::{Curve, Settings, Solution};
use crate::error::Error;

/// Places that are sought between two solutions.
const MOST_PLACES: usize = 64;
/// Shortest bracket, in the metric: rounding shows below.
const RESOLUTION: f64 = 1e-13;
/// A bracket is widened by this many times its shortest length, and by this much of the metric at least, so that exponents that
/// rounding splits cross in one place.
const WIDENING: f64 = 100.0;
const LEAST_WIDENING: f64 = 1e-11;

/// What was found by the number of unstable directions alone.
pub(super) struct Crossings<C: Curve> {
    pub found: Vec<Event<C::Kind, C::Point>>,
    /// Solutions between which the number changes for no reason that could be located.
    pub unlocated: Vec<[Solution<C::Point>; 2]>,
}

/// All places between two solutions where the number of unstable directions changes.
pub(super) fn crossings<C: Curve>(
    curve: &mut C,
    before: &Node<C>,
    after: &Node<C>,
    settings: &Settings,
) -> Result<Crossings<C>, Error> {
    let (one, other) = (&before.solution, &after.solution);
    let length = distance(curve, &one.unknown, &other.unknown);
    let at = |curve: &mut C, fraction: f64| {
        let solution = between(curve, one, other, fraction, settings).ok()?;
        let spectrum = curve.spectrum(&solution);
        Some((solution, spectrum.unstable))
    };
    let last = after.spectrum.unstable;
    let resolution = settings.shortest_bracket.max(RESOLUTION / length);
    let widening = (WIDENING * settings.shortest_bracket).max(LEAST_WIDENING / length);
    let mut result = Crossings { found: Vec::new(), unlocated: Vec::new() };
    let mut left = (0.0, one.clone(), before.spectrum.unstable);
    for _ in 0..MOST_PLACES {
        if left.2 == last {
            break;
        }
        let mut right = (1.0, other.clone(), last);
        while right.0 - left.0 > resolution {
            let fraction = 0.5 * (left.0 + right.0);
            let Some((middle, unstable)) = at(curve, fraction) else { break };
            if unstable == left.2 {
                left = (fraction, middle, unstable);
            } else {
                right = (fraction, middle, unstable);
            }
        }
        let near = right.1.clone();
        let half = 0.5 * (right.0 - left.0) * length;
        let (low, high) = ((right.0 - widening).max(0.0), (right.0 + widening).min(1.0));
        if let Some((node, unstable)) = at(curve, low) {
            left = (low, node, unstable);
        }
        if let Some((node, unstable)) = at(curve, high) {
            right = (high, node, unstable);
        }
        let change = left.2.abs_diff(right.2);
        let located = curve.locate_crossing([&left.1, &right.1], near, change, half)?;
        if located.is_empty() && change > 0 {
            result.unlocated.push([left.1, right.1.clone()]);
        }
        result.found.extend(located);
        left = right;
    }
    Ok(result)
}
