//! Dense LU factorisation with partial pivoting, in place, on caller's memory.
//!
//! The systems that the condensation of a collocation interval and the continuation of equilibria
//! ask for are small (a few to a few hundred rows) and factorised thousands of times, so nothing is
//! allocated here and the loops run down contiguous columns. Matrices are column-major: entry
//! `(row, column)` of a matrix with `n` rows is at `row + n * column`.
//! Source: Golub and Van Loan, *Matrix Computations*, 4th edition (2013), algorithm 3.4.1.

/// Factorises the `n`-by-`n` matrix in place as `P A = L U`.
///
/// `pivots[k]` is the row exchanged with row `k` at step `k`. Returns the sign of the determinant,
/// zero if a pivot is exactly zero or not finite (the factors are then useless).
#[inline(always)]
pub fn factorize(matrix: &mut [f64], n: usize, pivots: &mut [usize]) -> f64 {
    let mut sign = 1.0;
    for step in 0..n {
        let (left, right) = matrix.split_at_mut((step + 1) * n);
        let column = &mut left[step * n..];
        let mut pivot_row = step;
        let mut largest = column[step].abs();
        for (row, entry) in column.iter().enumerate().skip(step + 1) {
            if entry.abs() > largest {
                largest = entry.abs();
                pivot_row = row;
            }
        }
        pivots[step] = pivot_row;
        if !(largest > 0.0 && largest.is_finite()) {
            return 0.0;
        }
        if pivot_row != step {
            column.swap(step, pivot_row);
            sign = -sign;
        }
        if column[step] < 0.0 {
            sign = -sign;
        }
        let reciprocal = 1.0 / column[step];
        let multipliers = &mut column[step + 1..];
        for multiplier in multipliers.iter_mut() {
            *multiplier *= reciprocal;
        }
        for other in right.chunks_exact_mut(n) {
            other.swap(step, pivot_row);
            let factor = other[step];
            if factor != 0.0 {
                for (entry, multiplier) in other[step + 1..].iter_mut().zip(multipliers.iter()) {
                    *entry -= factor * multiplier;
                }
            }
        }
        // The multipliers of earlier steps are exchanged too, so that one pass of row exchanges
        // over a right-hand side suffices in `solve`.
        if pivot_row != step {
            for earlier in left[..step * n].chunks_exact_mut(n) {
                earlier.swap(step, pivot_row);
            }
        }
    }
    sign
}

/// Solves `A X = B` in place for the columns of `right_hand_sides` (each of length `n`).
#[inline(always)]
pub fn solve(factors: &[f64], n: usize, pivots: &[usize], right_hand_sides: &mut [f64]) {
    for column in right_hand_sides.chunks_exact_mut(n) {
        for (step, &pivot_row) in pivots.iter().enumerate().take(n) {
            column.swap(step, pivot_row);
        }
        for step in 0..n {
            let (above, below) = column.split_at_mut(step + 1);
            let factor = above[step];
            if factor != 0.0 {
                let multipliers = &factors[step * n + step + 1..(step + 1) * n];
                for (entry, multiplier) in below.iter_mut().zip(multipliers) {
                    *entry -= factor * multiplier;
                }
            }
        }
        for step in (0..n).rev() {
            let upper = &factors[step * n..step * n + step + 1];
            let (above, here) = column.split_at_mut(step);
            here[0] /= upper[step];
            let factor = here[0];
            for (entry, coefficient) in above.iter_mut().zip(upper) {
                *entry -= factor * coefficient;
            }
        }
    }
}

/// Solves `A' x = b` in place for one right-hand side.
pub fn solve_transposed(factors: &[f64], n: usize, pivots: &[usize], right_hand_side: &mut [f64]) {
    for step in 0..n {
        let column = &factors[step * n..(step + 1) * n];
        let sum: f64 = column[..step].iter().zip(&right_hand_side[..step]).map(|(a, b)| a * b).sum();
        right_hand_side[step] = (right_hand_side[step] - sum) / column[step];
    }
    for step in (0..n).rev() {
        let column = &factors[step * n..(step + 1) * n];
        let sum: f64 = column[step + 1..].iter().zip(&right_hand_side[step + 1..n]).map(|(a, b)| a * b).sum();
        right_hand_side[step] -= sum;
    }
    for step in (0..n).rev() {
        right_hand_side.swap(step, pivots[step]);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn product(matrix: &[f64], n: usize, vector: &[f64], transposed: bool) -> Vec<f64> {
        (0..n)
            .map(|row| {
                (0..n)
                    .map(|column| {
                        let index = if transposed { column + n * row } else { row + n * column };
                        matrix[index] * vector[column]
                    })
                    .sum()
            })
            .collect()
    }

    proptest! {
        #[test]
        fn solves_random_systems(n in 1usize..12, seed in prop::collection::vec(-1.0..1.0f64, 144 + 12)) {
            let mut matrix = seed[..n * n].to_vec();
            for index in 0..n {
                // Cyclic dominance makes the system well conditioned and pivoting necessary.
                matrix[(index + 1) % n + n * index] += 4.0 * n as f64;
            }
            let truth = &seed[144..144 + n];
            for transposed in [false, true] {
                let mut solution = product(&matrix, n, truth, transposed);
                let mut factors = matrix.clone();
                let mut pivots = vec![0; n];
                prop_assert!(factorize(&mut factors, n, &mut pivots) != 0.0);
                if transposed {
                    solve_transposed(&factors, n, &pivots, &mut solution);
                } else {
                    solve(&factors, n, &pivots, &mut solution);
                }
                for (computed, exact) in solution.iter().zip(truth) {
                    prop_assert!((computed - exact).abs() < 1e-13);
                }
            }
        }
    }

    #[test]
    fn reports_the_sign_of_the_determinant_and_singularity() {
        let mut pivots = [0; 2];
        assert_eq!(factorize(&mut [0.0, 1.0, 1.0, 0.0], 2, &mut pivots), -1.0);
        assert_eq!(factorize(&mut [-2.0, 0.0, 0.0, -3.0], 2, &mut pivots), 1.0);
        assert_eq!(factorize(&mut [1.0, 2.0, 2.0, 4.0], 2, &mut pivots), 0.0);
        assert_eq!(factorize(&mut [f64::NAN; 4], 2, &mut pivots), 0.0);
    }
}
