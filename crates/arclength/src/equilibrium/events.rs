//! Which special points lie between two neighbouring equilibria, one by one and in order.
//!
//! A step is halved until the change in the number of unstable eigenvalues and the changes of sign of the test
//! functions agree and single out one point, or nothing is left to explain. Test functions that come close to zero
//! without changing sign (two points in one step) are looked at where a cubic through values and slopes says that they
//! come closest. Only then a point is located. Afterwards the number of unstable eigenvalues beside every located point has
//! to change as that point says; where it does not, the surroundings are searched again.
//!
//! A solution that happens to be a special point itself decides nothing: the one a little further along stands for it.

use super::crossings::crossings;
use super::curve::{EquilibriumCurve, Inspection, Tests};
use super::locating::{self, SHORTEST_JUMP};
use super::special::SpecialPoint;
use crate::algebraic::{between, length, position};
use crate::branch::{SpecialKind, Stability};
use crate::continuation::{Curve, Solution, correct, finish};
use crate::error::Error;

/// Solutions that may be computed to sort out one step.
const MOST_TRIALS: usize = 400;
/// Part of a step below which it is not divided any further.
const SMALLEST_PART: f64 = 1e-7;
/// The same while a fold and a branch point are not separated.
const COINCIDENT_PART: f64 = 0.02;
/// A test function that a cubic says shrinks to this part of the smaller of its end values is looked at.
const SUSPICIOUS: f64 = 0.3;
/// A step is divided no closer to its ends than this part.
const SMALLEST_FRACTION: f64 = 0.02;
/// A step is divided at these parts of the fraction where the fraction itself gives a special point.
const ASIDE: [f64; 3] = [0.8, 0.9, 0.7];
/// Distances, in the metric, to the solution that stands for one that is a special point itself.
const BEYOND: [f64; 2] = [1e-6, 1e-4];
/// The step is this many times as long at least.
const STEP_BEYOND: f64 = 10.0;
/// A rate of change of the parameter along the curve below which a solution may be a fold itself.
const NEARLY_FOLD: f64 = 1e-9;
/// Times that the surroundings of a located point are searched again, and the part of them that is set aside around the
/// point itself.
const MOST_SEARCHES: usize = 4;
const SURROUNDINGS: f64 = 0.02;
/// Distance, in the metric, from one located point to the next between which there is nothing to count.
const COINCIDENT: f64 = 1e-8;
/// A rate of change of the parameter along the curve that may be rounding error.
const UNDECIDED_FOLD: f64 = 1e-13;
/// Rate of change of the parameter at a branch point, relative to its values around, below which the branch is tangential
/// there: a pitchfork met on the branch that turns.
const TANGENTIAL: f64 = 1e-3;

/// Smallest cosine of the angle between a part of a step and the tangents at its ends: shorter parts are straighter.
const LEAST_COSINE: f64 = 0.5;

type Node = Solution<Inspection>;

/// Which test functions change sign.
#[derive(Clone, Copy, Debug, Default)]
struct Changes {
    fold: bool,
    branch_point: bool,
    hopf: bool,
}

fn opposite(one: f64, other: f64) -> bool {
    (one > 0.0) != (other > 0.0)
}

impl Changes {
    fn between(before: &Node, after: &Node) -> Self {
        let (one, other) = (&before.point, &after.point);
        Self {
            fold: opposite(one.tests.fold, other.tests.fold)
                && one.tests.fold.abs().max(other.tests.fold.abs()) > UNDECIDED_FOLD,
            branch_point: before.orientation * after.orientation < 0.0,
            hopf: opposite(one.tests.hopf, other.tests.hopf)
                && one.spectrum.hopf_undecided == other.spectrum.hopf_undecided,
        }
    }

    fn count(self) -> usize {
        usize::from(self.fold) + usize::from(self.branch_point) + usize::from(self.hopf)
    }

