//! The maxima of the caster angle along a motion, whether they repeat themselves, and how its size scatters.

use super::course::Node;
use crate::shimmy::extrema::extremum;

/// So many maxima in a row must be those of one cycle before, which has up to `MOST_MAXIMA`, ...
pub(super) const RUN: usize = 12;
const MOST_MAXIMA: usize = 8;
/// ... to this part of the range of the angle.
const REPEATED: f64 = 1e-6;
/// The size of an irregular motion is compared between the two halves of so many windows.
pub(super) const WINDOWS: usize = 20;
/// Means that differ by so many standard errors show a trend, ...
const STANDARD_ERRORS: f64 = 3.0;
/// ... and so do variances with such a ratio: a motion that leaves in the end scatters only then. Independent normal numbers
/// exceed it once in a thousand times (F distribution, 9 and 9 degrees of freedom).
const VARIANCE_RATIO: f64 = 10.0;
/// A size that scatters less than this in either half, relative to its mean, is not that of an irregular motion.
const LEAST_SCATTER: f64 = 1e-3;

/// A caster that swings by less than this, in rad, is at rest but for rounding.
const LEAST_SIZE: f64 = 1e-6;

/// A place where the caster angle is largest.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Maximum {
    /// Caster angle in rad.
    pub angle: f64,
    /// `(u, q, psi, V, Omega)` there, between two nodes of the motion.
    pub state: [f64; 5],
}

/// The maxima of the caster angle in one period of a motion that repeats itself.
pub(super) struct Cycle {
    pub maxima: Vec<Maximum>,
    /// Largest less smallest caster angle.
    pub range: f64,
}

/// The maxima of the caster angle along a motion, and its size.
#[derive(Clone, Debug, Default)]
pub(super) struct Maxima {
    before: Option<Node>,
    list: Vec<Maximum>,
    /// Smallest and largest angle in the present window, which began at a time.
    window: Option<(f64, [f64; 2])>,
    /// Ranges of the angle in the windows before.
    ranges: Vec<f64>,
}

impl Maxima {
    /// Those that were passed, in order.
    pub(super) fn list(&self) -> &[Maximum] {
        &self.list
    }

    /// Takes a node into account; `start` is when its piece began, `length` that of the windows in which the size is taken.
    pub(super) fn take(&mut self, start: f64, node: &Node, length: f64) {
        let node = Node { time: start + node.time, ..*node };
        let mut reached = [node.angle[0]; 2];
        if let Some(before) = self.before.replace(node) {
            let slopes = [before.angle[1], node.angle[1]];
            if before.time < node.time && (slopes[0] > 0.0) != (slopes[1] > 0.0) {
                let angle = extremum((before.time, before.angle), (node.time, node.angle));
                reached = [reached[0].min(angle), reached[1].max(angle)];
                if slopes[0] > 0.0 {
                    let part = slopes[0] / (slopes[0] - slopes[1]);
                    let between = |i: usize| before.state[i] + part * (node.state[i] - before.state[i]);
                    self.list.push(Maximum { angle, state: std::array::from_fn(between) });
                }
            }
        }
        let (began, [low, high]) = *self.window.get_or_insert((node.time, reached));
        let range = [low.min(reached[0]), high.max(reached[1])];
        self.window = Some((began, range));
        if node.time - began >= length {
            self.ranges.push(range[1] - range[0]);
            self.window = None;
        }
    }

    /// The cycle that the last maxima repeat, where they do.
    pub(super) fn cycle(&self) -> Option<Cycle> {
        let range = match (self.ranges.last(), self.window) {
            (Some(range), _) => *range,
            (None, Some((_, [low, high]))) => high - low,
            (None, None) => return None,
        };
        let count = (1..=MOST_MAXIMA).find(|&count| {
            self.list.len() >= RUN + count && {
                let last = self.list[self.list.len() - RUN - count..].windows(count + 1);
                last.into_iter().all(|pair| (pair[count].angle - pair[0].angle).abs() < REPEATED * range)
            }
        })?;
        Some(Cycle { maxima: self.list[self.list.len() - count..].to_vec(), range })
    }

    /// Whether the size of the motion scatters from window to window and has no trend.
    pub(super) fn is_irregular(&self) -> bool {
        let Some(first) = self.ranges.len().checked_sub(WINDOWS) else { return false };
        let (early, late) = self.ranges[first..].split_at(WINDOWS / 2);
        let mean = |values: &[f64]| values.iter().sum::<f64>() / values.len() as f64;
        let variance = |values: &[f64]| {
            let centre = mean(values);
            values.iter().map(|value| (value - centre).powi(2)).sum::<f64>() / (values.len() - 1) as f64
        };
        let [before, after] = [variance(early), variance(late)];
        let size = 0.5 * (mean(early) + mean(late));
        let error = ((before + after) / (WINDOWS / 2) as f64).sqrt();
        size > LEAST_SIZE
            && before.min(after).sqrt() > LEAST_SCATTER * size
            && before.max(after) < VARIANCE_RATIO * before.min(after)
            && (mean(early) - mean(late)).abs() < STANDARD_ERRORS * error
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The maxima of an angle sampled with its derivatives.
    fn maxima(end: f64, angle: impl Fn(f64) -> [f64; 3]) -> Maxima {
        let mut maxima = Maxima::default();
        for index in 0..=(end * 10.0) as usize {
            let time = 0.1 * index as f64;
            maxima.take(0.0, &Node { time, angle: angle(time), state: [0.0; 5] }, 30.0);
        }
        maxima
    }

    fn modulated(size: impl Fn(f64) -> f64 + Copy) -> impl Fn(f64) -> [f64; 3] {
        move |time: f64| {
            let amplitude = size(time);
            [amplitude * time.sin(), amplitude * time.cos(), -amplitude * time.sin()]
        }
    }

    #[test]
    fn repeated_maxima_are_a_cycle() {
        let single = maxima(200.0, modulated(|_| 1.0)).cycle().unwrap();
        assert_eq!(single.maxima.len(), 1);
        assert!((single.maxima[0].angle - 1.0).abs() < 1e-7 && (single.range - 2.0).abs() < 1e-6);
        let double = maxima(200.0, |time| {
            let half = 0.5 * time;
            [time.sin() + 0.3 * half.cos(), time.cos() - 0.15 * half.sin(), -time.sin() - 0.075 * half.cos()]
        });
        assert_eq!(double.cycle().unwrap().maxima.len(), 2);
        assert!(maxima(200.0, modulated(|time| (-1e-5 * time).exp())).cycle().is_none());
    }

    #[test]
    fn a_size_with_a_trend_is_not_irregular() {
        assert!(!maxima(1000.0, modulated(|_| 1.0)).is_irregular());
        assert!(!maxima(1000.0, modulated(|time| 1.0 - 1e-4 * time)).is_irregular());
        assert!(!maxima(1000.0, modulated(|time| 1.0 + 1e-4 * (0.01 * time).exp())).is_irregular());
        // Steady but for rounding, then away: in the last window, over some, or all the time.
        for rate in [0.005, 0.02, 0.1, 0.5] {
            let leaves = modulated(move |time: f64| {
                1.0 + 1e-3 * (0.7 * time).sin() + 0.5 * (rate * (time - 999.0)).exp()
            });
            assert!(!maxima(999.0, leaves).is_irregular(), "{rate}");
        }
        let beating = modulated(|time: f64| 1.0 + 0.1 * (0.0137 * time).sin() * (0.7 * time).cos());
        assert!(maxima(1000.0, beating).is_irregular());
    }
}
