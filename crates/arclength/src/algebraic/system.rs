//! The linear algebra that a curve of solutions of an algebraic problem asks for.

use super::{AlgebraicEquations, Differentiator, ScaledLu};
use crate::continuation::{Equations, Solution};
use crate::error::Error;

/// A problem with one unknown more than equations, the scales of its unknowns, and memory.
#[derive(Clone, Debug)]
pub struct DenseSystem<P> {
    /// The problem.
    pub problem: P,
    /// Sizes of the unknowns: the metric is Euclidean after division by them.
    pub scales: Vec<f64>,
    /// The Jacobian at the last factorisation, bordered below, column-major.
    pub matrix: Vec<f64>,
    /// The sizes at the start.
    first_scales: Vec<f64>,
    /// Smallest and largest value of every unknown so far.
    visited: Vec<[f64; 2]>,
    lu: ScaledLu,
    differentiator: Differentiator,
}

impl<P: AlgebraicEquations> DenseSystem<P> {
    /// The system of `problem` with the sizes of its unknowns.
    pub fn new(problem: P, scales: Vec<f64>) -> Self {
        let n = problem.unknowns();
        Self {
            problem,
            first_scales: scales.clone(),
            scales,
            matrix: vec![0.0; n * n],
            visited: vec![[f64::INFINITY, f64::NEG_INFINITY]; n],
            lu: ScaledLu::default(),
            differentiator: Differentiator::default(),
        }
    }

    /// Evaluates the Jacobian without factorising it; the border is left as it was.
    pub fn linearize(&mut self, unknown: &[f64], residual: &mut [f64]) {
        let n = unknown.len();
        self.differentiator.jacobian(&self.problem, unknown, residual, &mut self.matrix, n);
    }

    /// Modulus of the determinant of the last factorised matrix after scaling of rows and columns.
    pub fn determinant_size(&self) -> f64 {
        self.lu.determinant_size()
    }

    /// As [`Curve::apply_metric`](crate::continuation::Curve::apply_metric).
    pub fn apply_metric(&self, vector: &[f64], image: &mut [f64]) {
        for ((image, entry), scale) in image.iter_mut().zip(vector).zip(&self.scales) {
            *image = entry / (scale * scale);
        }
    }

    /// The scales of the first `count` unknowns grow to the ranges that the curve has covered. Beyond a hundredfold of the first they are no larger
    /// than the unknown itself, so that a curve that comes back from far away is not followed with the steps and tolerances of there.
    pub fn grow_scales(&mut self, unknown: &[f64], count: usize) {
        let sizes = self.scales.iter_mut().zip(&self.first_scales);
        for ((value, range), (scale, first)) in unknown.iter().zip(&mut self.visited).zip(sizes).take(count) {
            *range = [range[0].min(*value), range[1].max(*value)];
            *scale = grown(*first, *range, *value);
        }
    }

    /// Forgets how far the curve has gone: the next direction starts with the sizes of the start.
    pub fn restart(&mut self) {
        self.scales.copy_from_slice(&self.first_scales);
        self.visited.fill([f64::INFINITY, f64::NEG_INFINITY]);
    }

    /// A tangent at `unknown`, a unit vector in the metric with either sign.
    ///
    /// # Errors
    /// When the Jacobian does not have full rank.
    pub fn tangent(&mut self, unknown: &[f64]) -> Result<Vec<f64>, Error> {
        let n = unknown.len();
        let mut residual = vec![0.0; n];
        // Without symmetry, so that it is orthogonal to the tangent by bad luck only.
        let mut tangent: Vec<f64> =
            (0..n).map(|index| (0.5 + (0.618 * index as f64).fract()) * self.scales[index]).collect();
        let mut border = vec![0.0; n];
        for _ in 0..3 {
            self.apply_metric(&tangent, &mut border);
            if self.factorize(unknown, &border, &mut residual) == 0.0 {
                return Err(singular());
            }
            tangent.fill(0.0);
            tangent[n - 1] = 1.0;
            self.solve(&mut tangent);
            let length = length(&tangent, &self.scales);
            if !(length.is_finite() && length > 0.0) {
                return Err(singular());
            }
            tangent.iter_mut().for_each(|entry| *entry /= length);
        }
        Ok(tangent)
    }
}

/// Growth of a scale over that at the start up to which the range that was covered counts alone.
const LARGEST_GROWTH: f64 = 100.0;

/// The scale of an unknown: that at the start, or the range covered.
pub(crate) fn grown(first: f64, range: [f64; 2], value: f64) -> f64 {
    let covered = range[1] - range[0];
    first.max(covered.min(value.abs().max(LARGEST_GROWTH * first)))
}

impl<P: AlgebraicEquations> Equations for DenseSystem<P> {
    fn unknowns(&self) -> usize {
        self.problem.unknowns()
    }

    fn residual(&mut self, unknown: &[f64], residual: &mut [f64]) {
        let equations = self.problem.equations();
        self.problem.evaluate(unknown, &mut residual[..equations]);
    }

    fn factorize(&mut self, unknown: &[f64], border: &[f64], residual: &mut [f64]) -> f64 {
        let n = unknown.len();
        self.differentiator.jacobian(&self.problem, unknown, residual, &mut self.matrix, n);
        for (column, &entry) in border.iter().enumerate() {
            self.matrix[n - 1 + n * column] = entry;
        }
        self.lu.factorize(n, &self.matrix, &self.scales)
    }

    fn solve(&mut self, vector: &mut [f64]) {
        self.lu.solve(vector);
    }
}

fn singular() -> Error {
    Error::NotFound { sought: "tangent", cause: crate::error::CorrectionFailure::Singular }
}

/// Euclidean length after division by the scales.
pub(crate) fn length(vector: &[f64], scales: &[f64]) -> f64 {
    vector.iter().zip(scales).map(|(entry, scale)| (entry / scale).powi(2)).sum::<f64>().sqrt()
}

/// Position of `unknown` along the tangent at `origin`, in the metric.
pub(crate) fn position<P>(origin: &Solution<P>, unknown: &[f64], scales: &[f64]) -> f64 {
    let coordinates = origin.tangent.iter().zip(scales).zip(unknown.iter().zip(&origin.unknown));
    coordinates.map(|((tangent, scale), (there, here))| tangent / scale * ((there - here) / scale)).sum()
}
