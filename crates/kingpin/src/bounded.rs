//! Numbers that carry a bound on their rounding error.
//!
//! Every operation adds the rounding of its own result to what its operands bring with them (running error analysis; Wilkinson
//! 1963, Higham, *Accuracy and Stability of Numerical Algorithms*, section 3.3). Parameters come with the rounding of the decimal
//! numbers that they were read from. A condition whose value is below its bound is one that rounding could decide either way.

use arclength::Scalar;
use std::iter::Sum;
use std::ops::{Add, AddAssign, Div, DivAssign, Mul, MulAssign, Neg, Sub, SubAssign};

/// The rounding of one operation, a little more than half a unit in the last place.
const ROUNDING: f64 = 0.6 * f64::EPSILON;
/// The rounding of a function of the mathematical library.
const FUNCTION_ROUNDING: f64 = 2.0 * f64::EPSILON;

/// Order of the largest matrices.
const LARGEST_ORDER: usize = 7;

/// A number and a bound on its error, to first order in the errors.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Bounded {
    pub value: f64,
    pub error: f64,
}

impl Bounded {
    /// A number that was rounded when it was read, and once more if it is stored as its reciprocal.
    pub(crate) fn read(value: f64) -> Self {
        Self { value, error: 2.0 * ROUNDING * value.abs() }
    }

    /// Whether it is positive, whatever its error; false where it is not a number.
    pub(crate) fn is_positive(self) -> bool {
        self.value > self.error
    }

    /// Whether it is negative, whatever its error.
    pub(crate) fn is_negative(self) -> bool {
        -self.value > self.error
    }

    /// A result with the error that its operands bring, and its own rounding.
    #[inline]
    fn result(value: f64, brought: f64) -> Self {
        Self { value, error: brought + ROUNDING * value.abs() }
    }

    /// A function of one variable from its value and its slope there.
    #[inline]
    fn function(self, value: f64, slope: f64) -> Self {
        Self { value, error: slope.abs() * self.error + FUNCTION_ROUNDING * value.abs() }
    }
}

impl From<f64> for Bounded {
    #[inline]
    fn from(value: f64) -> Self {
        Self { value, error: 0.0 }
    }
}

impl Add for Bounded {
    type Output = Self;
    #[inline]
    fn add(self, other: Self) -> Self {
        Self::result(self.value + other.value, self.error + other.error)
    }
}

impl Sub for Bounded {
    type Output = Self;
    #[inline]
    fn sub(self, other: Self) -> Self {
        Self::result(self.value - other.value, self.error + other.error)
    }
}

impl Mul for Bounded {
    type Output = Self;
    #[inline]
    fn mul(self, other: Self) -> Self {
        let brought =
            self.value.abs() * other.error + self.error * other.value.abs() + self.error * other.error;
        Self::result(self.value * other.value, brought)
    }
}

impl Div for Bounded {
    type Output = Self;
    #[inline]
    fn div(self, other: Self) -> Self {
        let value = self.value / other.value;
        Self::result(
            value,
            (self.error + value.abs() * other.error) / (other.value.abs() - other.error).max(0.0),
        )
    }
}

impl Neg for Bounded {
    type Output = Self;
    #[inline]
    fn neg(self) -> Self {
        Self { value: -self.value, error: self.error }
    }
}

macro_rules! with_numbers {
    ($($trait:ident $method:ident),*) => {$(
        impl $trait<f64> for Bounded {
            type Output = Self;
            #[inline]
            fn $method(self, other: f64) -> Self {
                $trait::$method(self, Self::from(other))
            }
        }
    )*};
}
with_numbers!(Add add, Sub sub, Mul mul, Div div);

macro_rules! assigning {
    ($($trait:ident $method:ident $operator:tt),*) => {$(
        impl $trait for Bounded {
            #[inline]
            fn $method(&mut self, other: Self) {
                *self = *self $operator other;
            }
        }
    )*};
}
assigning!(AddAssign add_assign +, SubAssign sub_assign -, MulAssign mul_assign *, DivAssign div_assign /);

impl Sum for Bounded {
    fn sum<I: Iterator<Item = Self>>(terms: I) -> Self {
        terms.fold(Self::from(0.0), |sum, term| sum + term)
    }
}

