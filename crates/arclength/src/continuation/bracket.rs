//! Zeros of test functions between two neighbouring solutions, by the Illinois variant of regula falsi with a correction at
//! every trial point: starts for Newton's method on a defining system.

use super::corrector::correct;
use super::curve::Curve;
use super::settings::Settings;
use super::solution::{Solution, along, finish, interpolate, metric_image};
use crate::error::Error;

/// Most trial points.
const MOST_TRIALS: usize = 60;
/// A trial point keeps this part of the bracket away from its ends.
const DISTANCE_FROM_ENDS: f64 = 0.01;

/// A change of the sign of a test function, bracketed ever more closely.
pub struct Bracket<'a, P> {
    ends: [&'a Solution<P>; 2],
    border: Vec<f64>,
    /// Length of the way.
    length: f64,
    /// The bracket in parts of the distance between the ends, with the values there.
    left: (f64, f64),
    right: (f64, f64),
    best: Solution<P>,
    smallest: f64,
    trials: usize,
}

impl<'a, P: Clone> Bracket<'a, P> {
    /// Between two neighbouring solutions; `None` where `test` does not exist or has the same sign at both.
    pub fn new<C: Curve<Point = P>>(
        curve: &mut C,
        before: &'a Solution<P>,
        after: &'a Solution<P>,
        mut test: impl FnMut(&mut C, &Solution<P>) -> Option<f64>,
    ) -> Option<Self> {
        let (left, right) = (test(curve, before)?, test(curve, after)?);
        (left * right <= 0.0).then(|| Self {
            ends: [before, after],
            border: metric_image(curve, &before.tangent),
            length: along(curve, before, &after.unknown),
            left: (0.0, left),
            right: (1.0, right),
            best: if left.abs() < right.abs() { before.clone() } else { after.clone() },
            smallest: left.abs().min(right.abs()),
            trials: 0,
        })
    }

    /// Narrows the bracket to a part `tolerance` of the distance between the ends. `test` is given the curve and a finished
    /// solution. Returns the solution where its modulus is smallest, `None` where it does not exist.
    ///
    /// # Errors
    /// When a trial point cannot be corrected.
    pub fn narrow<C: Curve<Point = P>>(
        &mut self,
        curve: &mut C,
        settings: &Settings,
        tolerance: f64,
        mut test: impl FnMut(&mut C, &Solution<P>) -> Option<f64>,
    ) -> Result<Option<&Solution<P>>, Error> {
        let [before, after] = self.ends;
        while self.trials < MOST_TRIALS && self.right.0 - self.left.0 >= tolerance && self.smallest != 0.0 {
            self.trials += 1;
            let ((left, left_value), (right, right_value)) = (self.left, self.right);
            let margin = DISTANCE_FROM_ENDS * (right - left);
            let secant = (left * right_value - right * left_value) / (right_value - left_value);
            let fraction = secant.clamp(left + margin, right - margin);
            let mut unknown = interpolate(before, after, self.length, fraction);
            correct(curve, &mut unknown, &self.border, settings)
                .map_err(|cause| Error::NotFound { sought: "solution between two points", cause })?;
            let trial = finish(curve, unknown, &before.tangent)?;
            let Some(value) = test(curve, &trial) else { return Ok(None) };
            if value.abs() < self.smallest {
                self.smallest = value.abs();
                self.best = trial;
            }
            if value * left_value <= 0.0 {
                self.right = (fraction, value);
                self.left.1 *= 0.5;
            } else {
                self.left = (fraction, value);
                self.right.1 *= 0.5;
            }
        }
        Ok(Some(&self.best))
    }
}

/// The solution where a test function that changes its sign between two neighbouring solutions has its smallest modulus in a
/// bracket of a part `tolerance` of the distance between them; `None` where it does not exist or does not change its sign.
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
    Ok(bracket.narrow(curve, settings, tolerance, test)?.cloned())
}
