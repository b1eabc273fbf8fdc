//! The operations a vector field may use.

use std::fmt::Debug;
use std::iter::Sum;
use std::ops::{Add, AddAssign, Div, DivAssign, Mul, MulAssign, Neg, Sub, SubAssign};

/// A real number, or a real number that carries derivatives.
///
/// Comparisons look at [`Scalar::value`] only; functions that are not differentiable everywhere
/// ([`abs`](Scalar::abs), [`max`](Scalar::max), [`floor`](Scalar::floor)) have the derivative of the
/// piece the value lies on.
///
/// ```
/// use arclength::{Dual, Scalar};
///
/// fn energy<T: Scalar>(angle: T, rate: T) -> T {
///     rate * rate * 0.5 - angle.cos()
/// }
///
/// assert_eq!(energy(0.0, 2.0), 1.0);
/// let with_slope = energy(Dual::<f64, 1>::variable(0.5, 0), Dual::constant(0.0));
/// assert_eq!(with_slope.derivatives[0], 0.5_f64.sin());
/// ```
pub trait Scalar:
    Copy
    + Debug
    + Send
    + Sync
    + 'static
    + From<f64>
    + Add<Output = Self>
    + Sub<Output = Self>
    + Mul<Output = Self>
    + Div<Output = Self>
    + Neg<Output = Self>
    + Add<f64, Output = Self>
    + Sub<f64, Output = Self>
    + Mul<f64, Output = Self>
    + Div<f64, Output = Self>
    + AddAssign
    + SubAssign
    + MulAssign
    + DivAssign
    + Sum
{
    /// The real number without its derivatives.
    fn value(&self) -> f64;
    /// `1 / self`.
    fn recip(self) -> Self;
    /// Square root.
    fn sqrt(self) -> Self;
    /// Exponential.
    fn exp(self) -> Self;
    /// Natural logarithm.
    fn ln(self) -> Self;
    /// Sine and cosine together.
    fn sin_cos(self) -> (Self, Self);
    /// Tangent.
    fn tan(self) -> Self;
    /// Inverse sine.
    fn asin(self) -> Self;
    /// Inverse cosine.
    fn acos(self) -> Self;
    /// Inverse tangent.
    fn atan(self) -> Self;
    /// Angle of the point `(x, self)`.
    fn atan2(self, x: Self) -> Self;
    /// Hyperbolic sine.
    fn sinh(self) -> Self;
    /// Hyperbolic cosine.
    fn cosh(self) -> Self;
    /// Hyperbolic tangent.
    fn tanh(self) -> Self;
    /// Whole power.
    fn powi(self, exponent: i32) -> Self;
    /// Real power of a positive number; a whole constant exponent also takes a negative base.
    fn powf(self, exponent: Self) -> Self;
    /// Whether every derivative that the number carries is zero.
    fn is_constant(&self) -> bool;

    /// The number zero.
    fn zero() -> Self {
        Self::from(0.0)
    }
    /// The number one.
    fn one() -> Self {
        Self::from(1.0)
    }
    /// Sine.
    fn sin(self) -> Self {
        self.sin_cos().0
    }
    /// Cosine.
    fn cos(self) -> Self {
        self.sin_cos().1
    }
    /// Absolute value.
    fn abs(self) -> Self {
        if self.value() < 0.0 { -self } else { self }
    }
    /// Sign of the value: -1, 0 or 1, without derivative.
    fn signum(self) -> Self {
        let value = self.value();
        Self::from(if value == 0.0 { 0.0 } else { value.signum() })
    }
    /// The larger of two numbers; not a number where one of them is none.
    fn max(self, other: Self) -> Self {
        if self.value() < other.value() || other.value().is_nan() { other } else { self }
    }
    /// The smaller of two numbers; not a number where one of them is none.
    fn min(self, other: Self) -> Self {
        if other.value() < self.value() || other.value().is_nan() { other } else { self }
    }
    /// The number zero as the value of a norm where all that it is made of vanishes, for products with a factor that vanishes there,
    /// too: its first derivatives are zero; higher ones along two or more directions in which `self` varies do not exist and are no
    /// numbers. `directions` are how many such directions were taken already.
    fn kink(self, directions: u32) -> Self {
        Self::from(if directions < 2 { 0.0 } else { f64::NAN })
    }
    /// Largest whole number not above the value, without derivative.
    fn floor(self) -> Self {
        Self::from(self.value().floor())
    }
}

impl Scalar for f64 {
    #[inline]
    fn value(&self) -> f64 {
        *self
    }
    #[inline]
    fn recip(self) -> Self {
        1.0 / self
    }
    #[inline]
    fn sqrt(self) -> Self {
        f64::sqrt(self)
    }
    #[inline]
    fn exp(self) -> Self {
        f64::exp(self)
    }
    #[inline]
    fn ln(self) -> Self {
        f64::ln(self)
    }
    #[inline]
    fn sin_cos(self) -> (Self, Self) {
        f64::sin_cos(self)
    }
    #[inline]
    fn tan(self) -> Self {
        f64::tan(self)
    }
    #[inline]
    fn asin(self) -> Self {
        f64::asin(self)
    }
    #[inline]
    fn acos(self) -> Self {
        f64::acos(self)
    }
    #[inline]
    fn atan(self) -> Self {
        f64::atan(self)
    }
    #[inline]
    fn atan2(self, x: Self) -> Self {
        f64::atan2(self, x)
    }
    #[inline]
    fn sinh(self) -> Self {
        f64::sinh(self)
    }
    #[inline]
    fn cosh(self) -> Self {
        f64::cosh(self)
    }
    #[inline]
    fn tanh(self) -> Self {
        f64::tanh(self)
    }
    #[inline]
    fn powi(self, exponent: i32) -> Self {
        f64::powi(self, exponent)
    }
    #[inline]
    fn powf(self, exponent: Self) -> Self {
        f64::powf(self, exponent)
    }
    #[inline]
    fn is_constant(&self) -> bool {
        true
    }
}
