//! Intervals that enclose what an operation gives for every operand in other intervals.

use crate::expression::{BinaryOperation, UnaryOperation};
use crate::tape::{apply_binary, apply_unary};
use std::f64::consts::{FRAC_PI_2, PI, TAU};

/// All numbers from `low` to `high`. A single number is what floating-point arithmetic gives for it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Interval {
    pub low: f64,
    pub high: f64,
}

impl Interval {
    pub(crate) const ALL: Self = Self { low: f64::NEG_INFINITY, high: f64::INFINITY };
    const TRUTH: Self = Self { low: 0.0, high: 1.0 };

    pub(crate) fn point(value: f64) -> Self {
        if value.is_nan() { Self::ALL } else { Self { low: value, high: value } }
    }

    pub(crate) fn is_point(self) -> bool {
        self.low == self.high
    }

    pub(crate) fn contains(self, value: f64) -> bool {
        self.low <= value && value <= self.high
    }

    /// The smallest interval around numbers, widened by what they may be rounded.
    fn around(values: &[f64]) -> Self {
        if values.iter().any(|value| value.is_nan()) {
            return Self::ALL;
        }
        let low = values.iter().copied().fold(f64::INFINITY, f64::min);
        let high = values.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        if low == high { Self { low, high } } else { Self { low: low.next_down(), high: high.next_up() } }
    }

    pub(crate) fn hull(self, other: Self) -> Self {
        Self { low: self.low.min(other.low), high: self.high.max(other.high) }
    }

    /// Whether it is not zero, where that is decided.
    pub(crate) fn truth(self) -> Option<bool> {
        if self.contains(0.0) { self.is_point().then_some(false) } else { Some(true) }
    }

    fn of_truth(decided: Option<bool>) -> Self {
        decided.map_or(Self::TRUTH, |truth| Self::point(f64::from(u8::from(truth))))
    }

    fn ends(self, function: impl Fn(f64) -> f64) -> Self {
        Self::around(&[function(self.low), function(self.high)])
    }

    fn corners(self, other: Self, function: impl Fn(f64, f64) -> f64) -> Self {
        Self::around(&[
            function(self.low, other.low),
            function(self.low, other.high),
            function(self.high, other.low),
            function(self.high, other.high),
        ])
    }

    /// `sin(x)` with `peak` pi/2, `cos(x)` with `peak` 0.
    fn wave(self, function: impl Fn(f64) -> f64, peak: f64) -> Self {
        let mut range = self.ends(function);
        // An extreme within rounding of the ends counts.
        let slack = 4.0 * f64::EPSILON * self.low.abs().max(self.high.abs()).max(1.0);
        let reaches = |place: f64| {
            let first = place + TAU * ((self.low - slack - place) / TAU).ceil();
            first.is_nan() || first <= self.high + slack
        };
        if reaches(peak) {
            range.high = 1.0;
        }
        if reaches(peak + PI) {
            range.low = -1.0;
        }
        range
    }

    pub(crate) fn unary(self, operation: UnaryOperation) -> Self {
        use UnaryOperation as U;
        if self.is_point() {
            return Self::point(apply_unary(operation, self.low));
        }
        let Self { low, high } = self;
        let apply = |value: f64| apply_unary(operation, value);
        match operation {
            U::Exponential
            | U::HyperbolicSine
            | U::HyperbolicTangent
            | U::InverseTangent
            | U::RelativeExponential
            | U::ErrorFunction
            | U::ComplementaryErrorFunction => self.ends(apply),
            U::Negate => Self { low: -high, high: -low },
            U::Heaviside | U::Sign | U::Floor | U::Ceiling => Self { low: apply(low), high: apply(high) },
            U::SquareRoot | U::Logarithm | U::DecimalLogarithm | U::BinaryLogarithm if low >= 0.0 => {
                self.ends(apply)
            }
            U::InverseSine | U::InverseCosine if low >= -1.0 && high <= 1.0 => self.ends(apply),
            U::Reciprocal if !self.contains(0.0) => self.ends(apply),
            U::AbsoluteValue | U::HyperbolicCosine if self.contains(0.0) => {
                Self { low: apply(0.0), ..self.ends(apply) }
            }
            U::AbsoluteValue | U::HyperbolicCosine => self.ends(apply),
            U::Sine => self.wave(f64::sin, FRAC_PI_2),
            U::Cosine => self.wave(f64::cos, 0.0),
            U::Tangent if !self.wave(f64::cos, 0.0).contains(0.0) => self.ends(apply),
            U::Not => Self::of_truth(self.truth().map(|truth| !truth)),
            _ => Self::ALL,
        }
    }

