//! The exponential of a dense matrix, by scaling and squaring of the diagonal Padé approximant of degree 13.
//!
//! Source: Higham, "The scaling and squaring method for the matrix exponential revisited" (2005), algorithm 2.3 and table 2.3.

use super::lu;

/// Norm up to which the approximant is exact to rounding.
const LARGEST_NORM: f64 = 5.371_920_351_148_152;
/// Coefficients of the numerator, of ascending powers.
const COEFFICIENTS: [f64; 14] = [
    64_764_752_532_480_000.0,
    32_382_376_266_240_000.0,
    7_771_770_303_897_600.0,
    1_187_353_796_428_800.0,
    129_060_195_264_000.0,
    10_559_470_521_600.0,
    670_442_572_800.0,
    33_522_128_640.0,
    1_323_241_920.0,
    40_840_800.0,
    960_960.0,
    16_380.0,
    182.0,
    1.0,
];

/// Memory for exponentials of `n`-by-`n` matrices, column-major, so that repeated computations allocate nothing.
///
/// ```
/// use arclength::linear::exponential::Exponential;
/// // A quarter of a turn that shrinks to a half.
/// let (decay, turn) = (0.5f64.ln(), std::f64::consts::FRAC_PI_2);
/// let mut matrix = [decay, turn, -turn, decay];
/// assert!(Exponential::new(2).apply(&mut matrix));
/// let expected = [0.0, 0.5, -0.5, 0.0];
/// assert!(matrix.iter().zip(expected).all(|(entry, exact)| (entry - exact).abs() < 1e-15));
/// ```
#[derive(Clone, Debug)]
pub struct Exponential {
    n: usize,
    pivots: Vec<usize>,
    powers: [Vec<f64>; 3],
    odd: Vec<f64>,
    even: Vec<f64>,
    product: Vec<f64>,
}

impl Exponential {
    /// Memory for matrices with `n` rows.
    pub fn new(n: usize) -> Self {
        let square = || vec![0.0; n * n];
        Self {
            n,
            pivots: vec![0; n],
            powers: [square(), square(), square()],
            odd: square(),
            even: square(),
            product: square(),
        }
    }

    /// Replaces a matrix (`n * n` entries) by its exponential. `false`, with entries that mean nothing, where it is too large for
    /// numbers or not finite.
    pub fn apply(&mut self, matrix: &mut [f64]) -> bool {
        let n = self.n;
        let norm = matrix.chunks_exact(n).map(|column| column.iter().map(|entry| entry.abs()).sum::<f64>());
        let norm = norm.fold(0.0, f64::max);
        if !norm.is_finite() {
            return false;
        }
        let squarings = (norm / LARGEST_NORM).log2().ceil().max(0.0);
        matrix.iter_mut().for_each(|entry| *entry *= (-squarings).exp2());
        let [second, fourth, sixth] = &mut self.powers;
        multiply(matrix, matrix, second, n);
        multiply(second, second, fourth, n);
        multiply(fourth, second, sixth, n);
        // The approximant is (even + odd) / (even - odd).
        let part = |upper: [f64; 3], lower: [f64; 4], target: &mut [f64], scratch: &mut [f64]| {
            let combine = |[of_sixth, of_fourth, of_second]: [f64; 3], index: usize| {
                of_sixth * sixth[index] + of_fourth * fourth[index] + of_second * second[index]
            };
            (0..n * n).for_each(|index| scratch[index] = combine(upper, index));
            multiply(sixth, scratch, target, n);
            for (index, entry) in target.iter_mut().enumerate() {
                *entry += combine([lower[0], lower[1], lower[2]], index);
            }
            target.iter_mut().step_by(n + 1).for_each(|entry| *entry += lower[3]);
        };
        let c = &COEFFICIENTS;
        part([c[13], c[11], c[9]], [c[7], c[5], c[3], c[1]], &mut self.even, &mut self.product);
        multiply(matrix, &self.even, &mut self.odd, n);
        part([c[12], c[10], c[8]], [c[6], c[4], c[2], c[0]], &mut self.even, &mut self.product);
        for ((entry, odd), even) in matrix.iter_mut().zip(&self.odd).zip(&mut self.even) {
            *entry = *even + odd;
            *even -= odd;
        }
        if lu::factorize(&mut self.even, n, &mut self.pivots) == 0.0 {
            return false;
        }
        lu::solve(&self.even, n, &self.pivots, matrix);
        for _ in 0..squarings as usize {
            multiply(matrix, matrix, &mut self.product, n);
            matrix.copy_from_slice(&self.product);
        }
        matrix.iter().all(|entry| entry.is_finite())
    }
}

