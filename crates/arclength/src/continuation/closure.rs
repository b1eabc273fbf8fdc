//! Recognises that a curve is closed: that it has come back to its start.
//!
//! The discretisation may have changed on the way, so solutions are not compared component by component but by their
//! signatures. Where the signature passes the plane through that of the start, across the direction in which the curve left
//! it, the solution on the plane is computed and compared.

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
    /// The signature and the parameter, as a part of its range.
    signature: Vec<f64>,
    /// How the curve left; empty before its first step.
    direction: Vec<f64>,
}

impl Closure {
    pub fn at<C: Curve>(curve: &C, start: &Solution<C::Point>, bound: Bound) -> Self {
        let parameter = start.unknown[start.unknown.len() - bound.from_end];
        let mut closure = Self { bound, parameter, signature: Vec::new(), direction: Vec::new() };
        closure.signature = closure.signature_of(curve, start);
        closure
    }

    fn signature_of<C: Curve>(&self, curve: &C, solution: &Solution<C::Point>) -> Vec<f64> {
        let mut signature = curve.signature(&solution.unknown);
        let parameter = solution.unknown[solution.unknown.len() - self.bound.from_end];
        signature.push(parameter / (self.bound.upper - self.bound.lower));
        signature
    }

    /// Whether a solution is the start.
    pub fn is_start<C: Curve>(&self, curve: &C, solution: &Solution<C::Point>) -> bool {
        let signature = self.signature_of(curve, solution);
        let close = |(a, b): (&f64, &f64)| (a - b).abs() <= CLOSURE_TOLERANCE * (1.0 + a.abs().max(b.abs()));
        signature.iter().zip(&self.signature).all(close)
    }

    /// The solution at which the curve comes back between two consecutive solutions.
    pub fn reached<C: Curve>(
        &mut self,
        curve: &mut C,
        current: &Solution<C::Point>,
        advanced: &Solution<C::Point>,
        settings: &Settings,
    ) -> Option<Solution<C::Point>> {
        if self.direction.is_empty() {
            self.direction = difference(&self.signature_of(curve, advanced), &self.signature);
            return None;
        }
        // Signatures cost more than the parameter, which tells where a step cannot lead back.
        let parameter =
            |solution: &Solution<C::Point>| solution.unknown[solution.unknown.len() - self.bound.from_end];
        let distance = [current, advanced].map(|solution| (parameter(solution) - self.parameter).abs());
        let range = self.bound.upper - self.bound.lower;
        if distance[0].min(distance[1]) > FAR * settings.largest_parameter_change * range {
            return None;
        }
        let [here, there] = [current, advanced].map(|solution| self.signature_of(curve, solution));
        let height = |signature: &[f64]| inner(&self.direction, &difference(signature, &self.signature));
        let passes = height(&here) < 0.0 && height(&there) >= 0.0;
        let far = length(&difference(&here, &self.signature)) > FAR * length(&difference(&here, &there));
        if !passes || far {
            return None;
        }
        let test =
            |curve: &mut C, solution: &Solution<C::Point>| Some(height(&self.signature_of(curve, solution)));
        // A curve whose start cannot be computed again is followed on.
        let candidate = locate(curve, current, advanced, settings, PLACE, test).ok()??;
        self.is_start(curve, &candidate).then_some(candidate)
    }
}

fn difference(one: &[f64], other: &[f64]) -> Vec<f64> {
    one.iter().zip(other).map(|(a, b)| a - b).collect()
}

fn inner(one: &[f64], other: &[f64]) -> f64 {
    one.iter().zip(other).map(|(a, b)| a * b).sum()
}

fn length(vector: &[f64]) -> f64 {
    inner(vector, vector).sqrt()
}
