//! Eigenvectors of a product of matrices by inverse iteration on the cyclic system, not on the product.
//!
//! With `P = R_N ... R_1` and `P z_0 = mu z_0` the vectors `z_j = R_j z_(j-1)` solve a block bidiagonal
//! system with a corner. It is condensed to `z_0` by Householder reflectors, which stay stable where the
//! product mixes growing and decaying directions (Wright 1992; Lust 2001). Each equation is scaled by its
//! share of the multiplier, so that modulus 1e-300 is as good as one.

use num_complex::Complex64;
use std::f64::consts::LN_2;

use super::balancing::{largest_exponent, power_of_two};
use super::complex_lu::ComplexLu;
use super::eigenvalues::{EigenvalueError, check};
use super::eigenvectors::{fix_phase, inverse_iteration, normalize};
use super::multiplier::Multiplier;
use super::periodic_schur::{common_scales, scale_factor};
use super::wide_range::WideRange;

/// Logarithm of the largest share of the multiplier in one equation. No multiplier of factors of order one
/// comes near it; a number that is no multiplier then shows in the residual instead of overflowing.
const LARGEST_SHARE: f64 = 200.0;

/// An eigenvector of a product of `count` matrices, followed through the factors.
#[derive(Clone, Debug, PartialEq)]
pub struct ProductEigenvector {
    /// `z_0`, `z_1`, ..., one after the other, `count` times `n` numbers; `z_0` has norm one and its largest
    /// component is real and positive. Vectors outside the range of `f64` are zero or infinite.
    pub vectors: Vec<Complex64>,
    /// Largest residual of an equation of the cyclic system, scaled to factors and vectors of order one.
    pub residual: f64,
}

/// The vectors with `R_1 z_0 = z_1`, `R_2 z_1 = z_2`, ..., `R_count z_(count-1) = mu z_0` for a simple
/// multiplier `mu`.
///
/// `factors` holds `R_1`, `R_2`, ... one after the other, each n-by-n and column-major. The multiplier should
/// be accurate to rounding, as from [`multipliers`](super::periodic_schur::multipliers); one that is none
/// shows in the residual. For a real multiplier the vectors are exactly real.
///
/// # Errors
/// [`EigenvalueError`] when the shape is wrong or a number is not finite.
///
/// # Examples
/// ```
/// use arclength::linear::product_eigenvectors::product_eigenvector;
/// // diag(2, 1) and then diag(3, 1): multiplier 6 belongs to the first coordinate.
/// let factors = [2.0, 0.0, 0.0, 1.0, 3.0, 0.0, 0.0, 1.0];
/// let z = product_eigenvector(&factors, 2, 2, 6.0)?.vectors;
/// assert!((z[0].re - 1.0).abs() < 1e-15 && (z[2].re - 2.0).abs() < 1e-14);
/// # Ok::<(), arclength::linear::eigenvalues::EigenvalueError>(())
/// ```
pub fn product_eigenvector(
    factors: &[f64],
    n: usize,
    count: usize,
    multiplier: impl Into<Multiplier>,
) -> Result<ProductEigenvector, EigenvalueError> {
    check(factors, n, count)?;
    let multiplier = multiplier.into();
    let log_modulus = multiplier.log_modulus;
    if log_modulus.is_nan() || log_modulus == f64::INFINITY || !multiplier.argument.is_finite() {
        let Complex64 { re, im } = multiplier.to_complex();
        return Err(EigenvalueError::EigenvalueNotFinite { re, im });
    }
    if n == 0 || count == 0 {
        return Ok(ProductEigenvector { vectors: Vec::new(), residual: 0.0 });
    }
    let (system, scales, exponents) = CyclicSystem::new(factors, n, count, multiplier);
    let condensed = system.condense();

    let solve = |iterate: &mut [Complex64]| condensed.solve(iterate);
    let (mut vectors, residual) = inverse_iteration(n * count, solve, |iterate| system.residual(iterate));
    for vector in vectors.chunks_exact_mut(n) {
        vector.iter_mut().zip(&scales).for_each(|(x, scale)| *x *= scale);
    }
    system.follow(&mut vectors, &exponents);
    Ok(ProductEigenvector { vectors, residual })
}

/// The left eigenvectors: `w_0^H R_count ... R_1 = mu w_0^H`, with `w_j` belonging to the same place as
/// `z_j`.
///
/// The vectors run backwards: `R_count^T w_0 = w_(count-1)`, then `R_j^T w_j = w_(j-1)` down to `w_1`, and
/// `R_1^T w_1 = conj(mu) w_0`. So `<w_j, z_j>` is the same for all `j` but zero, where it is smaller by the
/// factor `mu`.
///
/// # Errors
/// As [`product_eigenvector`].
pub fn product_left_eigenvector(
    factors: &[f64],
    n: usize,
    count: usize,
    multiplier: impl Into<Multiplier>,
) -> Result<ProductEigenvector, EigenvalueError> {
    check(factors, n, count)?;
    let size = n * n;
    let mut adjoint = Vec::with_capacity(factors.len());
    if n > 0 {
        for factor in factors.chunks_exact(size).rev() {
            adjoint.extend((0..size).map(|k| factor[k / n + n * (k % n)]));
        }
    }
    let mut found = product_eigenvector(&adjoint, n, count, multiplier.into().conj())?;
    // The adjoint runs backwards from the end of the period: put its vectors in the order of the factors.
    if n > 0 && count > 0 {
        let reversed: Vec<Complex64> =
            found.vectors.chunks_exact(n).skip(1).rev().flatten().copied().collect();
        found.vectors.truncate(n);
        found.vectors.extend(reversed);
    }
    Ok(found)
}

