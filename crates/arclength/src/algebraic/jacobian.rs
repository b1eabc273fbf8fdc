//! Jacobians by forward differentiation in chunks of four or eight directions.

use super::AlgebraicEquations;
use crate::differentiation::Dual;

/// Memory for one chunk width.
#[derive(Clone, Debug, Default)]
struct Chunk<const N: usize> {
    unknown: Vec<Dual<f64, N>>,
    residual: Vec<Dual<f64, N>>,
}

impl<const N: usize> Chunk<N> {
    /// The Jacobian by `evaluate`; whether it serves this scalar.
    fn jacobian(
        &mut self,
        evaluate: impl Fn(&[Dual<f64, N>], &mut [Dual<f64, N>]) -> bool,
        equations: usize,
        unknown: &[f64],
        residual: &mut [f64],
        matrix: &mut [f64],
        rows: usize,
    ) -> bool {
        self.unknown.clear();
        self.unknown.extend(unknown.iter().map(|&value| Dual::constant(value)));
        self.residual.clear();
        self.residual.resize(equations, Dual::constant(0.0));
        for first in (0..unknown.len()).step_by(N) {
            let width = N.min(unknown.len() - first);
            for direction in 0..width {
                self.unknown[first + direction] = Dual::variable(unknown[first + direction], direction);
            }
            if !evaluate(&self.unknown, &mut self.residual) {
                return false;
            }
            for direction in 0..width {
                let column = &mut matrix[(first + direction) * rows..][..equations];
                for (entry, value) in column.iter_mut().zip(&self.residual) {
                    *entry = value.derivatives[direction];
                }
                self.unknown[first + direction] = Dual::constant(unknown[first + direction]);
            }
        }
        for (entry, value) in residual.iter_mut().zip(&self.residual) {
            *entry = value.value;
        }
        true
    }
}

/// Computes Jacobians and keeps the memory for them.
#[derive(Clone, Debug, Default)]
pub struct Differentiator {
    narrow: Chunk<4>,
    wide: Chunk<8>,
}

impl Differentiator {
    /// Writes `F(unknown)` into `residual` and its Jacobian, column-major with `rows` rows (at least the
    /// number of equations; the others are left alone), into `matrix`.
    pub fn jacobian<P: AlgebraicEquations>(
        &mut self,
        problem: &P,
        unknown: &[f64],
        residual: &mut [f64],
        matrix: &mut [f64],
        rows: usize,
    ) {
        let equations = problem.equations();
        let wide =
            |unknown: &[Dual<f64, 8>], values: &mut [Dual<f64, 8>]| problem.evaluate_wide(unknown, values);
        if unknown.len() > 4 && self.wide.jacobian(wide, equations, unknown, residual, matrix, rows) {
            return;
        }
        let narrow = |unknown: &[Dual<f64, 4>], values: &mut [Dual<f64, 4>]| {
            problem.evaluate(unknown, values);
            true
        };
        self.narrow.jacobian(narrow, equations, unknown, residual, matrix, rows);
    }
}
