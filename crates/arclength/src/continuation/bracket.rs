//! Zeros of test functions between two neighbouring solutions, by the Illinois variant of regula falsi with a correction at
//! every trial point: starts for Newton's method on a defining system.

use super::corrector::{correct, finish, finish_measured};
use super::curve::Curve;
use super::events::Location;
use super::metric::{along, distance, metric_image};
use super::settings::Settings;
use super::solution::{Solution, interpolate};
use crate::error::Error;

/// Most trial points.
const MOST_TRIALS: usize = 60;
/// Solutions at the ends of a narrow bracket that are this part of its first length apart, and this many times its length now, are not
/// on one curve.
const TORN: f64 = 1e-6;
const STRAIGHT: f64 = 10.0;
/// A trial point keeps this part of the bracket away from its ends.
const DISTANCE_FROM_ENDS: f64 = 0.01;

/// A test function, behind a pointer so that brackets are compiled once for every curve.
type Test<'t, C> = dyn FnMut(&mut C, &Solution<<C as Curve>::Point>) -> Option<f64> + 't;

/// A change of the sign of a test function, bracketed ever more closely.
pub(crate) struct Bracket<'a, P> {
    ends: [&'a Solution<P>; 2],
    border: Vec<f64>,
    /// Length of the way.
    length: f64,
    left: Side<P>,
    right: Side<P>,
    trials: usize,
    /// A trial whose value is at most this ends the search.
    negligible: f64,
    /// Whether the test function is smooth; others may jump, or be rounding on one side.
    is_smooth: bool,
}

/// A solution on one side of the change.
#[derive(Clone)]
struct Side<P> {
    /// Its place in parts of the distance between the ends.
    fraction: f64,
    solution: Solution<P>,
    value: f64,
    /// The value as the secant counts it, halved where the side stays: of a smooth test function from the second time on, which keeps
    /// the secant's speed, of others at once, which brings the ends together by halves.
    weight: f64,
    /// Trials that it has stayed for.
    stays: usize,
}

impl<P: Clone> Side<P> {
    fn new(fraction: f64, solution: Solution<P>, value: f64) -> Self {
        Self { fraction, solution, value, weight: value, stays: 0 }
    }
}

impl<'a, P: Clone> Bracket<'a, P> {
    /// Between two neighbouring solutions; `None` where `test` does not exist or has the same sign at both.
    pub(crate) fn new<C: Curve<Point = P>>(
        curve: &mut C,
        before: &'a Solution<P>,
        after: &'a Solution<P>,
        test: &mut Test<'_, C>,
    ) -> Option<Self> {
        let (left, right) = (test(curve, before)?, test(curve, after)?);
        (left * right <= 0.0).then(|| Self {
            ends: [before, after],
            border: metric_image(curve, &before.tangent),
            length: along(curve, before, &after.unknown),
            left: Side::new(0.0, before.clone(), left),
            right: Side::new(1.0, after.clone(), right),
            trials: 0,
            negligible: 0.0,
            is_smooth: false,
        })
    }

    /// Whether the two sides are solutions on different branches: they stay apart although the bracket is narrow.
    pub(crate) fn is_torn<C: Curve<Point = P>>(&self, curve: &C) -> bool {
        let gap = distance(curve, &self.left.solution.unknown, &self.right.solution.unknown);
        gap > TORN * self.length && gap > (self.right.fraction - self.left.fraction) * self.length * STRAIGHT
    }

