//! Balancing: similarity transformations by permutations and powers of two that make rows and columns alike
//! in norm.
//!
//! Units mix in the Jacobians of mechanical models, and an unbalanced eigenvalue solver then loses digits.
//! The permutations of Parlett and Reinsch (1969) isolate eigenvalues that stand on the diagonal of a block
//! triangular matrix; the scaling compares Euclidean norms that include the diagonal (James, Langou and
//! Lowery 2014), because the older choice can ruin a matrix with tiny off-diagonal noise.

/// A row is rescaled only if that lowers the sum of row and column norm to less than this part.
const WORTHWHILE: f64 = 0.95;
/// Scale factors stay within these bounds, so that no entry of a matrix of moderate size over- or underflows.
const SMALLEST_SCALE: f64 = 1e-120;
const LARGEST_SCALE: f64 = 1e120;
/// Sweeps after which scaling stops; two or three are usual, and stopping early costs accuracy only.
const MAXIMUM_SWEEPS: usize = 100;

/// Permutes the matrix so that the rows and columns outside `low..high` are upper triangular, and returns
/// `(low, high)`.
pub(super) fn isolate(matrix: &mut [f64], n: usize) -> (usize, usize) {
    let (mut low, mut high) = (0, n);
    // Rows without off-diagonal entries go to the bottom.
    while let Some(row) = (0..high)
        .rev()
        .find(|row| (0..high).all(|column| column == *row || matrix[row + n * column] == 0.0))
        .filter(|_| high > 1)
    {
        exchange(matrix, n, row, high - 1);
        high -= 1;
    }
    // Columns without off-diagonal entries go to the left.
    while let Some(column) = (low..high)
        .find(|column| (low..high).all(|row| row == *column || matrix[row + n * column] == 0.0))
        .filter(|_| low + 1 < high)
    {
        exchange(matrix, n, column, low);
        low += 1;
    }
    (low, high)
}

fn exchange(matrix: &mut [f64], n: usize, i: usize, j: usize) {
    if i == j {
        return;
    }
    for row in 0..n {
        matrix.swap(row + n * i, row + n * j);
    }
    for column in 0..n {
        matrix.swap(i + n * column, j + n * column);
    }
}

/// Replaces `A` by `D^-1 A D` within `low..high` and writes the diagonal of `D`, powers of two, to `scales`.
///
/// The largest entry of `A` should be of order one.
pub(super) fn scale(matrix: &mut [f64], n: usize, low: usize, high: usize, scales: &mut [f64]) {
    scales.fill(1.0);
    for _ in 0..MAXIMUM_SWEEPS {
        let mut settled = true;
        for i in low..high {
            let mut column_square: f64 = (low..high).map(|row| matrix[row + n * i].powi(2)).sum();
            let mut row_square: f64 = (low..high).map(|column| matrix[i + n * column].powi(2)).sum();
            if column_square == 0.0 || row_square == 0.0 {
                continue;
            }
            let (column_before, row_before) = (column_square, row_square);
            let mut factor = 1.0;
            while 4.0 * column_square < row_square && scales[i] * factor < LARGEST_SCALE {
                factor *= 2.0;
                column_square *= 4.0;
                row_square *= 0.25;
            }
            while column_square >= 4.0 * row_square && scales[i] * factor > SMALLEST_SCALE {
                factor *= 0.5;
                column_square *= 0.25;
                row_square *= 4.0;
            }
            if factor == 1.0 {
                continue;
            }
            let before = column_before.sqrt() + row_before.sqrt();
            if column_square.sqrt() + row_square.sqrt() >= WORTHWHILE * before {
                continue;
            }
            settled = false;
            scales[i] *= factor;
            let reciprocal = 1.0 / factor;
            for column in low..high {
                matrix[i + n * column] *= reciprocal;
            }
            for row in low..high {
                matrix[row + n * i] *= factor;
            }
        }
        if settled {
            return;
        }
    }
}

/// The exponent `e` with `2^e <= |x| < 2^(e + 1)`, for finite `x` other than zero.
pub(super) fn binary_exponent(x: f64) -> i32 {
    let biased = ((x.to_bits() >> 52) & 0x7ff) as i32;
    if biased == 0 { binary_exponent(x * 2f64.powi(64)) - 64 } else { biased - 1023 }
}

/// Two powers of two whose product is `2^exponent`, for exponents beyond the range of one number.
pub(super) fn power_of_two(exponent: i32) -> (f64, f64) {
    let half = exponent / 2;
    (2f64.powi(half), 2f64.powi(exponent - half))
}

/// The exponent of the largest entry; `None` when all entries are zero.
pub(super) fn largest_exponent(matrix: &[f64]) -> Option<i32> {
    let largest = matrix.iter().fold(0.0_f64, |largest, x| largest.max(x.abs()));
    (largest != 0.0).then(|| binary_exponent(largest))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn exponents_reach_the_ends_of_the_range() {
        for x in [1.0, -1.5, 3.0, f64::MAX, f64::MIN_POSITIVE, 5e-324, 1e-310] {
            let exponent = binary_exponent(x);
            let (a, b) = power_of_two(-exponent);
            let significand = x.abs() * a * b;
            assert!((1.0..2.0).contains(&significand), "{x} = {significand} 2^{exponent}");
        }
    }

    #[test]
    fn bad_scaling_is_undone() {
        // D^-1 A D with A well scaled and D = diag(1e-8, 1, 1e8).
        let well = [2.0, 1.0, -1.0, 0.5, 3.0, 1.0, 1.0, -0.5, 1.5];
        let d = [1e-8, 1.0, 1e8];
        let mut bad: Vec<f64> = (0..9).map(|k| well[k] * d[k / 3] / d[k % 3]).collect();
        let mut scales = [0.0; 3];
        scale(&mut bad, 3, 0, 3, &mut scales);
        let largest = bad.iter().fold(0.0_f64, |m, x| m.max(x.abs()));
        assert!(largest < 10.0, "{bad:?}");
    }

    #[test]
    fn permuted_triangular_matrix_is_isolated() {
        // Upper triangular after reversing the order of the unknowns.
        let mut lower = [1.0, 4.0, 5.0, 0.0, 2.0, 6.0, 0.0, 0.0, 3.0];
        let (low, high) = isolate(&mut lower, 3);
        assert!(high - low <= 1);
        assert_eq!((lower[1], lower[2], lower[5]), (0.0, 0.0, 0.0));
    }
}