    /// Whether these changes alone explain the change in the number of unstable eigenvalues.
    fn explain(self, before: &Node, after: &Node) -> bool {
        let (one, other) = (&before.point.spectrum, &after.point.spectrum);
        if one.stability == Stability::Undecided || other.stability == Stability::Undecided {
            return true;
        }
        let difference = one.unstable.abs_diff(other.unstable);
        let through_zero = usize::from(self.fold) + usize::from(self.branch_point);
        difference <= through_zero + 2 * usize::from(self.hopf)
            && (difference + through_zero).is_multiple_of(2)
            // A pair that crosses at a Hopf point changes the test function with it.
            && !(difference == 2 && !self.hopf && through_zero < 2)
    }
}

/// Where a cubic with the given end values and slopes (per unit of the whole) comes close to zero without changing sign.
fn closest_approach(values: [f64; 2], slopes: [f64; 2]) -> Option<f64> {
    if opposite(values[0], values[1]) {
        return None;
    }
    let difference = values[1] - values[0];
    // Of c1 + 2 c2 s + 3 c3 s^2, the derivative of the cubic.
    let (c1, c2, c3) =
        (slopes[0], 3.0 * difference - 2.0 * slopes[0] - slopes[1], slopes[0] + slopes[1] - 2.0 * difference);
    let discriminant = c2 * c2 - 3.0 * c1 * c3;
    if discriminant.is_nan() || discriminant < 0.0 {
        return None;
    }
    let root = -(c2 + discriminant.sqrt().copysign(c2));
    let limit = SUSPICIOUS * values[0].abs().min(values[1].abs());
    [root / (3.0 * c3), c1 / root]
        .into_iter()
        .filter(|s| *s > 0.0 && *s < 1.0)
        .map(|s| (s, values[0].signum() * (values[0] + s * (c1 + s * (c2 + s * c3)))))
        .filter(|&(_, value)| value < limit)
        .min_by(|one, other| one.1.total_cmp(&other.1))
        .map(|(s, _)| s.clamp(SMALLEST_FRACTION, 1.0 - SMALLEST_FRACTION))
}

/// Where a second look is needed because a test function that does not change its sign comes close to zero.
fn suspicious(before: &Node, after: &Node, distance: f64) -> Option<f64> {
    let tests = |pick: fn(&Tests) -> f64| [pick(&before.point.tests), pick(&after.point.tests)];
    let decided = before.point.spectrum.hopf_undecided == after.point.spectrum.hopf_undecided;
    let changes = Changes::between(before, after);
    let hopf = (decided && !changes.hopf)
        .then(|| {
            let slopes = [before.point.hopf_slope * distance, after.point.hopf_slope * distance];
            closest_approach(tests(|tests| tests.hopf), slopes)
        })
        .flatten();
    hopf.or_else(|| {
        // The parameter itself, a cubic of the arc length, may turn twice.
        let [one, other] = tests(|tests| tests.fold);
        let parameter = before.unknown.len() - 1;
        let unit = before.tangent[parameter] / one;
        let mean = (after.unknown[parameter] - before.unknown[parameter]) / (unit * distance);
        if changes.count() > 0 || opposite(one, other) || !mean.is_finite() {
            return None;
        }
        // Derivative of the cubic: one + s (6 mean - 4 one - 2 other) + s^2 (3 one + 3 other - 6 mean).
        let (linear, quadratic) = (6.0 * mean - 4.0 * one - 2.0 * other, 3.0 * (one + other) - 6.0 * mean);
        let s = -0.5 * linear / quadratic;
        let extreme = one + s * (linear + s * quadratic);
        let inside = s > 0.0 && s < 1.0;
        let near = extreme * one.signum() < SUSPICIOUS * one.abs().min(other.abs());
        (inside && near).then_some(s.clamp(SMALLEST_FRACTION, 1.0 - SMALLEST_FRACTION))
    })
}

/// How many of the signs that are compared may be rounding error.
fn undecided(node: &Node) -> usize {
    let spectrum = &node.point.spectrum;
    spectrum.hopf_undecided
        + usize::from(spectrum.stability == Stability::Undecided)
        + usize::from(node.point.tests.fold.abs() < NEARLY_FOLD)
}

