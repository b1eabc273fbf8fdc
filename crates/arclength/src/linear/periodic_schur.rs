//! Floquet multipliers: eigenvalues of a product of matrices without forming the product.
//!
//! The product `R_N ... R_2 R_1` of transition matrices mixes multipliers of very different size, and the
//! small ones drown in the rounding errors of the large ones. Here orthogonal transformations at every factor
//! bring all factors to triangular form at once: periodic Hessenberg reduction and implicit double-shift
//! periodic QR iteration (Bojanczyk, Golub and Van Dooren 1992; Lust 2001; Kressner 2005). Each multiplier is
//! then a product of diagonal entries.
//!
//! The Hessenberg factor is not one of the given factors but an identity matrix put in front of them. It
//! stays orthogonal throughout, so an entry below its diagonal is negligible when it is small against one,
//! and every given factor becomes triangular, so that a singular factor shows as a zero on its diagonal.

use num_complex::Complex64;

use super::balancing::{largest_exponent, power_of_two, scale};
use super::eigenvalues::{EigenvalueError, check};
use super::multiplier::Multiplier;
use super::periodic_block::{self, Block};
use super::periodic_sweep::{deflate_zero, double_shift_sweep};
use super::reflector::householder;
use super::wide_range::WideRange;

/// Sweeps allowed for one window before it is given up.
const MAXIMUM_SWEEPS: usize = 300;
/// After this many sweeps an entry counts as negligible when it is as small as the rounding errors of all factors together: in
/// a cluster of equal multipliers it gets no smaller.
const PATIENCE: usize = 30;
/// Where that does not suffice, because every sweep adds its own rounding errors, as many sweeps later it may be so many times larger: the
/// multipliers are those of factors that differ by it.
const INDULGENCE: usize = 4;
/// Rounding errors grow where columns are nearly dependent, and a factor passes for singular below what they
/// may have grown to, but not by more than this: the backward error of the decision stays below about 1e-13.
const LARGEST_AMPLIFICATION: f64 = 256.0;

/// Eigenvalues of the product `R_count ... R_2 R_1` of n-by-n matrices, by descending modulus.
///
/// `factors` holds `R_1`, `R_2`, ... one after the other, each column-major. Complex multipliers come in
/// conjugate pairs, the one with negative argument first. A multiplier is exactly zero when a factor is
/// singular to rounding. For repeated use see [`PeriodicSchur`].
///
/// # Errors
/// [`EigenvalueError`] when the shape is wrong, an entry is not finite, or the iteration does not converge.
///
/// # Examples
/// ```
/// use arclength::linear::periodic_schur::multipliers;
/// // A thousand times diag(0.1, 10): the product has the multipliers 1e1000 and 1e-1000.
/// let factors = [0.1, 0.0, 0.0, 10.0].repeat(1000);
/// let multipliers = multipliers(&factors, 2, 1000)?;
/// assert!((multipliers[0].log_modulus - 1000.0 * 10f64.ln()).abs() < 1e-9);
/// assert!((multipliers[1].log_modulus + 1000.0 * 10f64.ln()).abs() < 1e-9);
/// # Ok::<(), arclength::linear::eigenvalues::EigenvalueError>(())
/// ```
pub fn multipliers(factors: &[f64], n: usize, count: usize) -> Result<Vec<Multiplier>, EigenvalueError> {
    let mut workspace = PeriodicSchur::new(n, count);
    workspace.multipliers(factors)?;
    Ok(workspace.multipliers)
}

/// Memory for the multipliers of products of `count` n-by-n matrices, so that repeated computations allocate
/// nothing.
#[derive(Clone, Debug)]
pub struct PeriodicSchur {
    n: usize,
    count: usize,
    /// The orthogonal Hessenberg factor, then `R_count`, ..., `R_1`: the product from left to right.
    factors: Vec<f64>,
    /// Bound of the rounding errors in the rows of each factor, in units of the rounding unit.
    noise: Vec<f64>,
    /// The largest entry in each row of each factor as given.
    row_sizes: Vec<f64>,
    /// How far nearly dependent columns of each factor amplify the noise.
    amplification: Vec<f64>,
    magnitudes: Vec<f64>,
    scales: Vec<f64>,
    reflector: Vec<f64>,
    sums: Vec<f64>,
    rotations: Vec<(f64, f64)>,
    blocks: Vec<Block>,
    multipliers: Vec<Multiplier>,
}

