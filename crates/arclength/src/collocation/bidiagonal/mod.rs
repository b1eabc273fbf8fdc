//! Block-bidiagonal systems with boundary conditions and bordering, what is left of a collocation system when the
//! interior of every interval is condensed.
//!
//! Unknowns are `u_0, ..., u_N` of size `n` and `E` scalars `s`. Equations:
//!
//! ```text
//! u_(j+1) - R_j u_j - Q_j s = rho_j,   j = 0 .. N-1     (rho_(N-1) = 0)
//! B_1 u_N + B_0 u_0 + B_s s = c                         (boundary conditions)
//! sum_(j<N) G_j u_j + S s = d                           (dense rows; there are n + E together with the boundary conditions)
//! ```
//!
//! Interior unknowns are eliminated one after the other by Householder reflections of two neighbouring
//! block rows, which stays stable when the system has rapidly growing and decaying modes together, where
//! multiplying the `R_j` would not. Source: Wright, "Stable parallel algorithms for two-point boundary
//! value problems", SIAM J. Sci. Stat. Comput. 13 (1992). Cost: linear in `N`, cubic in `n`.

mod reflections;
#[cfg(test)]
mod tests;

use crate::lanes::{Kernel, run};

use crate::linear::lu;
use reflections::{dot, reflect, solve_triangle_from_left, triangularize};

/// Factorisation of a block-bidiagonal system; memory is kept from one factorisation to the next.
#[derive(Clone, Debug, Default)]
pub(crate) struct Bidiagonal {
    sizes: Sizes,
    /// For every eliminated block: the 2n-by-n reflectors and triangle, column-major.
    reflectors: Vec<f64>,
    /// For every eliminated block: factors of the n reflections.
    factors: Vec<f64>,
    /// For every eliminated block: its n rows in the columns `u_0`, `u_(j+1)`, `s`, column-major.
    top: Vec<f64>,
    /// For every eliminated block: the multipliers of the dense rows, n numbers for each, row by row.
    multipliers: Vec<f64>,
    /// LU factors of the last system, in `u_N`, `u_0`, `s`.
    last: Vec<f64>,
    pivots: Vec<usize>,
    /// Factor of the boundary conditions in that system.
    weight: f64,
    /// Work of 2n rows by `2n + E` columns.
    work: Vec<f64>,
    rows: Vec<f64>,
    right: Vec<f64>,
    last_right: Vec<f64>,
}

/// The numbers of unknowns and equations.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Sizes {
    /// `n`.
    pub components: usize,
    /// `E`.
    pub scalars: usize,
    /// Number of boundary conditions.
    pub boundary_conditions: usize,
    /// `N`.
    pub intervals: usize,
}

impl Sizes {
    /// Number of dense rows.
    pub(crate) fn dense_rows(&self) -> usize {
        self.components + self.scalars - self.boundary_conditions
    }
}

/// The blocks of the system, borrowed.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Blocks<'a> {
    /// `R_j`, n-by-n column-major, one after the other.
    pub transfer: &'a [f64],
    /// `Q_j`, n-by-E column-major, one after the other.
    pub scalar_columns: &'a [f64],
    /// `B_1`, `B_0` and `B_s`, column-major, one after the other.
    pub boundary: &'a [f64],
    /// Dense rows: for every row, `N n` entries.
    pub rows: &'a [f64],
    /// Block `S` of the dense rows in the scalars, row by row.
    pub corner: &'a [f64],
}

impl Bidiagonal {
    /// Factorises. Returns the sign of the determinant of the system reduced to `(u_N, u_0, s)`, which does not
    /// depend on the number of intervals; zero if the system is singular.
    pub(crate) fn factorize(&mut self, blocks: Blocks<'_>, sizes: Sizes) -> f64 {
        self.sizes = sizes;
        run(Factorization(self, blocks))
    }

    #[inline(always)]
    fn factorize_kernel(&mut self, blocks: Blocks<'_>, n: usize) -> f64 {
        let Sizes { scalars, intervals, .. } = self.sizes;
        let width = 2 * n + scalars;
        self.make_room(n);
        self.load_dense_rows(blocks.rows, n);
        let mut corner = blocks.corner.to_vec();
        let mut pending = first_block_row(&blocks, n, scalars);
        // Sign of det B, tracked because B itself may underflow: complementary minors of the orthogonal
        // matrix H of the reflections give det B_next = det H det B / det U, and det H = (-1)^n.
        let mut coefficient_sign = 1.0;
        for block in 0..intervals - 1 {
            self.load_two_rows(&blocks, block, &pending, n);
            let reflectors = &mut self.reflectors[block * 2 * n * n..(block + 1) * 2 * n * n];
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
            self.eliminate_from_dense_rows(block, &mut corner, n);
        }
        self.assemble_last(blocks.boundary, &pending, &corner);
        lu::factorize(&mut self.last, width, &mut self.pivots) * coefficient_sign
    }