/// The solution with `unknown` up to a correction across the tangent of `origin`.
fn across(curve: &mut EquilibriumCurve<'_>, origin: &Node, mut unknown: Vec<f64>) -> Option<Node> {
    let settings = curve.settings;
    let mut border = vec![0.0; unknown.len()];
    curve.apply_metric(&origin.tangent, &mut border);
    correct(curve, &mut unknown, &border, &settings).ok()?;
    finish(curve, unknown, &origin.tangent).ok()
}

fn along(node: &Node, distance: f64) -> Vec<f64> {
    node.unknown.iter().zip(&node.tangent).map(|(value, slope)| value + distance * slope).collect()
}

/// A solution a little further along, with no more than `least` undecided signs if there is one within `reach`.
pub(super) fn beyond(
    curve: &mut EquilibriumCurve<'_>,
    node: &Node,
    least: usize,
    reach: f64,
) -> Option<Node> {
    let mut first = None;
    for distance in BEYOND.into_iter().filter(|distance| STEP_BEYOND * distance < reach) {
        if let Some(there) = across(curve, node, along(node, distance)) {
            if undecided(&there) <= least {
                return Some(there);
            }
            first.get_or_insert(there);
        }
    }
    first
}

struct Scan<'c, 'a> {
    curve: &'c mut EquilibriumCurve<'a>,
    trials: usize,
    found: Vec<Node>,
}

/// As [`Curve::special_points`], but for the first step from a start not those at the start itself: see [`at_start`].
pub(super) fn special_points(
    curve: &mut EquilibriumCurve<'_>,
    before: &Node,
    after: &Node,
) -> Result<Vec<Node>, Error> {
    let first_step = curve.first_beyond.is_none();
    let reach = distance(curve, before, after);
    let least = undecided(before).min(undecided(after));
    let from =
        if first_step || undecided(before) > least { beyond(curve, before, least, reach) } else { None };
    let to = if undecided(after) > least { beyond(curve, after, least, reach) } else { None };
    let from = from.as_ref().unwrap_or(before);
    let found = search(curve, from, to.as_ref().unwrap_or(after));
    // A first step that led to another branch is made anew.
    if first_step && !matches!(found, Err(Error::OtherBranch)) {
        curve.first_beyond = Some(from.clone());
    }
    found
}

/// Special points between two solutions, in order.
pub(super) fn search(
    curve: &mut EquilibriumCurve<'_>,
    before: &Node,
    after: &Node,
) -> Result<Vec<Node>, Error> {
    Scan { curve, trials: MOST_TRIALS, found: Vec::new() }.verified(before, after, MOST_SEARCHES)
}

fn distance(curve: &EquilibriumCurve<'_>, before: &Node, after: &Node) -> f64 {
    let step: Vec<f64> = after.unknown.iter().zip(&before.unknown).map(|(b, a)| b - a).collect();
    length(&step, &curve.system.scales)
}

/// The change in the number of unstable eigenvalues; `None` where it is not decided.
fn change(before: &Node, after: &Node) -> Option<usize> {
    let [one, other] = [before, after].map(|node| node.point.spectrum.stability.unstable_dimension());
    Some(one?.abs_diff(other?))
}

/// Whether the change in the number of unstable eigenvalues is that which the points between say; where it is not, whether
/// it is larger.
fn surplus(points: &[Node], before: &Node, after: &Node) -> Option<bool> {
    let change = change(before, after)?;
    let mut most = 0;
    let mut exact = points.len() == 1;
    let mut parity = true;
    for point in points {
        most += match point.point.special.as_deref() {
            Some(SpecialPoint::Hopf(_)) => 2,
            Some(SpecialPoint::Fold(_)) => 1,
            // On the branch that turns at a pitchfork an eigenvalue touches zero.
            Some(SpecialPoint::BranchPoint(_)) => {
                (exact, parity) = (false, false);
                1
            }
            Some(SpecialPoint::NeutralSaddle(_)) => 0,
            Some(SpecialPoint::Degenerate { .. }) | None => return None,
        };
    }
    let agrees =
        change <= most && (!exact || change == most) && (!parity || (most - change).is_multiple_of(2));
    (!agrees).then_some(change > most)
}