impl PeriodicSchur {
    /// Memory for `count` factors of n rows and columns.
    pub fn new(n: usize, count: usize) -> Self {
        PeriodicSchur {
            n,
            count,
            factors: vec![0.0; (count + 1) * n * n],
            noise: vec![0.0; (count + 1) * n],
            row_sizes: vec![0.0; (count + 1) * n],
            amplification: vec![1.0; count + 1],
            magnitudes: vec![0.0; n * n],
            scales: vec![1.0; n],
            reflector: vec![0.0; n],
            sums: vec![0.0; n],
            rotations: vec![(1.0, 0.0); n],
            blocks: vec![Block::ZERO; count + 1],
            multipliers: vec![Multiplier::ZERO; n],
        }
    }

    /// As the function [`multipliers`], without allocating.
    ///
    /// # Errors
    /// As [`multipliers`].
    pub fn multipliers(&mut self, factors: &[f64]) -> Result<&[Multiplier], EigenvalueError> {
        check(factors, self.n, self.count)?;
        if self.n > 0 {
            let exponent = self.load(factors);
            self.reduce();
            self.iterate(exponent)?;
        }
        self.multipliers.sort_unstable_by(|a, b| {
            let by_argument = a.argument.abs().total_cmp(&b.argument.abs());
            let by_modulus = b.log_modulus.total_cmp(&a.log_modulus);
            by_modulus.then(by_argument).then(a.argument.total_cmp(&b.argument))
        });
        Ok(&self.multipliers)
    }

    /// Copies the factors, balanced in common and each scaled to order one; returns the exponent taken out.
    fn load(&mut self, given: &[f64]) -> i64 {
        let n = self.n;
        let (identity, factors) = self.factors.split_at_mut(n * n);
        identity.fill(0.0);
        identity.iter_mut().step_by(n + 1).for_each(|x| *x = 1.0);
        let mut total = common_scales(given, n, &mut self.magnitudes, &mut self.scales);
        let scaled = self.scales.iter().any(|scale| *scale != 1.0);
        for (factor, given) in factors.chunks_exact_mut(n * n).rev().zip(given.chunks_exact(n * n)) {
            let (a, b) = power_of_two(-largest_exponent(given).unwrap_or(0));
            factor.iter_mut().zip(given).for_each(|(x, y)| *x = y * a * b);
            if scaled {
                total += scale_factor(factor, n, &self.scales);
            }
        }
        total
    }