    #[inline(always)]
    fn make_room(&mut self, n: usize) {
        let Sizes { scalars, intervals, .. } = self.sizes;
        let eliminated = intervals - 1;
        let width = 2 * n + scalars;
        self.reflectors.resize(eliminated * 2 * n * n, 0.0);
        self.factors.resize(eliminated * n, 0.0);
        self.top.resize(eliminated * n * width, 0.0);
        self.multipliers.resize(eliminated * self.sizes.dense_rows() * n, 0.0);
        self.work.resize(2 * n * width, 0.0);
        self.right.resize(2 * n, 0.0);
    }

    /// Copies the dense rows, with room for their entries in `u_N`.
    #[inline(always)]
    fn load_dense_rows(&mut self, rows: &[f64], n: usize) {
        self.rows.clear();
        for row in rows.chunks_exact(self.sizes.intervals * n) {
            self.rows.extend_from_slice(row);
            self.rows.extend(std::iter::repeat_n(0.0, n));
        }
    }

    /// Writes the pending block row and the next one: their columns of the unknown between them to where its reflectors will be, those of
    /// `u_0`, `u_(j+1)` and `s` to the work.
    #[inline(always)]
    fn load_two_rows(&mut self, blocks: &Blocks<'_>, block: usize, pending: &[f64], n: usize) {
        let scalars = self.sizes.scalars;
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
    }

    /// Dense rows: y = g_j U^-1, then subtract y times the top rows.
    #[inline(always)]
    fn eliminate_from_dense_rows(&mut self, block: usize, corner: &mut [f64], n: usize) {
        let Sizes { scalars, intervals, .. } = self.sizes;
        let dense_rows = self.sizes.dense_rows();
        let width = 2 * n + scalars;
        let row_length = (intervals + 1) * n;
        let j = block + 1;
        let reflectors = &self.reflectors[block * 2 * n * n..(block + 1) * 2 * n * n];
        let top = &self.top[block * n * width..(block + 1) * n * width];
        for row in 0..dense_rows {
            let multiplier = &mut self.multipliers[(block * dense_rows + row) * n..][..n];
            let entries = &mut self.rows[row * row_length..(row + 1) * row_length];
            multiplier.copy_from_slice(&entries[j * n..(j + 1) * n]);
            solve_triangle_from_left(reflectors, n, multiplier);
            for column in 0..n {
                entries[column] -= dot(multiplier, &top[n * column..n * (column + 1)]);
                entries[(j + 1) * n + column] -=
                    dot(multiplier, &top[n * (n + column)..n * (n + column + 1)]);
            }
            for column in 0..scalars {
                corner[row * scalars + column] -=
                    dot(multiplier, &top[n * (2 * n + column)..n * (2 * n + column + 1)]);
            }
        }
    }

    /// Writes the system that is left: boundary conditions, the pending block row, dense rows, in the columns `u_N`, `u_0`,
    /// `s`.
    ///
    /// The boundary conditions are made as large as what is in the columns of `u_N` below them, by a power of two, so that pivots
    /// are sought in them first: periodic ones then eliminate `u_N` without rounding.
    fn assemble_last(&mut self, boundary: &[f64], pending: &[f64], corner: &[f64]) {
        let Sizes { components: n, scalars, boundary_conditions, intervals } = self.sizes;
        let size = 2 * n + scalars;
        let row_length = (intervals + 1) * n;
        self.last.clear();
        self.last.resize(size * size, 0.0);
        self.pivots.resize(size, 0);
        let below = boundary_conditions + n;
        let mut columns = self.last.chunks_exact_mut(size);
        // Columns of the pending block row and first entries of the dense rows, for u_N and then for u_0.
        for (first_pending, first_entry) in [(n, intervals * n), (0, 0)] {
            for (component, column) in columns.by_ref().take(n).enumerate() {
                let source = n * (first_pending + component);
                column[boundary_conditions..below].copy_from_slice(&pending[source..source + n]);
                let entries = self.rows.iter().skip(first_entry + component).step_by(row_length);
                column[below..].iter_mut().zip(entries).for_each(|(target, entry)| *target = *entry);
            }
        }
        for (scalar, column) in columns.enumerate() {
            let source = n * (2 * n + scalar);
            column[boundary_conditions..below].copy_from_slice(&pending[source..source + n]);
            let entries = corner.iter().skip(scalar).step_by(scalars);
            column[below..].iter_mut().zip(entries).for_each(|(target, entry)| *target = *entry);
        }
        let largest =
            |most: f64, entries: &[f64]| entries.iter().fold(most, |most, entry| most.max(entry.abs()));
        let beside = self
            .last
            .chunks_exact(size)
            .take(n)
            .fold(0.0, |most, column| largest(most, &column[boundary_conditions..]));
        let ratio = beside / largest(0.0, boundary);
        self.weight = if ratio.is_finite() && ratio > 1.0 { ratio.log2().ceil().exp2() } else { 1.0 };
        for (column, source) in
            self.last.chunks_exact_mut(size).zip(boundary.chunks_exact(boundary_conditions.max(1)))
        {
            column.iter_mut().zip(source).for_each(|(target, entry)| *target = self.weight * entry);
        }
    }

