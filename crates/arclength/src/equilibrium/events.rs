//! Which special points lie between two neighbouring equilibria, one by one and in order.
//!
//! A step is halved until the change in the number of unstable eigenvalues and the changes of sign of the test
//! functions agree and single out one point, or nothing is left to explain. Test functions that come close to zero
//! without changing sign (two points in one step) are looked at where a cubic through values and slopes says that they
//! come closest. Only then a point is located.

use super::curve::{EquilibriumCurve, Inspection, Tests};
use super::locating;
use crate::algebraic::{between, length};
use crate::branch::Stability;
use crate::continuation::Solution;
use crate::error::Error;

/// Solutions that may be computed to sort out one step.
const MOST_TRIALS: usize = 100;
/// Part of a step below which it is not divided any further.
const SMALLEST_PART: f64 = 1e-7;
/// The same while a fold and a branch point are not separated.
const COINCIDENT_PART: f64 = 0.02;
/// A test function that a cubic says shrinks to this part of the smaller of its end values is looked at.
const SUSPICIOUS: f64 = 0.3;
/// A step is divided no closer to its ends than this part.
const SMALLEST_FRACTION: f64 = 0.02;
/// A step is divided at this part of the fraction where the fraction itself gives a special point.
const ASIDE: f64 = 0.8;
/// A rate of change of the parameter along the curve that may be rounding error.
const UNDECIDED_FOLD: f64 = 1e-13;
/// Rate of change of the parameter at a branch point, relative to its values around, below which the branch is tangential
/// there: a pitchfork met on the branch that turns.
const TANGENTIAL: f64 = 1e-3;

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

/// Where a second look is needed although no test function changes sign.
fn suspicious(before: &Node, after: &Node, distance: f64) -> Option<f64> {
    let tests = |pick: fn(&Tests) -> f64| [pick(&before.point.tests), pick(&after.point.tests)];
    let decided = before.point.spectrum.hopf_undecided == after.point.spectrum.hopf_undecided;
    let hopf = decided
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
        if opposite(one, other) || !mean.is_finite() {
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

struct Scan<'c, 'a> {
    curve: &'c mut EquilibriumCurve<'a>,
    trials: usize,
    found: Vec<Node>,
}

/// As [`Curve::special_points`](crate::continuation::Curve::special_points).
pub(super) fn special_points(
    curve: &mut EquilibriumCurve<'_>,
    before: &Node,
    after: &Node,
) -> Result<Vec<Node>, Error> {
    let mut scan = Scan { curve, trials: MOST_TRIALS, found: Vec::new() };
    scan.part(before, after, 1.0)?;
    Ok(scan.found)
}

impl Scan<'_, '_> {
    /// Special points in a part of the step.
    fn part(&mut self, before: &Node, after: &Node, share: f64) -> Result<(), Error> {
        let changes = Changes::between(before, after);
        let step: Vec<f64> = after.unknown.iter().zip(&before.unknown).map(|(b, a)| b - a).collect();
        let distance = length(&step, &self.curve.system.scales);
        let divide = if changes.count() > 1 || !changes.explain(before, after) {
            Some(0.5)
        } else if changes.count() == 0 {
            suspicious(before, after, distance)
        } else {
            None
        };
        // A fold at a branch point is most likely one and the same point.
        let smallest = if changes.fold && changes.branch_point { COINCIDENT_PART } else { SMALLEST_PART };
        if let Some(fraction) = divide.filter(|_| share > smallest && self.trials > 0) {
            self.trials -= 1;
            let settings = self.curve.settings;
            // A trial that fails (next to a branch point, where the equations are singular) ends the division: the point is
            // located from the ends.
            for fraction in [fraction, ASIDE * fraction] {
                let Ok(middle) = between(self.curve, before, after, distance, fraction, &settings) else {
                    break;
                };
                // A trial that happens to be a special point itself explains nothing.
                let undecided = middle.point.spectrum.stability == Stability::Undecided;
                if undecided && changes.count() == 0 && fraction == 0.5 {
                    continue;
                }
                self.part(before, &middle, share * fraction)?;
                return self.part(&middle, after, share * (1.0 - fraction));
            }
        }
        if changes.count() == 0 && !changes.explain(before, after) {
            // Symmetry makes several eigenvalues cross at once.
            self.found.push(locating::multiple(self.curve, before, after, distance));
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
            self.found.push(locating::hopf(self.curve, before, after, distance)?);
        }
        Ok(())
    }
}