/// Bracketed points of one kind at one place are one point, and none where the number of unstable eigenvalues stays: where
/// symmetry makes eigenvalues equal, the signs of test functions are rounding.
fn without_repetitions(mut points: Vec<Node>, before: &Node, after: &Node) -> Vec<Node> {
    let bracketed = |point: &Node| match point.point.special.as_deref() {
        Some(SpecialPoint::Degenerate { of, .. }) => Some(*of),
        _ => None,
    };
    if change(before, after) == Some(0) && points.len() == 1 {
        points.retain(|point| bracketed(point) != Some(SpecialKind::Hopf));
    }
    points.dedup_by(|next, previous| bracketed(next).is_some() && bracketed(next) == bracketed(previous));
    points
}

impl Scan<'_, '_> {
    /// Special points between two solutions, each with the change in the number of unstable eigenvalues that belongs to it.
    fn verified(&mut self, before: &Node, after: &Node, searches: usize) -> Result<Vec<Node>, Error> {
        self.trials = MOST_TRIALS;
        self.part(before, after, 1.0)?;
        let mut found = std::mem::take(&mut self.found);
        let place = |scan: &Self, node: &Node| position(before, &node.unknown, &scan.curve.system.scales);
        found.sort_by(|one, other| place(self, one).total_cmp(&place(self, other)));
        let mut checked = Vec::new();
        let mut group: Vec<Node> = Vec::new();
        let mut left = before.clone();
        let mut rest = found.into_iter().peekable();
        while let Some(point) = rest.next() {
            let right = match rest.peek() {
                None => Some(after.clone()),
                Some(next) if place(self, next) - place(self, &point) > COINCIDENT => {
                    let ends = point.unknown.iter().zip(&next.unknown);
                    let middle = ends.map(|(one, other)| 0.5 * (one + other)).collect();
                    across(self.curve, before, middle)
                }
                Some(_) => None,
            };
            group.push(point);
            if let Some(right) = right {
                let group = std::mem::take(&mut group);
                checked.extend(self.checked(group, &left, &right, before, searches)?);
                left = right;
            }
        }
        Ok(checked)
    }

    /// The points between two solutions, or what a closer search finds where they do not explain the change in the number of
    /// unstable eigenvalues.
    fn checked(
        &mut self,
        group: Vec<Node>,
        left: &Node,
        right: &Node,
        origin: &Node,
        searches: usize,
    ) -> Result<Vec<Node>, Error> {
        let group = without_repetitions(group, left, right);
        let Some(larger) = surplus(&group, left, right) else { return Ok(group) };
        if searches > 0
            && let Some((low, high)) = self.surroundings(&group, left, right, origin)
        {
            let mut found = self.verified(left, &low, searches - 1)?;
            match surplus(&group, &low, &high) {
                None => found.extend(group),
                Some(_) => found.extend(self.verified(&low, &high, searches - 1)?),
            }
            found.extend(self.verified(&high, right, searches - 1)?);
            return Ok(found);
        }
        let distance = distance(self.curve, left, right);
        if larger { crossings(self.curve, left, right, distance) } else { Ok(group) }
    }

