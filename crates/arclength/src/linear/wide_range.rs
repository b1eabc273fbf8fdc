//! Numbers with an exponent of their own, for products of hundreds of matrices.
//!
//! A product of a thousand factors of modest size leaves the range of `f64` although every ratio that the
//! periodic QR iteration asks for is harmless. A number is `significand * 2^(512 exponent)` with a
//! significand between `2^-256` and `2^256`, so that multiplication rarely renormalises and no product of two
//! significands overflows.

use std::ops::{Add, Div, Mul, Sub};

use num_complex::Complex64;

use super::balancing::{binary_exponent, power_of_two};

const STEP: i32 = 512;
const UP: f64 = f64::from_bits((512 + 1023) << 52);
const DOWN: f64 = 1.0 / UP;
const LARGEST: f64 = f64::from_bits((256 + 1023) << 52);
const SMALLEST: f64 = 1.0 / LARGEST;

/// What a significand can be: `f64` or [`Complex64`].
pub(super) trait Significand:
    Copy
    + Add<Output = Self>
    + Sub<Output = Self>
    + Mul<Output = Self>
    + Div<Output = Self>
    + Mul<f64, Output = Self>
{
    /// The largest modulus of a component.
    fn size(self) -> f64;
}

impl Significand for f64 {
    #[inline(always)]
    fn size(self) -> f64 {
        self.abs()
    }
}

impl Significand for Complex64 {
    #[inline(always)]
    fn size(self) -> f64 {
        self.re.abs().max(self.im.abs())
    }
}

/// `significand * 2^(512 exponent)`.
#[derive(Clone, Copy, Debug)]
pub(super) struct WideRange<S> {
    significand: S,
    exponent: i64,
}

impl<S: Significand> WideRange<S> {
    #[inline]
    pub(super) fn new(significand: S) -> Self {
        WideRange { significand, exponent: 0 }.normalized()
    }

    #[inline(always)]
    fn normalized(self) -> Self {
        let size = self.significand.size();
        if (SMALLEST..LARGEST).contains(&size) || size == 0.0 { self } else { self.renormalized() }
    }

    #[cold]
    fn renormalized(mut self) -> Self {
        while self.significand.size() >= LARGEST && self.significand.size().is_finite() {
            self.significand = self.significand * DOWN;
            self.exponent += 1;
        }
        while self.significand.size() < SMALLEST {
            self.significand = self.significand * UP;
            self.exponent -= 1;
        }
        self
    }

    pub(super) fn is_zero(self) -> bool {
        self.significand.size() == 0.0
    }

    /// The significand relative to `2^(512 exponent)`; zero or infinite where that leaves the range of `f64`.
    pub(super) fn relative_to(self, exponent: i64) -> S {
        match self.exponent - exponent {
            0 => self.significand,
            -1 => self.significand * DOWN,
            1 => self.significand * UP,
            difference if difference < 0 => self.significand * 0.0,
            _ if self.is_zero() => self.significand,
            _ => self.significand * f64::INFINITY,
        }
    }

    /// The exponent that makes [`relative_to`](Self::relative_to) moderate for all of `numbers`.
    pub(super) fn common_exponent(numbers: &[Self]) -> i64 {
        numbers.iter().filter(|x| !x.is_zero()).map(|x| x.exponent).max().unwrap_or(0)
    }

    /// `(s, e)` with the value `s * 2^e` and `1 <= size of s < 2`; zero gives `(0, 0)`.
    pub(super) fn split(self) -> (S, i64) {
        if self.is_zero() {
            return (self.significand, 0);
        }
        let exponent = binary_exponent(self.significand.size());
        let (a, b) = power_of_two(-exponent);
        (self.significand * a * b, self.exponent * i64::from(STEP) + i64::from(exponent))
    }
}

impl WideRange<f64> {
    pub(super) fn abs(self) -> Self {
        WideRange { significand: self.significand.abs(), ..self }
    }
}

impl WideRange<Complex64> {
    pub(super) fn sqrt(self) -> Self {
        let even = self.exponent.rem_euclid(2) == 0;
        let significand = if even { self.significand } else { self.significand * UP };
        let exponent = self.exponent.div_euclid(2);
        WideRange { significand: significand.sqrt(), exponent }.normalized()
    }

