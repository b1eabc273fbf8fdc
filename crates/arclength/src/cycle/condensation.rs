//! Condensation of a linearised collocation system: the interior of every interval is eliminated by one small
//! dense factorisation, and a [`Cyclic`] system in the left ends and the scalars is left.
//!
//! Apart from the evaluation of the vector field this is where the time of a continuation of cycles goes, so
//! it is compiled once, not for every field, and also for processors with wide vectors and fused operations.
//! Source: Ascher, Mattheij and Russell, *Numerical Solution of Boundary Value Problems* (1995), section 7.2.

use super::cyclic::{Blocks, Cyclic};
use super::gauss::Gauss;
use crate::linear::lu;

/// A linearised collocation system and its factors; memory is kept from one factorisation to the next.
#[derive(Debug, Clone)]
pub(super) struct Condensation {
    pub(super) gauss: Gauss,
    /// Number of state components.
    n: usize,
    /// Number of scalars, and of dense rows.
    scalars: usize,
    /// Diagonal of the boundary condition `y(1) = Theta y(0)`.
    signs: Vec<f64>,
    intervals: usize,
    /// Derivatives of the field at the Gauss points, to be filled in before [`factorize`](Self::factorize):
    /// `n` by `n + E` column-major for each point.
    pub(super) derivatives: Vec<f64>,
    /// Gradients of the dense rows (conditions, then the border) in the states, row by row; to be filled in.
    pub(super) gradients: Vec<f64>,
    /// Derivatives of the dense rows with respect to the scalars, row by row; to be filled in.
    pub(super) corner: Vec<f64>,
    /// Rows of the interior systems, `m n` rounded up so that vector instructions leave no rest.
    padded: usize,
    /// LU factors of the interior systems, padded by unit vectors, for each interval, and their pivots.
    factors: Vec<f64>,
    pivots: Vec<usize>,
    /// Interior response to `u_j` and the scalars: `m n` (padded) by `n + E` for each interval.
    response: Vec<f64>,
    /// One padded right-hand side.
    column: Vec<f64>,
    transfer: Vec<f64>,
    scalar_columns: Vec<f64>,
    rows: Vec<f64>,
    states: Vec<f64>,
    cyclic: Cyclic,
    /// Whether the processor has vectors of four numbers and fused operations.
    #[cfg(target_arch = "x86_64")]
    vectorized: bool,
}

impl Condensation {
    pub(super) fn new(degree: usize, n: usize, scalars: usize, signs: Vec<f64>) -> Self {
        Self {
            gauss: Gauss::new(degree),
            n,
            scalars,
            signs,
            intervals: 0,
            derivatives: Vec::new(),
            gradients: Vec::new(),
            corner: Vec::new(),
            padded: (degree * n).next_multiple_of(lu::BLOCK),
            column: vec![0.0; (degree * n).next_multiple_of(lu::BLOCK)],
            factors: Vec::new(),
            pivots: Vec::new(),
            response: Vec::new(),
            transfer: Vec::new(),
            scalar_columns: Vec::new(),
            rows: Vec::new(),
            states: Vec::new(),
            cyclic: Cyclic::default(),
            #[cfg(target_arch = "x86_64")]
            vectorized: is_x86_feature_detected!("avx2") && is_x86_feature_detected!("fma"),
        }
    }

    /// Makes room for a mesh of `intervals` intervals and clears what is summed up.
    pub(super) fn prepare(&mut self, intervals: usize) {
        let (n, e, degree) = (self.n, self.scalars, self.gauss.degree());
        let inner = degree * n;
        self.intervals = intervals;
        self.derivatives.resize(intervals * inner * (n + e), 0.0);
        self.gradients.resize(e * intervals * (inner + n), 0.0);
        self.corner.clear();
        self.corner.resize(e * e, 0.0);
        self.factors.resize(intervals * self.padded * self.padded, 0.0);
        self.pivots.resize(intervals * self.padded, 0);
        self.response.resize(intervals * self.padded * (n + e), 0.0);
        self.transfer.resize(intervals * n * n, 0.0);
        self.scalar_columns.resize(intervals * n * e, 0.0);
        self.rows.resize(e * intervals * n, 0.0);
        self.states.resize(intervals * n, 0.0);
    }

