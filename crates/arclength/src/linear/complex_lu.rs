//! LU factorisation of complex matrices: those of implicit steps, and those that are singular on purpose, as inverse iteration needs it.
//!
//! Inverse iteration solves with `A - lambda I` where `lambda` is an eigenvalue: a vanishing pivot is
//! expected and is replaced by one of the size of the rounding errors (Wilkinson 1965, chapter 9), so that
//! the solution grows along the eigenvector and stays finite.

use num_complex::Complex64;

/// `P A = L U` with partial pivoting, column-major in place of `A`.
#[derive(Clone, Debug)]
pub(crate) struct ComplexLu {
    n: usize,
    factors: Vec<Complex64>,
    pivots: Vec<usize>,
}

fn size(z: Complex64) -> f64 {
    z.re.abs() + z.im.abs()
}

impl ComplexLu {
    /// Factorises `matrix`; pivots smaller than `smallest_pivot`, which must be positive, are replaced by it.
    pub(crate) fn of(n: usize, mut matrix: Vec<Complex64>, smallest_pivot: f64) -> Self {
        let mut pivots = vec![0; n];
        for k in 0..n {
            let mut pivot = k;
            for row in k + 1..n {
                if size(matrix[row + n * k]) > size(matrix[pivot + n * k]) {
                    pivot = row;
                }
            }
            pivots[k] = pivot;
            if pivot != k {
                (0..n).for_each(|column| matrix.swap(k + n * column, pivot + n * column));
            }
            if size(matrix[k + n * k]) < smallest_pivot {
                matrix[k + n * k] = smallest_pivot.into();
            }
            let (left, right) = matrix.split_at_mut(n * (k + 1));
            let column = &mut left[n * k..];
            let diagonal = column[k];
            column[k + 1..].iter_mut().for_each(|x| *x /= diagonal);
            for other in right.chunks_exact_mut(n) {
                let factor = other[k];
                if factor != Complex64::ZERO {
                    for (x, l) in other[k + 1..].iter_mut().zip(&column[k + 1..]) {
                        *x -= factor * l;
                    }
                }
            }
        }
        ComplexLu { n, factors: matrix, pivots }
    }

    /// Solves `A x = b` in place of `b`.
    pub(crate) fn solve(&self, vector: &mut [Complex64]) {
        let n = self.n;
        for (k, pivot) in self.pivots.iter().enumerate() {
            vector.swap(k, *pivot);
        }
        let columns = self.factors.chunks_exact(n.max(1));
        for (k, column) in columns.clone().enumerate() {
            let value = vector[k];
            vector[k + 1..].iter_mut().zip(&column[k + 1..]).for_each(|(x, l)| *x -= l * value);
        }
        for (k, column) in columns.enumerate().rev() {
            vector[k] /= column[k];
            let value = vector[k];
            vector[..k].iter_mut().zip(column).for_each(|(x, u)| *x -= u * value);
        }
    }
}