    /// Narrows the bracket to a part `tolerance` of the distance between the ends. `test` is given the curve and a finished
    /// solution. Returns the side of the bracket where its modulus is smaller, `None` where it does not exist. A test function
    /// may jump where its sign changes.
    ///
    /// # Errors
    /// When a trial point cannot be corrected.
    pub(crate) fn narrow<C: Curve<Point = P>>(
        &mut self,
        curve: &mut C,
        settings: &Settings,
        tolerance: f64,
        test: &mut Test<'_, C>,
    ) -> Result<Option<&Solution<P>>, Error> {
        let [before, after] = self.ends;
        while self.trials < MOST_TRIALS
            && self.right.fraction - self.left.fraction >= tolerance
            && self.left.value != 0.0
            && self.right.value != 0.0
        {
            self.trials += 1;
            let (left, right) = (&mut self.left, &mut self.right);
            let margin = DISTANCE_FROM_ENDS * (right.fraction - left.fraction);
            let secant =
                (left.fraction * right.weight - right.fraction * left.weight) / (right.weight - left.weight);
            let fraction = secant.clamp(left.fraction + margin, right.fraction - margin);
            let mut unknown = interpolate(before, after, self.length, fraction);
            correct(curve, &mut unknown, &self.border, settings)
                .map_err(|cause| Error::NotFound { sought: "solution between two points", cause })?;
            let trial = finish(curve, unknown, &before.tangent)?;
            let Some(value) = test(curve, &trial) else { return Ok(None) };
            let side = Side::new(fraction, trial, value);
            let is_negligible = value.abs() <= self.negligible;
            let staying = if value * left.value <= 0.0 {
                *right = side;
                left
            } else {
                *left = side;
                right
            };
            staying.stays += 1;
            if staying.stays > 1 || !self.is_smooth {
                staying.weight *= 0.5;
            }
            if is_negligible {
                break;
            }
        }
        let nearer = if self.left.value.abs() < self.right.value.abs() { &self.left } else { &self.right };
        Ok(Some(&nearer.solution))
    }
}

/// The side where a test function that changes its sign between two neighbouring solutions has the smaller modulus, of a bracket
/// of a part `tolerance` of the distance between them; `None` where it does not exist or does not change its sign.
///
/// # Errors
/// When a trial point cannot be corrected.
pub fn locate<C: Curve>(
    curve: &mut C,
    before: &Solution<C::Point>,
    after: &Solution<C::Point>,
    settings: &Settings,
    tolerance: f64,
    mut test: impl FnMut(&mut C, &Solution<C::Point>) -> Option<f64>,
) -> Result<Option<Solution<C::Point>>, Error> {
    let Some(mut bracket) = Bracket::new(curve, before, after, &mut test) else { return Ok(None) };
    Ok(bracket.narrow(curve, settings, tolerance, &mut test)?.cloned())
}

/// As [`locate`], for a test function that is smooth: a solution where its modulus is at most `negligible` is as good as its zero.
///
/// # Errors
/// As [`locate`].
pub(crate) fn locate_value<C: Curve>(
    curve: &mut C,
    [before, after]: [&Solution<C::Point>; 2],
    settings: &Settings,
    (tolerance, negligible): (f64, f64),
    mut test: impl FnMut(&mut C, &Solution<C::Point>) -> Option<f64>,
) -> Result<Option<Solution<C::Point>>, Error> {
    let Some(bracket) = Bracket::new(curve, before, after, &mut test) else { return Ok(None) };
    let mut bracket = Bracket { negligible, is_smooth: true, ..bracket };
    Ok(bracket.narrow(curve, settings, tolerance, &mut test)?.cloned())
}

/// Parts of the distance between two solutions to which the zero of a test function is bracketed before Newton's method takes
/// over, and tries again.
const STARTS: [f64; 4] = [0.5, 1e-2, 1e-4, 1e-7];
/// A special point may lie this part of the distance outside.
const OUTSIDE: f64 = 1e-6;

/// Locates the zero of a test function between two neighbouring solutions on its defining system: `solve` computes the unknowns of
/// the curve there, as a rule by Newton's method, from starts that come ever closer.
///
/// # Errors
/// When a solution cannot be inspected.
pub fn locate_by_defining_system<C: Curve>(
    curve: &mut C,
    [before, after]: [&Solution<C::Point>; 2],
    settings: &Settings,
    mut test: impl FnMut(&mut C, &Solution<C::Point>) -> Option<f64>,
    mut solve: impl FnMut(&mut C, &Solution<C::Point>) -> Result<Vec<f64>, Error>,
) -> Result<Location<C::Point>, Error> {
    let Some(mut bracket) = Bracket::new(curve, before, after, &mut test) else {
        return Ok(Location::Missed);
    };
    let length = along(curve, before, &after.unknown);
    for tolerance in STARTS {
        let near = match bracket.narrow(curve, settings, tolerance, &mut test) {
            Ok(Some(near)) => near.clone(),
            Ok(None) | Err(Error::NotFound { .. }) => break,
            Err(error) => return Err(error),
        };
        let Ok(unknown) = solve(curve, &near) else { continue };
        let place = along(curve, before, &unknown);
        if place >= -OUTSIDE * length && place <= (1.0 + OUTSIDE) * length {
            return Ok(Location::At(finish_measured(curve, unknown, &before.tangent)?));
        }
    }
    Ok(Location::Missed)
}