/// Writes the product of two matrices into a third.
pub(crate) fn multiply(left: &[f64], right: &[f64], product: &mut [f64], n: usize) {
    match n {
        2 => multiply_small::<2>(left, right, product),
        3 => multiply_small::<3>(left, right, product),
        4 => multiply_small::<4>(left, right, product),
        5 => multiply_small::<5>(left, right, product),
        6 => multiply_small::<6>(left, right, product),
        _ => {
            product.fill(0.0);
            for (target, column) in product.chunks_exact_mut(n).zip(right.chunks_exact(n)) {
                for (entries, factor) in left.chunks_exact(n).zip(column) {
                    target.iter_mut().zip(entries).for_each(|(entry, value)| *entry += value * factor);
                }
            }
        }
    }
}

/// The same with a number of rows that the compiler knows: for a few it takes a third of the time.
fn multiply_small<const N: usize>(left: &[f64], right: &[f64], product: &mut [f64]) {
    let (left, _) = left.as_chunks::<N>();
    let (right, _) = right.as_chunks::<N>();
    let (product, _) = product.as_chunks_mut::<N>();
    for (target, column) in product.iter_mut().zip(right) {
        let mut sum = [0.0; N];
        for (entries, factor) in left.iter().zip(column) {
            for (entry, value) in sum.iter_mut().zip(entries) {
                *entry += value * factor;
            }
        }
        *target = sum;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        /// Similar to a block diagonal matrix whose exponential is known in closed form.
        #[test]
        fn closed_forms(
            rates in prop::array::uniform2(-1e4..3.0),
            turn in -300.0..300.0,
            mixing in prop::array::uniform9(-0.3..0.3),
        ) {
            let [real, pair]: [f64; 2] = rates;
            let block = |diagonal: f64, off: f64, other: f64| {
                [diagonal, off, 0.0, -off, diagonal, 0.0, 0.0, 0.0, other]
            };
            let mut basis: Vec<f64> = mixing.to_vec();
            basis.iter_mut().step_by(4).for_each(|entry| *entry += 1.0);
            let conjugate = |matrix: [f64; 9]| {
                // basis * matrix / basis, from the transposed system.
                let mut product = vec![0.0; 9];
                multiply(&basis, &matrix, &mut product, 3);
                let transposed = |m: &[f64]| -> Vec<f64> { (0..9).map(|i| m[i % 3 * 3 + i / 3]).collect() };
                let (mut factors, mut right, mut pivots) = (transposed(&basis), transposed(&product), [0; 3]);
                lu::factorize(&mut factors, 3, &mut pivots);
                lu::solve(&factors, 3, &pivots, &mut right);
                transposed(&right)
            };
            let mut matrix = conjugate(block(pair, turn, real));
            prop_assert!(Exponential::new(3).apply(&mut matrix));
            let size = pair.exp();
            let expected = conjugate(block(size * turn.cos(), size * turn.sin(), real.exp()));
            let largest = expected.iter().fold(0.0, |largest: f64, entry| largest.max(entry.abs()));
            let norm = rates[0].abs().max(rates[1].abs()).max(turn.abs());
            for (entry, exact) in matrix.iter().zip(&expected) {
                prop_assert!((entry - exact).abs() <= 1e-13 * (1.0 + norm) * largest.max(1e-10), "{entry} {exact}");
            }
        }
    }

    #[test]
    fn what_is_too_large_is_told() {
        assert!(!Exponential::new(1).apply(&mut [1000.0]));
        assert!(!Exponential::new(1).apply(&mut [f64::NAN]));
        let mut dead = [-1e9];
        assert!(Exponential::new(1).apply(&mut dead));
        assert_eq!(dead, [0.0]);
    }
}
