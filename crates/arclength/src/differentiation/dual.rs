//! Dual numbers: a value and its derivatives in `N` directions.

use super::Scalar;
use std::iter::Sum;
use std::ops::{Add, AddAssign, Div, DivAssign, Mul, MulAssign, Neg, Sub, SubAssign};

/// A number of type `T` with derivatives in `N` directions, propagated exactly.
///
/// `T` is itself a [`Scalar`], so duals nest: `Dual<Dual<f64, 1>, 1>` carries a mixed second
/// derivative along two independent directions.
///
/// ```
/// use arclength::{Dual, Scalar};
/// let x = Dual::<f64, 2>::variable(3.0, 0);
/// let y = Dual::<f64, 2>::variable(2.0, 1);
/// let z = x * y + x.sin();
/// assert_eq!(z.derivatives, [2.0 + 3.0_f64.cos(), 3.0]);
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Dual<T, const N: usize> {
    /// The value.
    pub value: T,
    /// The derivatives, one for each direction.
    pub derivatives: [T; N],
}

impl<T: Scalar, const N: usize> Dual<T, N> {
    /// A number that does not vary.
    #[inline]
    pub fn constant(value: T) -> Self {
        Self { value, derivatives: [T::zero(); N] }
    }

    /// A number that varies with unit speed in one direction; a direction of `N` or more leaves it constant.
    #[inline]
    pub fn variable(value: T, direction: usize) -> Self {
        let mut dual = Self::constant(value);
        if let Some(derivative) = dual.derivatives.get_mut(direction) {
            *derivative = T::one();
        }
        dual
    }

    /// Chain rule: `value` and `slope` of a function of one variable at `self.value`.
    #[inline]
    fn chain(self, value: T, slope: T) -> Self {
        let mut result = self.each(|derivative| slope * derivative);
        result.value = value;
        result
    }

    /// Changes every derivative. (`array::map` would be several times as much to compile, for every scalar.)
    #[inline]
    fn each(mut self, change: impl Fn(T) -> T) -> Self {
        for direction in 0..N {
            self.derivatives[direction] = change(self.derivatives[direction]);
        }
        self
    }
}

impl<T: Scalar, const N: usize> From<f64> for Dual<T, N> {
    #[inline]
    fn from(value: f64) -> Self {
        Self::constant(T::from(value))
    }
}

impl<T: Scalar, const N: usize> Add for Dual<T, N> {
    type Output = Self;
    #[inline]
    fn add(mut self, other: Self) -> Self {
        self += other;
        self
    }
}

impl<T: Scalar, const N: usize> Sub for Dual<T, N> {
    type Output = Self;
    #[inline]
    fn sub(mut self, other: Self) -> Self {
        self -= other;
        self
    }
}

impl<T: Scalar, const N: usize> Mul for Dual<T, N> {
    type Output = Self;
    #[inline]
    fn mul(self, other: Self) -> Self {
        let mut product = Self::constant(self.value * other.value);
        for direction in 0..N {
            product.derivatives[direction] =
                self.derivatives[direction] * other.value + self.value * other.derivatives[direction];
        }
        product
    }
}

impl<T: Scalar, const N: usize> Div for Dual<T, N> {
    type Output = Self;
    #[inline]
    fn div(self, other: Self) -> Self {
        let reciprocal = other.value.recip();
        let mut quotient = Self::constant(self.value * reciprocal);
        for direction in 0..N {
            quotient.derivatives[direction] =
                (self.derivatives[direction] - quotient.value * other.derivatives[direction]) * reciprocal;
        }
        quotient
    }
}

impl<T: Scalar, const N: usize> Neg for Dual<T, N> {
    type Output = Self;
    #[inline]
    fn neg(self) -> Self {
        let mut result = self.each(|derivative| -derivative);
        result.value = -self.value;
        result
    }
}

impl<T: Scalar, const N: usize> Add<f64> for Dual<T, N> {
    type Output = Self;
    #[inline]
    fn add(mut self, constant: f64) -> Self {
        self.value = self.value + constant;
        self
    }
}

impl<T: Scalar, const N: usize> Sub<f64> for Dual<T, N> {
    type Output = Self;
    #[inline]
    fn sub(mut self, constant: f64) -> Self {
        self.value = self.value - constant;
        self
    }
}

impl<T: Scalar, const N: usize> Mul<f64> for Dual<T, N> {
    type Output = Self;
    #[inline]
    fn mul(self, constant: f64) -> Self {
        let mut result = self.each(|derivative| derivative * constant);
        result.value = self.value * constant;
        result
    }
}

