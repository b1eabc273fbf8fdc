//! The curve of equilibria of one parameter: metric, stability and test functions along the way.

use super::branch_point::BranchPoint;
use super::events;
use super::problem::EquilibriumProblem;
use super::special::SpecialPoint;
use super::spectrum::Spectrum;
use crate::algebraic::DenseSystem;
use crate::continuation::{Adaptation, Bound, Curve, Ending, Settings, Solution, Stop};
use crate::error::Error;
use crate::linear::eigenvalues::EigenvalueWorkspace;

/// Test functions of an equilibrium; each changes sign at one kind of special point.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Tests {
    /// Rate of change of the parameter along the curve, as part of the whole: zero at a fold.
    pub fold: f64,
    /// Determinant of the scaled Jacobian bordered by the tangent: zero at a branch point.
    pub branch_point: f64,
    /// See [`Spectrum::hopf_test`].
    pub hopf: f64,
}

/// What is known about an equilibrium on a curve.
#[derive(Clone, Debug)]
pub(crate) struct Inspection {
    pub spectrum: Spectrum,
    pub tests: Tests,
    /// Derivative of the Hopf test along the curve.
    pub hopf_slope: f64,
    pub special: Option<Box<SpecialPoint>>,
}

/// The same solution for travel in the opposite direction.
pub(super) fn reversed(mut solution: Solution<Inspection>) -> Solution<Inspection> {
    solution.tangent.iter_mut().for_each(|entry| *entry = -*entry);
    solution.orientation = -solution.orientation;
    let Inspection { tests, hopf_slope, .. } = &mut solution.point;
    tests.fold = -tests.fold;
    tests.branch_point = -tests.branch_point;
    *hopf_slope = -*hopf_slope;
    solution
}

/// Displacement along the tangent for the derivative of the Hopf test. Small enough that curvature does not matter,
/// large enough that rounding does not.
const DISPLACEMENT: f64 = 1e-7;

/// Rate of change of the parameter, as part of the whole, and growth of a state since the start that together mean that the
/// state grows without bound.
const VERTICAL: f64 = 1e-9;
const UNBOUNDED_GROWTH: f64 = 1e6;
/// Part of its range by which the parameter has to change in [`MOST_IDLE_STEPS`] steps.
const IDLE: f64 = 1e-13;
const MOST_IDLE_STEPS: usize = 20;

/// The curve of equilibria in the space of the states and one parameter.
pub(crate) struct EquilibriumCurve<'a> {
    pub system: DenseSystem<EquilibriumProblem<'a>>,
    pub settings: Settings,
    bound: Bound,
    idle_steps: usize,
    first_scales: Vec<f64>,
    workspace: EigenvalueWorkspace,
    scratch: Vec<f64>,
    /// Solution close to the start, from which on the direction followed was searched for special points.
    pub first_beyond: Option<Solution<Inspection>>,
}

impl<'a> EquilibriumCurve<'a> {
    /// `scales` are the sizes of the states and the length of the parameter's range.
    pub fn new(problem: EquilibriumProblem<'a>, scales: Vec<f64>, bound: Bound, settings: Settings) -> Self {
        let workspace = EigenvalueWorkspace::new(problem.dimension);
        Self {
            system: DenseSystem::new(problem, scales.clone()),
            settings,
            bound,
            idle_steps: 0,
            first_scales: scales,
            workspace,
            scratch: Vec::new(),
            first_beyond: None,
        }
    }

    /// Forgets the direction followed before.
    pub fn restart(&mut self) {
        self.idle_steps = 0;
        self.first_beyond = None;
    }

    pub fn dimension(&self) -> usize {
        self.system.problem.dimension
    }

    /// The Jacobian with respect to the state, column-major.
    pub fn jacobian(&mut self, unknown: &[f64]) -> Vec<f64> {
        let n = self.dimension();
        let mut residual = vec![0.0; n + 1];
        self.system.linearize(unknown, &mut residual);
        (0..n).flat_map(|column| self.system.matrix[(n + 1) * column..][..n].iter().copied()).collect()
    }

