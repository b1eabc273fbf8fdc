//! An axis: its label, scale and limits, and the mapping from data to the page.

use crate::ticks::{self, Ticks};

/// Share of the range that automatic limits leave free at each end.
const PADDING: f64 = 0.04;

/// One axis of a panel.
///
/// ```
/// use kingpin_figure::Axis;
/// let speed = Axis::new("$v$ (m/s)").limits(0.0, 12.0);
/// let error = Axis::new("relative error").logarithmic();
/// ```
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Axis {
    pub(crate) label: String,
    pub(crate) limits: Option<(f64, f64)>,
    pub(crate) logarithmic: bool,
    pub(crate) tight: bool,
    pub(crate) labels_hidden: bool,
    pub(crate) ticks: Option<Vec<(f64, String)>>,
}

impl Axis {
    /// An axis with a label in markup, such as `"$\\psi_0$ (rad)"`; limits are taken from the data.
    pub fn new(label: impl Into<String>) -> Self {
        Self { label: label.into(), ..Self::default() }
    }

    /// Fixed limits; when `low > high` the axis runs backwards. Limits that are equal, not finite, or not positive on a
    /// logarithmic axis are passed over and taken from the data instead.
    pub fn limits(self, low: f64, high: f64) -> Self {
        Self { limits: Some((low, high)), ..self }
    }

    /// A logarithmic scale; values that are not positive are gaps.
    pub fn logarithmic(self) -> Self {
        Self { logarithmic: true, ..self }
    }

    /// Automatic limits end exactly where the data end.
    pub fn tight(self) -> Self {
        Self { tight: true, ..self }
    }

    /// Ticks without numbers and an axis without label, for panels that share the axis of a neighbour.
    pub fn without_labels(self) -> Self {
        Self { labels_hidden: true, ..self }
    }

    /// Own ticks with labels in markup, in place of the chosen ones.
    pub fn ticks<T: Into<String>>(self, ticks: impl IntoIterator<Item = (f64, T)>) -> Self {
        Self { ticks: Some(ticks.into_iter().map(|(value, label)| (value, label.into())).collect()), ..self }
    }

    /// The scale for data within the given range, `None` when there are no data.
    pub(crate) fn scale(&self, data: Range) -> Scale {
        let usable = |(low, high): &(f64, f64)| {
            low.is_finite()
                && high.is_finite()
                && low != high
                && (!self.logarithmic || (*low > 0.0 && *high > 0.0))
        };
        if let Some((low, high)) = self.limits.filter(usable) {
            return Scale { low, high, logarithmic: self.logarithmic };
        }
        let range = if self.logarithmic { data.positive() } else { data.all() };
        let (mut low, mut high) = match (range, self.logarithmic) {
            (Some((low, high)), true) => (low.log10(), high.log10()),
            (Some(range), false) => range,
            (None, _) => (0.0, 1.0),
        };
        if high - low <= 1e-12 * low.abs().max(high.abs()) {
            // All values equal: a window around the value, of its own size.
            let half = if low == 0.0 { 1.0 } else { 0.5 * low.abs() };
            (low, high) = (low - half, high + half);
        } else if !self.tight {
            let padding = PADDING * (high - low);
            (low, high) = (low - padding, high + padding);
        }
        if self.logarithmic {
            // Beyond these powers the limits themselves could not be represented.
            (low, high) = (10f64.powf(low.max(-300.0)), 10f64.powf(high.min(300.0)));
        } else {
            (low, high) = (low.max(f64::MIN / 4.0), high.min(f64::MAX / 4.0));
        }
        Scale { low, high, logarithmic: self.logarithmic }
    }
}

/// The range of the finite values seen, and of the positive ones among them.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Range {
    low: f64,
    high: f64,
    lowest_positive: f64,
}

impl Default for Range {
    fn default() -> Self {
        Self { low: f64::INFINITY, high: f64::NEG_INFINITY, lowest_positive: f64::INFINITY }
    }
}

impl Range {
    pub(crate) fn include(&mut self, value: f64) {
        if !value.is_finite() {
            return;
        }
        self.low = self.low.min(value);
        self.high = self.high.max(value);
        if value > 0.0 {
            self.lowest_positive = self.lowest_positive.min(value);
        }
    }

    pub(crate) fn all(&self) -> Option<(f64, f64)> {
        (self.low <= self.high).then_some((self.low, self.high))
    }

    fn positive(&self) -> Option<(f64, f64)> {
        (self.lowest_positive <= self.high).then_some((self.lowest_positive, self.high))
    }
}

/// The mapping from data to the fraction of an axis.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Scale {
    pub low: f64,
    pub high: f64,
    pub logarithmic: bool,
}

impl Scale {
    /// 0 at the low limit, 1 at the high one; not a number for what a logarithmic axis cannot show.
    pub(crate) fn fraction(&self, value: f64) -> f64 {
        if self.logarithmic {
            if value <= 0.0 {
                return f64::NAN;
            }
            (value / self.low).log10() / (self.high / self.low).log10()
        } else {
            (value - self.low) / (self.high - self.low)
        }
    }

    /// The value at a fraction of the axis.
    pub(crate) fn value(&self, fraction: f64) -> f64 {
        if self.logarithmic {
            self.low * (self.high / self.low).powf(fraction)
        } else {
            self.low + fraction * (self.high - self.low)
        }
    }

    pub(crate) fn ticks(&self, target: usize) -> Ticks {
        if self.logarithmic {
            ticks::logarithmic(self.low, self.high, target)
        } else {
            ticks::linear(self.low, self.high, target)
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn range(values: &[f64]) -> Range {
        let mut range = Range::default();
        values.iter().for_each(|value| range.include(*value));
        range
    }

    #[test]
    fn degenerate_data_give_a_window() {
        for values in
            [vec![], vec![3.0], vec![0.0, 0.0], vec![f64::NAN], vec![-1e-300], vec![f64::MAX, f64::MIN]]
        {
            for axis in [Axis::new("x"), Axis::new("x").logarithmic(), Axis::new("x").tight()] {
                let scale = axis.scale(range(&values));
                assert!(
                    scale.low.is_finite() && scale.high.is_finite() && scale.low < scale.high,
                    "{values:?}"
                );
            }
        }
    }

    #[test]
    fn unusable_limits_are_passed_over() {
        let data = range(&[1.0, 2.0]);
        for (low, high) in [(1.0, 1.0), (f64::NAN, 2.0), (0.0, f64::INFINITY)] {
            assert_eq!(Axis::new("x").limits(low, high).scale(data), Axis::new("x").scale(data));
        }
        assert_eq!(Axis::new("x").limits(5.0, 1.0).scale(data).fraction(5.0), 0.0);
    }

    proptest! {
        #[test]
        fn fraction_and_value_are_inverse(low in 0.1..10.0_f64, span in 0.1..100.0_f64, t in 0.0..1.0_f64) {
            for logarithmic in [false, true] {
                let scale = Scale { low, high: low + span, logarithmic };
                prop_assert!((scale.fraction(scale.value(t)) - t).abs() < 1e-9);
            }
        }

        #[test]
        fn data_lie_inside_automatic_limits(values in proptest::collection::vec(-1e9..1e9_f64, 1..20)) {
            let scale = Axis::new("x").scale(range(&values));
            prop_assert!(values.iter().all(|v| scale.low <= *v && *v <= scale.high));
        }
    }
}