impl<T: Scalar, const N: usize> Div<f64> for Dual<T, N> {
    type Output = Self;
    #[inline]
    fn div(self, constant: f64) -> Self {
        let mut result = self.each(|derivative| derivative / constant);
        result.value = self.value / constant;
        result
    }
}

impl<T: Scalar, const N: usize> AddAssign for Dual<T, N> {
    #[inline]
    fn add_assign(&mut self, other: Self) {
        self.value += other.value;
        for direction in 0..N {
            self.derivatives[direction] += other.derivatives[direction];
        }
    }
}

impl<T: Scalar, const N: usize> SubAssign for Dual<T, N> {
    #[inline]
    fn sub_assign(&mut self, other: Self) {
        self.value -= other.value;
        for direction in 0..N {
            self.derivatives[direction] -= other.derivatives[direction];
        }
    }
}

impl<T: Scalar, const N: usize> MulAssign for Dual<T, N> {
    #[inline]
    fn mul_assign(&mut self, other: Self) {
        *self = *self * other;
    }
}

impl<T: Scalar, const N: usize> DivAssign for Dual<T, N> {
    #[inline]
    fn div_assign(&mut self, other: Self) {
        *self = *self / other;
    }
}

impl<T: Scalar, const N: usize> Sum for Dual<T, N> {
    fn sum<I: Iterator<Item = Self>>(terms: I) -> Self {
        terms.fold(Self::zero(), |sum, term| sum + term)
    }
}

impl<T: Scalar, const N: usize> Scalar for Dual<T, N> {
    #[inline]
    fn value(&self) -> f64 {
        self.value.value()
    }
    #[inline]
    fn recip(self) -> Self {
        let reciprocal = self.value.recip();
        self.chain(reciprocal, -(reciprocal * reciprocal))
    }
    #[inline]
    fn sqrt(self) -> Self {
        let root = self.value.sqrt();
        self.chain(root, root.recip() * 0.5)
    }
    #[inline]
    fn exp(self) -> Self {
        let exponential = self.value.exp();
        self.chain(exponential, bounded(exponential, exponential))
    }
    #[inline]
    fn ln(self) -> Self {
        self.chain(self.value.ln(), self.value.recip())
    }
    #[inline]
    fn sin_cos(self) -> (Self, Self) {
        let (sine, cosine) = self.value.sin_cos();
        (self.chain(sine, cosine), self.chain(cosine, -sine))
    }
    #[inline]
    fn tan(self) -> Self {
        let tangent = self.value.tan();
        self.chain(tangent, tangent * tangent + 1.0)
    }
    #[inline]
    fn asin(self) -> Self {
        let slope = (-(self.value * self.value) + 1.0).sqrt().recip();
        self.chain(self.value.asin(), slope)
    }
    #[inline]
    fn acos(self) -> Self {
        let slope = -(-(self.value * self.value) + 1.0).sqrt().recip();
        self.chain(self.value.acos(), slope)
    }
    #[inline]
    fn atan(self) -> Self {
        let slope = (self.value * self.value + 1.0).recip();
        self.chain(self.value.atan(), slope)
    }
    #[inline]
    fn atan2(self, x: Self) -> Self {
        let inverse_square = (self.value * self.value + x.value * x.value).recip();
        let mut angle = Self::constant(self.value.atan2(x.value));
        for direction in 0..N {
            angle.derivatives[direction] = (x.value * self.derivatives[direction]
                - self.value * x.derivatives[direction])
                * inverse_square;
        }
        angle
    }
    #[inline]
    fn sinh(self) -> Self {
        let (sine, cosine) = (self.value.sinh(), self.value.cosh());
        self.chain(sine, bounded(sine, cosine))
    }
    #[inline]
    fn cosh(self) -> Self {
        let (sine, cosine) = (self.value.sinh(), self.value.cosh());
        self.chain(cosine, bounded(cosine, sine))
    }
    #[inline]
    fn tanh(self) -> Self {
        let tangent = self.value.tanh();
        self.chain(tangent, -(tangent * tangent) + 1.0)
    }
    #[inline]
    fn powi(self, exponent: i32) -> Self {
        if exponent == 0 {
            return Self::one();
        }
        let lower = self.value.powi(exponent - 1);
        // At zero a negative power is infinite, but `lower` times zero is not a number.
        let value = if exponent > 0 { lower * self.value } else { self.value.powi(exponent) };
        self.chain(value, lower * f64::from(exponent))
    }
    #[inline]
    fn powf(self, exponent: Self) -> Self {
        let power = exponent.value.value();
        // Zero to any positive power is zero.
        let constant = exponent.is_constant() || (self.value.value() == 0.0 && power > 0.0);
        if constant && power.fract() == 0.0 && power.abs() <= f64::from(i32::MAX) {
            return self.powi(power as i32);
        }
        if constant {
            let lower = self.value.powf(exponent.value - 1.0);
            let value = if power > 1.0 { lower * self.value } else { self.value.powf(exponent.value) };
            return self.chain(value, lower * exponent.value);
        }
        (self.ln() * exponent).exp()
    }
    fn kink(self, directions: u32) -> Self {
        let mut result = Self::constant(self.value.kink(directions));
        for direction in 0..N {
            let varies = self.derivatives[direction].value() != 0.0;
            result.derivatives[direction] = self.value.kink(directions + u32::from(varies));
        }
        result
    }
    #[inline]
    fn is_constant(&self) -> bool {
        self.value.is_constant()
            && self.derivatives.iter().all(|derivative| derivative.value() == 0.0 && derivative.is_constant())
    }
}

