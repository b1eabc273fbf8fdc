//! Quantiles of Student's t and tails of the chi-squared distribution.

use std::f64::consts::PI;

/// Smallest change of a continued fraction or series that counts.
const SMALLEST_CHANGE: f64 = 1e-15;
/// Most terms of them.
const MOST_TERMS: usize = 10_000;
/// Stands for a zero denominator.
const TINY: f64 = 1e-300;
/// Degrees of freedom from which on t is normal to four digits of the difference.
const NEARLY_NORMAL: f64 = 1e6;
/// The 97.5 per cent quantile of the normal distribution.
const NORMAL_QUANTILE: f64 = 1.959_963_984_540_054;

/// The half width of a 95 per cent interval in standard errors that were estimated with so many degrees of freedom; infinite ones are
/// a standard deviation that is known.
pub(super) fn half_width(degrees_of_freedom: f64) -> f64 {
    if degrees_of_freedom > NEARLY_NORMAL {
        return NORMAL_QUANTILE;
    }
    // P(|t| > x) = I(n/(n + x^2); n/2, 1/2) falls with x.
    let outside = |x: f64| {
        let part = degrees_of_freedom / (degrees_of_freedom + x * x);
        incomplete_beta(part, 0.5 * degrees_of_freedom, 0.5)
    };
    let (mut low, mut high) = (1.0, 1e3);
    for _ in 0..100 {
        let middle = 0.5 * (low + high);
        if outside(middle) > 0.05 { low = middle } else { high = middle }
    }
    0.5 * (low + high)
}

/// The probability that a chi-squared variable exceeds a value.
pub(super) fn chi_squared_tail(value: f64, degrees_of_freedom: f64) -> f64 {
    if value <= 0.0 {
        return 1.0;
    }
    incomplete_gamma_tail(0.5 * degrees_of_freedom, 0.5 * value)
}

/// `ln Gamma(x)` of a positive number, by the coefficients of Lanczos for g = 7.
fn ln_gamma(x: f64) -> f64 {
    const COEFFICIENTS: [f64; 8] = [
        676.520_368_121_885_1,
        -1_259.139_216_722_402_8,
        771.323_428_777_653_1,
        -176.615_029_162_140_6,
        12.507_343_278_686_905,
        -0.138_571_095_265_720_12,
        9.984_369_578_019_572e-6,
        1.505_632_735_149_311_6e-7,
    ];
    let shifted = x - 1.0;
    let terms =
        COEFFICIENTS.iter().zip(1..).map(|(coefficient, index)| coefficient / (shifted + f64::from(index)));
    let sum = 0.999_999_999_999_809_9 + terms.sum::<f64>();
    let height = shifted + 7.5;
    0.5 * (2.0 * PI).ln() + (shifted + 0.5) * height.ln() - height + sum.ln()
}

/// A continued fraction `b0 + a1/(b1 + a2/(b2 + ..))` by the method of Lentz; `terms` are `(a, b)` from the first on.
fn continued_fraction(b0: f64, terms: impl Iterator<Item = (f64, f64)>) -> f64 {
    let not_zero = |x: f64| if x.abs() < TINY { TINY } else { x };
    let mut value = not_zero(b0);
    let (mut upper, mut lower) = (value, 0.0);
    for (a, b) in terms.take(MOST_TERMS) {
        lower = 1.0 / not_zero(b + a * lower);
        upper = not_zero(b + a / upper);
        let change = upper * lower;
        value *= change;
        if (change - 1.0).abs() < SMALLEST_CHANGE {
            break;
        }
    }
    value
}

/// The regularised incomplete beta function `I(x; a, b)`.
fn incomplete_beta(x: f64, a: f64, b: f64) -> f64 {
    if x <= 0.0 || x >= 1.0 {
        return x.clamp(0.0, 1.0);
    }
    if x > (a + 1.0) / (a + b + 2.0) {
        return 1.0 - incomplete_beta(1.0 - x, b, a);
    }
    let front = (a * x.ln() + b * (-x).ln_1p() + ln_gamma(a + b) - ln_gamma(a) - ln_gamma(b)).exp() / a;
    let terms = (1..).map(|index| {
        let m = f64::from(index / 2);
        let numerator = if index % 2 == 0 {
            m * (b - m) * x / ((a + 2.0 * m - 1.0) * (a + 2.0 * m))
        } else {
            -(a + m) * (a + b + m) * x / ((a + 2.0 * m) * (a + 2.0 * m + 1.0))
        };
        (numerator, 1.0)
    });
    front / continued_fraction(1.0, terms)
}

/// The regularised upper incomplete gamma function `Q(a, x)`.
fn incomplete_gamma_tail(a: f64, x: f64) -> f64 {
    let front = (a * x.ln() - x - ln_gamma(a)).exp();
    if x < a + 1.0 {
        let mut term = 1.0 / a;
        let mut sum = term;
        for index in (1..).take(MOST_TERMS) {
            term *= x / (a + f64::from(index));
            sum += term;
            if term < SMALLEST_CHANGE * sum {
                break;
            }
        }
        return 1.0 - front * sum;
    }
    let terms = (1..).map(|index| {
        let i = f64::from(index);
        (-i * (i - a), x + 2.0 * i + 1.0 - a)
    });
    front / continued_fraction(x + 1.0 - a, terms)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn quantiles_are_those_of_tables() {
        // scipy.stats.t.ppf(0.975, n)
        for (degrees_of_freedom, expected) in [
            (1.0, 12.706_204_736_174_694),
            (2.0, 4.302_652_729_749_462),
            (7.0, 2.364_624_251_592_784),
            (30.0, 2.042_272_456_301_237_8),
            (193.0, 1.972_331_675_795_749_9),
            (5000.0, 1.960_438_551_706_507_3),
        ] {
            let found = half_width(degrees_of_freedom);
            assert!((found / expected - 1.0).abs() < 1e-9, "{degrees_of_freedom}: {found} {expected}");
        }
        assert_eq!(half_width(f64::INFINITY), NORMAL_QUANTILE);
    }

    #[test]
    fn tails_are_those_of_tables() {
        // scipy.stats.chi2.sf(x, n)
        for (value, degrees_of_freedom, expected) in [
            (3.841_458_820_694_124, 1.0, 0.05),
            (10.0, 10.0, 0.440_493_285_065_212_6),
            (40.0, 20.0, 0.004_995_412_308_307_578_5),
            (180.0, 200.0, 0.841_779_010_813_57),
        ] {
            let found = chi_squared_tail(value, degrees_of_freedom);
            assert!((found / expected - 1.0).abs() < 1e-8, "{value}: {found} {expected}");
        }
    }
}
