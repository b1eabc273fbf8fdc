//! Cyclic block-bidiagonal systems with bordering, what is left of a collocation system when the
//! interior of every interval is condensed.
//!
//! Unknowns are `u_0, ..., u_(N-1)` of size `n` and `E` scalars `s`. Equations:
//!
//! ```text
//! u_(j+1) - R_j u_j - Q_j s = rho_j,   j = 0 .. N-1,   u_N = Theta u_0, Theta = diag(+-1)
//! sum_j G_j u_j + S s = d              (E dense rows)
//! ```
//!
//! Interior unknowns are eliminated one after the other by Householder reflections of two neighbouring
//! block rows, which stays stable when the system has rapidly growing and decaying modes together, where
//! multiplying the `R_j` would not. Source: Wright, "Stable parallel algorithms for two-point boundary
//! value problems", SIAM J. Sci. Stat. Comput. 13 (1992). Cost: linear in `N`, cubic in `n`.

use crate::linear::lu;

/// Factorisation of a cyclic system; memory is kept from one factorisation to the next.
#[derive(Clone, Debug, Default)]
pub struct Cyclic {
    n: usize,
    scalars: usize,
    intervals: usize,
    signs: Vec<f64>,
    /// For every eliminated block: the 2n-by-n reflectors and triangle, column-major.
    reflectors: Vec<f64>,
    /// For every eliminated block: factors of the n reflections.
    factors: Vec<f64>,
    /// For every eliminated block: its n rows in the columns `u_0`, `u_(j+1)`, `s`, column-major.
    top: Vec<f64>,
    /// For every eliminated block: the E-by-n multipliers of the dense rows, row by row.
    multipliers: Vec<f64>,
    /// LU factors of the last `(n + E)`-square system.
    last: Vec<f64>,
    pivots: Vec<usize>,
    /// Work of 2n rows by `2n + E` columns.
    work: Vec<f64>,
    rows: Vec<f64>,
    right: Vec<f64>,
}

/// The blocks of the system, borrowed.
#[derive(Clone, Copy, Debug)]
pub struct Blocks<'a> {
    /// `R_j`, n-by-n column-major, one after the other.
    pub transfer: &'a [f64],
    /// `Q_j`, n-by-E column-major, one after the other.
    pub scalar_columns: &'a [f64],
    /// Dense rows: for every row, `N n` entries.
    pub rows: &'a [f64],
    /// E-by-E block of the dense rows in the scalars, row by row.
    pub corner: &'a [f64],
    /// Diagonal of `Theta`.
    pub signs: &'a [f64],
}

impl Cyclic {
    /// Factorises. Returns the sign of the determinant of the system reduced to `(u_0, s)`, which does not
    /// depend on the number of intervals; zero if the system is singular.
    pub fn factorize(&mut self, blocks: Blocks<'_>, n: usize, scalars: usize, intervals: usize) -> f64 {
        // Loops over few states are worth unrolling.
        match n {
            1 => self.factorize_kernel(blocks, 1, scalars, intervals),
            2 => self.factorize_kernel(blocks, 2, scalars, intervals),
            3 => self.factorize_kernel(blocks, 3, scalars, intervals),
            4 => self.factorize_kernel(blocks, 4, scalars, intervals),
            5 => self.factorize_kernel(blocks, 5, scalars, intervals),
            6 => self.factorize_kernel(blocks, 6, scalars, intervals),
            n => self.factorize_kernel(blocks, n, scalars, intervals),
        }
    }