    /// Solutions close to the first and the last point of a group, on both sides of it.
    fn surroundings(
        &mut self,
        group: &[Node],
        left: &Node,
        right: &Node,
        origin: &Node,
    ) -> Option<(Node, Node)> {
        let scales = &self.curve.system.scales;
        let places = [left, right].map(|node| position(origin, &node.unknown, scales));
        let aside = SURROUNDINGS * (places[1] - places[0]);
        let shifted = |node: &Node, shift: f64| -> Vec<f64> {
            node.unknown.iter().zip(&origin.tangent).map(|(value, slope)| value + shift * slope).collect()
        };
        let (low, high) = (shifted(group.first()?, -aside), shifted(group.last()?, aside));
        let inside = |unknown: &[f64]| {
            let place = position(origin, unknown, scales);
            place > places[0] && place < places[1]
        };
        if !inside(&low) || !inside(&high) {
            return None;
        }
        Some((across(self.curve, origin, low)?, across(self.curve, origin, high)?))
    }

    /// Special points in a part of the step.
    ///
    /// # Errors
    /// [`Error::OtherBranch`] if the ends lie beside each other and not behind each other.
    fn part(&mut self, before: &Node, after: &Node, share: f64) -> Result<(), Error> {
        let changes = Changes::between(before, after);
        let distance = distance(self.curve, before, after);
        let scales = &self.curve.system.scales;
        let cosine = |origin: &Node, other: &Node| {
            position(origin, &other.unknown, scales).abs() / (length(&origin.tangent, scales) * distance)
        };
        if distance > SHORTEST_JUMP && cosine(before, after).min(cosine(after, before)) < LEAST_COSINE {
            return Err(Error::OtherBranch);
        }
        let divide = if changes.count() > 1 || !changes.explain(before, after) {
            Some(0.5)
        } else {
            suspicious(before, after, distance)
        };
        // A fold at a branch point is most likely one and the same point.
        let smallest = if changes.fold && changes.branch_point { COINCIDENT_PART } else { SMALLEST_PART };
        if let Some(fraction) = divide.filter(|_| share > smallest && self.trials > 0) {
            self.trials -= 1;
            let settings = self.curve.settings;
            // Where all trials fail (next to a branch point, where the equations are singular) the division ends: the point
            // is located from the ends.
            let least = undecided(before).max(undecided(after));
            let mut middle = None;
            for fraction in std::iter::once(1.0).chain(ASIDE).map(|part| part * fraction) {
                let Ok(trial) = between(self.curve, before, after, distance, fraction, &settings) else {
                    continue;
                };
                let decided = undecided(&trial) <= least;
                middle = Some((fraction, trial));
                // A trial that happens to be a special point itself explains nothing.
                if decided {
                    break;
                }
            }
            if let Some((fraction, middle)) = middle {
                self.part(before, &middle, share * fraction)?;
                return self.part(&middle, after, share * (1.0 - fraction));
            }
        }
        if changes.count() == 0 && !changes.explain(before, after) {
            // Symmetry makes several eigenvalues cross at once.
            let crossings = crossings(self.curve, before, after, distance)?;
            self.found.extend(crossings);
            return Ok(());
        }
        self.locate(changes, before, after, distance)
    }

    fn locate(&mut self, changes: Changes, before: &Node, after: &Node, distance: f64) -> Result<(), Error> {
        if changes.branch_point {
            let point = locating::branch_point(self.curve, before, after, distance)?;
            // On the branch that turns at a pitchfork the parameter turns too, but that is no fold.
            let around = before.point.tests.fold.abs().max(after.point.tests.fold.abs());
            let turns = changes.fold && point.point.tests.fold.abs() < TANGENTIAL * around.max(distance);
            self.found.push(point);
            if changes.fold && !turns {
                self.found.push(locating::fold(self.curve, before, after, distance)?);
            }
        } else if changes.fold {
            self.found.push(locating::fold(self.curve, before, after, distance)?);
        }
        if changes.hopf {
            let point = locating::hopf(self.curve, before, after, distance)?;
            let bracketed = matches!(point.point.special.as_deref(), Some(SpecialPoint::Degenerate { .. }));
            // Two real eigenvalues that symmetry takes through zero together change the test function too.
            if bracketed && change(before, after).is_some_and(|change| change > 0) {
                self.found.extend(crossings(self.curve, before, after, distance)?);
            } else {
                self.found.push(point);
            }
        }
        Ok(())
    }
}