    /// The condensed blocks `R_j`.
    pub(super) fn transfer(&self) -> &[f64] {
        &self.transfer
    }

    /// Interior values of the linearised flow that starts with `start` at the left end of an interval.
    pub(super) fn interior_response(&self, interval: usize, start: &[f64], interior: &mut [f64]) {
        let response = &self.response[interval * self.padded * (self.n + self.scalars)..];
        interior.fill(0.0);
        for (column, factor) in response.chunks_exact(self.padded).zip(start) {
            for (entry, value) in interior.iter_mut().zip(column) {
                *entry += factor * value;
            }
        }
    }

    /// Factorises; as [`Collocation::factorize`](super::Collocation::factorize).
    pub(super) fn factorize(&mut self, mesh: &[f64]) -> f64 {
        #[cfg(target_arch = "x86_64")]
        if self.vectorized {
            // SAFETY: the processor has these instructions.
            return unsafe { self.factorize_vectorized(mesh) };
        }
        self.factorize_kernel::<false>(mesh)
    }

    #[cfg(target_arch = "x86_64")]
    #[target_feature(enable = "avx2,fma")]
    fn factorize_vectorized(&mut self, mesh: &[f64]) -> f64 {
        self.factorize_kernel::<true>(mesh)
    }

    #[inline(always)]
    fn factorize_kernel<const FUSED: bool>(&mut self, mesh: &[f64]) -> f64 {
        for (interval, pair) in mesh.windows(2).enumerate() {
            if !self.condense::<FUSED>(interval, pair[1] - pair[0]) {
                return 0.0;
            }
        }
        self.reduce_rows();
        let blocks = Blocks {
            transfer: &self.transfer,
            scalar_columns: &self.scalar_columns,
            rows: &self.rows,
            corner: &self.corner,
            signs: &self.signs,
        };
        self.cyclic.factorize(blocks, self.n, self.scalars, self.intervals)
    }

    /// Factorises the interior system of an interval and forms its response and transfer blocks.
    #[inline(always)]
    fn condense<const FUSED: bool>(&mut self, interval: usize, width: f64) -> bool {
        let n = self.n;
        let e = self.scalars;
        let degree = self.gauss.degree();
        let inner = degree * n;
        let columns = n + e;
        let derivatives = &self.derivatives[interval * inner * columns..(interval + 1) * inner * columns];
        let padded = self.padded;
        let matrix = &mut self.factors[interval * padded * padded..(interval + 1) * padded * padded];
        // Column (k, c) of the interior system: unit vector minus width a_ik df/dy_c at Gauss point k.
        for k in 0..degree {
            for component in 0..n {
                let slope = &derivatives[(k * columns + component) * n..][..n];
                let target = &mut matrix[(k * n + component) * padded..][..padded];
                target[inner..].fill(0.0);
                for (i, block) in target[..inner].chunks_exact_mut(n).enumerate() {
                    let factor = -width * self.gauss.integration[i * degree + k];
                    for (entry, value) in block.iter_mut().zip(slope) {
                        *entry = factor * value;
                    }
                }
                target[k * n + component] += 1.0;
            }
        }
        for column in inner..padded {
            let target = &mut matrix[column * padded..(column + 1) * padded];
            target.fill(0.0);
            target[column] = 1.0;
        }
        let response = &mut self.response[interval * padded * columns..(interval + 1) * padded * columns];
        response.fill(0.0);
        for component in 0..n {
            for point in 0..degree {
                response[component * padded + point * n + component] = 1.0;
            }
        }
        for scalar in 0..e {
            let target = &mut response[(n + scalar) * padded..][..inner];
            for k in 0..degree {
                let slope = &derivatives[(k * columns + n + scalar) * n..][..n];
                for (i, block) in target.chunks_exact_mut(n).enumerate() {
                    let factor = width * self.gauss.integration[i * degree + k];
                    for (entry, value) in block.iter_mut().zip(slope) {
                        *entry += factor * value;
                    }
                }
            }
        }
        let pivots = &mut self.pivots[interval * padded..(interval + 1) * padded];
        if lu::factorize_with::<FUSED>(matrix, padded, pivots) == 0.0 {
            return false;
        }
        lu::solve_with::<FUSED>(matrix, padded, pivots, response);
        for (column, interior) in response.chunks_exact(padded).enumerate() {
            let interior = &interior[..inner];
            let target = if column < n {
                &mut self.transfer[(interval * n + column) * n..][..n]
            } else {
                &mut self.scalar_columns[(interval * e + column - n) * n..][..n]
            };
            target.fill(0.0);
            if column < n {
                target[column] = self.gauss.end[0];
            }
            for (block, weight) in interior.chunks_exact(n).zip(&self.gauss.end[1..]) {
                for (entry, value) in target.iter_mut().zip(block) {
                    *entry += weight * value;
                }
            }
        }
        true
    }

