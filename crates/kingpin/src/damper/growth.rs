//! Where the uniform motion grows fastest, over speeds and other conditions.
//!
//! The growth rate is computed on a grid; from each of its local maxima a compass search (Kolda, Lewis and Torczon 2003) goes up
//! within the neighbouring cells, from those below zero as well: what is unstable between the points of the grid is seen where the
//! growth rate rises towards it.

use super::condition::Condition;
use crate::error::KingpinError;
use crate::parallel;
use crate::parameters::Key;
use crate::plane::Axis;
use crate::uniform_motion::UniformMotion;
use crate::wheel::Wheel;
use arclength::control::Control;

/// Points along the speed, about half in geometric progression and half evenly spaced, and along each other interval, for no, one
/// and several other intervals.
const SPEEDS: [usize; 3] = [400, 120, 60];
const VALUES: [usize; 3] = [0, 49, 13];
/// Step of the difference quotients at a maximum, as a part of the interval, the number of Newton's steps in each coordinate, and the
/// distance from an end within which a place is that end, as a part of the interval.
const DIFFERENCE: f64 = 1e-3;
const NEWTON_STEPS: usize = 8;
const AT_END: f64 = 1e-9;
/// Part of the size of an eigenvalue by which the growth rate has to rise: less is rounding.
const RISE: f64 = 1e-14;
/// Halvings of the steps of a compass search, from one cell of the grid on: an error of the maximum of 1e-12 of the change over a cell.
const HALVINGS: usize = 20;

/// Values of a parameter.
#[derive(Clone, Debug)]
struct Coordinate {
    key: Key,
    /// Ascending.
    values: Vec<f64>,
    /// Whether values between them count.
    is_interval: bool,
}

/// The wheels among which the growth rate is looked for.
pub(super) struct Conditions {
    wheel: Wheel,
    /// The speed is the first.
    coordinates: Vec<Coordinate>,
}

impl Conditions {
    /// The wheel at these speeds and at all values of the conditions; a radius is followed as curvature.
    ///
    /// # Errors
    /// Values that are not allowed.
    pub(super) fn new(wheel: &Wheel, speeds: Axis, conditions: &[Condition]) -> Result<Self, KingpinError> {
        let intervals =
            conditions.iter().filter(|condition| matches!(condition, Condition::Interval(_))).count().min(2);
        let mut values: Vec<f64> = speeds.values(SPEEDS[intervals] / 2);
        let ratio = speeds.end() / speeds.start();
        let even = values.len();
        values.extend((1..even).map(|index| speeds.start() * ratio.powf(index as f64 / even as f64)));
        values.sort_by(f64::total_cmp);
        let mut coordinates = vec![Coordinate { key: Key::V, values, is_interval: true }];
        for condition in conditions {
            coordinates.push(match condition {
                Condition::Interval(along) => {
                    let axis = Axis::new(along.followed(), along.range())?;
                    Coordinate { key: axis.key(), values: axis.values(VALUES[intervals]), is_interval: true }
                }
                Condition::Values(key, values) => {
                    values.iter().try_for_each(|value| wheel.with(*key, *value).map(|_| ()))?;
                    Coordinate { key: *key, values: values.clone(), is_interval: false }
                }
            });
        }
        Ok(Self { wheel: *wheel, coordinates })
    }

    /// The wheel at some values; nothing where they are not allowed together.
    fn at(&self, values: &[f64]) -> Option<Wheel> {
        let mut wheel = self.wheel;
        for (coordinate, value) in self.coordinates.iter().zip(values) {
            wheel = wheel.with(coordinate.key, *value).ok()?;
        }
        Some(wheel)
    }

    fn motion(&self, values: &[f64], (key, damping): (Key, f64)) -> Option<UniformMotion> {
        self.at(values)?.with(key, damping).ok()?.uniform_motion().ok()
    }

    /// The growth rate at some values; infinite where there is no uniform motion.
    fn growth_rate(&self, values: &[f64], damper: (Key, f64)) -> f64 {
        self.motion(values, damper).map_or(f64::INFINITY, |motion| motion.growth_rate())
    }

    fn points(&self) -> usize {
        self.coordinates.iter().map(|coordinate| coordinate.values.len()).product()
    }

    /// The index along each coordinate of a point of the grid.
    fn indices(&self, point: usize) -> Vec<usize> {
        let mut rest = point;
        let index = |coordinate: &Coordinate| {
            let index = rest % coordinate.values.len();
            rest /= coordinate.values.len();
            index
        };
        self.coordinates.iter().map(index).collect()
    }

    fn values(&self, indices: &[usize]) -> Vec<f64> {
        self.coordinates.iter().zip(indices).map(|(coordinate, index)| coordinate.values[*index]).collect()
    }