    /// `2^exponent`.
    pub(super) fn power_of_two(exponent: i64) -> Self {
        let step = i64::from(STEP);
        let significand = f64::powi(2.0, exponent.rem_euclid(step) as i32);
        WideRange { significand: significand.into(), exponent: exponent.div_euclid(step) }.normalized()
    }

    /// Whether the modulus is at most that of `other`.
    pub(super) fn is_not_larger_than(self, other: Self) -> bool {
        let exponent = Self::common_exponent(&[self, other]);
        self.relative_to(exponent).norm() <= other.relative_to(exponent).norm()
    }

    /// The nearest number of ordinary range; infinite or zero outside.
    pub(super) fn to_complex(self) -> Complex64 {
        let (significand, exponent) = self.split();
        let (a, b) = power_of_two(exponent.clamp(-2040, 2040) as i32);
        significand * a * b
    }
}

impl<S: Significand> Mul for WideRange<S> {
    type Output = Self;
    #[inline(always)]
    fn mul(self, other: Self) -> Self {
        let significand = self.significand * other.significand;
        WideRange { significand, exponent: self.exponent + other.exponent }.normalized()
    }
}

impl<S: Significand> Mul<S> for WideRange<S> {
    type Output = Self;
    #[inline(always)]
    fn mul(self, other: S) -> Self {
        self * WideRange::new(other)
    }
}

impl<S: Significand> Div for WideRange<S> {
    type Output = Self;
    fn div(self, other: Self) -> Self {
        let significand = self.significand / other.significand;
        WideRange { significand, exponent: self.exponent - other.exponent }.normalized()
    }
}

impl<S: Significand> Add for WideRange<S> {
    type Output = Self;
    #[inline(always)]
    fn add(self, other: Self) -> Self {
        if self.exponent == other.exponent {
            let significand = self.significand + other.significand;
            return WideRange { significand, exponent: self.exponent }.normalized();
        }
        let exponent = Self::common_exponent(&[self, other]);
        let significand = self.relative_to(exponent) + other.relative_to(exponent);
        WideRange { significand, exponent }.normalized()
    }
}

impl<S: Significand> Sub for WideRange<S> {
    type Output = Self;
    #[inline(always)]
    fn sub(self, other: Self) -> Self {
        self + WideRange { significand: other.significand * -1.0, exponent: other.exponent }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn arithmetic_beyond_the_range_of_f64() {
        let mut product = WideRange::new(1.0);
        for _ in 0..1000 {
            product = product * 1e-200;
        }
        for _ in 0..1000 {
            product = product * 1e199;
        }
        let (significand, exponent) = product.split();
        let logarithm = significand.ln() + exponent as f64 * std::f64::consts::LN_2;
        assert!((logarithm + 1000.0 * std::f64::consts::LN_10).abs() < 1e-9);
    }

    #[test]
    fn sums_align_exponents() {
        let small = WideRange::new(1e-100);
        let large = WideRange::new(1e100);
        assert_eq!((small + large).split(), large.split());
        let difference = (large + small * large) - large;
        let quotient = difference / large;
        assert_eq!(quotient.split().0, 0.0, "a summand below rounding is lost");
        assert_eq!((WideRange::new(3.0) - WideRange::new(1.0)).split(), (1.0, 1));
        assert_eq!((WideRange::new(0.0) + small).split(), small.split());
    }

    #[test]
    fn square_root_of_any_exponent() {
        for exponent in [-3.0_f64, -1.0, 0.0, 2.0, 3.0] {
            let mut number = WideRange::new(Complex64::new(-1.0, 0.0));
            for _ in 0..exponent.abs() as usize {
                let factor = if exponent > 0.0 { 1e200 } else { 1e-200 };
                number = number * Complex64::from(factor);
            }
            let root = number.sqrt();
            assert!(((root * root) / number - WideRange::new(Complex64::ONE)).to_complex().norm() < 1e-15);
        }
    }
}
