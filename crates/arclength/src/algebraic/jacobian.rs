//! Jacobians by forward differentiation in chunks of four or eight directions.

use super::AlgebraicProblem;
use crate::differentiation::Dual;

/// Memory for one chunk width.
#[derive(Clone, Debug, Default)]
struct Chunk<const N: usize> {
    unknown: Vec<Dual<f64, N>>,
    residual: Vec<Dual<f64, N>>,
    scratch: Vec<Dual<f64, N>>,
}

impl<const N: usize> Chunk<N> {
    fn jacobian<P: AlgebraicProblem>(
        &mut self,
        problem: &P,
        unknown: &[f64],
        residual: &mut [f64],
        matrix: &mut [f64],
        rows: usize,
    ) {
        let equations = problem.equations();
        self.unknown.clear();
        self.unknown.extend(unknown.iter().map(|&value| Dual::constant(value)));
        self.residual.clear();
        self.residual.resize(equations, Dual::constant(0.0));
        for first in (0..unknown.len()).step_by(N) {
            let width = N.min(unknown.len() - first);
            for direction in 0..width {
                self.unknown[first + direction] = Dual::variable(unknown[first + direction], direction);
            }
            problem.evaluate(&self.unknown, &mut self.residual, &mut self.scratch);
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
    }
}

/// Computes Jacobians and keeps the memory for them.
#[derive(Clone, Debug, Default)]
pub(crate) struct Differentiator {
    narrow: Chunk<4>,
    wide: Chunk<8>,
}

impl Differentiator {
    /// Writes `F(unknown)` into `residual` and its Jacobian, column-major with `rows` rows (at least the
    /// number of equations; the others are left alone), into `matrix`.
    pub fn jacobian<P: AlgebraicProblem>(
        &mut self,
        problem: &P,
        unknown: &[f64],
        residual: &mut [f64],
        matrix: &mut [f64],
        rows: usize,
    ) {
        if P::WIDE && unknown.len() > 4 {
            self.wide.jacobian(problem, unknown, residual, matrix, rows);
        } else {
            self.narrow.jacobian(problem, unknown, residual, matrix, rows);
        }
    }
}
