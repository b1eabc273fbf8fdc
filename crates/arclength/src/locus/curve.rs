//! The system of equations of a curve of special equilibria in two parameters, and its linear algebra.

use super::codimension_two::CodimensionTwoPoint;
use super::kind::Monitor;
use super::system::LocusSystem;
use crate::algebraic::{DenseSystem, Differentiator, grown};
use crate::continuation::Settings;
use crate::equilibrium::spectrum::Spectrum;
use crate::error::Error;
use crate::linear::eigenvalues::EigenvalueWorkspace;

/// What is known about a point of the curve.
#[derive(Clone, Debug)]
pub(super) struct EquilibriumLocusInspection {
    pub spectrum: Spectrum,
    pub monitor: Monitor,
    pub special: Option<Box<CodimensionTwoPoint>>,
}

/// The curve of one kind of special equilibria in two parameters.
pub(super) struct LocusCurve<'a> {
    pub system: DenseSystem<LocusSystem<'a>>,
    pub settings: Settings,
    /// Sizes of the states.
    pub states: Vec<f64>,
    /// Those at the start.
    first_states: Vec<f64>,
    pub(super) ranges: [f64; 2],
    pub(super) visited: Vec<[f64; 2]>,
    pub(super) differentiator: Differentiator,
    pub(super) workspace: EigenvalueWorkspace,
    pub(super) matrix: Vec<f64>,
    pub(super) residual: Vec<f64>,
}

impl<'a> LocusCurve<'a> {
    pub(super) fn new(kind: LocusSystem<'a>, states: Vec<f64>, ranges: [f64; 2], settings: Settings) -> Self {
        let n = states.len();
        let sizes = kind.sizes(&states, ranges);
        Self {
            system: DenseSystem::new(kind, sizes),
            settings,
            ranges,
            visited: vec![[f64::INFINITY, f64::NEG_INFINITY]; n],
            first_states: states.clone(),
            states,
            differentiator: Differentiator::default(),
            workspace: EigenvalueWorkspace::new(n),
            matrix: Vec::new(),
            residual: vec![0.0; n],
        }
    }

    /// Forgets how far the curve has gone: the next direction starts with the sizes of the start.
    pub(super) fn restart(&mut self) {
        self.states.copy_from_slice(&self.first_states);
        self.visited.fill([f64::INFINITY, f64::NEG_INFINITY]);
        self.system.scales = self.system.problem.sizes(&self.states, self.ranges);
    }

    /// State and parameters out of the unknowns.
    pub(super) fn equilibrium(&self, unknown: &[f64]) -> Vec<f64> {
        [&unknown[..self.states.len()], &unknown[unknown.len() - 2..]].concat()
    }

    /// The column-major Jacobian with respect to the state.
    pub(super) fn jacobian(&mut self, unknown: &[f64]) -> &[f64] {
        let n = self.states.len();
        let point = self.equilibrium(unknown);
        let problem = self.system.problem.equilibria();
        self.matrix.resize(n * (n + 2), 0.0);
        self.differentiator.jacobian(problem, &point, &mut self.residual, &mut self.matrix, n);
        &self.matrix[..n * n]
    }

    pub(super) fn spectrum(&mut self, unknown: &[f64]) -> Result<Spectrum, Error> {
        let n = self.states.len();
        self.jacobian(unknown);
        Spectrum::of(&self.matrix[..n * n], &mut self.workspace)
    }

    /// Suits scales and normalisations to `unknown`.
    pub(super) fn renormalize(
        &mut self,
        unknown: &mut [f64],
        vectors: &mut [&mut Vec<f64>],
    ) -> Result<(), Error> {
        let sizes = self.states.iter_mut().zip(&self.first_states);
        for ((value, range), (scale, first)) in unknown.iter().zip(&mut self.visited).zip(sizes) {
            *range = [range[0].min(*value), range[1].max(*value)];
            *scale = grown(*first, *range, *value);
        }
        let spectrum = self.spectrum(unknown)?;
        let largest = spectrum.eigenvalues.iter().map(|value| value.norm()).fold(0.0, f64::max);
        self.system.problem.renormalize(unknown, vectors, &self.states, largest);
        self.system.scales = self.system.problem.sizes(&self.states, self.ranges);
        Ok(())
    }
}