    /// The wheels where the growth rate has a local maximum and the motion is surely unstable with a damper. Values that are no
    /// interval have a maximum each.
    ///
    /// # Errors
    /// [`Interrupted`](KingpinError::Interrupted).
    pub(super) fn unstable(
        &self,
        damper: (Key, f64),
        control: &Control<'_>,
    ) -> Result<Vec<Wheel>, KingpinError> {
        let rate_at = |point: usize| -> Result<f64, KingpinError> {
            control.check()?;
            Ok(self.growth_rate(&self.values(&self.indices(point)), damper))
        };
        let rates = parallel::try_map_indices(self.points(), rate_at)?;
        let maxima: Vec<usize> = (0..rates.len()).filter(|point| self.is_maximum(*point, &rates)).collect();
        let climbed = |&point: &usize| -> Result<Option<Wheel>, KingpinError> {
            control.check()?;
            let values = self.climb(&self.indices(point), rates[point], damper);
            Ok(self.at(&values).filter(|wheel| is_unstable(wheel, damper)))
        };
        let found = parallel::try_map(&maxima, climbed)?;
        Ok(found.into_iter().flatten().collect())
    }

    /// Whether no neighbour along a coordinate grows faster.
    fn is_maximum(&self, point: usize, rates: &[f64]) -> bool {
        let mut stride = 1;
        self.coordinates.iter().zip(self.indices(point)).all(|(coordinate, index)| {
            let step = stride;
            stride *= coordinate.values.len();
            !coordinate.is_interval
                || ((index == 0 || rates[point - step] <= rates[point])
                    && (index + 1 == coordinate.values.len() || rates[point + step] <= rates[point]))
        })
    }

    /// The wheel at the maximum of the growth rate beside another one, where its slope vanishes: a maximum is flat, and a search that
    /// compares heights finds its place to half of the digits only. Coordinates at the end of their interval stay.
    pub(super) fn peak_beside(&self, wheel: &Wheel, damper: (Key, f64)) -> Option<Wheel> {
        let mut best: Vec<f64> =
            self.coordinates.iter().map(|coordinate| wheel.get(coordinate.key)).collect();
        for _ in 0..NEWTON_STEPS {
            for (index, Coordinate { values, is_interval, .. }) in self.coordinates.iter().enumerate() {
                let (low, high) = (values[0], values[values.len() - 1]);
                let to_end = (best[index] - low).min(high - best[index]);
                if !is_interval || to_end < AT_END * (high - low) {
                    continue;
                }
                let step = (DIFFERENCE * (high - low)).min(0.5 * to_end);
                let [far_below, below, here, above, far_above] = [-2.0, -1.0, 0.0, 1.0, 2.0].map(|steps| {
                    let mut other = best.clone();
                    other[index] += steps * step;
                    self.growth_rate(&other, damper)
                });
                // Both quotients of fourth order.
                let slope = (8.0 * (above - below) - (far_above - far_below)) / (12.0 * step);
                let bend =
                    (16.0 * (above + below) - (far_above + far_below) - 30.0 * here) / (12.0 * step * step);
                let change = -slope / bend;
                if bend < 0.0 && change.abs() < to_end {
                    best[index] += change;
                }
            }
        }
        self.at(&best)
    }

    /// A compass search for the maximum within the cells beside a point of the grid.
    fn climb(&self, indices: &[usize], start: f64, damper: (Key, f64)) -> Vec<f64> {
        let (mut best, mut highest) = (self.values(indices), start);
        let Some(motion) = self.motion(&best, damper) else { return best };
        let size = motion.eigenvalues_that_count().first().map_or(0.0, |eigenvalue| eigenvalue.norm());
        let cells: Vec<[f64; 2]> = self
            .coordinates
            .iter()
            .zip(indices)
            .map(|(Coordinate { values, is_interval, .. }, &index)| match is_interval {
                true => [values[index.saturating_sub(1)], values[(index + 1).min(values.len() - 1)]],
                false => [values[index]; 2],
            })
            .collect();
        for halving in 1..=HALVINGS {
            let part = f64::powi(0.5, halving as i32);
            // A step is taken again as long as it leads up: not for ever, for the cell is finite.
            loop {
                let before = highest;
                for (index, [low, high]) in
                    cells.iter().copied().enumerate().filter(|(_, [low, high])| low < high)
                {
                    for step in [-part, part] {
                        let mut other = best.clone();
                        other[index] = (other[index] + step * (high - low)).clamp(low, high);
                        if other[index] == best[index] {
                            continue;
                        }
                        let rate = self.growth_rate(&other, damper);
                        if rate > highest + RISE * size {
                            (best, highest) = (other, rate);
                        }
                    }
                }
                if highest <= before || highest.is_infinite() {
                    break;
                }
            }
        }
        best
    }
}

/// Whether the motion is surely unstable with a damper, or there is none.
pub(super) fn is_unstable(wheel: &Wheel, (key, damping): (Key, f64)) -> bool {
    let damped = wheel.with(key, damping).and_then(|wheel| wheel.uniform_motion());
    damped.map_or(true, |motion| motion.is_stable() == Some(false))
}
