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
    factorize_with::<false>(matrix, n, pivots)
}

/// Solves `A X = B` in place for the columns of `right_hand_sides` (each of length `n`).
#[inline(always)]
pub fn solve(factors: &[f64], n: usize, pivots: &[usize], right_hand_sides: &mut [f64]) {
    solve_with::<false>(factors, n, pivots, right_hand_sides);
}

/// Steps that are applied to the columns behind them together, so that these are read and written once for all.
pub(crate) const BLOCK: usize = 4;

/// `entry - a b`, rounded once where the processor can; only to be compiled with `FUSED` for those that do.
#[inline(always)]
fn subtract<const FUSED: bool>(entry: f64, a: f64, b: f64) -> f64 {
    if FUSED { (-a).mul_add(b, entry) } else { entry - a * b }
}

/// `target -= sum_k factors[k] columns[k]`.
#[inline(always)]
fn subtract_columns<const FUSED: bool>(target: &mut [f64], columns: [&[f64]; BLOCK], factors: [f64; BLOCK]) {
    let [first, second, third, fourth] = columns;
    let columns = first.iter().zip(second).zip(third.iter().zip(fourth));
    for (entry, ((a, b), (c, d))) in target.iter_mut().zip(columns) {
        let one = subtract::<FUSED>(subtract::<FUSED>(*entry, factors[0], *a), factors[1], *b);
        *entry = subtract::<FUSED>(subtract::<FUSED>(one, factors[2], *c), factors[3], *d);
    }
}

/// As [`factorize`], with fused operations if `FUSED`.
#[inline(always)]
pub(crate) fn factorize_with<const FUSED: bool>(matrix: &mut [f64], n: usize, pivots: &mut [usize]) -> f64 {
    let mut sign = 1.0;
    for first in (0..n).step_by(BLOCK) {
        let end = (first + BLOCK).min(n);
        for step in first..end {
            let column = &matrix[step * n..(step + 1) * n];
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
            // The multipliers of earlier steps are exchanged too, so that one pass of row exchanges
            // over a right-hand side suffices in `solve`.
            if pivot_row != step {
                matrix.chunks_exact_mut(n).for_each(|column| column.swap(step, pivot_row));
                sign = -sign;
            }
            let (left, right) = matrix.split_at_mut((step + 1) * n);
            let column = &mut left[step * n..];
            if column[step] < 0.0 {
                sign = -sign;
            }
            let reciprocal = 1.0 / column[step];
            let multipliers = &mut column[step + 1..];
            multipliers.iter_mut().for_each(|multiplier| *multiplier *= reciprocal);
            for other in right.chunks_exact_mut(n).take(end - step - 1) {
                let factor = other[step];
                for (entry, multiplier) in other[step + 1..].iter_mut().zip(multipliers.iter()) {
                    *entry = subtract::<FUSED>(*entry, factor, *multiplier);
                }
            }
        }
        // Only a full block has columns behind it.
        let (left, right) = matrix.split_at_mut(end * n);
        if right.is_empty() {
            break;
        }
        let block = Block::new(&left[first * n..], n, first);
        for other in right.chunks_exact_mut(n) {
            block.eliminate::<FUSED>(first, other);
        }
    }
    sign
}

/// A full block of steps: their columns of multipliers, from the row of the first step on.
#[derive(Clone, Copy)]
struct Block<'a> {
    head: [&'a [f64]; BLOCK],
    below: [&'a [f64]; BLOCK],
}

impl<'a> Block<'a> {
    /// Of the columns of a matrix of `n` rows that start at `columns`.
    #[inline(always)]
    fn new(columns: &'a [f64], n: usize, first: usize) -> Self {
        let (one, rest) = columns.split_at(n);
        let (two, rest) = rest.split_at(n);
        let (three, rest) = rest.split_at(n);
        let four = &rest[..n];
        let (middle, end) = (first, first + BLOCK);
        Self {
            head: [&one[middle..end], &two[middle..end], &three[middle..end], &four[middle..end]],
            below: [&one[end..], &two[end..], &three[end..], &four[end..]],
        }
    }

    /// Applies the steps to a column.
    #[inline(always)]
    fn eliminate<const FUSED: bool>(self, first: usize, column: &mut [f64]) {
        let (above, below) = column.split_at_mut(first + BLOCK);
        let head = &mut above[first..];
        for step in 0..BLOCK {
            for row in step + 1..BLOCK {
                head[row] = subtract::<FUSED>(head[row], head[step], self.head[step][row]);
            }
        }
        // Boundary conditions leave many columns alone.
        let factors = [head[0], head[1], head[2], head[3]];
        if factors != [0.0; BLOCK] {
            subtract_columns::<FUSED>(below, self.below, factors);
        }
    }
}

/// As [`solve`], with fused operations if `FUSED`.
#[inline(always)]
pub(crate) fn solve_with<const FUSED: bool>(
    factors: &[f64],
    n: usize,
    pivots: &[usize],
    right_hand_sides: &mut [f64],
) {
    let full = n - n % BLOCK;
    for column in right_hand_sides.chunks_exact_mut(n) {
        for (step, &pivot_row) in pivots.iter().enumerate().take(n) {
            column.swap(step, pivot_row);
        }
        for first in (0..full).step_by(BLOCK) {
            Block::new(&factors[first * n..], n, first).eliminate::<FUSED>(first, column);
        }
        for step in full..n {
            let (above, below) = column.split_at_mut(step + 1);
            for (entry, multiplier) in below.iter_mut().zip(&factors[step * n + step + 1..]) {
                *entry = subtract::<FUSED>(*entry, above[step], *multiplier);
            }
        }
        for step in (full..n).rev() {
            back_substitute::<FUSED>(&factors[step * n..], step, 0, column);
        }
        for first in (0..full).step_by(BLOCK).rev() {
            let block = &factors[first * n..(first + BLOCK) * n];
            for step in (0..BLOCK).rev() {
                back_substitute::<FUSED>(&block[step * n..], first + step, first, column);
            }
            let (above, here) = column.split_at_mut(first);
            let columns = [
                &block[..first],
                &block[n..n + first],
                &block[2 * n..2 * n + first],
                &block[3 * n..3 * n + first],
            ];
            subtract_columns::<FUSED>(above, columns, [here[0], here[1], here[2], here[3]]);
        }
    }
}

/// Solves for the entry `step` of `column` and takes it out of the entries from `first` on above it.
#[inline(always)]
fn back_substitute<const FUSED: bool>(upper: &[f64], step: usize, first: usize, column: &mut [f64]) {
    let (above, here) = column.split_at_mut(step);
    here[0] /= upper[step];
    for (entry, coefficient) in above[first..].iter_mut().zip(&upper[first..step]) {
        *entry = subtract::<FUSED>(*entry, here[0], *coefficient);
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
