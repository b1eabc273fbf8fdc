//! The singular value decomposition of a tall matrix with few columns, by one-sided Jacobi rotations.
//!
//! The method is slow for many columns and simple; it finds small singular values to high relative accuracy where the columns
//! are well scaled (Demmel and Veselic, SIAM J. Matrix Anal. Appl. 13, 1992).

/// Cosine of the angle between two columns from which on they are orthogonal.
const ORTHOGONAL: f64 = 1e-15;
/// Most sweeps over all pairs of columns; convergence is quadratic.
const MOST_SWEEPS: usize = 60;

/// `A = U diag(s) V^T`.
#[derive(Clone, Debug)]
pub(super) struct SingularValues {
    /// Columns of `U diag(s)`.
    pub scaled_left: Vec<Vec<f64>>,
    /// Singular values, in no order.
    pub values: Vec<f64>,
    /// Columns of `V`.
    pub right: Vec<Vec<f64>>,
}

impl SingularValues {
    /// The decomposition of a matrix given by its columns.
    pub(super) fn of(mut columns: Vec<Vec<f64>>) -> Self {
        let n = columns.len();
        let mut right: Vec<Vec<f64>> =
            (0..n).map(|i| (0..n).map(|j| f64::from(u8::from(i == j))).collect()).collect();
        for _ in 0..MOST_SWEEPS {
            let mut rotated = false;
            for first in 0..n {
                for second in first + 1..n {
                    rotated |= orthogonalise(&mut columns, &mut right, first, second);
                }
            }
            if !rotated {
                break;
            }
        }
        let values = columns.iter().map(|column| dot(column, column).sqrt()).collect();
        Self { scaled_left: columns, values, right }
    }

    /// The largest singular value.
    pub(super) fn largest(&self) -> f64 {
        self.values.iter().fold(0.0, |largest, value| largest.max(*value))
    }
}

/// Rotates two columns so that they are orthogonal; false where they were.
fn orthogonalise(columns: &mut [Vec<f64>], right: &mut [Vec<f64>], first: usize, second: usize) -> bool {
    let (one, other) = (&columns[first], &columns[second]);
    let (alpha, beta, gamma) = (dot(one, one), dot(other, other), dot(one, other));
    if gamma == 0.0 || gamma.abs() <= ORTHOGONAL * (alpha * beta).sqrt() {
        return false;
    }
    let zeta = (beta - alpha) / (2.0 * gamma);
    let tangent = zeta.signum() / (zeta.abs() + zeta.hypot(1.0));
    let cosine = 1.0 / tangent.hypot(1.0);
    for matrix in [columns, right] {
        let (before, after) = matrix.split_at_mut(second);
        for (x, y) in before[first].iter_mut().zip(&mut after[0]) {
            (*x, *y) = (cosine * (*x - tangent * *y), cosine * (*y + tangent * *x));
        }
    }
    true
}

/// The inner product.
pub(super) fn dot(one: &[f64], other: &[f64]) -> f64 {
    one.iter().zip(other).map(|(x, y)| x * y).sum()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_hilbert_matrix_is_taken_apart() {
        // Singular values of the 5 x 5 Hilbert matrix (Higham, Accuracy and Stability, section 28.1; MATLAB svd(hilb(5))).
        let expected = [
            1.567_050_691_098_231,
            0.208_534_218_611_013,
            0.011_407_491_623_420,
            3.058_980_401_511_9e-4,
            3.287_928_772_171_6e-6,
        ];
        let hilbert: Vec<Vec<f64>> =
            (0..5).map(|i| (0..5).map(|j| 1.0 / f64::from(i + j + 1)).collect()).collect();
        let found = SingularValues::of(hilbert.clone());
        let mut values = found.values.clone();
        values.sort_by(|a, b| b.total_cmp(a));
        for (value, expected) in values.iter().zip(expected) {
            assert!((value / expected - 1.0).abs() < 1e-9, "{value} {expected}");
        }
        for (index, row) in hilbert.iter().enumerate() {
            // A V = U diag(s), and A is symmetric.
            for (right, left) in found.right.iter().zip(&found.scaled_left) {
                assert!((dot(row, right) - left[index]).abs() < 1e-14);
            }
        }
    }

    #[test]
    fn dependent_columns_have_a_vanishing_singular_value() {
        let found = SingularValues::of(vec![vec![1.0, 2.0, 3.0], vec![2.0, 4.0, 6.0], vec![0.0, 1.0, 0.0]]);
        let smallest = found.values.iter().copied().fold(f64::INFINITY, f64::min);
        assert!(smallest < 1e-14 * found.largest());
    }
}
