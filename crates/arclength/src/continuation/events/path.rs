//! How a quantity runs between two solutions, as far as values and rates at both tell: how often it may pass zero.

use super::spectrum::Spectrum;
use num_complex::Complex64;

/// A quantity that a cubic says shrinks to this part of the smaller of its end values is looked at.
pub(super) const SUSPICIOUS: f64 = 0.3;
/// Places to which slopes at both ends lead are one if they are no farther apart than this part of the step.
const SAME_KINK: f64 = 0.3;
/// A step is divided no closer to its ends than this part.
const SMALLEST_FRACTION: f64 = 0.02;

/// Why a step is to be looked at more closely.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Suspicion {
    /// The fraction of the step at which to look.
    pub place: f64,
    /// Whether a quantity seems to come to zero from both sides without passing it, as it does where a step leads over to another branch
    /// through a branch point.
    pub is_kink: bool,
}

impl Suspicion {
    /// Something may hide near a fraction of a step.
    pub(super) fn at(fraction: f64) -> Self {
        Self { place: inside(fraction), is_kink: false }
    }
}

/// A fraction of a step at which it may be divided.
fn inside(fraction: f64) -> f64 {
    fraction.clamp(SMALLEST_FRACTION, 1.0 - SMALLEST_FRACTION)
}

/// Values and rates of a quantity at both ends of a step; rates are per step.
#[derive(Clone, Copy, Debug)]
pub(super) struct Path {
    pub ends: [f64; 2],
    pub slopes: [f64; 2],
    /// What values and rates say about the middle from both sides may differ by this much; the cubic is known as well.
    pub doubt: f64,
}

impl Path {
    pub(super) fn new(ends: [f64; 2], slopes: [f64; 2]) -> Self {
        let doubt = (ends[0] + 0.5 * slopes[0] - ends[1] + 0.5 * slopes[1]).abs();
        Self { ends, slopes, doubt }
    }

    fn cubic(&self, s: f64) -> f64 {
        let [c1, c2, c3] = self.coefficients();
        self.ends[0] + s * (c1 + s * (c2 + s * c3))
    }

    fn coefficients(&self) -> [f64; 3] {
        let ([a, b], [u, v]) = (self.ends, self.slopes);
        [u, 3.0 * (b - a) - 2.0 * u - v, u + v - 2.0 * (b - a)]
    }

    /// Places inside the step where the cubic turns, in order.
    fn turns(&self) -> Vec<f64> {
        let [c1, c2, c3] = self.coefficients();
        let (c2, c3) = (2.0 * c2, 3.0 * c3);
        let discriminant = c2 * c2 - 4.0 * c3 * c1;
        if discriminant.is_nan() || discriminant < 0.0 {
            return Vec::new();
        }
        let root = -0.5 * (c2 + discriminant.sqrt().copysign(c2));
        let mut turns: Vec<f64> =
            [root / c3, c1 / root].into_iter().filter(|s| *s > 0.0 && *s < 1.0).collect();
        turns.sort_by(f64::total_cmp);
        turns.dedup();
        turns
    }

    /// Where the quantity comes to zero by its slopes at both ends. It is zero there on both branches where a step leads over from one to
    /// the other through a branch point, and grows again on the other.
    fn kink(&self) -> Option<f64> {
        let ([a, b], [u, v]) = (self.ends, self.slopes);
        let [ahead, behind] = [-a / u, 1.0 - b / v];
        let inside = |place: f64| place > 0.0 && place < 1.0;
        let place = 0.5 * (ahead + behind);
        (inside(ahead) && inside(behind) && (ahead - behind).abs() < SAME_KINK).then_some(place)
    }

    /// Where the quantity may pass zero more often than the signs at the ends say; `None` where there is no doubt.
    pub(super) fn suspicious(&self) -> Option<Suspicion> {
        let [a, b] = self.ends;
        let least = a.abs().min(b.abs());
        let turns = self.turns();
        let mut is_kink = false;
        let place = if (a > 0.0) == (b > 0.0) {
            let sign = a.signum();
            let nearest = turns
                .into_iter()
                .map(|s| (s, sign * self.cubic(s)))
                .min_by(|one, other| one.1.total_cmp(&other.1));
            let kink = self.kink();
            is_kink = kink.is_some();
            match nearest {
                Some((s, value)) if value < (SUSPICIOUS * least).max(self.doubt) => Some(s),
                _ if is_kink => kink,
                // The cubic does not come close, but it may be far off.
                _ if self.doubt > least => Some(0.5),
                _ => None,
            }
        } else {
            // One crossing is certain; two more take a turn to the wrong side of zero and back.
            let value = |s: f64| a.signum() * self.cubic(s);
            match turns[..] {
                [one, other]
                    if value(one) < self.doubt && value(other) > -self.doubt && value(one) < value(other) =>
                {
                    Some(0.5 * (one + other))
                }
                _ if self.doubt > a.abs().max(b.abs()) => Some(0.5),
                _ => None,
            }
        };
        place.map(|place| Suspicion { is_kink, ..Suspicion::at(place) })
    }
}