    /// Reduces the given factors to triangular form and the one in front to Hessenberg form.
    fn reduce(&mut self) {
        let (n, size) = (self.n, self.n * self.n);
        self.noise.fill(0.0);
        self.amplification.fill(1.0);
        self.row_sizes.fill(0.0);
        for (factor, row_sizes) in self.factors.chunks_exact(size).zip(self.row_sizes.chunks_exact_mut(n)) {
            for column in factor.chunks_exact(n) {
                row_sizes.iter_mut().zip(column).for_each(|(size, x)| *size = size.max(x.abs()));
            }
        }
        for k in 0..n {
            for i in (1..=self.count).rev() {
                let (before, factor) = self.factors.split_at_mut(size * i);
                let factor = &mut factor[..size];
                let (noise_before, noise) = self.noise.split_at_mut(n * i);
                let column = &mut factor[n * k + k..n * k + n];
                let margin = f64::EPSILON * self.amplification[i];
                let negligible = |x: &f64, noise: &f64| x.abs() <= margin * noise;
                if column.iter().zip(&noise[k..n]).all(|(x, noise)| negligible(x, noise)) {
                    // Singular. What else is noise in these rows must not pass for rank.
                    for column in factor.chunks_exact_mut(n).skip(k) {
                        for (x, noise) in column[k..].iter_mut().zip(&noise[k..n]) {
                            *x = if negligible(x, noise) { 0.0 } else { *x };
                        }
                    }
                    continue;
                }
                let reflector = &mut self.reflector[..n - k];
                let tau = take_reflector(column, reflector);
                if tau == 0.0 {
                    continue;
                }
                let largest = apply_left(factor, n, k, k + 1, reflector, tau);
                let row_sizes = &self.row_sizes[n * i + k..];
                for ((noise, v), row_size) in noise[k..n].iter_mut().zip(&*reflector).zip(row_sizes) {
                    *noise += if *v == 0.0 { 0.0 } else { row_size + largest * v.abs() };
                }
                // A short column leaves the direction of the reflector uncertain.
                let uncertainty = (largest + noise[k]) / factor[k + n * k].abs();
                let amplification = &mut self.amplification[i];
                *amplification = (*amplification * (1.0 + uncertainty)).min(LARGEST_AMPLIFICATION);
                apply_right(&mut before[size * (i - 1)..], n, k, reflector, tau, &mut self.sums);
                add_noise(&mut noise_before[n * (i - 1)..], &self.sums, &self.row_sizes[n * (i - 1)..]);
            }
            if k + 2 < n {
                let first = &mut self.factors[..size];
                let reflector = &mut self.reflector[..n - k - 1];
                let tau = take_reflector(&mut first[n * k + k + 1..n * k + n], reflector);
                if tau != 0.0 {
                    apply_left(first, n, k + 1, k + 1, reflector, tau);
                    let last = &mut self.factors[size * self.count..];
                    apply_right(last, n, k + 1, reflector, tau, &mut self.sums);
                    let at = n * self.count;
                    add_noise(&mut self.noise[at..], &self.sums, &self.row_sizes[at..]);
                }
            }
        }
    }

    /// Periodic QR iteration from the last row upwards; writes the multipliers.
    fn iterate(&mut self, exponent: i64) -> Result<(), EigenvalueError> {
        let n = self.n;
        let mut end = n;
        while end > 0 {
            let last = end - 1;
            let mut sweeps = 0;
            let first = loop {
                let first = self.window_start(last, sweeps);
                if first == last {
                    break first;
                }
                if let Some((factor, zero)) = self.zero_on_diagonal(first, last) {
                    deflate_zero(&mut self.factors, n, first, last, factor, zero, &mut self.rotations);
                    continue;
                }
                if first + 1 == last {
                    break first;
                }
                if sweeps == MAXIMUM_SWEEPS {
                    return Err(EigenvalueError::NotConverged { first, last, sweeps });
                }
                sweeps += 1;
                double_shift_sweep(&mut self.factors, n, first, last, sweeps);
            };
            if first == last {
                let mut product = WideRange::new(1.0);
                for factor in self.factors.chunks_exact(n * n) {
                    product = product * factor[last + n * last];
                }
                let (significand, own) = product.split();
                let complex = WideRange::new(Complex64::from(significand));
                self.multipliers[last] = Multiplier::of(complex, own + exponent);
            } else {
                for (block, factor) in self.blocks.iter_mut().zip(self.factors.chunks_exact(n * n)) {
                    let at = |row: usize, column: usize| Complex64::from(factor[row + n * column]);
                    let (a, d) = (at(first, first), at(last, last));
                    *block = Block { a, b: at(first, last), c: at(last, first), d };
                }
                let sweeps = periodic_block::MAXIMUM_SWEEPS;
                let pair = periodic_block::multipliers(&mut self.blocks, exponent)
                    .ok_or(EigenvalueError::NotConverged { first, last, sweeps })?;
                [self.multipliers[first], self.multipliers[last]] = pair;
            }
            end = first;
        }
        Ok(())
    }

    /// First row of the window that ends in row `last`: the entry left of it is negligible, and made zero.
    fn window_start(&mut self, last: usize, sweeps: usize) -> usize {
        let n = self.n;
        let errors = match (sweeps / PATIENCE) as u32 {
            0 => 1,
            times => n * (self.count + 1) * INDULGENCE.pow(times - 1),
        };
        let negligible = errors as f64 * f64::EPSILON;
        let hessenberg = &mut self.factors[..n * n];
        for k in (1..=last).rev() {
            let neighbours = hessenberg[(n + 1) * (k - 1)].abs() + hessenberg[(n + 1) * k].abs();
            if hessenberg[k + n * (k - 1)].abs() <= negligible * neighbours {
                hessenberg[k + n * (k - 1)] = 0.0;
                return k;
            }
        }
        0
    }

