//! Special functions for any scalar, from values and derivatives at a real number.
//!
//! A scalar is a real number plus a part that is nilpotent: some power of it vanishes. A Taylor
//! polynomial of that degree is therefore the function itself, exactly, with all its derivatives.

use arclength::Scalar;
use std::f64::consts::PI;

/// Degree of the Taylor polynomials: derivatives up to this order are exact.
const DEGREE: usize = 8;

/// Evaluates the polynomial with the given derivatives at `x.value()`.
fn taylor<T: Scalar>(x: T, derivatives: [f64; DEGREE + 1]) -> T {
    let value = derivatives[0];
    if x.is_constant() || !value.is_finite() {
        return T::from(value);
    }
    let increment = x - x.value();
    let mut result = T::zero();
    for order in (1..=DEGREE).rev() {
        result = (result + derivatives[order]) * increment / order as f64;
    }
    result + value
}

/// Derivatives of the error function: 2/sqrt(pi) (-1)^n H_n(x) exp(-x^2) (Abramowitz and Stegun, 7.1.19).
fn error_function_derivatives(x: f64, value: f64, sign: f64) -> [f64; DEGREE + 1] {
    let factor = sign * 2.0 / PI.sqrt() * (-x * x).exp();
    let mut derivatives = [value; DEGREE + 1];
    let (mut before, mut hermite) = (0.0, 1.0);
    for (order, derivative) in derivatives.iter_mut().enumerate().skip(1) {
        let parity = if order % 2 == 0 { -1.0 } else { 1.0 };
        *derivative = parity * factor * hermite;
        (before, hermite) = (hermite, 2.0 * x * hermite - 2.0 * (order as f64 - 1.0) * before);
    }
    derivatives
}

/// The error function.
pub(super) fn error_function<T: Scalar>(x: T) -> T {
    let at = x.value();
    taylor(x, error_function_derivatives(at, libm::erf(at), 1.0))
}

/// One minus the error function.
pub(super) fn complementary_error_function<T: Scalar>(x: T) -> T {
    let at = x.value();
    taylor(x, error_function_derivatives(at, libm::erfc(at), -1.0))
}

/// `(exp(x) - 1)/x`, one at zero.
pub(super) fn relative_exponential<T: Scalar>(x: T) -> T {
    /// Where `exp(x)` is closer to one, digits of the difference and of its derivatives would cancel.
    const SMALL: f64 = 1.0;
    /// Terms of the series, whose last are below rounding then.
    const TERMS: u32 = 20;
    let at = x.value();
    if at.abs() >= SMALL {
        return (x.exp() - 1.0) / x;
    }
    if x.is_constant() {
        return T::from(if at == 0.0 { 1.0 } else { at.exp_m1() / at });
    }
    // Derivative of order k: the sum of x^j/(j! (j + k + 1)).
    let mut derivatives = [0.0; DEGREE + 1];
    let mut power = 1.0;
    for term in 0..TERMS {
        for (order, derivative) in derivatives.iter_mut().enumerate() {
            *derivative += power / f64::from(term + order as u32 + 1);
        }
        power *= at / f64::from(term + 1);
    }
    taylor(x, derivatives)
}

/// The root of a sum of squares, which stands in products that vanish with it: at its kink, see [`Scalar::kink`].
pub(super) fn norm<T: Scalar>(square: T, trace: T) -> T {
    if square.value() == 0.0 { trace.kink(0) } else { square.sqrt() }
}

/// Derivatives of a Bessel function of the first or second kind (Abramowitz and Stegun, 9.1.31):
/// 2^k C_n^(k) = sum over i of (-1)^i binomial(k, i) C_{n-k+2i}.
fn bessel_derivatives(order: i32, x: f64, bessel: fn(i32, f64) -> f64) -> [f64; DEGREE + 1] {
    // Orders n - DEGREE to n + DEGREE.
    let neighbours: [f64; 2 * DEGREE + 1] =
        std::array::from_fn(|index| bessel(order + index as i32 - DEGREE as i32, x));
    std::array::from_fn(|k| {
        let mut sum = 0.0;
        let mut weight = 1.0;
        for i in 0..=k {
            sum += weight * neighbours[DEGREE - k + 2 * i];
            weight *= -((k - i) as f64) / (i + 1) as f64;
        }
        sum / f64::from(1 << k)
    })
}

/// Bessel function of the first kind.
pub(super) fn bessel_j<T: Scalar>(order: i32, x: T) -> T {
    taylor(x, bessel_derivatives(order, x.value(), libm::jn))
}

/// Bessel function of the second kind.
pub(super) fn bessel_y<T: Scalar>(order: i32, x: T) -> T {
    taylor(x, bessel_derivatives(order, x.value(), libm::yn))
}

#[cfg(test)]
mod tests {
    use super::*;
    use approx::assert_relative_eq;
    use arclength::Dual;

    type Second = Dual<Dual<f64, 1>, 1>;

    fn second(x: f64) -> Second {
        Dual::variable(Dual::variable(x, 0), 0)
    }

    #[test]
    fn error_function_and_its_derivatives() {
        // Abramowitz and Stegun, table 7.1.
        let x = 0.5;
        let y = error_function(second(x));
        assert_relative_eq!(y.value(), 0.520_499_877_813_046_5, max_relative = 1e-15);
        let slope = 2.0 / PI.sqrt() * (-x * x).exp();
        assert_relative_eq!(y.derivatives[0].value, slope, max_relative = 1e-15);
        assert_relative_eq!(y.derivatives[0].derivatives[0], -2.0 * x * slope, max_relative = 1e-14);
        let complement = complementary_error_function(second(x));
        assert_relative_eq!(complement.value() + y.value(), 1.0, max_relative = 1e-15);
        assert_relative_eq!(complement.derivatives[0].derivatives[0], 2.0 * x * slope, max_relative = 1e-14);
    }

    #[test]
    fn the_relative_exponential_is_smooth() {
        // The derivatives at zero are 1/(k + 1); elsewhere x E = exp(x) - 1 and x E' + E = exp(x).
        let zero = relative_exponential(second(0.0));
        assert_eq!(zero.value(), 1.0);
        assert_relative_eq!(zero.derivatives[0].value, 0.5, max_relative = 1e-15);
        assert_relative_eq!(zero.derivatives[0].derivatives[0], 1.0 / 3.0, max_relative = 1e-15);
        for x in [-30.0_f64, -1.0, -0.999, -0.3, 1e-9, 0.2, 0.999, 1.0, 4.0] {
            let y = relative_exponential(second(x));
            assert_relative_eq!(x * y.value(), x.exp_m1(), max_relative = 1e-15);
            let slope = x * y.derivatives[0].value + y.value();
            assert_relative_eq!(slope, x.exp(), max_relative = 1e-14, epsilon = 1e-15);
        }
    }

    #[test]
    fn bessel_functions_satisfy_their_equation() {
        for (order, function) in [(0, bessel_j as fn(i32, Second) -> Second), (3, bessel_j), (1, bessel_y)] {
            let x = 2.5;
            let y = function(order, second(x));
            let n = f64::from(order);
            let residual = x * x * y.derivatives[0].derivatives[0]
                + x * y.derivatives[0].value
                + (x * x - n * n) * y.value();
            assert!(residual.abs() < 1e-13, "order {order}: {residual}");
        }
        // Abramowitz and Stegun, table 9.1.
        assert_relative_eq!(bessel_j(0, 1.0), 0.765_197_686_557_966_6, max_relative = 1e-14);
    }
}
