//! A curve of special equilibria as continuation sees it.

use super::codimension_two::CodimensionTwoPoint;
use super::kind::{Linearized, LocusKind, Monitor};
use super::locating;
use crate::algebraic::{DenseSystem, Differentiator};
use crate::branch::SpecialKind;
use crate::continuation::events::{self, Location, Reading, TestFunction};
use crate::continuation::{Adaptation, Curve, Ending, Settings, Solution, Stop, distance};
use crate::equilibrium::spectrum::{Spectrum, without};
use crate::error::Error;
use crate::linear::eigenvalues::EigenvalueWorkspace;
use std::convert::Infallible;
use std::marker::PhantomData;

/// Perturbation of the field, relative to its fastest rate, beyond which a branch point does not persist.
const UNPERTURBED: f64 = 1e-8;
/// A real part, relative to the largest modulus, of an eigenvalue that is not critical below which its sign is not decided: next
/// to another bifurcation eigenvalues are known to the root of rounding only.
const UNDECIDED: f64 = 1e-7;

/// What is known about a point of the curve.
#[derive(Clone, Debug)]
pub(super) struct Inspection {
    pub spectrum: Spectrum,
    pub monitor: Monitor,
    pub special: Option<Box<CodimensionTwoPoint>>,
}

/// The curve of one kind of special equilibria in two parameters.
pub(super) struct LocusCurve<'a, K: LocusKind<'a>> {
    pub system: DenseSystem<K>,
    pub settings: Settings,
    /// Sizes of the states.
    pub states: Vec<f64>,
    ranges: [f64; 2],
    visited: Vec<[f64; 2]>,
    differentiator: Differentiator,
    workspace: EigenvalueWorkspace,
    matrix: Vec<f64>,
    residual: Vec<f64>,
    lifetime: PhantomData<&'a ()>,
}

impl<'a, K: LocusKind<'a>> LocusCurve<'a, K> {
    pub fn new(kind: K, states: Vec<f64>, ranges: [f64; 2], settings: Settings) -> Self {
        let n = states.len();
        let sizes = kind.sizes(&states, ranges);
        Self {
            system: DenseSystem::new(kind, sizes),
            settings,
            ranges,
            visited: vec![[f64::INFINITY, f64::NEG_INFINITY]; n],
            states,
            differentiator: Differentiator::default(),
            workspace: EigenvalueWorkspace::new(n),
            matrix: Vec::new(),
            residual: vec![0.0; n],
            lifetime: PhantomData,
        }
    }

    /// State and parameters out of the unknowns.
    pub fn equilibrium(&self, unknown: &[f64]) -> Vec<f64> {
        [&unknown[..self.states.len()], &unknown[unknown.len() - 2..]].concat()
    }

    /// The column-major Jacobian with respect to the state.
    pub fn jacobian(&mut self, unknown: &[f64]) -> &[f64] {
        let n = self.states.len();
        let point = self.equilibrium(unknown);
        let problem = self.system.problem.equilibria();
        self.matrix.resize(n * (n + 2), 0.0);
        self.differentiator.jacobian(problem, &point, &mut self.residual, &mut self.matrix, n);
        &self.matrix[..n * n]
    }

    pub fn spectrum(&mut self, unknown: &[f64]) -> Result<Spectrum, Error> {
        let n = self.states.len();
        self.jacobian(unknown);
        Spectrum::of(&self.matrix[..n * n], &mut self.workspace)
    }

    /// Suits scales and normalisations to `unknown`.
    pub fn renormalize(&mut self, unknown: &mut [f64], vectors: &mut [&mut Vec<f64>]) -> Result<(), Error> {
        for ((value, range), scale) in unknown.iter().zip(&mut self.visited).zip(&mut self.states) {
            *range = [range[0].min(*value), range[1].max(*value)];
            *scale = scale.max(range[1] - range[0]);
        }
        let spectrum = self.spectrum(unknown)?;
        let largest = spectrum.eigenvalues.iter().map(|value| value.norm()).fold(0.0, f64::max);
        self.system.problem.renormalize(unknown, vectors, &self.states, largest);
        self.system.scales = self.system.problem.sizes(&self.states, self.ranges);
        Ok(())
    }
}

impl<'a, K: LocusKind<'a>> Curve for LocusCurve<'a, K> {
    type Point = Inspection;
    type Kind = SpecialKind;
    type Reason = Infallible;

    fn unknowns(&self) -> usize {
        self.system.problem.unknowns()
    }

    fn residual(&mut self, unknown: &[f64], residual: &mut [f64]) {
        self.system.residual(unknown, residual);
    }

    fn factorize(&mut self, unknown: &[f64], border: &[f64], residual: &mut [f64]) -> f64 {
        self.system.factorize(unknown, border, residual)
    }

    fn solve(&mut self, right_hand_side: &mut [f64]) {
        self.system.solve(right_hand_side);
    }

    fn apply_metric(&self, vector: &[f64], image: &mut [f64]) {
        self.system.apply_metric(vector, image);
    }

    fn adapt(&mut self, unknown: &mut Vec<f64>, vectors: &mut [&mut Vec<f64>]) -> Result<Adaptation, Error> {
        self.renormalize(unknown, vectors)?;
        Ok(Adaptation::Unchanged)
    }

    fn inspect(&mut self, unknown: &[f64], _tangent: &[f64], _orientation: f64) -> Result<Inspection, Error> {
        let n = self.states.len();
        let spectrum = self.spectrum(unknown)?;
        let point = Linearized {
            unknown,
            matrix: &self.matrix[..n * n],
            eigenvalues: &spectrum.eigenvalues,
            scales: &self.states,
        };
        let monitor = self.system.problem.monitor(&point)?;
        Ok(Inspection { spectrum, monitor, special: None })
    }

    fn test_functions(&self) -> &'static [TestFunction<SpecialKind>] {
        K::TEST_FUNCTIONS
    }

    fn test(&self, kind: SpecialKind, solution: &Solution<Inspection>) -> Option<Reading> {
        solution.point.monitor.test(kind).map(Reading::exact)
    }

    fn spectrum(&self, solution: &Solution<Inspection>) -> events::Spectrum {
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
        [before, after]: [&Solution<Inspection>; 2],
    ) -> Result<Location<Inspection>, Error> {
        let distance = distance(self, &before.unknown, &after.unknown);
        let found = locating::codimension_two(self, before, after, distance, kind)?;
        Ok(found.map_or(Location::Nothing, Location::At))
    }

    fn signature(&self, unknown: &[f64]) -> Vec<(f64, f64)> {
        let states = unknown.iter().copied().zip(self.system.scales.iter().copied()).take(self.states.len());
        let last = unknown.last().map(|value| (*value, self.ranges[1]));
        states.chain(last).collect()
    }

    fn ending(
        &mut self,
        _before: &Solution<Inspection>,
        after: &Solution<Inspection>,
    ) -> Option<Ending<Infallible>> {
        if K::KIND != SpecialKind::BranchPoint {
            return None;
        }
        let perturbation = after.unknown[2 * self.states.len()];
        let limit = UNPERTURBED * self.system.scales[2 * self.states.len()];
        (perturbation.abs() > limit).then_some(Ending::Between(Stop::Failed(Error::BranchPointBreaksUp)))
    }
}