/// `R_j z_j - shift_j z_(j+1) = 0` with `z_count = z_0` and factors of order one (numbered from zero).
struct CyclicSystem {
    n: usize,
    factors: Vec<f64>,
    shifts: Vec<Complex64>,
}

impl CyclicSystem {
    /// The system, the common balancing of the coordinates and the exponent taken out of each factor.
    fn new(factors: &[f64], n: usize, count: usize, multiplier: Multiplier) -> (Self, Vec<f64>, Vec<i64>) {
        let mut scales = vec![1.0; n];
        common_scales(factors, n, &mut vec![0.0; n * n], &mut scales);
        let mut balanced = factors.to_vec();
        let mut exponents = Vec::with_capacity(count);
        for factor in balanced.chunks_exact_mut(n * n) {
            let exponent = largest_exponent(factor).unwrap_or(0);
            let (a, b) = power_of_two(-exponent);
            factor.iter_mut().for_each(|x| *x = *x * a * b);
            exponents.push(i64::from(exponent) + scale_factor(factor, n, &scales));
        }
        // Equal shares of the modulus; the argument goes to the last equation, so that a real multiplier
        // stays real.
        let total: i64 = exponents.iter().sum();
        let mut shifts = vec![Complex64::ONE; count];
        if multiplier.log_modulus > f64::NEG_INFINITY {
            let share = (multiplier.log_modulus - total as f64 * LN_2) / count as f64;
            shifts.fill(share.min(LARGEST_SHARE).exp().into());
        }
        if let Some(last) = shifts.last_mut() {
            *last = if multiplier.log_modulus == f64::NEG_INFINITY {
                Complex64::ZERO
            } else {
                *last * Multiplier { log_modulus: 0.0, ..multiplier }.to_complex()
            };
        }
        (CyclicSystem { n, factors: balanced, shifts }, scales, exponents)
    }

    /// Largest residual of a block equation.
    fn residual(&self, vectors: &[Complex64]) -> f64 {
        let n = self.n;
        let count = self.shifts.len();
        let mut largest = 0.0_f64;
        for (j, (factor, shift)) in self.factors.chunks_exact(n * n).zip(&self.shifts).enumerate() {
            let (here, there) = (&vectors[n * j..], &vectors[n * ((j + 1) % count)..]);
            let mut square = 0.0;
            for row in 0..n {
                let image: Complex64 = (0..n).map(|column| here[column] * factor[row + n * column]).sum();
                square += (image - shift * there[row]).norm_sqr();
            }
            largest = largest.max(square.sqrt() / (1.0 + shift.norm()));
        }
        largest
    }

    /// Normalises by `z_0` and undoes the scaling of the equations: `z_(j+1)` gains the share of the first
    /// `j` ones.
    fn follow(&self, vectors: &mut [Complex64], exponents: &[i64]) {
        let n = self.n;
        let (start, rest) = vectors.split_at_mut(n);
        let largest = start.iter().fold(f64::MIN_POSITIVE, |m, x| m.max(x.norm()));
        let norm = largest * start.iter().map(|x| (x / largest).norm_sqr()).sum::<f64>().sqrt();
        let turn = fix_phase(start);
        let mut gain = WideRange::new(turn) / WideRange::new(norm.into());
        normalize(start);
        for (j, vector) in rest.chunks_exact_mut(n).enumerate() {
            gain = gain * self.shifts[j] * WideRange::power_of_two(exponents[j]);
            vector.iter_mut().for_each(|x| *x = (gain * *x).to_complex());
        }
    }

    /// Eliminates `z_1`, ..., `z_(count-1)` by Householder reflectors.
    fn condense(&self) -> Condensed {
        let n = self.n;
        let size = n * n;
        let count = self.shifts.len();
        let mut steps = Vec::with_capacity(count - 1);
        // The remaining equations between `z_0` and `z_j`: start z_0 + end z_j = ...
        let mut start: Vec<Complex64> = self.factors[..size].iter().map(|x| Complex64::from(*x)).collect();
        let mut end = vec![Complex64::ZERO; size];
        end.iter_mut().step_by(n + 1).for_each(|x| *x = -self.shifts[0]);
        for j in 1..count {
            let mut step =
                Step::new(n, &start, &end, &self.factors[size * j..size * (j + 1)], self.shifts[j]);
            step.triangularize();
            // The lower block row holds what remains.
            let (of_start, of_end) = step.columns[2 * size..].split_at(2 * size);
            for (remaining, columns) in [(&mut start, of_start), (&mut end, of_end)] {
                for (remaining, column) in remaining.chunks_exact_mut(n).zip(columns.chunks_exact(2 * n)) {
                    remaining.copy_from_slice(&column[n..]);
                }
            }
            steps.push(step);
        }
        start.iter_mut().zip(&end).for_each(|(x, y)| *x += y);
        let largest = end.iter().fold(1.0_f64, |m, x| m.max(x.norm()));
        Condensed { n, steps, last: ComplexLu::of(n, start, f64::EPSILON * largest) }
    }
}

