//! Places between two equilibria where the number of unstable eigenvalues changes, found by that number alone.
//!
//! Symmetry makes several eigenvalues cross the imaginary axis at once, so that no test function changes sign, and points
//! that lie close together may exhaust the division of a step. The number of unstable eigenvalues still tells: bisection
//! brackets every place where it changes. Pairs of different frequencies that cross at one place are located there one by
//! one.

use super::curve::{EquilibriumCurve, Inspection};
use super::locating::{LAST_BRACKET, hopf_of_pair};
use super::special::SpecialPoint;
use super::spectrum::critical_pairs;
use crate::algebraic::{between, length};
use crate::branch::SpecialKind;
use crate::continuation::Solution;
use crate::error::Error;

/// Places that are sought between two solutions.
const MOST_PLACES: usize = 64;
/// Shortest bracket, in the metric: rounding shows below.
const RESOLUTION: f64 = 1e-13;
/// A bracket is widened by this part of the whole, and by this much of the metric at least, so that eigenvalues that rounding
/// splits cross in one place.
const WIDENING: f64 = 1e-8;
const LEAST_WIDENING: f64 = 1e-11;
/// Distance, in the metric, of a point located by Newton's method from its bracket.
const AGREEMENT: f64 = 1e-6;
/// Relative difference of the frequencies of two pairs.
const DISTINCT: f64 = 1e-6;

type Node = Solution<Inspection>;

/// All places between two solutions, at the given distance from each other, where the number of unstable eigenvalues
/// changes.
pub(super) fn crossings(
    curve: &mut EquilibriumCurve<'_>,
    before: &Node,
    after: &Node,
    distance: f64,
) -> Result<Vec<Node>, Error> {
    let settings = curve.settings;
    let at = |curve: &mut EquilibriumCurve<'_>, fraction: f64| {
        between(curve, before, after, distance, fraction, &settings).ok()
    };
    let unstable = |node: &Node| node.point.spectrum.unstable;
    let resolution = LAST_BRACKET.max(RESOLUTION / distance);
    let widening = WIDENING.max(LEAST_WIDENING / distance);
    let mut found = Vec::new();
    let mut left = (0.0, before.clone());
    for _ in 0..MOST_PLACES {
        if unstable(&left.1) == unstable(after) {
            break;
        }
        let mut right = (1.0, after.clone());
        while right.0 - left.0 > resolution {
            let fraction = 0.5 * (left.0 + right.0);
            let Some(middle) = at(curve, fraction) else { break };
            if unstable(&middle) == unstable(&left.1) {
                left = (fraction, middle);
            } else {
                right = (fraction, middle);
            }
        }
        let near = right.1.clone();
        let half = 0.5 * (right.0 - left.0) * distance * curve.system.scales[curve.dimension()];
        let (low, high) = ((right.0 - widening).max(0.0), (right.0 + widening).min(1.0));
        if let Some(node) = at(curve, low) {
            left = (low, node);
        }
        if let Some(node) = at(curve, high) {
            right = (high, node);
        }
        found.extend(located(curve, &left.1, &right.1, near, half)?);
        left = right;
    }
    Ok(found)
}

/// What crosses between two solutions that enclose one place, `near`.
fn located(
    curve: &mut EquilibriumCurve<'_>,
    before: &Node,
    after: &Node,
    mut near: Node,
    location_error: f64,
) -> Result<Vec<Node>, Error> {
    let difference = before.point.spectrum.unstable.abs_diff(after.point.spectrum.unstable);
    let eigenvalues = &near.point.spectrum.eigenvalues;
    let closest = eigenvalues.iter().min_by(|a, b| a.re.abs().total_cmp(&b.re.abs()));
    let oscillates = closest.is_some_and(|value| value.im != 0.0);
    if oscillates && difference > 0 && difference.is_multiple_of(2) {
        let pairs = critical_pairs(eigenvalues).into_iter().filter(|pair| pair[0].im != 0.0);
        let mut hopf: Vec<Node> = Vec::new();
        for pair in pairs.take(difference / 2) {
            let Some(node) = hopf_of_pair(curve, before, &near, pair)? else { break };
            let offset: Vec<f64> = node.unknown.iter().zip(&near.unknown).map(|(a, b)| a - b).collect();
            let new = hopf.iter().all(|other| match (frequency(other), frequency(&node)) {
                (Some(one), Some(other)) => (one - other).abs() > DISTINCT * one,
                _ => false,
            });
            if frequency(&node).is_none() || !new || length(&offset, &curve.system.scales) > AGREEMENT {
                break;
            }
            hopf.push(node);
        }
        if hopf.len() == difference / 2 {
            return Ok(hopf);
        }
    }
    let of = if oscillates { SpecialKind::Hopf } else { SpecialKind::BranchPoint };
    let parameter = near.unknown[curve.dimension()];
    near.point.special = Some(Box::new(SpecialPoint::Degenerate { of, parameter, location_error }));
    Ok(vec![near])
}

fn frequency(node: &Node) -> Option<f64> {
    match node.point.special.as_deref() {
        Some(SpecialPoint::Hopf(hopf)) => Some(hopf.frequency),
        _ => None,
    }
}
