//! Which points of codimension two lie between two neighbours on a curve.

use super::curve::{Inspection, LocusCurve};
use super::kind::LocusKind;
use super::locating;
use crate::algebraic::{between, length};
use crate::branch::SpecialKind;
use crate::continuation::Solution;
use crate::error::Error;

/// Solutions that may be computed to sort out one step.
const MOST_TRIALS: usize = 60;
/// Part of a step below which it is not divided any further.
const SMALLEST_PART: f64 = 1e-6;

type Node = Solution<Inspection>;

/// The value of a test function, where it is defined.
pub(super) fn test_value(node: &Node, kind: SpecialKind) -> Option<f64> {
    node.point.monitor.tests.iter().find(|(candidate, _)| *candidate == kind).map(|(_, value)| *value)
}

/// Test functions that change sign.
fn changes(before: &Node, after: &Node) -> Vec<SpecialKind> {
    let tests = before.point.monitor.tests.iter();
    tests
        .filter(|(kind, value)| test_value(after, *kind).is_some_and(|other| (*value > 0.0) != (other > 0.0)))
        .map(|(kind, _)| *kind)
        .collect()
}

struct Scan<'c, 'a, K: LocusKind<'a>> {
    curve: &'c mut LocusCurve<'a, K>,
    trials: usize,
    found: Vec<Node>,
}

/// As [`Curve::special_points`](crate::continuation::Curve::special_points).
pub(super) fn special_points<'a, K: LocusKind<'a>>(
    curve: &mut LocusCurve<'a, K>,
    before: &Node,
    after: &Node,
) -> Result<Vec<Node>, Error> {
    let mut scan = Scan { curve, trials: MOST_TRIALS, found: Vec::new() };
    scan.part(before, after, 1.0)?;
    Ok(scan.found)
}

impl<'a, K: LocusKind<'a>> Scan<'_, 'a, K> {
    fn part(&mut self, before: &Node, after: &Node, share: f64) -> Result<(), Error> {
        let changed = changes(before, after);
        let step: Vec<f64> = after.unknown.iter().zip(&before.unknown).map(|(b, a)| b - a).collect();
        let distance = length(&step, &self.curve.system.scales);
        if changed.len() > 1 && share > SMALLEST_PART && self.trials > 0 {
            self.trials -= 1;
            let settings = self.curve.settings;
            if let Ok(middle) = between(self.curve, before, after, distance, 0.5, &settings) {
                self.part(before, &middle, 0.5 * share)?;
                return self.part(&middle, after, 0.5 * share);
            }
        }
        for kind in changed {
            self.found.extend(locating::codimension_two(self.curve, before, after, distance, kind)?);
        }
        Ok(())
    }
}