/// The elimination of one `z_j` from two block rows: columns of `z_j`, of `z_0` and of `z_(j+1)`, each `2 n`
/// long.
struct Step {
    n: usize,
    columns: Vec<Complex64>,
    taus: Vec<f64>,
    diagonal: Vec<Complex64>,
}

impl Step {
    fn new(n: usize, start: &[Complex64], end: &[Complex64], factor: &[f64], shift: Complex64) -> Self {
        let rows = 2 * n;
        let mut columns = vec![Complex64::ZERO; rows * 3 * n];
        for k in 0..n {
            for row in 0..n {
                columns[row + rows * k] = end[row + n * k];
                columns[n + row + rows * k] = factor[row + n * k].into();
                columns[row + rows * (n + k)] = start[row + n * k];
            }
            columns[n + k + rows * (2 * n + k)] = -shift;
        }
        Step { n, columns, taus: vec![0.0; n], diagonal: vec![Complex64::ZERO; n] }
    }

    fn triangularize(&mut self) {
        let rows = 2 * self.n;
        for k in 0..self.n {
            let (left, right) = self.columns.split_at_mut(rows * (k + 1));
            let vector = &mut left[rows * k + k..];
            let norm = vector.iter().map(|x| x.norm_sqr()).sum::<f64>().sqrt();
            let size = vector[0].norm();
            let direction = if size == 0.0 { Complex64::ONE } else { vector[0] / size };
            self.diagonal[k] = -direction * norm;
            // I - tau v v^H with v = x + direction |x| e_1 maps x onto -direction |x| e_1.
            vector[0] += direction * norm;
            let square = 2.0 * norm * (norm + size);
            self.taus[k] = if square == 0.0 { 0.0 } else { 2.0 / square };
            for column in right.chunks_exact_mut(rows) {
                reflect(&mut column[k..], vector, self.taus[k]);
            }
        }
    }
}

/// Applies `I - tau v v^H`.
fn reflect(column: &mut [Complex64], vector: &[Complex64], tau: f64) {
    let sum: Complex64 = vector.iter().zip(&*column).map(|(v, x)| v.conj() * x).sum();
    let sum = sum * tau;
    column.iter_mut().zip(vector).for_each(|(x, v)| *x -= sum * v);
}

/// The condensed system, ready to be solved.
struct Condensed {
    n: usize,
    steps: Vec<Step>,
    last: ComplexLu,
}

impl Condensed {
    /// Solves in place: right-hand sides of the block equations become `z_0`, `z_1`, ...
    fn solve(&self, vectors: &mut [Complex64]) {
        let n = self.n;
        let mut pair = vec![Complex64::ZERO; 2 * n];
        pair[n..].copy_from_slice(&vectors[..n]);
        for (j, step) in self.steps.iter().enumerate() {
            pair.copy_within(n.., 0);
            pair[n..].copy_from_slice(&vectors[n * (j + 1)..n * (j + 2)]);
            for (k, tau) in step.taus.iter().enumerate() {
                reflect(&mut pair[k..], &step.columns[2 * n * k + k..2 * n * (k + 1)], *tau);
            }
            vectors[n * (j + 1)..n * (j + 2)].copy_from_slice(&pair[..n]);
        }
        let (start, rest) = vectors.split_at_mut(n);
        start.copy_from_slice(&pair[n..]);
        self.last.solve(start);
        let mut next = start.to_vec();
        for (step, vector) in self.steps.iter().zip(rest.chunks_exact_mut(n)).rev() {
            for column in 0..n {
                let of_start = &step.columns[2 * n * (n + column)..];
                let of_next = &step.columns[2 * n * (2 * n + column)..];
                for row in 0..n {
                    vector[row] -= of_start[row] * start[column] + of_next[row] * next[column];
                }
            }
            for k in (0..n).rev() {
                let diagonal = step.diagonal[k];
                let floor = Complex64::from(f64::EPSILON);
                vector[k] /= if diagonal.norm() < f64::EPSILON { floor } else { diagonal };
                let value = vector[k];
                let column = &step.columns[2 * n * k..];
                vector[..k].iter_mut().zip(column).for_each(|(x, entry)| *x -= entry * value);
            }
            next.copy_from_slice(vector);
        }
    }
}
