//! Cycles that are born at a Hopf point: the first one is as large as the normal form holds.

use super::asked::{Asked, FollowedCycles, MOST_REDUCTIONS};
use super::curve::{Birth, CycleInspection};
use super::expansion::Expansion;
use super::floquet::UnstableCount;
use super::hopf_start::HopfStart;
use crate::algebraic::Differentiator;
use crate::algebraic::scales::natural_scales_along;
use crate::branch::SpecialKind;
use crate::continuation::{Observer, Request, Settings, exact_start};
use crate::equilibrium::problem::EquilibriumProblem;
use crate::equilibrium::spectrum::without;
use crate::error::{CorrectionFailure, Error};
use crate::linear::eigenvalues::eigenvalues;
use num_complex::Complex64;

/// Reduction of the first amplitude.
const AMPLITUDE_REDUCTION: f64 = 0.25;
/// Distance of the first cycle from a Hopf point in the parameter, in multiples of what the normal form gives, beyond which it is
/// no cycle that is born there.
const FARTHEST_FIRST: f64 = 3.0;
/// Growth rate beside the frequency of a Hopf point above which it is certain that the cycles are born with its sign.
const CERTAIN_RATE: f64 = 1e-6;
/// Error of a cycle, relative to its amplitude, beyond which it is so small that its multipliers say nothing.
const RESOLVED: f64 = 1e-3;

impl Asked<'_> {
    /// Follows the branch from a Hopf point, from a smaller first cycle where there is none near that of the normal form.
    pub(super) fn be_born(
        &self,
        hopf: &HopfStart<'_>,
        request: &Request<'_, CycleInspection>,
        observer: &mut Observer<'_, CycleInspection, SpecialKind>,
    ) -> Result<FollowedCycles, Error> {
        // Shorter steps asked for mean a shorter first one.
        let share = (self.settings.initial_step / Settings::default().initial_step).min(1.0);
        let range = (self.active, self.bound.width());
        let scales = natural_scales_along(&self.field, hopf.state, &self.parameters, range);
        let mut amplitude = share * hopf.first_amplitude(self.bound.width(), &scales);
        // A first cycle of another stability than the normal form gives lies behind a fold, or behind another bifurcation, and so does
        // one whose parameter is elsewhere.
        if hopf.cubic_coefficient.is_normal() {
            let expected = self.unstable_at_birth(hopf);
            let reduced = std::iter::successors(Some(amplitude), |last| Some(last * AMPLITUDE_REDUCTION));
            let fits = |amplitude: &f64| self.is_as_born(hopf, *amplitude, expected, request);
            amplitude = reduced.take(MOST_REDUCTIONS).find(fits).unwrap_or(amplitude);
        }
        let place = self.parameters[self.active];
        let expansion = Expansion::at(hopf, self.field, &self.parameters, self.active, &scales);
        self.first_of(amplitude, AMPLITUDE_REDUCTION, |amplitude| {
            let mut first = |expansion: Option<&Expansion>| {
                let start = hopf.cycle(place, amplitude, expansion, self.resolution.degree);
                let is_certain = hopf.cubic_coefficient.is_normal();
                let birth = if is_certain { Birth::OfCertainSense } else { Birth::Unknown };
                let followed = self.follow(&start, birth, request, observer)?;
                let expected = amplitude * amplitude * hopf.cubic_coefficient / hopf.crossing_speed;
                if self.is_stray(&followed, FARTHEST_FIRST * expected.abs()) {
                    return Err(Error::NotFound { sought: "cycle", cause: CorrectionFailure::Diverged });
                }
                Ok(followed)
            };
            match first(None) {
                Err(Error::NotFound { .. }) if expansion.is_some() => first(expansion.as_ref()),
                result => result,
            }
        })
    }

    /// Whether a branch that is to start at the parameter's value starts outside its range and farther away than `expected`:
    /// then Newton's method has gone elsewhere.
    fn is_stray(&self, followed: &FollowedCycles, expected: f64) -> bool {
        let first = followed.solutions.first().and_then(|(solution, _)| solution.unknown.last());
        first.is_some_and(|&value| {
            let outside = !(self.bound.lower..=self.bound.upper).contains(&value);
            outside && (value - self.parameters[self.active]).abs() > expected
        })
    }

    /// Number of multipliers outside the unit circle with which the cycles are born; `None` where it is not certain.
    fn unstable_at_birth(&self, hopf: &HopfStart<'_>) -> Option<usize> {
        let n = hopf.state.len();
        let problem = EquilibriumProblem::new(self.field, &self.parameters, &[]);
        let (mut residual, mut matrix) = (vec![0.0; n], vec![0.0; n * n]);
        Differentiator::default().jacobian(&problem, hopf.state, &mut residual, &mut matrix, n);
        let pair = Complex64::new(0.0, hopf.frequency);
        let rest = without(&eigenvalues(&matrix, n).ok()?, &[pair, pair.conj()]);
        let certain = hopf.cubic_coefficient.is_normal()
            && rest.iter().all(|value| value.re.abs() > CERTAIN_RATE * hopf.frequency);
        let unstable = rest.iter().filter(|value| value.re > 0.0).count();
        certain.then_some(unstable + usize::from(hopf.cubic_coefficient > 0.0))
    }

    /// Whether the cycle near a Hopf point that has an amplitude has as many multipliers outside the unit circle as those that are
    /// born there; where that number is not certain, whether its parameter is about where the normal form says.
    fn is_as_born(
        &self,
        hopf: &HopfStart<'_>,
        amplitude: f64,
        unstable_at_birth: Option<usize>,
        request: &Request<'_, CycleInspection>,
    ) -> bool {
        let place = self.parameters[self.active];
        let start = hopf.cycle(place, amplitude, None, self.resolution.degree);
        let mut curve = self.curve(&start);
        let Ok(found) = exact_start(&mut curve, start.unknown, start.tangent, request) else { return false };
        if found.point.error_estimate > RESOLVED {
            return false;
        }
        if let Some(expected) = unstable_at_birth {
            return found.point.floquet.unstable() == UnstableCount { count: expected, is_certain: true };
        }
        let expected = -amplitude * amplitude * hopf.cubic_coefficient / hopf.crossing_speed;
        let ratio = (found.unknown[found.unknown.len() - 1] - place) / expected;
        (FARTHEST_FIRST.recip()..=FARTHEST_FIRST).contains(&ratio)
    }
}
