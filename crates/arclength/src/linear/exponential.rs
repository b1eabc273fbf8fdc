//! The exponential of a dense matrix, by scaling and squaring of diagonal Padé approximants.
//!
//! The degree is the smallest that is exact to rounding at the norm at hand. Source: Higham, "The scaling and squaring method for the
//! matrix exponential revisited" (2005), algorithm 2.3 and table 2.3.

use super::lu;
use crate::lanes::{self, Kernel};

/// An approximant: the norm up to which it is exact to rounding, and the coefficients of its numerator, of ascending powers.
struct Approximant<const COUNT: usize> {
    largest_norm: f64,
    coefficients: [f64; COUNT],
}

const OF_DEGREE_3: Approximant<4> =
    Approximant { largest_norm: 1.495_585_217_958_292e-2, coefficients: [120.0, 60.0, 12.0, 1.0] };
const OF_DEGREE_5: Approximant<6> = Approximant {
    largest_norm: 2.539_398_330_063_23e-1,
    coefficients: [30_240.0, 15_120.0, 3_360.0, 420.0, 30.0, 1.0],
};
const OF_DEGREE_7: Approximant<8> = Approximant {
    largest_norm: 9.504_178_996_162_932e-1,
    coefficients: [17_297_280.0, 8_648_640.0, 1_995_840.0, 277_200.0, 25_200.0, 1_512.0, 56.0, 1.0],
};
const OF_DEGREE_9: Approximant<10> = Approximant {
    largest_norm: 2.097_847_961_257_068,
    coefficients: [
        17_643_225_600.0,
        8_821_612_800.0,
        2_075_673_600.0,
        302_702_400.0,
        30_270_240.0,
        2_162_160.0,
        110_880.0,
        3_960.0,
        90.0,
        1.0,
    ],
};
const OF_DEGREE_13: Approximant<14> = Approximant {
    largest_norm: 5.371_920_351_148_152,
    coefficients: [
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
    ],
};

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
    /// Even powers of the matrix: the second, fourth, sixth and eighth.
    powers: [Vec<f64>; 4],
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
            powers: [square(), square(), square(), square()],
            odd: square(),
            even: square(),
            product: square(),
        }
    }

    /// Replaces a matrix (`n * n` entries) by its exponential. `false`, with entries that mean nothing, where it is too large for
    /// numbers or not finite.
    pub fn apply(&mut self, matrix: &mut [f64]) -> bool {
        lanes::run(Replacement { memory: self, matrix })
    }

    #[inline(always)]
    fn replace<const FUSED: bool>(&mut self, n: usize, matrix: &mut [f64]) -> bool {
        let matrix = &mut matrix[..n * n];
        let norm = matrix.chunks_exact(n).map(|column| column.iter().map(|entry| entry.abs()).sum::<f64>());
        let norm = norm.fold(0.0, f64::max);
        if !norm.is_finite() {
            return false;
        }
        let squarings = (norm / OF_DEGREE_13.largest_norm).log2().ceil().max(0.0);
        if squarings > 0.0 {
            let scale = (-squarings).exp2();
            matrix.iter_mut().for_each(|entry| *entry *= scale);
        }
        let [second, fourth, sixth, eighth] = self.powers.each_mut().map(|power| &mut power[..n * n]);
        multiply(matrix, matrix, second, n);
        if norm > OF_DEGREE_3.largest_norm {
            multiply(second, second, fourth, n);
        }
        if norm > OF_DEGREE_5.largest_norm {
            multiply(fourth, second, sixth, n);
        }
        // The approximant is (even + odd) / (even - odd), `odd` being the matrix times a polynomial of the same kind as `even`.
        let (even, product) = (&mut self.even[..n * n], &mut self.product[..n * n]);
        if norm <= OF_DEGREE_3.largest_norm {
            sums(n, &OF_DEGREE_3, [second], (&mut *product, &mut *even));
        } else if norm <= OF_DEGREE_5.largest_norm {
            sums(n, &OF_DEGREE_5, [second, fourth], (&mut *product, &mut *even));
        } else if norm <= OF_DEGREE_7.largest_norm {
            sums(n, &OF_DEGREE_7, [second, fourth, sixth], (&mut *product, &mut *even));
        } else if norm <= OF_DEGREE_9.largest_norm {
            multiply(fourth, fourth, eighth, n);
            sums(n, &OF_DEGREE_9, [second, fourth, sixth, eighth], (&mut *product, &mut *even));
        } else {
            sums_of_degree_13(n, [second, fourth, sixth], eighth, (&mut *product, &mut *even));
        }
        let odd = &mut self.odd[..n * n];
        multiply(matrix, product, odd, n);
        for ((entry, odd), even) in matrix.iter_mut().zip(odd).zip(&mut *even) {
            *entry = *even + *odd;
            *even -= *odd;
        }
        let pivots = &mut self.pivots[..n];
        if lu::factorize_with::<FUSED>(even, n, pivots) == 0.0 {
            return false;
        }
        lu::solve_with::<FUSED>(even, n, pivots, matrix);
        for _ in 0..squarings as usize {
            multiply(matrix, matrix, product, n);
            matrix.copy_from_slice(product);
        }
        matrix.iter().all(|entry| entry.is_finite())
    }
}