/// Size of a function that grows exponentially next to which its rate may overflow.
const OVERFLOWING: f64 = 1e280;

/// The rate of a function that grows exponentially; where that has overflowed, or is about to, zero: what is finite then has it in a
/// denominator, and does not depend on it.
#[inline]
fn bounded<T: Scalar>(value: T, rate: T) -> T {
    if value.value().abs() > OVERFLOWING { T::zero() } else { rate }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_saturated_flank_is_flat_up_to_the_overflow_and_beyond() {
        for steps in 0..400 {
            let exponent = Dual::<f64, 1>::variable(600.0 + 0.5 * f64::from(steps), 0) * 2000.0 / 2000.0;
            let grown = (exponent * 1.0).exp() * 2000.0 + 1.0;
            let flank = grown.recip();
            assert!(flank.derivatives[0].abs() < 1e-250, "{steps}: {flank:?}");
        }
    }

    #[test]
    fn the_larger_of_a_number_and_none_is_none() {
        let (one, none) = (Dual::<f64, 1>::variable(1.0, 0), Dual::<f64, 1>::constant(f64::NAN));
        for result in [one.max(none), none.max(one), one.min(none), none.min(one)] {
            assert!(result.value.is_nan());
        }
    }

    #[test]
    fn derivatives_beside_overflow_and_of_powers_of_zero() {
        let x = Dual::<Dual<f64, 1>, 1>::variable(Dual::variable(1e4, 0), 0);
        let one = Dual::one();
        for quotient in [one / (one + x.exp()), x / x.cosh(), x.sinh().recip()] {
            let slope = quotient.derivatives[0];
            assert_eq!([quotient.value.value, slope.value, slope.derivatives[0]], [0.0; 3]);
        }
        let base = Dual::<f64, 2>::variable(0.0, 0);
        for (power, slope) in [(2.5, 0.0), (1.0, 1.0), (3.0, 0.0)] {
            let found = base.powf(Dual::variable(power, 1));
            assert_eq!((found.value, found.derivatives), (0.0, [slope, 0.0]));
        }
    }

    #[test]
    fn a_kink_has_first_derivatives_and_those_along_one_direction_that_varies() {
        // x in direction 0, y in direction 1, nothing in direction 2.
        let at = |value: f64, direction: usize| {
            Dual::<Dual<f64, 3>, 3>::variable(Dual::variable(value, direction), direction)
        };
        let trace = at(0.0, 0) + at(0.0, 1) * 2.0;
        let norm = trace.kink(0);
        assert_eq!((norm.value.value, norm.value.derivatives), (0.0, [0.0; 3]));
        for (first, row) in norm.derivatives.iter().enumerate() {
            assert_eq!(row.value, 0.0);
            for (second, derivative) in row.derivatives.iter().enumerate() {
                assert_eq!(derivative.is_nan(), first < 2 && second < 2, "{first} {second}: {derivative}");
            }
        }
    }

    #[test]
    fn the_value_is_that_of_the_plain_function_at_the_edge_of_its_domain_too() {
        for base in [0.0, -0.0, 0.5, 2.0] {
            let x = Dual::<f64, 1>::variable(base, 0);
            for exponent in [-2, -1, 0, 1, 2, 3] {
                let (dual, plain) = (x.powi(exponent).value, base.powi(exponent));
                assert!((dual - plain).abs() <= 1e-15 * plain || dual == plain, "{base}^{exponent}: {dual}");
            }
            for exponent in [-1.5, -0.5, 0.5, 1.5, 2.5] {
                let (dual, plain) = (x.powf(Dual::constant(exponent)).value, base.powf(exponent));
                assert!((dual - plain).abs() <= 1e-15 * plain || dual == plain, "{base}^{exponent}: {dual}");
            }
        }
    }
}
