//! Eigenvalues of a product of 2-by-2 matrices by a complex single-shift periodic QR iteration.
//!
//! A real double-shift iteration ends with 2-by-2 blocks. Forming the product of a block would lose the
//! smaller of two real multipliers and the accuracy of a pair behind ill-conditioned factors; iterating on
//! the factors in complex arithmetic loses neither (Kressner 2005, chapter 4). All stays exactly real when
//! the eigenvalues are.

use num_complex::Complex64;

use super::multiplier::Multiplier;
use super::periodic_sweep::HOPELESS_SHIFT;
use super::wide_range::WideRange;

/// Sweeps before the iteration gives up; three are usual.
pub(super) const MAXIMUM_SWEEPS: usize = 60;
/// Every so many sweeps an unshifted one is made.
const UNSHIFTED_INTERVAL: usize = 10;

/// A 2-by-2 matrix `[a b; c d]`.
#[derive(Clone, Copy, Debug)]
pub(super) struct Block {
    pub a: Complex64,
    pub b: Complex64,
    pub c: Complex64,
    pub d: Complex64,
}

impl Block {
    pub(super) const ZERO: Block =
        Block { a: Complex64::ZERO, b: Complex64::ZERO, c: Complex64::ZERO, d: Complex64::ZERO };
}

/// The unitary matrix `[cosine sine; -conj(sine) cosine]`.
#[derive(Clone, Copy)]
struct Rotation {
    cosine: f64,
    sine: Complex64,
}

impl Rotation {
    /// The rotation that maps `(x, y)` onto a multiple of the first unit vector.
    fn annihilating(x: Complex64, y: Complex64) -> Self {
        let size = x.re.abs().max(x.im.abs()).max(y.re.abs()).max(y.im.abs());
        if y == Complex64::ZERO {
            return Rotation { cosine: 1.0, sine: Complex64::ZERO };
        }
        let (x, y) = (Complex64::new(x.re / size, x.im / size), Complex64::new(y.re / size, y.im / size));
        let (p, q) = (x.norm(), y.norm());
        if p == 0.0 {
            return Rotation { cosine: 0.0, sine: y.conj() / q };
        }
        let r = p.hypot(q);
        Rotation { cosine: p / r, sine: (x / p) * (y.conj() / r) }
    }

    /// Multiplies a block by the rotation from the left.
    fn times(self, block: &mut Block) {
        let Rotation { cosine, sine } = self;
        let Block { a, b, c, d } = *block;
        *block = Block {
            a: a * cosine + sine * c,
            b: b * cosine + sine * d,
            c: c * cosine - sine.conj() * a,
            d: d * cosine - sine.conj() * b,
        };
    }

    /// Multiplies a block by the adjoint of the rotation from the right.
    fn adjoint_after(self, block: &mut Block) {
        let Rotation { cosine, sine } = self;
        let Block { a, b, c, d } = *block;
        *block = Block {
            a: a * cosine + b * sine.conj(),
            b: b * cosine - a * sine,
            c: c * cosine + d * sine.conj(),
            d: d * cosine - c * sine,
        };
    }
}

/// The two eigenvalues of `blocks[0] * blocks[1] * ... * 2^exponent`, where all blocks but the first are
/// upper triangular with non-zero diagonals; `None` if the iteration does not converge.
pub(super) fn multipliers(blocks: &mut [Block], exponent: i64) -> Option<[Multiplier; 2]> {
    for sweep in 1..=MAXIMUM_SWEEPS {
        let (first, triangular) = blocks.split_first_mut()?;
        if first.c.norm() <= f64::EPSILON * (first.a.norm() + first.d.norm()) {
            first.c = Complex64::ZERO;
            return Some(classify(blocks, exponent));
        }
        let (x, y) = first_column(first, triangular, sweep.is_multiple_of(UNSHIFTED_INTERVAL));
        let mut rotation = Rotation::annihilating(x, y);
        rotation.times(first);
        for block in triangular.iter_mut().rev() {
            rotation.adjoint_after(block);
            rotation = Rotation::annihilating(block.a, block.c);
            rotation.times(block);
            block.c = Complex64::ZERO;
        }
        rotation.adjoint_after(first);
    }
    None
}

/// The first column of the shifted product up to a factor; the shift is the eigenvalue next to the last
/// diagonal entry.
fn first_column(first: &Block, triangular: &[Block], unshifted: bool) -> (Complex64, Complex64) {
    if unshifted {
        return (first.a, first.c);
    }
    let wide = WideRange::new;
    let (mut a, mut b, mut d) = (wide(Complex64::ONE), wide(Complex64::ZERO), wide(Complex64::ONE));
    for block in triangular {
        b = a * block.b + b * block.d;
        a = a * block.a;
        d = d * block.d;
    }
    let (p, q) = (a * first.a, b * first.a + d * first.b);
    let (r, s) = (a * first.c, b * first.c + d * first.d);
    let half = (p - s) * Complex64::from(0.5);
    let coupling = q * r;
    let root = (half * half + coupling).sqrt();
    let (sum, difference) = (half + root, half - root);
    let larger = if difference.is_not_larger_than(sum) { sum } else { difference };
    let shift = if larger.is_zero() { s } else { s - coupling / larger };
    let x = wide(first.a) - shift / a;
    let y = wide(first.c);
    let common = WideRange::common_exponent(&[x, y]);
    let (x, y) = (x.relative_to(common), y.relative_to(common));
    if y.norm() <= HOPELESS_SHIFT * x.norm() { (first.a, first.c) } else { (x, y) }
}

/// Reads off the eigenvalues of a triangular product and restores what is known about them: both real or
/// conjugate.
fn classify(blocks: &[Block], exponent: i64) -> [Multiplier; 2] {
    let product = |entry: fn(&Block) -> Complex64| {
        blocks.iter().fold(WideRange::new(Complex64::ONE), |product, block| product * entry(block))
    };
    let (one, other) = (product(|block| block.a), product(|block| block.d));
    let common = WideRange::common_exponent(&[one, other]);
    let (x, y) = (one.relative_to(common), other.relative_to(common));
    // A pair of real eigenvalues differs from the nearest conjugate pair more than from the real axis.
    if (x - y.conj()).norm() >= x.im.abs() + y.im.abs() {
        let real = |value: WideRange<Complex64>| {
            let multiplier = Multiplier::of(value, exponent);
            let argument = if multiplier.argument.abs() < 0.5 * std::f64::consts::PI {
                0.0
            } else {
                std::f64::consts::PI
            };
            Multiplier { argument, ..multiplier }
        };
        return [real(one), real(other)];
    }
    let (one, other) = (Multiplier::of(one, exponent), Multiplier::of(other, exponent));
    let direction = Complex64::cis(one.argument) + Complex64::cis(-other.argument);
    let pair = Multiplier {
        log_modulus: 0.5 * (one.log_modulus + other.log_modulus),
        argument: direction.arg().abs(),
    };
    [pair.conj(), pair]
}
