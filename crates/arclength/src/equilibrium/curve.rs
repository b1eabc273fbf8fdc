//! The curve of equilibria of one parameter: metric, stability and test functions along the way.

use super::branch_point::BranchPoint;
use super::problem::EquilibriumProblem;
use super::special::SpecialPoint;
use super::spectrum::Spectrum;
use crate::algebraic::DenseSystem;
use crate::continuation::{Bound, Settings, Solution};
use crate::error::Error;
use crate::linear::eigenvalues::EigenvalueWorkspace;
use crate::pieces::Pieces;
use num_complex::Complex64;

/// What is known about an equilibrium on a curve.
#[derive(Clone, Debug)]
pub(crate) struct EquilibriumInspection {
    pub spectrum: Spectrum,
    /// Rates of change of the eigenvalues in the direction of travel in which the orientation was this.
    pub rates: Vec<Complex64>,
    pub orientation: f64,
    /// Modulus of the determinant of the scaled Jacobian bordered by the tangent: zero at a branch point.
    pub determinant: f64,
    /// The cells of the piece in which it was computed; none where the field was taken as it is.
    pub cells: Vec<f64>,
    pub special: Option<Box<SpecialPoint>>,
}

/// The curve of equilibria in the space of the states and one parameter.
pub(crate) struct EquilibriumCurve<'a> {
    pub system: DenseSystem<EquilibriumProblem<'a>>,
    pub settings: Settings,
    pub(super) bound: Bound,
    /// Length of the way on which the parameter has stood still.
    pub(super) idle_way: f64,
    /// Whether it has moved since the start.
    pub(super) has_moved: bool,
    /// The pieces of a field that is smooth piece by piece.
    pub(super) pieces: Option<Pieces<'a>>,
    /// The piece that was given up, until the curve has left it.
    pub(super) given_up: Vec<f64>,
    pub(super) first_scales: Vec<f64>,
    pub(super) workspace: EigenvalueWorkspace,
    pub(super) scratch: Vec<f64>,
}

impl<'a> EquilibriumCurve<'a> {
    /// `scales` are the sizes of the states and the length of the parameter's range.
    pub(super) fn new(
        problem: EquilibriumProblem<'a>,
        scales: Vec<f64>,
        bound: Bound,
        settings: Settings,
    ) -> Self {
        let workspace = EigenvalueWorkspace::new(problem.dimension);
        let pieces = Pieces::of_erased(problem.field);
        Self {
            system: DenseSystem::new(problem, scales.clone()),
            settings,
            bound,
            idle_way: 0.0,
            has_moved: false,
            pieces,
            given_up: Vec::new(),
            first_scales: scales,
            workspace,
            scratch: Vec::new(),
        }
    }

    /// Forgets the direction followed before.
    pub(super) fn restart(&mut self) {
        self.idle_way = 0.0;
        self.has_moved = false;
        self.given_up.clear();
        self.system.restart();
    }

    /// The value to which the parameter tends where its rate dies out along the curve: from the rates at two solutions.
    pub(super) fn limit(
        &self,
        before: &Solution<EquilibriumInspection>,
        after: &Solution<EquilibriumInspection>,
    ) -> f64 {
        let n = self.dimension();
        let parameter = after.unknown[n];
        let [one, other] = [before, after].map(|solution| solution.tangent[n]);
        let ratio = other / one;
        if !(ratio > 0.0 && ratio < 1.0) {
            return parameter;
        }
        // A geometric series of steps like the last one.
        let left = (parameter - before.unknown[n]) * ratio / (1.0 - ratio);
        (parameter + left).clamp(self.bound.lower, self.bound.upper)
    }

    pub(super) fn dimension(&self) -> usize {
        self.system.problem.dimension
    }

    /// The Jacobian with respect to the state, column-major.
    pub(super) fn jacobian(&mut self, unknown: &[f64]) -> Vec<f64> {
        let n = self.dimension();
        let mut residual = vec![0.0; n + 1];
        self.system.linearize(unknown, &mut residual);
        (0..n).flat_map(|column| self.system.matrix[(n + 1) * column..][..n].iter().copied()).collect()
    }

    /// A branch point as a solution of the curve: the bordered Jacobian is singular there, the tangent that of the normal
    /// form.
    pub(super) fn at_branch_point(
        &mut self,
        unknown: Vec<f64>,
        point: BranchPoint,
    ) -> Result<Solution<EquilibriumInspection>, Error> {
        let matrix = self.jacobian(&unknown);
        let spectrum = Spectrum::of(&matrix, &mut self.workspace)?;
        let tangent = point.tangents[0].clone();
        let special = Some(Box::new(SpecialPoint::BranchPoint(point)));
        let rates = vec![Complex64::ZERO; spectrum.eigenvalues.len()];
        let cells = self.system.problem.cells().to_vec();
        let point =
            EquilibriumInspection { spectrum, rates, orientation: 0.0, determinant: 0.0, cells, special };
        Ok(Solution { unknown, tangent, orientation: 0.0, point })
    }

    /// Rate of change of the parameter along the curve, as part of its range: zero at a fold.
    pub(super) fn turn(&self, tangent: &[f64]) -> f64 {
        Self::turn_of(tangent, self.system.scales[self.dimension()])
    }

    /// The same for a range of this length.
    pub(super) fn turn_of(tangent: &[f64], range: f64) -> f64 {
        tangent.last().map_or(0.0, |rate| rate / range)
    }

    /// Eigenvalues and so on of the last factorised Jacobian.
    pub(super) fn spectrum(&mut self) -> Result<Spectrum, Error> {
        let n = self.dimension();
        self.scratch.clear();
        for column in 0..n {
            self.scratch.extend_from_slice(&self.system.matrix[(n + 1) * column..][..n]);
        }
        Spectrum::of(&self.scratch, &mut self.workspace)
    }
}
