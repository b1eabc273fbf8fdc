//! Floquet multipliers as logarithm of the modulus and argument, because their range exceeds that of `f64`.

use num_complex::Complex64;
use std::f64::consts::{LN_2, PI};

use super::wide_range::WideRange;

/// An eigenvalue of a product of matrices: `exp(log_modulus + i argument)`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Multiplier {
    /// Natural logarithm of the modulus; minus infinity when the multiplier is zero.
    pub log_modulus: f64,
    /// Argument in radians in `(-pi, pi]`; exactly zero or `PI` when the multiplier is real.
    pub argument: f64,
}

impl Multiplier {
    /// The multiplier zero.
    pub const ZERO: Multiplier = Multiplier { log_modulus: f64::NEG_INFINITY, argument: 0.0 };

    /// The multiplier as a complex number; zero or infinite where its modulus leaves the range of `f64`.
    pub fn to_complex(self) -> Complex64 {
        let modulus = self.log_modulus.exp();
        if self.is_real() {
            return Complex64::from(if self.argument == 0.0 { modulus } else { -modulus });
        }
        let part = |x: f64| if x == 0.0 { 0.0 } else { modulus * x };
        Complex64::new(part(self.argument.cos()), part(self.argument.sin()))
    }

    /// Whether the multiplier is exactly real.
    pub fn is_real(self) -> bool {
        self.argument == 0.0 || self.argument == PI
    }

    /// The complex-conjugate multiplier.
    pub fn conj(self) -> Self {
        if self.is_real() { self } else { Multiplier { argument: -self.argument, ..self } }
    }

    /// The multiplier `value * 2^exponent`.
    pub(super) fn of(value: WideRange<Complex64>, exponent: i64) -> Self {
        if value.is_zero() {
            return Multiplier::ZERO;
        }
        let (significand, own) = value.split();
        let argument = if significand.im == 0.0 {
            if significand.re > 0.0 { 0.0 } else { PI }
        } else {
            significand.arg()
        };
        Multiplier { log_modulus: significand.norm().ln() + (own + exponent) as f64 * LN_2, argument }
    }
}

impl From<Complex64> for Multiplier {
    fn from(value: Complex64) -> Self {
        if value.is_finite() {
            return Multiplier::of(WideRange::new(value), 0);
        }
        Multiplier { log_modulus: value.norm().ln(), argument: value.arg() }
    }
}

impl From<f64> for Multiplier {
    fn from(value: f64) -> Self {
        Complex64::from(value).into()
    }
}

impl From<Multiplier> for Complex64 {
    fn from(multiplier: Multiplier) -> Self {
        multiplier.to_complex()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn conversion_to_and_from_complex_numbers() {
        for value in [
            Complex64::new(0.3, -0.4),
            Complex64::new(-2.0, 0.0),
            Complex64::ZERO,
            Complex64::new(-1e300, 1e300),
        ] {
            let back = Multiplier::from(value).to_complex();
            assert!((back - value).norm() <= 1e-13 * value.norm(), "{value} {back}");
        }
        assert_eq!(Multiplier::from(-1.0).to_complex(), Complex64::new(-1.0, 0.0));
        let huge = Multiplier { log_modulus: 1e4, argument: PI };
        assert_eq!(huge.to_complex(), Complex64::new(f64::NEG_INFINITY, 0.0));
        assert_eq!(Multiplier { log_modulus: -1e4, argument: 1.0 }.to_complex(), Complex64::ZERO);
    }
}
