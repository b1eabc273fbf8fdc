//! The equilibrium beside which a cycle spends the time that makes its period grow without bound.
//!
//! A growing period alone says nothing: on the explosion of a canard it grows by factors while the parameter stands still to ten
//! digits, and no equilibrium of the right kind is near. Where the cycle is slowest, either a saddle is found by Newton's method,
//! to which homoclinic and heteroclinic orbits lead, or a fold of equilibria that is about to be born on the cycle (Kuznetsov,
//! *Elements of Applied Bifurcation Theory*, 3rd edition, 2004, sections 6.2 and 7.1).
//!
//! And the opposite: a cycle too fast for a field without jumps.

use crate::algebraic::{Differentiator, solve_square};
use crate::equilibrium::defining::FoldSystem;
use crate::equilibrium::newton::find_erased;
use crate::equilibrium::problem::EquilibriumProblem;
use crate::erased::ErasedField;
use crate::linear::eigenvalues::eigenvalues;
use crate::linear::eigenvectors::right_eigenvector;
use num_complex::Complex64;
use serde::{Deserialize, Serialize};
use std::f64::consts::TAU;

/// The equilibrium is this near to the slowest point of the cycle, in sizes of the states.
const NEAR: f64 = 0.1;
/// A fold of equilibria is this near, in parts of the parameter's range.
const NEAR_PARAMETER: f64 = 1e-2;
/// Part of the largest modulus of an eigenvalue below which a real part has no sign.
const UNDECIDED: f64 = 1e-10;

/// An equilibrium beside which a cycle is slow.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
#[non_exhaustive]
pub enum SlowPassage {
    /// A saddle, with stable and unstable directions: a homoclinic or heteroclinic orbit is near.
    Saddle {
        /// The equilibrium.
        state: Vec<f64>,
    },
    /// A saddle-node that is born on the cycle.
    SaddleNode {
        /// The equilibrium.
        state: Vec<f64>,
        /// Value of the parameter at which it is born.
        parameter: f64,
    },
    /// An equilibrium that lies on the condition of an event, or on a border between two pieces of the field, to which the cycle
    /// comes ever more slowly.
    AtGate {
        /// The equilibrium.
        state: Vec<f64>,
        /// The number of the event, counted from one; none at a border.
        event: Option<usize>,
    },
}

/// A cycle as it is looked at here.
pub(crate) struct Passing<'a> {
    pub field: ErasedField<'a>,
    pub parameters: &'a [f64],
    /// Index of the parameter that varies, and the length of its range.
    pub active: (usize, f64),
    /// States on the nodes.
    pub states: &'a [f64],
    /// Sizes of the states.
    pub scales: &'a [f64],
}

impl Passing<'_> {
    /// The equilibrium beside which the cycle is slowest, if it is one that makes periods grow without bound.
    pub(crate) fn slow_passage(&self) -> Option<SlowPassage> {
        let slowest = self.slowest()?;
        self.saddle(slowest).or_else(|| self.saddle_node(slowest))
    }

    /// Whether the period is shorter than that of any cycle of a field that changes no faster than this one does between its jumps: `2 pi`
    /// over its Lipschitz constant (J. A. Yorke, Periods of periodic solutions and the Lipschitz constant, 1969).
    pub(crate) fn is_too_fast(&self, period: f64) -> bool {
        let n = self.scales.len();
        let rate = |state: &[f64]| {
            let matrix = self.jacobian(state);
            let entry = |(place, value): (usize, &f64)| {
                (value * self.scales[place / n] / self.scales[place % n]).powi(2)
            };
            matrix.iter().enumerate().map(entry).sum::<f64>().sqrt()
        };
        let fastest = self.states.chunks_exact(n).map(rate).fold(0.0, f64::max);
        period * fastest < TAU
    }

    /// The state in which the cycle is slowest.
    fn slowest(&self) -> Option<&[f64]> {
        let n = self.scales.len();
        let mut slope = vec![0.0; n];
        let speed = |state: &[f64]| {
            self.field.evaluate(state, self.parameters, &mut slope);
            slope.iter().zip(self.scales).map(|(value, scale)| (value / scale).powi(2)).sum::<f64>()
        };
        let mut speed = speed;
        let speeds: Vec<f64> = self.states.chunks_exact(n).map(&mut speed).collect();
        let place = (0..speeds.len()).min_by(|&one, &other| speeds[one].total_cmp(&speeds[other]))?;
        self.states.chunks_exact(n).nth(place)
    }

    fn is_near(&self, state: &[f64], slowest: &[f64]) -> bool {
        state
            .iter()
            .zip(slowest)
            .zip(self.scales)
            .all(|((one, other), scale)| (one - other).abs() <= NEAR * scale)
    }

    fn problem(&self) -> EquilibriumProblem<'_> {
        EquilibriumProblem::new(self.field, self.parameters, &[self.active.0])
    }

    /// The Jacobian with respect to the state.
    fn jacobian(&self, state: &[f64]) -> Vec<f64> {
        let n = state.len();
        let unknown = [state, &[self.parameters[self.active.0]]].concat();
        let (mut residual, mut matrix) = (vec![0.0; n], vec![0.0; n * (n + 1)]);
        Differentiator::default().jacobian(&self.problem(), &unknown, &mut residual, &mut matrix, n);
        matrix.truncate(n * n);
        matrix
    }

    fn saddle(&self, slowest: &[f64]) -> Option<SlowPassage> {
        let state = find_erased(self.field, slowest, self.parameters).ok()?;
        if !self.is_near(&state, slowest) {
            return None;
        }
        let eigenvalues = eigenvalues(&self.jacobian(&state), state.len()).ok()?;
        let noise = UNDECIDED * eigenvalues.iter().map(|value| value.norm()).fold(0.0, f64::max);
        let has = |sign: f64| eigenvalues.iter().any(|value| sign * value.re > noise);
        (has(1.0) && has(-1.0)).then_some(SlowPassage::Saddle { state })
    }

    fn saddle_node(&self, slowest: &[f64]) -> Option<SlowPassage> {
        let n = slowest.len();
        let matrix = self.jacobian(slowest);
        let smallest = eigenvalues(&matrix, n)
            .ok()?
            .into_iter()
            .filter(|value| value.im == 0.0)
            .min_by(|one, other| one.norm().total_cmp(&other.norm()))?;
        let vector: Vec<f64> = right_eigenvector(&matrix, n, Complex64::from(smallest.re))
            .ok()?
            .vector
            .iter()
            .map(|entry| entry.re)
            .collect();
        let scaled = vector.iter().zip(self.scales).map(|(entry, scale)| (entry / scale).powi(2));
        let size = scaled.sum::<f64>().sqrt();
        let vector: Vec<f64> = vector.iter().map(|entry| entry / size).collect();
        let normal = vector.iter().zip(self.scales).map(|(entry, scale)| entry / (scale * scale)).collect();
        let system = FoldSystem { equilibria: self.problem(), normal, left: Vec::new() };
        let (active, range) = self.active;
        let here = self.parameters[active];
        let start = [slowest, &vector, &[here]].concat();
        let sizes = [self.scales, self.scales, &[range]].concat();
        let solved = solve_square(&system, &start, &sizes).ok()?;
        let (state, parameter) = (solved.unknown[..n].to_vec(), solved.unknown[2 * n]);
        let is_near = self.is_near(&state, slowest) && (parameter - here).abs() <= NEAR_PARAMETER * range;
        is_near.then_some(SlowPassage::SaddleNode { state, parameter })
    }
}