/// The replacement of a matrix, to be run with the vector instructions of the processor.
struct Replacement<'a> {
    memory: &'a mut Exponential,
    matrix: &'a mut [f64],
}

impl Kernel for Replacement<'_> {
    type Output = bool;

    #[inline(always)]
    fn run<const FUSED: bool>(self) -> bool {
        let Self { memory, matrix } = self;
        // With a number of rows that the compiler knows the loops are unrolled.
        match memory.n {
            2 => memory.replace::<FUSED>(2, matrix),
            3 => memory.replace::<FUSED>(3, matrix),
            4 => memory.replace::<FUSED>(4, matrix),
            5 => memory.replace::<FUSED>(5, matrix),
            6 => memory.replace::<FUSED>(6, matrix),
            n => memory.replace::<FUSED>(n, matrix),
        }
    }
}

/// Writes the sums of the even powers with the odd and with the even coefficients of an approximant.
#[inline(always)]
fn sums<const COUNT: usize, const POWERS: usize>(
    n: usize,
    approximant: &Approximant<COUNT>,
    powers: [&mut [f64]; POWERS],
    (of_odd, of_even): (&mut [f64], &mut [f64]),
) {
    let coefficients = &approximant.coefficients;
    for (index, (odd, even)) in of_odd.iter_mut().zip(&mut *of_even).enumerate() {
        (*odd, *even) = (0.0, 0.0);
        for (power, pair) in powers.iter().zip(coefficients[2..].chunks_exact(2)) {
            *even += pair[0] * power[index];
            *odd += pair[1] * power[index];
        }
    }
    of_odd.iter_mut().step_by(n + 1).for_each(|entry| *entry += coefficients[1]);
    of_even.iter_mut().step_by(n + 1).for_each(|entry| *entry += coefficients[0]);
}

/// As [`sums`] for the approximant of degree 13, by powers up to the sixth.
#[inline(always)]
fn sums_of_degree_13(
    n: usize,
    [second, fourth, sixth]: [&mut [f64]; 3],
    scratch: &mut [f64],
    targets: (&mut [f64], &mut [f64]),
) {
    let c = &OF_DEGREE_13.coefficients;
    for (first, target) in [(1, targets.0), (0, targets.1)] {
        let combine = |from: usize, index: usize| {
            c[from + 4] * sixth[index] + c[from + 2] * fourth[index] + c[from] * second[index]
        };
        for (index, entry) in scratch.iter_mut().enumerate() {
            *entry = combine(first + 8, index);
        }
        multiply(sixth, scratch, target, n);
        for (index, entry) in target.iter_mut().enumerate() {
            *entry += combine(first + 2, index);
        }
        target.iter_mut().step_by(n + 1).for_each(|entry| *entry += c[first]);
    }
}

/// Writes the product of two matrices into a third.
#[inline(always)]
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
#[inline(always)]
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
    use crate::random::Random;
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

    /// With every degree and number of rows: the exponential of a matrix is the square of that of its half.
    #[test]
    fn a_whole_is_the_square_of_its_half() {
        for n in 1..=8 {
            for norm in [1e-3, 0.02, 0.2, 0.5, 1.0, 1.8, 2.5, 5.0, 40.0] {
                let mut random = Random::new(n as u64);
                let entries = (0..n * n).map(|_| 2.0 * random.next_unit() - 1.0);
                let mut whole: Vec<f64> = entries.map(|entry| norm / n as f64 * entry).collect();
                let mut half: Vec<f64> = whole.iter().map(|entry| 0.5 * entry).collect();
                let mut exponential = Exponential::new(n);
                assert!(exponential.apply(&mut whole) && exponential.apply(&mut half));
                let mut square = vec![0.0; n * n];
                multiply(&half, &half, &mut square, n);
                let largest = whole.iter().fold(0.0, |largest: f64, entry| largest.max(entry.abs()));
                for (entry, exact) in square.iter().zip(&whole) {
                    assert!((entry - exact).abs() <= 1e-14 * (1.0 + norm) * largest, "{n} {norm}");
                }
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