    /// Expresses the dense rows by the left ends and the scalars.
    #[inline(always)]
    fn reduce_rows(&mut self) {
        let n = self.n;
        let e = self.scalars;
        let size = (self.gauss.degree() + 1) * n;
        let intervals = self.intervals;
        for row in 0..e {
            for interval in 0..intervals {
                let gradient = &self.gradients[(row * intervals + interval) * size..][..size];
                let response =
                    &self.response[interval * self.padded * (n + e)..(interval + 1) * self.padded * (n + e)];
                for (column, interior) in response.chunks_exact(self.padded).enumerate() {
                    let sum: f64 = gradient[n..].iter().zip(interior).map(|(a, b)| a * b).sum();
                    if column < n {
                        self.rows[(row * intervals + interval) * n + column] = gradient[column] + sum;
                    } else {
                        self.corner[row * e + column - n] += sum;
                    }
                }
            }
        }
    }

    /// Solves with the last factorisation, in place; the last entry belongs to the border.
    pub(super) fn solve(&mut self, right_hand_side: &mut [f64]) {
        #[cfg(target_arch = "x86_64")]
        if self.vectorized {
            // SAFETY: the processor has these instructions.
            return unsafe { self.solve_vectorized(right_hand_side) };
        }
        self.solve_kernel::<false>(right_hand_side);
    }

    #[cfg(target_arch = "x86_64")]
    #[target_feature(enable = "avx2,fma")]
    fn solve_vectorized(&mut self, right_hand_side: &mut [f64]) {
        self.solve_kernel::<true>(right_hand_side);
    }

    #[inline(always)]
    fn solve_kernel<const FUSED: bool>(&mut self, right_hand_side: &mut [f64]) {
        let n = self.n;
        let e = self.scalars;
        let inner = self.gauss.degree() * n;
        let size = (self.gauss.degree() + 1) * n;
        let (intervals, padded) = (self.intervals, self.padded);
        let (blocks, scalars) = right_hand_side.split_at_mut(intervals * size);
        for (interval, block) in blocks.chunks_exact_mut(size).enumerate() {
            let (end, interior) = block.split_at_mut(n);
            let factors = &self.factors[interval * padded * padded..(interval + 1) * padded * padded];
            let pivots = &self.pivots[interval * padded..(interval + 1) * padded];
            self.column[..inner].copy_from_slice(interior);
            self.column[inner..].fill(0.0);
            lu::solve_with::<FUSED>(factors, padded, pivots, &mut self.column);
            interior.copy_from_slice(&self.column[..inner]);
            let target = &mut self.states[interval * n..(interval + 1) * n];
            target.copy_from_slice(end);
            for (values, weight) in interior.chunks_exact(n).zip(&self.gauss.end[1..]) {
                for (entry, value) in target.iter_mut().zip(values) {
                    *entry += weight * value;
                }
            }
            for (row, scalar) in scalars.iter_mut().enumerate() {
                let gradient = &self.gradients[(row * intervals + interval) * size..][..size];
                *scalar -= gradient[n..].iter().zip(interior.iter()).map(|(a, b)| a * b).sum::<f64>();
            }
        }
        self.cyclic.solve(&mut self.states, scalars);
        for (interval, block) in blocks.chunks_exact_mut(size).enumerate() {
            let start = &self.states[interval * n..(interval + 1) * n];
            let (end, interior) = block.split_at_mut(n);
            end.copy_from_slice(start);
            let response = &self.response[interval * padded * (n + e)..(interval + 1) * padded * (n + e)];
            let coefficients = start.iter().chain(scalars.iter());
            for (column, coefficient) in response.chunks_exact(padded).zip(coefficients) {
                for (entry, value) in interior.iter_mut().zip(column) {
                    *entry += coefficient * value;
                }
            }
        }
    }
}
