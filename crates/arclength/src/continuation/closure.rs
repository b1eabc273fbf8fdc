//! Recognises that a curve is closed: that it has come back to a solution passed before.
//!
//! The discretisation may have changed on the way, so solutions are not compared component by component. Where the first
//! parameter passes the value that it had there, in the same direction, the solution at exactly that value is computed, and
//! the signatures of the two are compared.

use super::curve::{Curve, Solution};
use super::follow::{Bound, Origin, fix, fix_closely};
use super::settings::Settings;

/// Relative agreement of signatures that makes a curve closed.
const CLOSURE_TOLERANCE: f64 = 1e-6;
/// The first parameter nearly stands still at a solution if it moves less than this part of how fast it moves soon after.
const STANDSTILL: f64 = 0.1;
/// Solutions among which one with a moving parameter is looked for.
const EARLY: usize = 10;
/// Part of the length up to the solution compared with; special points this close before the start are those of the start.
const MARGIN: f64 = 0.5;

/// The solution to which a closed curve comes back.
pub(super) struct Closure {
    bound: Bound,
    parameter: f64,
    /// Rate of the parameter there.
    rate: f64,
    signature: Vec<f64>,
    /// Length of the curve from its first solution to this one.
    length: f64,
    /// Number of the solution.
    index: usize,
}

impl Closure {
    pub fn at<C: Curve>(curve: &C, solution: &Solution<C::Point>, bound: Bound) -> Self {
        let place = solution.unknown.len() - bound.from_end;
        Self {
            bound,
            parameter: solution.unknown[place],
            rate: solution.tangent[place],
            signature: curve.signature(&solution.unknown),
            length: 0.0,
            index: 0,
        }
    }

    /// Takes `solution`, the next of the curve, in place of one at which the parameter nearly stands still, as it does where a
    /// branch leaves a pitchfork.
    pub fn consider<C: Curve>(
        &mut self,
        curve: &C,
        solution: &Solution<C::Point>,
        index: usize,
        length: f64,
    ) {
        let rate = solution.tangent[solution.tangent.len() - self.bound.from_end];
        if index <= EARLY && self.rate.abs() < STANDSTILL * rate.abs() {
            *self = Self { index, length, ..Self::at(curve, solution, self.bound) };
        }
    }

    /// The solution at which the curve comes back between two of its solutions, `index` the number of the first of them.
    pub fn reached<C: Curve>(
        &self,
        curve: &mut C,
        current: &Solution<C::Point>,
        advanced: &Solution<C::Point>,
        index: usize,
        settings: &Settings,
    ) -> Option<Solution<C::Point>> {
        let from_end = self.bound.from_end;
        let position = |solution: &Solution<C::Point>| {
            solution.unknown[solution.unknown.len() - from_end] - self.parameter
        };
        let (here, there) = (position(current), position(advanced));
        let crosses = here * there <= 0.0 && there * self.rate >= 0.0 && here != 0.0;
        if index < self.index + 2 || !crosses {
            return None;
        }
        let value = self.parameter;
        let is_start = |curve: &C, candidate: &Solution<C::Point>| {
            same(&curve.signature(&candidate.unknown), &self.signature)
        };
        if let Ok(candidate) = fix(curve, current, advanced, from_end, value, settings)
            && is_start(curve, &candidate)
        {
            return Some(candidate);
        }
        let candidate = fix_closely(curve, current, advanced, from_end, value, settings).ok()??;
        is_start(curve, &candidate).then_some(candidate)
    }

    /// Removes the part of a closed curve, with the lengths of its solutions, behind its start and adds the start as its end.
    pub fn cut<P: Clone>(&self, solutions: &mut Vec<(Solution<P>, Origin)>, lengths: &[f64], total: f64) {
        if self.length == 0.0 {
            return;
        }
        let start = total - self.length;
        let mut lengths = lengths.iter();
        solutions.retain(|_| lengths.next().is_some_and(|length| *length < start - MARGIN * self.length));
        if let Some((first, _)) = solutions.first().cloned() {
            solutions.push((first, Origin::End));
        }
    }
}

fn same(signature: &[f64], other: &[f64]) -> bool {
    signature.len() == other.len()
        && signature
            .iter()
            .zip(other)
            .all(|(a, b)| (a - b).abs() <= CLOSURE_TOLERANCE * (1.0 + a.abs().max(b.abs())))
}
