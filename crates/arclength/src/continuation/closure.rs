//! Recognises that a curve is closed: that it has come back to its start.
//!
//! The discretisation may have changed on the way, so solutions are not compared component by component but by their
//! signatures. Where a component of the signature passes its value at the start, the solution with that value is computed and
//! compared; of several components those come first that change most, because at a turning point the parameter stands still, and
//! the amplitude of a state that vanishes at the start has a kink there.

use super::bracket::locate;
use super::curve::Curve;
use super::settings::Settings;
use super::solution::{Bound, Solution};

/// Relative agreement of signatures that makes a curve closed.
const CLOSURE_TOLERANCE: f64 = 1e-6;
/// A curve has left its start when it has been this many times that away from it.
const AWAY: f64 = 2.0;
/// Part of a step to which the place of the start is narrowed down.
const PLACE: f64 = 1e-9;
/// Components of the signature that are tried.
const MOST_COMPONENTS: usize = 3;
/// Steps that end farther from the start than this many times their length do not pass it.
const FAR: f64 = 2.0;
/// Components vanish together where the curve comes back: one that is this many times larger than another, both in parts of their changes
/// in the step, leads elsewhere.
const APART: f64 = 100.0;

/// The start of a curve, to which it may come back.
pub(super) struct Closure {
    bounds: Vec<Bound>,
    /// The signature and the bounded parameters.
    signature: Vec<f64>,
    /// Whether the curve has left it: the first steps may be so short that they do not.
    has_left: bool,
}

impl Closure {
    pub(super) fn at<C: Curve>(curve: &C, start: &Solution<C::Point>, bounds: &[Bound]) -> Self {
        let mut signature: Vec<f64> =
            curve.signature(&start.unknown).into_iter().map(|(value, _)| value).collect();
        signature.extend(bounds.iter().map(|bound| bound.value(&start.unknown)));
        Self { bounds: bounds.to_vec(), signature, has_left: false }
    }

    /// The signature of a solution less that of the start, in parts of the sizes.
    fn beyond<C: Curve>(&self, curve: &C, solution: &Solution<C::Point>) -> Vec<f64> {
        let parameters = self.bounds.iter().map(|bound| (bound.value(&solution.unknown), bound.width()));
        let signature = curve.signature(&solution.unknown).into_iter().chain(parameters);
        signature.zip(&self.signature).map(|((here, size), start)| (here - start) / size).collect()
    }

    /// The solution at which the curve comes back between two consecutive solutions, which are not the first two.
    pub(super) fn reached<C: Curve>(
        &mut self,
        curve: &mut C,
        current: &Solution<C::Point>,
        advanced: &Solution<C::Point>,
        settings: &Settings,
    ) -> Option<Solution<C::Point>> {
        // Signatures cost more than the parameters, which tell where a step cannot lead back.
        let parameters = &self.signature[self.signature.len() - self.bounds.len()..];
        let leads_elsewhere = self.bounds.iter().zip(parameters).any(|(bound, start)| {
            let [here, there] =
                [current, advanced].map(|solution| (bound.value(&solution.unknown) - start).abs());
            here.min(there) > FAR * settings.largest_parameter_change * bound.width()
        });
        if leads_elsewhere {
            self.has_left = true;
            return None;
        }
        let [here, there] = [current, advanced].map(|solution| self.beyond(curve, solution));
        self.has_left |= here.iter().any(|entry| entry.abs() > AWAY * CLOSURE_TOLERANCE);
        if !self.has_left {
            return None;
        }
        let changes: Vec<f64> = here.iter().zip(&there).map(|(here, there)| (there - here).abs()).collect();
        let largest = changes.iter().copied().fold(0.0, f64::max);
        passing(&here, &there).into_iter().take(MOST_COMPONENTS).find_map(|index| {
            let slope = APART * largest / changes[index];
            let test = |curve: &mut C, solution: &Solution<C::Point>| {
                let beyond = self.beyond(curve, solution);
                let farthest = CLOSURE_TOLERANCE.max(slope * beyond[index].abs());
                beyond.iter().all(|entry| entry.abs() <= farthest).then_some(beyond[index])
            };
            // A curve whose start cannot be computed again is followed on.
            let candidate = locate(curve, current, advanced, settings, PLACE, test).ok()??;
            let beyond = self.beyond(curve, &candidate);
            beyond.iter().all(|difference| difference.abs() <= CLOSURE_TOLERANCE).then_some(candidate)
        })
    }
}

/// The components that pass zero between two consecutive solutions, those that change most first; none where the step leads elsewhere.
fn passing(here: &[f64], there: &[f64]) -> Vec<usize> {
    let change = |index: &usize| (there[*index] - here[*index]).abs();
    let step: f64 = (0..here.len()).map(|index| change(&index).powi(2)).sum();
    let beyond = here.iter().map(|entry| entry * entry).sum::<f64>();
    if beyond > (FAR * FAR) * step {
        return Vec::new();
    }
    let passes = |index: &usize| here[*index] * there[*index] <= 0.0 && change(index) > 0.0;
    let mut passing: Vec<usize> = (0..here.len()).filter(passes).collect();
    passing.sort_by(|one, other| change(other).total_cmp(&change(one)));
    passing
}