/// For every exponent the index of the one that it becomes; `rates` are per step at both ends.
///
/// The predictions of the middle from both sides are compared; the closest pairs belong together.
pub(super) fn partners(
    before: &Spectrum,
    after: &Spectrum,
    rates: Option<(&[Complex64], &[Complex64])>,
) -> Vec<usize> {
    let count = before.exponents.len().min(after.exponents.len());
    let middle = |exponents: &[Complex64], rates: Option<&[Complex64]>, sign: f64| -> Vec<Complex64> {
        let shifted = exponents.iter().enumerate().map(|(index, value)| {
            let rate = rates.and_then(|rates| rates.get(index)).copied().unwrap_or_default();
            value + 0.5 * sign * rate
        });
        shifted.collect()
    };
    let ahead = middle(&before.exponents, rates.map(|rates| rates.0), 1.0);
    let behind = middle(&after.exponents, rates.map(|rates| rates.1), -1.0);
    let mut pairs: Vec<(f64, usize, usize)> = Vec::with_capacity(count * count);
    for (one, here) in ahead.iter().enumerate() {
        for (other, there) in behind.iter().enumerate() {
            let separation = before.separation(*here, *there);
            pairs.push((if separation.is_nan() { f64::INFINITY } else { separation }, one, other));
        }
    }
    pairs.sort_by(|one, other| one.0.total_cmp(&other.0));
    let mut partner = vec![usize::MAX; before.exponents.len()];
    let mut taken = vec![false; after.exponents.len()];
    for (_, one, other) in pairs {
        if partner[one] == usize::MAX && !taken[other] {
            partner[one] = other;
            taken[other] = true;
        }
    }
    partner.iter_mut().filter(|index| **index == usize::MAX).for_each(|index| *index = 0);
    partner
}

/// For every exponent the index of the one nearest to it, each used once.
pub(crate) fn nearest_partners(before: &Spectrum, after: &Spectrum) -> Vec<usize> {
    partners(before, after, None)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn path(f: impl Fn(f64) -> f64, slope: impl Fn(f64) -> f64) -> Path {
        Path::new([f(0.0), f(1.0)], [slope(0.0), slope(1.0)])
    }

    #[test]
    fn two_zeros_between_equal_signs_are_suspicious() {
        let hidden = path(|s| (s - 0.4) * (s - 0.5), |s| 2.0 * s - 0.9);
        let hidden = hidden.suspicious().unwrap();
        assert!(!hidden.is_kink && (hidden.place - 0.45).abs() < 1e-12);
        // Far from zero, monotone.
        assert!(path(|s| 5.0 + s, |_| 1.0).suspicious().is_none());
        // A minimum that stays away from zero.
        assert!(path(|s| 1.0 + (s - 0.5).powi(2), |s| 2.0 * (s - 0.5)).suspicious().is_none());
    }

    #[test]
    fn a_quantity_that_comes_to_zero_and_turns_back_at_once_is_suspicious() {
        let kink = path(|s| (s - 0.6_f64).abs(), |s| (s - 0.6_f64).signum()).suspicious().unwrap();
        assert!(kink.is_kink && (kink.place - 0.6).abs() < 1e-12);
    }

    #[test]
    fn three_zeros_between_different_signs_are_suspicious() {
        let f = |s: f64| (s - 0.2) * (s - 0.5) * (s - 0.8);
        let slope = |s: f64| (s - 0.5) * (s - 0.8) + (s - 0.2) * (s - 0.8) + (s - 0.2) * (s - 0.5);
        assert!(path(f, slope).suspicious().is_some());
        assert!(path(|s| s - 0.3, |_| 1.0).suspicious().is_none());
    }

    #[test]
    fn exponents_that_pass_each_other_are_told_apart_by_their_rates() {
        let spectrum = |values: [f64; 2]| Spectrum {
            exponents: values.map(Complex64::from).to_vec(),
            ..Spectrum::default()
        };
        // From 1 to -3 and from -1 to 2, sorted at both ends.
        let (before, after) = (spectrum([1.0, -1.0]), spectrum([2.0, -3.0]));
        let rates = [-4.0, 3.0].map(Complex64::from);
        let behind = [3.0, -4.0].map(Complex64::from);
        assert_eq!(partners(&before, &after, Some((&rates, &behind))), [1, 0]);
        assert_eq!(partners(&before, &after, None), [0, 1]);
    }
}
