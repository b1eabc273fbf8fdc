//! LU factorisation of a matrix whose rows and columns are scaled first.
//!
//! Columns are multiplied by the scales of the unknowns, then rows are divided by their largest entry:
//! pivoting, singularity and rounding do not depend on units (van der Sluis, *Numer. Math.* 14, 1969).

use crate::linear::lu;

/// The factors of a square matrix and the scales of its rows and columns.
#[derive(Clone, Debug, Default)]
pub(crate) struct ScaledLu {
    n: usize,
    factors: Vec<f64>,
    pivots: Vec<usize>,
    rows: Vec<f64>,
    columns: Vec<f64>,
}

impl ScaledLu {
    /// Factorises the column-major `n`-by-`n` `matrix`; `columns` are positive.
    ///
    /// Returns the sign of the determinant, zero if the matrix is singular or not finite.
    pub(crate) fn factorize(&mut self, n: usize, matrix: &[f64], columns: &[f64]) -> f64 {
        self.n = n;
        self.factors.clear();
        self.factors.extend_from_slice(matrix);
        self.pivots.resize(n, 0);
        self.columns.clear();
        self.columns.extend_from_slice(columns);
        self.rows.clear();
        self.rows.resize(n, 0.0);
        for (column, &scale) in self.factors.chunks_exact_mut(n).zip(columns) {
            for (entry, largest) in column.iter_mut().zip(&mut self.rows) {
                *entry *= scale;
                *largest = largest.max(entry.abs());
            }
        }
        for largest in &mut self.rows {
            *largest = if *largest > 0.0 && largest.is_finite() { largest.recip() } else { 1.0 };
        }
        for column in self.factors.chunks_exact_mut(n) {
            for (entry, factor) in column.iter_mut().zip(&self.rows) {
                *entry *= factor;
            }
        }
        lu::factorize(&mut self.factors, n, &mut self.pivots)
    }

    /// Solves with the matrix, in place.
    pub(crate) fn solve(&self, vector: &mut [f64]) {
        for (entry, factor) in vector.iter_mut().zip(&self.rows) {
            *entry *= factor;
        }
        lu::solve(&self.factors, self.n, &self.pivots, vector);
        for (entry, scale) in vector.iter_mut().zip(&self.columns) {
            *entry *= scale;
        }
    }

    /// Modulus of the determinant of the scaled matrix.
    pub(crate) fn determinant_size(&self) -> f64 {
        (0..self.n).map(|index| self.factors[index * (self.n + 1)].abs()).product()
    }
}