    #[inline(always)]
    fn factorize_kernel(&mut self, blocks: Blocks<'_>, n: usize, scalars: usize, intervals: usize) -> f64 {
        self.n = n;
        self.scalars = scalars;
        self.intervals = intervals;
        self.signs.clear();
        self.signs.extend_from_slice(blocks.signs);
        let eliminated = intervals - 1;
        let width = 2 * n + scalars;
        self.reflectors.resize(eliminated * 2 * n * n, 0.0);
        self.factors.resize(eliminated * n, 0.0);
        self.top.resize(eliminated * n * width, 0.0);
        self.multipliers.resize(eliminated * scalars * n, 0.0);
        self.work.resize(2 * n * width, 0.0);
        self.right.resize(2 * n, 0.0);
        self.rows.clear();
        self.rows.extend_from_slice(blocks.rows);
        let size = n + scalars;
        self.last.clear();
        self.last.resize(size * size, 0.0);
        self.pivots.resize(size, 0);
        let mut corner = blocks.corner.to_vec();

        // The pending block row: A u_0 + B u_j + C s, columns in that order, n rows.
        let mut pending = vec![0.0; n * width];
        for column in 0..n {
            for row in 0..n {
                pending[row + n * column] = -blocks.transfer[row + n * column];
            }
            pending[column + n * (n + column)] = 1.0;
        }
        for (target, source) in pending[2 * n * n..].iter_mut().zip(&blocks.scalar_columns[..n * scalars]) {
            *target = -source;
        }
        let row_length = intervals * n;
        // Sign of det B, tracked because B itself may underflow: complementary minors of the orthogonal
        // matrix H of the reflections give det B_next = det H det B / det U, and det H = (-1)^n.
        let mut coefficient_sign = 1.0;
        for block in 0..eliminated {
            let j = block + 1;
            let transfer = &blocks.transfer[j * n * n..(j + 1) * n * n];
            let scalar_columns = &blocks.scalar_columns[j * n * scalars..(j + 1) * n * scalars];
            let reflectors = &mut self.reflectors[block * 2 * n * n..(block + 1) * 2 * n * n];
            for column in 0..n {
                let target = &mut reflectors[column * 2 * n..(column + 1) * 2 * n];
                target[..n].copy_from_slice(&pending[n * (n + column)..n * (n + column + 1)]);
                for row in 0..n {
                    target[n + row] = -transfer[row + n * column];
                }
            }
            // Columns u_0, u_(j+1), s of the two block rows.
            self.work.fill(0.0);
            for column in 0..n {
                self.work[2 * n * column..2 * n * column + n]
                    .copy_from_slice(&pending[n * column..n * (column + 1)]);
                self.work[2 * n * (n + column) + n + column] = 1.0;
            }
            for column in 0..scalars {
                let target = &mut self.work[2 * n * (2 * n + column)..2 * n * (2 * n + column + 1)];
                target[..n].copy_from_slice(&pending[n * (2 * n + column)..n * (2 * n + column + 1)]);
                for row in 0..n {
                    target[n + row] = -scalar_columns[row + n * column];
                }
            }
            let factors = &mut self.factors[block * n..(block + 1) * n];
            if !triangularize(reflectors, factors, n) {
                return 0.0;
            }
            for column in 0..n {
                coefficient_sign *= -reflectors[column * 2 * n + column].signum();
            }
            reflect(reflectors, factors, n, &mut self.work);
            let top = &mut self.top[block * n * width..(block + 1) * n * width];
            for column in 0..width {
                let source = &self.work[2 * n * column..2 * n * (column + 1)];
                top[n * column..n * (column + 1)].copy_from_slice(&source[..n]);
                pending[n * column..n * (column + 1)].copy_from_slice(&source[n..]);
            }
            // Dense rows: y = g_j U^-1, then subtract y times the top rows.
            for row in 0..scalars {
                let multiplier = &mut self.multipliers[(block * scalars + row) * n..][..n];
                let entries = &mut self.rows[row * row_length..(row + 1) * row_length];
                multiplier.copy_from_slice(&entries[j * n..(j + 1) * n]);
                solve_triangle_from_left(reflectors, n, multiplier);
                for column in 0..n {
                    entries[column] -= dot(multiplier, &top[n * column..n * (column + 1)]);
                    let next = dot(multiplier, &top[n * (n + column)..n * (n + column + 1)]);
                    if j + 1 < intervals {
                        entries[(j + 1) * n + column] -= next;
                    } else {
                        entries[column] -= next * blocks.signs[column];
                    }
                }
                for column in 0..scalars {
                    corner[row * scalars + column] -=
                        dot(multiplier, &top[n * (2 * n + column)..n * (2 * n + column + 1)]);
                }
            }
        }
        for column in 0..n {
            for row in 0..n {
                self.last[row + size * column] =
                    pending[row + n * column] + pending[row + n * (n + column)] * blocks.signs[column];
            }
            for row in 0..scalars {
                self.last[n + row + size * column] = self.rows[row * row_length + column];
            }
        }
        for column in 0..scalars {
            for row in 0..n {
                self.last[row + size * (n + column)] = pending[row + n * (2 * n + column)];
            }
            for row in 0..scalars {
                self.last[n + row + size * (n + column)] = corner[row * scalars + column];
            }
        }
        lu::factorize(&mut self.last, size, &mut self.pivots) * coefficient_sign
    }

    /// Solves in place: `states` holds the `rho_j` and receives the `u_j`; `scalars` holds `d` and receives `s`.
    pub fn solve(&mut self, states: &mut [f64], scalars: &mut [f64]) {
        match self.n {
            1 => self.solve_kernel(1, states, scalars),
            2 => self.solve_kernel(2, states, scalars),
            3 => self.solve_kernel(3, states, scalars),
            4 => self.solve_kernel(4, states, scalars),
            5 => self.solve_kernel(5, states, scalars),
            6 => self.solve_kernel(6, states, scalars),
            n => self.solve_kernel(n, states, scalars),
        }
    }

