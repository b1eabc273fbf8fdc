//! What continuation asks of a curve of special equilibria: residuals, test functions, where points of codimension two lie.

use super::curve::{EquilibriumLocusInspection, LocusCurve};
use super::kind::Linearized;
use super::locating;
use super::system::LocusSystem;
use crate::algebraic::DenseSystem;
use crate::branch::SpecialKind;
use crate::continuation::events::{self, Location, Reading, TestFunction};
use crate::continuation::{Adaptation, Curve, Discretised, Ending, Solution, Stop, distance};
use crate::equilibrium::spectrum::without;
use crate::error::Error;
use std::borrow::Cow;
use std::convert::Infallible;

/// Perturbation of the field, relative to its fastest rate, beyond which a branch point does not persist.
const UNPERTURBED: f64 = 1e-8;
/// Points of codimension two are one where parameters and states differ by less than this part of their sizes.
const SAME_PLACE: f64 = 1e-8;
/// A real part, relative to the largest modulus, of an eigenvalue that is not critical below which its sign is not decided: next
/// to another bifurcation eigenvalues are known to the root of rounding only.
const UNDECIDED: f64 = 1e-7;

impl<'a> Discretised for LocusCurve<'a> {
    type System = DenseSystem<LocusSystem<'a>>;

    fn system(&self) -> &Self::System {
        &self.system
    }

    fn system_mut(&mut self) -> &mut Self::System {
        &mut self.system
    }
}

impl Curve for LocusCurve<'_> {
    type Point = EquilibriumLocusInspection;
    type Kind = SpecialKind;
    type Reason = Infallible;

    fn apply_metric(&self, vector: &[f64], image: &mut [f64]) {
        self.system.apply_metric(vector, image);
    }

    fn adapt(&mut self, unknown: &mut Vec<f64>, vectors: &mut [&mut Vec<f64>]) -> Result<Adaptation, Error> {
        self.renormalize(unknown, vectors)?;
        Ok(Adaptation::Unchanged)
    }

    fn inspect(
        &mut self,
        unknown: &[f64],
        _tangent: &[f64],
        _orientation: f64,
    ) -> Result<EquilibriumLocusInspection, Error> {
        let n = self.states.len();
        let spectrum = self.spectrum(unknown)?;
        let point = Linearized {
            unknown,
            matrix: &self.matrix[..n * n],
            eigenvalues: &spectrum.eigenvalues,
            scales: &self.states,
        };
        let monitor = self.system.problem.monitor(&point)?;
        Ok(EquilibriumLocusInspection { spectrum, monitor, special: None })
    }

    fn test_functions(&self) -> Cow<'static, [TestFunction<SpecialKind>]> {
        Cow::Borrowed(self.system.problem.test_functions())
    }

    fn test(&self, kind: SpecialKind, solution: &Solution<EquilibriumLocusInspection>) -> Option<Reading> {
        solution.point.monitor.reading(kind)
    }

    fn spectrum(&self, solution: &Solution<EquilibriumLocusInspection>) -> events::Spectrum {
        let all = &solution.point.spectrum.eigenvalues;
        let rest = without(all, &self.system.problem.critical_eigenvalues(&solution.unknown));
        let noise = UNDECIDED * all.iter().map(|value| value.norm()).fold(0.0, f64::max);
        events::Spectrum {
            unstable: rest.iter().filter(|value| value.re > 0.0).count(),
            decided: rest.iter().all(|value| value.re.abs() > noise),
            exponents: rest,
            noise,
            is_periodic: false,
        }
    }

    fn locate(
        &mut self,
        kind: SpecialKind,
        [before, after]: [&Solution<EquilibriumLocusInspection>; 2],
    ) -> Result<Location<EquilibriumLocusInspection>, Error> {
        let distance = distance(self, &before.unknown, &after.unknown);
        let found = locating::codimension_two(self, before, after, distance, kind)?;
        Ok(found.map_or(Location::Nothing, Location::At))
    }

    fn are_same(&self, one: &EquilibriumLocusInspection, other: &EquilibriumLocusInspection) -> bool {
        let (Some(one), Some(other)) = (&one.special, &other.special) else { return false };
        let values = one.values.iter().zip(&other.values).zip(self.ranges);
        let states = one.state.iter().zip(&other.state).zip(self.states.iter().copied());
        one.kind == other.kind
            && values.chain(states).all(|((one, other), size)| (one - other).abs() <= SAME_PLACE * size)
    }

    fn signature(&self, unknown: &[f64]) -> Vec<(f64, f64)> {
        let states = unknown.iter().copied().zip(self.system.scales.iter().copied());
        states.take(self.states.len()).collect()
    }

    fn ending(
        &mut self,
        _before: &Solution<EquilibriumLocusInspection>,
        after: &Solution<EquilibriumLocusInspection>,
    ) -> Option<Ending<Infallible>> {
        if self.system.problem.kind() != Some(SpecialKind::BranchPoint) {
            return None;
        }
        let perturbation = after.unknown[2 * self.states.len()];
        let limit = UNPERTURBED * self.system.scales[2 * self.states.len()];
        (perturbation.abs() > limit).then_some(Ending::Between(Stop::Failed(Error::BranchPointBreaksUp)))
    }
}