    /// A branch point as a solution of the curve: the bordered Jacobian is singular there, the tangent that of the normal
    /// form.
    pub fn at_branch_point(
        &mut self,
        unknown: Vec<f64>,
        point: BranchPoint,
    ) -> Result<Solution<Inspection>, Error> {
        let matrix = self.jacobian(&unknown);
        let spectrum = Spectrum::of(&matrix, &mut self.workspace)?;
        let tangent = point.tangents[0].clone();
        let n = self.dimension();
        let fold = tangent[n] / self.system.scales[n];
        let tests = Tests { fold, branch_point: 0.0, hopf: spectrum.hopf_test };
        let special = Some(Box::new(SpecialPoint::BranchPoint(point)));
        let point = Inspection { spectrum, tests, hopf_slope: 0.0, special };
        Ok(Solution { unknown, tangent, orientation: 0.0, point })
    }

    /// Eigenvalues and so on of the last factorised Jacobian.
    fn spectrum(&mut self) -> Result<Spectrum, Error> {
        let n = self.dimension();
        self.scratch.clear();
        for column in 0..n {
            self.scratch.extend_from_slice(&self.system.matrix[(n + 1) * column..][..n]);
        }
        Spectrum::of(&self.scratch, &mut self.workspace)
    }
}

impl Curve for EquilibriumCurve<'_> {
    type Point = Inspection;

    fn unknowns(&self) -> usize {
        self.dimension() + 1
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

    fn adapt(&mut self, unknown: &mut Vec<f64>, _vectors: &mut [&mut Vec<f64>]) -> Result<Adaptation, Error> {
        let n = self.dimension();
        self.system.grow_scales(unknown, n);
        Ok(Adaptation::Unchanged)
    }

    fn inspect(&mut self, unknown: &[f64], tangent: &[f64], orientation: f64) -> Result<Inspection, Error> {
        let n = self.dimension();
        let determinant = orientation * self.system.determinant_size();
        let spectrum = self.spectrum()?;
        let fold = tangent[n] / self.system.scales[n];
        let mut hopf_slope = 0.0;
        if n > 1 {
            let nearby: Vec<f64> =
                unknown.iter().zip(tangent).map(|(value, slope)| value + DISPLACEMENT * slope).collect();
            let mut residual = vec![0.0; n + 1];
            self.system.linearize(&nearby, &mut residual);
            if let Ok(there) = self.spectrum() {
                hopf_slope = (there.hopf_test - spectrum.hopf_test) / DISPLACEMENT;
            }
        }
        let tests = Tests { fold, branch_point: determinant, hopf: spectrum.hopf_test };
        Ok(Inspection { spectrum, tests, hopf_slope, special: None })
    }

    fn special_points(
        &mut self,
        before: &Solution<Inspection>,
        after: &Solution<Inspection>,
    ) -> Result<Vec<Solution<Inspection>>, Error> {
        events::special_points(self, before, after)
    }

    fn ending(&mut self, before: &Solution<Inspection>, after: &Solution<Inspection>) -> Option<Ending> {
        let n = self.dimension();
        let range = self.system.scales[n];
        let parameter = after.unknown[n];
        if (parameter - before.unknown[n]).abs() > IDLE * range {
            self.idle_steps = 0;
        } else {
            self.idle_steps += 1;
        }
        let grown = self
            .system
            .scales
            .iter()
            .zip(&self.first_scales)
            .any(|(now, first)| *now > UNBOUNDED_GROWTH * first);
        let vertical = after.point.tests.fold.abs() < VERTICAL;
        if self.idle_steps > MOST_IDLE_STEPS || (vertical && grown) {
            return Some(Ending::After(Stop::StateUnbounded { parameter }));
        }
        // The parameter creeps up to the end of its range and never reaches it.
        let end = [self.bound.lower, self.bound.upper]
            .into_iter()
            .find(|end| (parameter - end).abs() < IDLE * range);
        match end {
            Some(value) if vertical => Some(Ending::After(Stop::RangeEnd { bound: 0, value })),
            _ => None,
        }
    }

    fn signature(&self, unknown: &[f64]) -> Vec<(f64, f64)> {
        let states = unknown.iter().copied().zip(self.system.scales.iter().copied());
        states.take(self.dimension()).collect()
    }
}