    #[inline(always)]
    fn solve_kernel(&mut self, n: usize, states: &mut [f64], scalars: &mut [f64]) {
        let eliminated = self.intervals - 1;
        let width = 2 * n + self.scalars;
        self.right[n..].copy_from_slice(&states[..n]);
        for block in 0..eliminated {
            let j = block + 1;
            let reflectors = &self.reflectors[block * 2 * n * n..(block + 1) * 2 * n * n];
            let factors = &self.factors[block * n..(block + 1) * n];
            self.right.copy_within(n.., 0);
            self.right[n..].copy_from_slice(&states[j * n..(j + 1) * n]);
            reflect(reflectors, factors, n, &mut self.right);
            states[j * n..(j + 1) * n].copy_from_slice(&self.right[..n]);
            for (row, scalar) in scalars.iter_mut().enumerate() {
                let multiplier = &self.multipliers[(block * self.scalars + row) * n..][..n];
                *scalar -= dot(multiplier, &self.right[..n]);
            }
        }
        let size = n + self.scalars;
        let mut last = vec![0.0; size];
        last[..n].copy_from_slice(&self.right[n..]);
        last[n..].copy_from_slice(scalars);
        lu::solve(&self.last, size, &self.pivots, &mut last);
        scalars.copy_from_slice(&last[n..]);
        states[..n].copy_from_slice(&last[..n]);
        let mut next: Vec<f64> = last[..n].iter().zip(&self.signs).map(|(u, sign)| u * sign).collect();
        for block in (0..eliminated).rev() {
            let j = block + 1;
            let top = &self.top[block * n * width..(block + 1) * n * width];
            let (first, rest) = states.split_at_mut(j * n);
            let here = &mut rest[..n];
            let coefficients = first[..n].iter().chain(next.iter()).chain(scalars.iter());
            for (column, coefficient) in top.chunks_exact(n).zip(coefficients) {
                for (entry, value) in here.iter_mut().zip(column) {
                    *entry -= coefficient * value;
                }
            }
            let reflectors = &self.reflectors[block * 2 * n * n..(block + 1) * 2 * n * n];
            for column in (0..n).rev() {
                let upper = &reflectors[column * 2 * n..column * 2 * n + column + 1];
                here[column] /= upper[column];
                let value = here[column];
                for (entry, coefficient) in here[..column].iter_mut().zip(upper) {
                    *entry -= value * coefficient;
                }
            }
            next.copy_from_slice(here);
        }
    }
}

#[inline(always)]
fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

/// QR factorisation of a 2n-by-n matrix in place: triangle above, reflectors below with the leading entry
/// of each kept in `factors` as `beta = 2 / v'v` after scaling `v` to leading entry one.
#[inline(always)]
fn triangularize(matrix: &mut [f64], factors: &mut [f64], n: usize) -> bool {
    let rows = 2 * n;
    for step in 0..n {
        let (left, right) = matrix.split_at_mut((step + 1) * rows);
        let column = &mut left[step * rows..];
        let norm = dot(&column[step..], &column[step..]).sqrt();
        if !(norm > 0.0 && norm.is_finite()) {
            return false;
        }
        let alpha = if column[step] > 0.0 { -norm } else { norm };
        let leading = column[step] - alpha;
        let scale = 1.0 / leading;
        for entry in &mut column[step + 1..] {
            *entry *= scale;
        }
        factors[step] = -leading / alpha;
        column[step] = alpha;
        let reflector = &column[step + 1..];
        for other in right.chunks_exact_mut(rows) {
            let projection = factors[step] * (other[step] + dot(reflector, &other[step + 1..]));
            other[step] -= projection;
            for (entry, component) in other[step + 1..].iter_mut().zip(reflector) {
                *entry -= projection * component;
            }
        }
    }
    true
}

/// Applies the reflections to columns of length 2n.
#[inline(always)]
fn reflect(reflectors: &[f64], factors: &[f64], n: usize, columns: &mut [f64]) {
    let rows = 2 * n;
    for other in columns.chunks_exact_mut(rows) {
        for step in 0..n {
            let reflector = &reflectors[step * rows + step + 1..(step + 1) * rows];
            let projection = factors[step] * (other[step] + dot(reflector, &other[step + 1..]));
            other[step] -= projection;
            for (entry, component) in other[step + 1..].iter_mut().zip(reflector) {
                *entry -= projection * component;
            }
        }
    }
}