    /// Solves in place: `states` holds the `rho_j` and receives `u_0, ..., u_(N-1)`; `conditions` holds `c` and `d`, one
    /// after the other, and receives `u_N` and `s`.
    pub(crate) fn solve(&mut self, states: &mut [f64], conditions: &mut [f64]) {
        match self.sizes.components {
            1 => self.solve_kernel(1, states, conditions),
            2 => self.solve_kernel(2, states, conditions),
            3 => self.solve_kernel(3, states, conditions),
            4 => self.solve_kernel(4, states, conditions),
            5 => self.solve_kernel(5, states, conditions),
            6 => self.solve_kernel(6, states, conditions),
            n => self.solve_kernel(n, states, conditions),
        }
    }

    #[inline(always)]
    fn solve_kernel(&mut self, n: usize, states: &mut [f64], conditions: &mut [f64]) {
        let Sizes { scalars, boundary_conditions, intervals, .. } = self.sizes;
        let dense_rows = self.sizes.dense_rows();
        let eliminated = intervals - 1;
        let width = 2 * n + scalars;
        let (boundary, dense) = conditions.split_at_mut(boundary_conditions);
        self.right[n..].copy_from_slice(&states[..n]);
        for block in 0..eliminated {
            let j = block + 1;
            let reflectors = &self.reflectors[block * 2 * n * n..(block + 1) * 2 * n * n];
            let factors = &self.factors[block * n..(block + 1) * n];
            self.right.copy_within(n.., 0);
            self.right[n..].copy_from_slice(&states[j * n..(j + 1) * n]);
            reflect(reflectors, factors, n, &mut self.right);
            states[j * n..(j + 1) * n].copy_from_slice(&self.right[..n]);
            for (row, value) in dense.iter_mut().enumerate() {
                let multiplier = &self.multipliers[(block * dense_rows + row) * n..][..n];
                *value -= dot(multiplier, &self.right[..n]);
            }
        }
        self.last_right.clear();
        self.last_right.extend(boundary.iter().map(|value| self.weight * value));
        self.last_right.extend_from_slice(&self.right[n..]);
        self.last_right.extend_from_slice(dense);
        lu::solve(&self.last, width, &self.pivots, &mut self.last_right);
        let (end, rest) = self.last_right.split_at(n);
        let (start, scalars) = rest.split_at(n);
        states[..n].copy_from_slice(start);
        conditions[..n].copy_from_slice(end);
        conditions[n..].copy_from_slice(scalars);
        let mut next = end.to_vec();
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

/// The first pending block row: A u_0 + B u_j + C s, columns in that order, n rows.
#[inline(always)]
fn first_block_row(blocks: &Blocks<'_>, n: usize, scalars: usize) -> Vec<f64> {
    let mut pending = vec![0.0; n * (2 * n + scalars)];
    for column in 0..n {
        for row in 0..n {
            pending[row + n * column] = -blocks.transfer[row + n * column];
        }
        pending[column + n * (n + column)] = 1.0;
    }
    for (target, source) in pending[2 * n * n..].iter_mut().zip(&blocks.scalar_columns[..n * scalars]) {
        *target = -source;
    }
    pending
}

/// [`Bidiagonal::factorize`] with the vector instructions of the processor; no operation is fused.
struct Factorization<'a>(&'a mut Bidiagonal, Blocks<'a>);

impl Kernel for Factorization<'_> {
    type Output = f64;

    #[inline(always)]
    fn run<const FUSED: bool>(self) -> f64 {
        let Self(system, blocks) = self;
        // Loops over few states are worth unrolling.
        match system.sizes.components {
            1 => system.factorize_kernel(blocks, 1),
            2 => system.factorize_kernel(blocks, 2),
            3 => system.factorize_kernel(blocks, 3),
            4 => system.factorize_kernel(blocks, 4),
            5 => system.factorize_kernel(blocks, 5),
            6 => system.factorize_kernel(blocks, 6),
            n => system.factorize_kernel(blocks, n),
        }
    }
}
