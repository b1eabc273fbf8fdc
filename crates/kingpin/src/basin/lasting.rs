//! Motions that last: whether they are shimmy, or only slow to leave or to return.
//!
//! A motion near an unstable cycle, or one that hardly decays, keeps its amplitude for long, so that a steady amplitude
//! alone says nothing. Here a motion is shimmy if the maxima of the caster angle repeat themselves (Poincare's return map, seen through
//! one coordinate) *and* the motion comes back to them after it was pushed, outwards and inwards: from an
//! unstable cycle it would go away. A motion that never repeats itself is shimmy if its size scatters without a trend.

use super::course::{Course, Node};
use super::fate::{Fate, PATIENCE, Target, Watch};
use crate::shimmy::extrema::extremum;
use crate::simulation::SimulationError;
use arclength::control::Control;
use arclength::integration::IntegrationError;

/// Nodes in one natural period of the springs: enough for maxima of motions with sliding phases to be right to a part of `REPEATED`.
const NODES_PER_PERIOD: f64 = 384.0;
/// Natural periods that are followed at a time.
const PERIODS_AT_A_TIME: f64 = 5.0;
/// So many maxima in a row must be those of one cycle before, which has up to `MOST_MAXIMA`, ...
const RUN: usize = 12;
const MOST_MAXIMA: usize = 8;
/// ... to this part of the range of the angle.
const REPEATED: f64 = 1e-6;
/// Part of its deviation from the uniform motion by which a motion is pushed.
const PUSH: f64 = 1e-3;
/// It has come back when its maxima are so near, in units of the push and the range of the angle, and is gone when so far.
const BACK: f64 = 0.1;
const GONE: f64 = 30.0;
/// The size of an irregular motion is taken in windows of so many natural periods, and compared between the two halves of so many
/// windows.
const PERIODS_PER_WINDOW: f64 = 10.0;
const WINDOWS: usize = 20;
/// Means that differ by so many standard errors show a trend, ...
const STANDARD_ERRORS: f64 = 3.0;
/// ... and so do variances with such a ratio: a motion that leaves in the end scatters only then. Independent normal numbers
/// exceed it once in a thousand times (F distribution, 9 and 9 degrees of freedom).
const VARIANCE_RATIO: f64 = 10.0;
/// A size that scatters less than this in either half, relative to its mean, is not that of an irregular motion.
const LEAST_SCATTER: f64 = 1e-3;
/// Natural periods for which a motion is looked at in passing, and those which it takes to tell whether it is irregular.
pub(super) const BRIEF: f64 = 60.0;
pub(super) const THOROUGH: f64 = PERIODS_PER_WINDOW * (WINDOWS + 1) as f64;

/// A motion that is followed until it is known what becomes of it.
#[derive(Clone, Debug)]
pub(super) struct Lasting<'a> {
    course: Course<'a>,
    time: f64,
    maxima: Maxima,
    /// Not before this time is it pushed.
    push_after: f64,
}

/// What is known of a motion when it was followed for a while.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Seen {
    /// Where it ends.
    Ends(Fate),
    /// It still swings to and fro.
    Swings,
}

impl<'a> Lasting<'a> {
    /// From where it is at a time.
    pub(super) fn new(course: Course<'a>, time: f64) -> Self {
        Self { course, time, maxima: Maxima::default(), push_after: 0.0 }
    }

    /// Time that was reached.
    pub(super) fn time(&self) -> f64 {
        self.time
    }

    /// State `(u, q, psi, V, Omega)` there.
    pub(super) fn state(&self) -> [f64; 5] {
        self.course.state()
    }

    /// Follows the motion until its fate is known or a time is reached.
    ///
    /// # Errors
    /// A motion that cannot be followed for another reason than that it grows without bound or takes too many steps;
    /// [`SimulationError::Interrupted`].
    pub(super) fn follow(
        &mut self,
        until: f64,
        target: &Target,
        watch: &mut Watch,
        control: &Control<'_>,
    ) -> Result<Seen, SimulationError> {
        let piece = PERIODS_AT_A_TIME * target.natural_period;
        let spacing = target.natural_period / NODES_PER_PERIOD;
        let mut nodes = Vec::new();
        while self.time < until {
            let duration = piece.min(until - self.time);
            match self.course.follow(duration, spacing, &mut nodes, control) {
                Ok(()) => {}
                Err(error) => return ended_by(error, watch).map(Seen::Ends),
            }
            for node in &nodes {
                if watch.observe(self.time + node.time, &node.state).is_break() {
                    return Ok(watch.fate().map_or(Seen::Swings, Seen::Ends));
                }
                self.maxima.take(self.time, node, PERIODS_PER_WINDOW * target.natural_period);
            }
            // The end itself, not the sum of the pieces, where rounding would leave a rest.
            self.time = if duration < piece { until } else { self.time + duration };
            if self.time >= self.push_after
                && let Some(cycle) = self.maxima.cycle()
            {
                let patience = watch.duration().max(BRIEF * target.natural_period);
                if self.comes_back(&cycle, patience, target, control)? {
                    return Ok(Seen::Ends(Fate::Shimmy));
                }
                // It lingers at a cycle that does not attract, and may leave it yet.
                self.push_after = 2.0 * self.time;
            }
        }
        Ok(Seen::Swings)
    }