impl Scalar for Bounded {
    #[inline]
    fn value(&self) -> f64 {
        self.value
    }
    fn recip(self) -> Self {
        Self::from(1.0) / self
    }
    fn sqrt(self) -> Self {
        let root = self.value.sqrt();
        self.function(root, 0.5 / root)
    }
    fn exp(self) -> Self {
        self.function(self.value.exp(), self.value.exp())
    }
    fn ln(self) -> Self {
        self.function(self.value.ln(), self.value.recip())
    }
    #[inline]
    fn sin_cos(self) -> (Self, Self) {
        let (sine, cosine) = self.value.sin_cos();
        (self.function(sine, cosine), self.function(cosine, sine))
    }
    fn tan(self) -> Self {
        let tangent = self.value.tan();
        self.function(tangent, 1.0 + tangent * tangent)
    }
    fn asin(self) -> Self {
        self.function(self.value.asin(), (1.0 - self.value * self.value).sqrt().recip())
    }
    fn acos(self) -> Self {
        self.function(self.value.acos(), (1.0 - self.value * self.value).sqrt().recip())
    }
    fn atan(self) -> Self {
        self.function(self.value.atan(), (1.0 + self.value * self.value).recip())
    }
    fn atan2(self, x: Self) -> Self {
        let value = self.value.atan2(x.value);
        let square = self.value * self.value + x.value * x.value;
        let brought = (x.value.abs() * self.error + self.value.abs() * x.error) / square;
        Self { value, error: brought + FUNCTION_ROUNDING * value.abs() }
    }
    fn sinh(self) -> Self {
        self.function(self.value.sinh(), self.value.cosh())
    }
    fn cosh(self) -> Self {
        self.function(self.value.cosh(), self.value.sinh())
    }
    fn tanh(self) -> Self {
        let tangent = self.value.tanh();
        self.function(tangent, 1.0 - tangent * tangent)
    }
    fn powi(self, exponent: i32) -> Self {
        self.function(self.value.powi(exponent), f64::from(exponent) * self.value.powi(exponent - 1))
    }
    fn powf(self, exponent: Self) -> Self {
        let value = self.value.powf(exponent.value);
        let brought = exponent.value.abs() * self.value.powf(exponent.value - 1.0).abs() * self.error
            + if exponent.error == 0.0 { 0.0 } else { (value * self.value.ln()).abs() * exponent.error };
        Self { value, error: brought + FUNCTION_ROUNDING * value.abs() }
    }
    fn is_constant(&self) -> bool {
        true
    }
}

/// The coefficients `c1 ... cn` of `det(s I - A)`, which is expanded along its rows, so that what they bring of the errors of the
/// entries is that of every term.
pub(crate) fn characteristic_polynomial<const N: usize>(matrix: &[[Bounded; N]; N]) -> [Bounded; N] {
    const { assert!(N <= LARGEST_ORDER) };
    // For every set of columns the minor of as many first rows, a polynomial in s, lowest power first.
    let mut minors = vec![[Bounded::from(0.0); LARGEST_ORDER + 1]; 1 << N];
    minors[0][0] = Bounded::from(1.0);
    for columns in 0_usize..(1 << N) - 1 {
        let row = columns.count_ones() as usize;
        let minor = minors[columns];
        for column in (0..N).filter(|column| columns >> column & 1 == 0) {
            // The sign counts the columns already taken that lie to the right.
            let passed = (columns >> column).count_ones();
            let signed = |term: Bounded| if passed % 2 == 0 { term } else { -term };
            let next = &mut minors[columns | 1 << column];
            let entry = -matrix[row][column];
            for (power, &coefficient) in minor.iter().enumerate().take(row + 1) {
                if coefficient == Bounded::from(0.0) {
                    continue;
                }
                if entry != Bounded::from(0.0) {
                    next[power] += signed(coefficient * entry);
                }
                if row == column {
                    next[power + 1] += signed(coefficient);
                }
            }
        }
    }
    let determinant = minors[(1 << N) - 1];
    std::array::from_fn(|index| determinant[N - 1 - index])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bounds_hold_and_are_small() {
        // (0.1 + 0.2 - 0.3) is rounding; 0.1 + 0.2 + 0.3 is not.
        let [a, b, c] = [0.1, 0.2, 0.3].map(Bounded::read);
        let difference = a + b - c;
        assert!(!difference.is_positive() && !difference.is_negative());
        assert!((a + b + c).is_positive() && (c - a).is_positive() && (a - c).is_negative());
        assert!((a * b / c).error < 1e-15);
        let (sine, cosine) = c.sin_cos();
        assert!((sine * sine + cosine * cosine - 1.0).error < 1e-14);
        // A division by what may be zero says nothing.
        assert!(!(c / difference).is_positive());
    }

    #[test]
    fn polynomial_of_a_companion_matrix() {
        // (s + 1)(s + 2)(s + 3) = s^3 + 6 s^2 + 11 s + 6, and a permuted diagonal matrix with the signs of its minors.
        let companion =
            [[0.0, 1.0, 0.0], [0.0, 0.0, 1.0], [-6.0, -11.0, -6.0]].map(|row| row.map(Bounded::from));
        assert_eq!(
            characteristic_polynomial(&companion).map(|coefficient| coefficient.value),
            [6.0, 11.0, 6.0]
        );
        let full = [[1.0, 2.0, 3.0], [4.0, 5.0, 6.0], [7.0, 8.0, 10.0]].map(|row| row.map(Bounded::from));
        // trace 16, sum of minors (5 - 8) + (10 - 21) + (50 - 48) = -12, determinant -3.
        assert_eq!(
            characteristic_polynomial(&full).map(|coefficient| coefficient.value),
            [-16.0, -12.0, 3.0]
        );
    }
}
