//! Recognises that a curve is closed: that it has come back to its start.
//!
//! The discretisation may have changed on the way, so solutions are not compared component by component but by their
//! signatures. Where a step passes the plane through the signature of the start, across the step, the solution on the plane
//! is computed and compared.

use super::bracket::locate;
use super::curve::{Curve, Solution};
use super::follow::Bound;
use super::settings::Settings;

/// Relative agreement of signatures that makes a curve closed.
const CLOSURE_TOLERANCE: f64 = 1e-6;
/// Part of a step to which the place of the start is narrowed down.
const PLACE: f64 = 1e-9;
/// Steps that end farther from the start than this many times their length do not pass it.
const FAR: f64 = 2.0;

/// The start of a curve, to which it may come back.
pub(super) struct Closure {
    bound: Bound,
    parameter: f64,
    /// The signature and the parameter.
    signature: Vec<f64>,
}

impl Closure {
    pub fn at<C: Curve>(curve: &C, start: &Solution<C::Point>, bound: Bound) -> Self {
        let parameter = start.unknown[start.unknown.len() - bound.from_end];
        let mut signature: Vec<f64> =
            curve.signature(&start.unknown).into_iter().map(|(value, _)| value).collect();
        signature.push(parameter);
        Self { bound, parameter, signature }
    }

    fn parameter<P>(&self, solution: &Solution<P>) -> f64 {
        solution.unknown[solution.unknown.len() - self.bound.from_end]
    }

    /// The signature of a solution less that of the start, in parts of the sizes.
    fn beyond<C: Curve>(&self, curve: &C, solution: &Solution<C::Point>) -> Vec<f64> {
        let parameter = (self.parameter(solution), self.bound.upper - self.bound.lower);
        let signature = curve.signature(&solution.unknown).into_iter().chain([parameter]);
        signature.zip(&self.signature).map(|((here, size), start)| (here - start) / size).collect()
    }

    /// The solution at which the curve comes back between two consecutive solutions, which are not the first two.
    pub fn reached<C: Curve>(
        &self,
        curve: &mut C,
        current: &Solution<C::Point>,
        advanced: &Solution<C::Point>,
        settings: &Settings,
    ) -> Option<Solution<C::Point>> {
        // Signatures cost more than the parameter, which tells where a step cannot lead back.
        let distance = [current, advanced].map(|solution| (self.parameter(solution) - self.parameter).abs());
        let range = self.bound.upper - self.bound.lower;
        if distance[0].min(distance[1]) > FAR * settings.largest_parameter_change * range {
            return None;
        }
        let [here, there] = [current, advanced].map(|solution| self.beyond(curve, solution));
        let chord: Vec<f64> = there.iter().zip(&here).map(|(there, here)| there - here).collect();
        let passes = inner(&chord, &here) < 0.0 && inner(&chord, &there) >= 0.0;
        let far = inner(&here, &here).sqrt() > FAR * inner(&chord, &chord).sqrt();
        if !passes || far {
            return None;
        }
        let test =
            |curve: &mut C, solution: &Solution<C::Point>| Some(inner(&chord, &self.beyond(curve, solution)));
        // A curve whose start cannot be computed again is followed on.
        let candidate = locate(curve, current, advanced, settings, PLACE, test).ok()??;
        let same =
            self.beyond(curve, &candidate).iter().all(|difference| difference.abs() <= CLOSURE_TOLERANCE);
        same.then_some(candidate)
    }
}

fn inner(one: &[f64], other: &[f64]) -> f64 {
    one.iter().zip(other).map(|(a, b)| a * b).sum()
}