    /// Follows a motion to the end of the patience.
    ///
    /// # Errors
    /// As [`follow`](Self::follow).
    pub(super) fn until_the_end(
        mut self,
        target: &Target,
        mut watch: Watch,
        control: &Control<'_>,
    ) -> Result<Fate, SimulationError> {
        let until = PATIENCE * watch.duration();
        match self.follow(until, target, &mut watch, control)? {
            Seen::Ends(fate) => Ok(fate),
            Seen::Swings if self.maxima.is_irregular() => Ok(Fate::Shimmy),
            Seen::Swings => Ok(Fate::Undecided),
        }
    }

    /// Whether it comes back to the maxima of its cycle, pushed outwards and inwards.
    fn comes_back(
        &self,
        cycle: &Cycle,
        patience: f64,
        target: &Target,
        control: &Control<'_>,
    ) -> Result<bool, SimulationError> {
        for factor in [1.0 + PUSH, 1.0 - PUSH] {
            let mut course = self.course.pushed(target, factor);
            let mut maxima = Maxima::default();
            let mut nodes = Vec::new();
            let piece = PERIODS_AT_A_TIME * target.natural_period;
            let (mut time, mut known) = (0.0, 0);
            let mut is_back = false;
            while time < patience && !is_back {
                let spacing = target.natural_period / NODES_PER_PERIOD;
                match course.follow(piece, spacing, &mut nodes, control) {
                    Ok(()) => {}
                    Err(SimulationError::Interrupted(interrupted)) => return Err(interrupted.into()),
                    Err(_) => return Ok(false),
                }
                nodes.iter().for_each(|node| maxima.take(time, node, f64::INFINITY));
                time += piece;
                let distance = |maximum: &f64| {
                    let nearest = cycle.maxima.iter().map(|of_cycle| (maximum - of_cycle).abs());
                    nearest.fold(f64::INFINITY, f64::min) / (PUSH * cycle.range)
                };
                if maxima.list[known..].iter().any(|maximum| distance(maximum) > GONE) {
                    return Ok(false);
                }
                known = maxima.list.len();
                let last = maxima.list.iter().rev().take(RUN);
                is_back = known >= RUN && last.clone().all(|maximum| distance(maximum) < BACK);
            }
            if !is_back {
                return Ok(false);
            }
        }
        Ok(true)
    }
}

/// The fate of a motion that cannot be followed any further.
fn ended_by(error: SimulationError, watch: &Watch) -> Result<Fate, SimulationError> {
    match error {
        SimulationError::Integration(
            IntegrationError::NotFinite { .. } | IntegrationError::StepTooSmall { .. },
        ) => Ok(Fate::Escape),
        SimulationError::Integration(IntegrationError::TooManySteps { .. }) => {
            Ok(watch.fate_when_cut_short())
        }
        other => Err(other),
    }
}

/// The maxima of the caster angle in one period of a motion that repeats itself.
struct Cycle {
    maxima: Vec<f64>,
    /// Largest less smallest caster angle.
    range: f64,
}

/// The maxima of the caster angle along a motion, and its size.
#[derive(Clone, Debug, Default)]
struct Maxima {
    before: Option<Node>,
    list: Vec<f64>,
    /// Smallest and largest angle in the present window, which began at a time.
    window: Option<(f64, [f64; 2])>,
    /// Ranges of the angle in the windows before.
    ranges: Vec<f64>,
}

impl Maxima {
    fn take(&mut self, start: f64, node: &Node, length: f64) {
        let node = Node { time: start + node.time, ..*node };
        let mut reached = [node.angle[0]; 2];
        if let Some(before) = self.before.replace(node) {
            let slopes = [before.angle[1], node.angle[1]];
            if before.time < node.time && (slopes[0] > 0.0) != (slopes[1] > 0.0) {
                let extreme = extremum((before.time, before.angle), (node.time, node.angle));
                reached = [reached[0].min(extreme), reached[1].max(extreme)];
                if slopes[0] > 0.0 {
                    self.list.push(extreme);
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
    fn cycle(&self) -> Option<Cycle> {
        let range = match (self.ranges.last(), self.window) {
            (Some(range), _) => *range,
            (None, Some((_, [low, high]))) => high - low,
            (None, None) => return None,
        };
        let count = (1..=MOST_MAXIMA).find(|&count| {
            self.list.len() >= RUN + count && {
                let last = self.list[self.list.len() - RUN - count..].windows(count + 1);
                last.into_iter().all(|pair| (pair[count] - pair[0]).abs() < REPEATED * range)
            }
        })?;
        Some(Cycle { maxima: self.list[self.list.len() - count..].to_vec(), range })
    }

    /// Whether the size of the motion scatters from window to window and has no trend.
    fn is_irregular(&self) -> bool {
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
        before.min(after).sqrt() > LEAST_SCATTER * size
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
        assert!((single.maxima[0] - 1.0).abs() < 1e-7 && (single.range - 2.0).abs() < 1e-6);
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