    pub(crate) fn binary(self, operation: BinaryOperation, other: Self) -> Self {
        use BinaryOperation as B;
        let (a, b) = (self, other);
        if a.is_point() && b.is_point() {
            return Self::point(apply_binary(operation, a.low, b.low));
        }
        match operation {
            B::Add => Self::around(&[a.low + b.low, a.high + b.high]),
            B::Subtract => Self::around(&[a.low - b.high, a.high - b.low]),
            B::Multiply => a.corners(b, |a, b| a * b),
            B::Divide if !b.contains(0.0) => a.corners(b, |a, b| a / b),
            B::Power if a.low > 0.0 => a.corners(b, f64::powf),
            B::Norm => a.unary(UnaryOperation::SquareRoot),
            B::Maximum => Self { low: a.low.max(b.low), high: a.high.max(b.high) },
            B::Minimum => Self { low: a.low.min(b.low), high: a.high.min(b.high) },
            B::Modulo => a.modulo(b),
            B::And => Self::of_truth(match (a.truth(), b.truth()) {
                (Some(false), _) | (_, Some(false)) => Some(false),
                (Some(true), Some(true)) => Some(true),
                _ => None,
            }),
            B::Or => Self::of_truth(match (a.truth(), b.truth()) {
                (Some(true), _) | (_, Some(true)) => Some(true),
                (Some(false), Some(false)) => Some(false),
                _ => None,
            }),
            B::Greater => Self::of_truth(a.is_above(b, false)),
            B::Less => Self::of_truth(b.is_above(a, false)),
            B::GreaterOrEqual => Self::of_truth(a.is_above(b, true)),
            B::LessOrEqual => Self::of_truth(b.is_above(a, true)),
            B::Equal => Self::of_truth((a.high < b.low || b.high < a.low).then_some(false)),
            B::NotEqual => Self::of_truth((a.high < b.low || b.high < a.low).then_some(true)),
            B::Divide | B::Power | B::InverseTangent2 => Self::ALL,
        }
    }

    /// Whether every number is above every one of the other, or none is; `or_equal` counts equality as above.
    fn is_above(self, other: Self, or_equal: bool) -> Option<bool> {
        if self.low > other.high || or_equal && self.low == other.high {
            Some(true)
        } else if self.high < other.low || !or_equal && self.high == other.low {
            Some(false)
        } else {
            None
        }
    }

    fn modulo(self, divisor: Self) -> Self {
        let size = divisor.low.abs().max(divisor.high.abs());
        if !(divisor.is_point() && divisor.low > 0.0) {
            return Self { low: -2.0 * size, high: 2.0 * size };
        }
        let quotients = [self.low / size, self.high / size].map(f64::floor);
        if quotients[0] != quotients[1] {
            return Self { low: 0.0, high: size };
        }
        self.ends(|value| apply_binary(BinaryOperation::Modulo, value, size))
    }

    pub(crate) fn whole_power(self, exponent: i32) -> Self {
        let power = |value: f64| value.powi(exponent);
        match (self.contains(0.0) && !self.is_point(), exponent) {
            (true, ..0) => Self::ALL,
            (true, _) if exponent % 2 == 0 => Self { low: 0.0, ..self.ends(power) },
            _ => self.ends(power),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_interval_encloses_what_the_operations_give() {
        use BinaryOperation as B;
        use UnaryOperation as U;
        let places = [-7.3, -2.0, -1.0, -0.4, 0.0, 0.3, 1.0, 1.9, 2.0, 6.5];
        let pairs = || {
            places.iter().enumerate().flat_map(|(i, &low)| places[i..].iter().map(move |&high| (low, high)))
        };
        let within = |(low, high): (f64, f64)| {
            (0..=16).map(move |k| (low + (high - low) * f64::from(k) / 16.0).min(high))
        };
        for (low, high) in pairs() {
            let interval = Interval { low, high };
            for operation in [
                U::Negate,
                U::Reciprocal,
                U::SquareRoot,
                U::Exponential,
                U::Logarithm,
                U::Sine,
                U::Cosine,
                U::Tangent,
                U::InverseSine,
                U::InverseCosine,
                U::InverseTangent,
                U::HyperbolicSine,
                U::HyperbolicCosine,
                U::HyperbolicTangent,
                U::AbsoluteValue,
                U::Heaviside,
                U::Sign,
                U::Floor,
                U::Ceiling,
                U::Not,
                U::RelativeExponential,
                U::ErrorFunction,
                U::ComplementaryErrorFunction,
                U::BesselJ(0),
            ] {
                let image = interval.unary(operation);
                for value in within((low, high)) {
                    let value = apply_unary(operation, value);
                    assert!(
                        value.is_nan() || image.contains(value),
                        "{operation:?} {interval:?} {image:?} {value}"
                    );
                }
            }
            for exponent in [-3, -2, 3, 5, 6] {
                let image = interval.whole_power(exponent);
                assert!(
                    within((low, high)).all(|value| image.contains(value.powi(exponent))),
                    "{interval:?}^{exponent}"
                );
            }
            for (other_low, other_high) in pairs() {
                let other = Interval { low: other_low, high: other_high };
                for operation in [
                    B::Add,
                    B::Subtract,
                    B::Multiply,
                    B::Divide,
                    B::Power,
                    B::InverseTangent2,
                    B::Norm,
                    B::Maximum,
                    B::Minimum,
                    B::Modulo,
                    B::And,
                    B::Or,
                    B::Greater,
                    B::Less,
                    B::Equal,
                    B::GreaterOrEqual,
                    B::LessOrEqual,
                    B::NotEqual,
                ] {
                    let image = interval.binary(operation, other);
                    for a in within((low, high)) {
                        for b in within((other_low, other_high)) {
                            let value = apply_binary(operation, a, b);
                            assert!(
                                value.is_nan() || image.contains(value),
                                "{operation:?} {interval:?} {other:?} {image:?} {a} {b} {value}"
                            );
                        }
                    }
                }
            }
        }
    }
}