    /// A factor and a row in `first..=last` where its diagonal is zero.
    fn zero_on_diagonal(&self, first: usize, last: usize) -> Option<(usize, usize)> {
        let n = self.n;
        self.factors
            .chunks_exact(n * n)
            .enumerate()
            .skip(1)
            .find_map(|(i, factor)| (first..=last).find(|k| factor[(n + 1) * k] == 0.0).map(|k| (i, k)))
    }
}

/// Finds the diagonal scaling, by powers of two, that balances the sum of the moduli of the factors, each
/// scaled to order one; returns the exponent that these scalings take out.
///
/// The coordinates have the same units at every factor, so one scaling serves all.
pub(super) fn common_scales(given: &[f64], n: usize, magnitudes: &mut [f64], scales: &mut [f64]) -> i64 {
    let mut total = 0;
    magnitudes.fill(0.0);
    for given in given.chunks_exact(n * n) {
        let Some(exponent) = largest_exponent(given) else { continue };
        total += i64::from(exponent);
        let (a, b) = power_of_two(-exponent);
        magnitudes.iter_mut().zip(given).for_each(|(sum, x)| *sum += x.abs() * a * b);
    }
    scale(magnitudes, n, 0, n, scales);
    total
}

/// Replaces `R` by `D^-1 R D 2^-e` of order one and returns `e`.
pub(super) fn scale_factor(factor: &mut [f64], n: usize, scales: &[f64]) -> i64 {
    for (column, scale) in factor.chunks_exact_mut(n).zip(scales) {
        column.iter_mut().zip(scales).for_each(|(x, row_scale)| *x *= scale / row_scale);
    }
    let exponent = largest_exponent(factor).unwrap_or(0);
    let (a, b) = power_of_two(-exponent);
    factor.iter_mut().for_each(|x| *x = *x * a * b);
    i64::from(exponent)
}

/// Adds the rounding errors of a reflector applied from the right: rows that it leaves alone gain none.
fn add_noise(noise: &mut [f64], sums: &[f64], row_sizes: &[f64]) {
    for ((noise, sum), row_size) in noise.iter_mut().zip(sums).zip(row_sizes) {
        *noise += if *sum == 0.0 { 0.0 } else { row_size + sum.abs() };
    }
}

/// Annihilates all of `column` but its first entry; writes the vector to `reflector` and returns `tau`.
fn take_reflector(column: &mut [f64], reflector: &mut [f64]) -> f64 {
    let tau = householder(column);
    if tau != 0.0 {
        reflector.copy_from_slice(column);
        reflector[0] = 1.0;
        column[1..].fill(0.0);
    }
    tau
}

/// Applies a reflector of rows `row..` to the columns from `column` on; returns the largest `tau v^T a`.
fn apply_left(matrix: &mut [f64], n: usize, row: usize, column: usize, reflector: &[f64], tau: f64) -> f64 {
    let mut largest = 0.0_f64;
    for column in matrix.chunks_exact_mut(n).skip(column) {
        let rows = &mut column[row..];
        let sum: f64 = tau * rows.iter().zip(reflector).map(|(x, v)| x * v).sum::<f64>();
        rows.iter_mut().zip(reflector).for_each(|(x, v)| *x -= sum * v);
        largest = largest.max(sum.abs());
    }
    largest
}

/// Applies a reflector of columns `column..` to all rows; leaves `tau A v` in `sums`.
fn apply_right(matrix: &mut [f64], n: usize, column: usize, reflector: &[f64], tau: f64, sums: &mut [f64]) {
    sums.fill(0.0);
    for (column, v) in matrix.chunks_exact(n).skip(column).zip(reflector) {
        sums.iter_mut().zip(column).for_each(|(sum, x)| *sum += x * v);
    }
    sums.iter_mut().for_each(|sum| *sum *= tau);
    for (column, v) in matrix.chunks_exact_mut(n).skip(column).zip(reflector) {
        column.iter_mut().zip(&*sums).for_each(|(x, sum)| *x -= sum * v);
    }
}