/// Replaces the row `y` by `y U^-1`, `U` the triangle in the first n rows.
#[inline(always)]
fn solve_triangle_from_left(reflectors: &[f64], n: usize, y: &mut [f64]) {
    for column in 0..n {
        let upper = &reflectors[column * 2 * n..column * 2 * n + column + 1];
        let sum = dot(&y[..column], upper);
        y[column] = (y[column] - sum) / upper[column];
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(64))]
        #[test]
        fn agrees_with_dense_elimination(
            n in 1usize..5, intervals in 1usize..7, scalars in 1usize..4, flip in any::<bool>(),
            stretch in -6.0..6.0f64,
            entries in prop::collection::vec(-1.0..1.0f64, 1200),
        ) {
            let mut entries = entries.into_iter();
            let mut take = |count: usize| -> Vec<f64> { (0..count).filter_map(|_| entries.next()).collect() };
            let mut transfer = take(intervals * n * n);
            // One strongly growing and one strongly decaying direction.
            for block in transfer.chunks_exact_mut(n * n) {
                block[0] += stretch.exp2() * 4.0;
            }
            let scalar_columns = take(intervals * n * scalars);
            let rows = take(scalars * intervals * n);
            let corner = take(scalars * scalars);
            let signs = vec![if flip { -1.0 } else { 1.0 }; n];
            let size = intervals * n + scalars;
            let mut dense = vec![0.0; size * size];
            for j in 0..intervals {
                for row in 0..n {
                    for column in 0..n {
                        dense[j * n + row + size * (j * n + column)] -= transfer[j * n * n + row + n * column];
                    }
                    let next = ((j + 1) % intervals) * n + row;
                    dense[j * n + row + size * next] += if j + 1 == intervals { signs[row] } else { 1.0 };
                    for column in 0..scalars {
                        dense[j * n + row + size * (intervals * n + column)] =
                            -scalar_columns[j * n * scalars + row + n * column];
                    }
                }
            }
            for row in 0..scalars {
                for column in 0..intervals * n {
                    dense[intervals * n + row + size * column] = rows[row * intervals * n + column];
                }
                for column in 0..scalars {
                    dense[intervals * n + row + size * (intervals * n + column)] = corner[row * scalars + column];
                }
            }
            let truth = take(size);
            let mut right: Vec<f64> =
                (0..size).map(|row| (0..size).map(|column| dense[row + size * column] * truth[column]).sum()).collect();
            let mut pivots = vec![0; size];
            let mut factors = dense.clone();
            lu::factorize(&mut factors, size, &mut pivots);
            let mut by_elimination = right.clone();
            lu::solve(&factors, size, &pivots, &mut by_elimination);
            let blocks = Blocks { transfer: &transfer, scalar_columns: &scalar_columns, rows: &rows, corner: &corner, signs: &signs };
            let mut cyclic = Cyclic::default();
            prop_assert!(cyclic.factorize(blocks, n, scalars, intervals) != 0.0);
            let (states, rest) = right.split_at_mut(intervals * n);
            cyclic.solve(states, rest);
            let error = |x: &[f64]| x.iter().zip(&truth).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
            // As accurate as elimination with partial pivoting on the full matrix, near singular too.
            prop_assert!(error(&right) <= 1e3 * error(&by_elimination).max(1e-13), "{} {}", error(&right), error(&by_elimination));
        }
    }

    #[test]
    fn survives_modes_whose_product_would_overflow() {
        let (n, intervals) = (2, 400);
        let transfer: Vec<f64> = (0..intervals).flat_map(|_| [10.0, 0.0, 0.0, 0.1]).collect();
        let scalar_columns = vec![1.0; intervals * n];
        let rows = vec![1.0; intervals * n];
        let mut cyclic = Cyclic::default();
        let blocks = Blocks {
            transfer: &transfer,
            scalar_columns: &scalar_columns,
            rows: &rows,
            corner: &[0.0],
            signs: &[1.0, 1.0],
        };
        assert!(cyclic.factorize(blocks, n, 1, intervals) != 0.0);
        // u_j = (1/9, -1/0.9) s * (-1) solves u - R u = s with constant u.
        let mut states = vec![0.0; intervals * n];
        let mut scalars = [1.0];
        cyclic.solve(&mut states, &mut scalars);
        let s = 1.0 / (intervals as f64 * (-1.0 / 9.0 + 1.0 / 0.9));
        assert!((scalars[0] / s - 1.0).abs() < 1e-12);
        assert!((states[200] / (-s / 9.0) - 1.0).abs() < 1e-12);
    }
}
