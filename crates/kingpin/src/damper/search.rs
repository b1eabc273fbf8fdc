//! The search for the smallest damper: boundaries of stability along the speed and along other parameters, and their peaks.

use super::condition::{Condition, SmallestDamper};
use crate::boundary::Curve;
use crate::critical_speed::{SECTION, bisect};
use crate::error::KingpinError;
use crate::parameters::{Key, Tyre};
use crate::plane::{Axis, Plane};
use crate::wheel::Wheel;
use arclength::control::Control;
use rayon::prelude::*;

/// Speeds at which stability is looked at between the smallest and the largest of the range, and the smallest as part of the
/// largest.
const SPEEDS: usize = 200;
pub(super) const SLOWEST: f64 = 1e-3;
/// Values of one other parameter at which that is done, and of each of several.
const VALUES: usize = 49;
const VALUES_OF_SEVERAL: usize = 13;
/// The dampers that are tried begin at this part of a damper that would take the lateral motion a period to die out.
const WEAKEST: f64 = 1e-3;
/// Doublings of it that are tried.
const DOUBLINGS: usize = 24;
/// The plane reaches this many times as far as the damper that is enough.
const BEYOND: f64 = 1.1;
/// Relative distance from a boundary at which the stability on both sides is compared.
const ASIDE: f64 = 1e-6;
/// The same beside a boundary in the plane of two of the parameters, as a part of their intervals.
const BESIDE: f64 = 1e-4;
/// Steps by which a peak is narrowed down.
const GOLDEN_STEPS: usize = 40;
/// A peak along one parameter counts as higher than one along another when it is so by this part.
const HIGHER: f64 = 1e-9;
/// Most peaks that are tried over circles and loads.
const MOST_PEAKS: usize = 200;

/// A parameter other than the speed at whose values a damper has to be enough.
#[derive(Clone, Debug)]
pub(super) struct Variable {
    /// The parameter that is followed: the curvature in place of a radius.
    key: Key,
    /// Values at which stability is looked at, the ends among them.
    values: Vec<f64>,
    /// The interval, where it is one.
    axis: Option<Axis>,
}

impl Variable {
    /// Of one of so many conditions.
    ///
    /// # Errors
    /// As those of [`Axis::new`].
    pub(super) fn of(condition: &Condition, conditions: usize) -> Result<Self, KingpinError> {
        let count = if conditions == 1 { VALUES } else { VALUES_OF_SEVERAL };
        match condition {
            Condition::Interval(along) => {
                let axis = Axis::new(along.followed(), along.range())?;
                Ok(Self { key: axis.key(), values: axis.values(count), axis: Some(axis) })
            }
            Condition::Values(key, values) => Ok(Self { key: *key, values: values.clone(), axis: None }),
        }
    }

    /// The values at the ends, or all where there is no interval.
    fn extremes(&self) -> Vec<f64> {
        self.axis.map_or_else(|| self.values.clone(), |axis| vec![axis.start(), axis.end()])
    }
}

/// A damper that is enough along one parameter beside a wheel.
#[derive(Clone, Copy, Debug)]
struct Peak {
    damping: f64,
    at: Wheel,
}

/// What is searched.
pub(super) struct Search {
    key: Key,
    /// Speeds in m/s.
    speeds: Axis,
    variables: Vec<Variable>,
    /// The wheel at all values of the variables, and at their ends.
    wheels: Vec<Wheel>,
    corners: Vec<Wheel>,
}

impl Search {
    /// The wheel with a damper `key` at these speeds and at all values of the variables.
    ///
    /// # Errors
    /// Values that are not allowed.
    pub(super) fn new(
        wheel: &Wheel,
        key: Key,
        speeds: Axis,
        variables: Vec<Variable>,
    ) -> Result<Self, KingpinError> {
        let all = |values: &dyn Fn(&Variable) -> Vec<f64>| -> Result<Vec<Wheel>, KingpinError> {
            let mut wheels = vec![*wheel];
            for variable in &variables {
                let pairs =
                    wheels.iter().flat_map(|wheel| values(variable).into_iter().map(move |at| (wheel, at)));
                wheels = pairs.map(|(wheel, at)| wheel.with(variable.key, at)).collect::<Result<_, _>>()?;
            }
            Ok(wheels)
        };
        let wheels: Vec<Wheel> = all(&|variable| variable.values.clone())?;
        let corners = all(&Variable::extremes)?;
        Ok(Self { key, speeds, variables, wheels, corners })
    }

    fn is_stable(&self, wheel: &Wheel, damping: f64) -> Option<bool> {
        let wheel = wheel.with(self.key, damping).ok()?;
        wheel.uniform_motion().map_or(Some(false), |motion| motion.is_stable())
    }

    /// The wheel where its motion is surely unstable with a damper; nothing where that is nowhere.
    ///
    /// # Errors
    /// [`Interrupted`](KingpinError::Interrupted).
    pub(super) fn refuted(&self, damping: f64, control: &Control<'_>) -> Result<Option<Wheel>, KingpinError> {
        control.check()?;
        let up_to = self.speeds.end();
        let geometric = |index: usize| up_to * SLOWEST.powf(1.0 - index as f64 / SPEEDS as f64);
        let even = |index: usize| up_to * (index + 1) as f64 / (SPEEDS + 1) as f64;
        let unstable = |wheel: &Wheel| {
            let all = (0..SPEEDS).flat_map(|index| [geometric(index), even(index)]).chain([up_to]);
            let mut wheels = all.filter_map(|speed| wheel.with(Key::V, speed).ok());
            wheels.find(|wheel| self.is_stable(wheel, damping) == Some(false))
        };
        Ok(match &self.wheels[..] {
            [wheel] => unstable(wheel),
            wheels => wheels.par_iter().find_map_first(unstable),
        })
    }

    /// The smallest damper, where the wheel without one is unstable.
    ///
    /// # Errors
    /// [`Interrupted`](KingpinError::Interrupted).
    pub(super) fn smallest(&self, control: &Control<'_>) -> Result<Option<SmallestDamper>, KingpinError> {
        let Some((enough, refuting)) = self.some_that_is_enough(control)? else { return Ok(None) };
        let dampings = Axis::new(self.key, 0.0..=BEYOND * enough)?;
        let mut peaks = Vec::new();
        for at in self.corners.iter().chain(refuting.as_ref().filter(|_| !self.variables.is_empty())) {
            peaks.extend(self.peaks_along(&self.speeds, at, &dampings, control)?);
        }
        let mut tried = 0;
        while tried < MOST_PEAKS {
            peaks.sort_by(|one, other| one.damping.total_cmp(&other.damping));
            let Some(index) = (0..peaks.len()).find(|index| self.is_needed(&peaks[*index])) else { break };
            let peak = peaks.remove(index);
            // Weaker ones are not needed, or refuted.
            peaks.drain(..index);
            tried += 1;
            let with_more = peak.damping * (1.0 + ASIDE);
            let refuting = match self.refuted(with_more, control)? {
                None => self.refuted_in_planes(&peak.at, with_more, control)?,
                refuting => refuting,
            };
            let mut higher = Vec::new();
            if !self.variables.is_empty() {
                for at in refuting.iter().chain([&peak.at]) {
                    let axes = self.variables.iter().filter_map(|variable| variable.axis.as_ref());
                    for axis in axes.chain([&self.speeds]) {
                        higher.extend(self.peaks_along(axis, at, &dampings, control)?);
                    }
                }
            }
            // Without a refutation only a peak of the same unstable range counts, not one of another range with more damping.
            let just_above = peak.damping * (1.0 + HIGHER);
            higher.retain(|other| {
                let reaches_down =
                    || refuting.is_some() || self.is_stable(&other.at, just_above) == Some(false);
                other.damping > just_above && self.is_needed(other) && reaches_down()
            });
            if refuting.is_none() && higher.is_empty() {
                let corner = peak.at.with(self.key, peak.damping)?;
                let speed = Some(corner.get(Key::V));
                return Ok(Some(SmallestDamper { damping: peak.damping, speed, corner: Some(corner) }));
            }
            peaks.extend(higher);
        }
        Ok(None)
    }

    /// Whether the motion is unstable beside a peak with a weaker damper.
    fn is_needed(&self, peak: &Peak) -> bool {
        self.is_stable(&peak.at, peak.damping * (1.0 - ASIDE)) == Some(false)
    }
}

impl Search {
    /// A damper that is enough, and the wheel that half of it leaves unstable.
    fn some_that_is_enough(
        &self,
        control: &Control<'_>,
    ) -> Result<Option<(f64, Option<Wheel>)>, KingpinError> {
        let rotational = self.rotational_scale();
        let arm = self.wheels.first().map_or(1.0, |wheel| wheel.get(Key::L));
        let unit = if self.key == Key::CPsi { rotational } else { rotational / (arm * arm) };
        let mut unstable = None;
        for doubling in 0..DOUBLINGS {
            let damping = WEAKEST * unit * f64::powi(2.0, doubling as i32);
            if BEYOND * damping > self.key.allowed().highest {
                return Ok(None);
            }
            match self.refuted(damping, control)? {
                None => return Ok(Some((damping, unstable))),
                refuting => unstable = refuting,
            }
        }
        Ok(None)
    }

    /// A damper about the king pin, in N m s/rad, that would take the lateral motion about a period to die out.
    fn rotational_scale(&self) -> f64 {
        let of_wheel = |wheel: &Wheel| {
            if wheel.tyre() == Tyre::Rigid {
                return wheel.natural_rotational_damping();
            }
            let inertia = wheel.body().inverse_yaw_inertia.recip();
            let fastest = wheel.with(Key::V, self.speeds.end()).and_then(|wheel| wheel.uniform_motion());
            let eigenvalues = fastest.map(|motion| motion.eigenvalues()).unwrap_or_default();
            let frequency = eigenvalues.iter().map(|eigenvalue| eigenvalue.norm()).fold(0.0, f64::max);
            // Without a motion at the largest speed no damper is enough.
            if frequency > 0.0 { frequency * inertia } else { f64::INFINITY }
        };
        self.corners.iter().map(of_wheel).fold(0.0, f64::max)
    }

    /// The wheel where it is surely unstable beside a boundary of stability in the plane of speed and another parameter.
    fn refuted_in_planes(
        &self,
        at: &Wheel,
        damping: f64,
        control: &Control<'_>,
    ) -> Result<Option<Wheel>, KingpinError> {
        let damped = at.with(self.key, damping)?;
        for axis in self.variables.iter().filter_map(|variable| variable.axis) {
            let plane = Plane::new(self.speeds, axis)?;
            for Curve { points, .. } in damped.stability_boundary(&plane, control)? {
                let aside = |[speed, value]: [f64; 2], [along, across]: [f64; 2]| {
                    let moved = |axis: &Axis, value: f64, part: f64| {
                        (value + BESIDE * part * (axis.end() - axis.start())).clamp(axis.start(), axis.end())
                    };
                    let wheel = damped.with(axis.key(), moved(&axis, value, across)).ok()?;
                    let wheel = wheel.with(Key::V, moved(&self.speeds, speed, along)).ok()?;
                    (self.is_stable(&wheel, damping) == Some(false)).then_some(wheel)
                };
                let around = [[1.0, 0.0], [-1.0, 0.0], [0.0, 1.0], [0.0, -1.0]];
                let middle = points.get(points.len() / 2).copied();
                let mut beside = middle.into_iter().flat_map(|point| around.map(|part| (point, part)));
                if let Some(wheel) = beside.find_map(|(point, part)| aside(point, part)) {
                    return Ok(Some(wheel));
                }
            }
        }
        Ok(None)
    }

    /// The peaks of the boundary of stability along a parameter beside a wheel, and its ends.
    fn peaks_along(
        &self,
        axis: &Axis,
        at: &Wheel,
        dampings: &Axis,
        control: &Control<'_>,
    ) -> Result<Vec<Peak>, KingpinError> {
        let plane = Plane::new(*axis, *dampings)?;
        let line = Line { axis, key: self.key, at };
        let mut peaks = Vec::new();
        for curve in at.stability_boundary(&plane, control)? {
            for [value, damping] in line.peaks(&curve) {
                peaks.push(Peak { damping, at: at.with(axis.key(), value)? });
            }
        }
        Ok(peaks)
    }
}

/// The wheels along one parameter, with a damper.
struct Line<'a> {
    axis: &'a Axis,
    /// Of the damper.
    key: Key,
    at: &'a Wheel,
}

impl Line<'_> {
    /// Values and dampings of the peaks of a boundary, and of its ends.
    fn peaks(&self, curve: &Curve) -> Vec<[f64; 2]> {
        let points = &curve.points;
        let mut peaks = Vec::new();
        for index in 0..points.len() {
            let here = points[index];
            let neighbour = |step: isize| {
                let other = index as isize + step;
                if curve.closed {
                    return points.get(other.rem_euclid(points.len() as isize - 1) as usize);
                }
                usize::try_from(other).ok().and_then(|other| points.get(other))
            };
            match (neighbour(-1), neighbour(1)) {
                (Some(before), Some(after)) if before[1] <= here[1] && after[1] <= here[1] => {
                    peaks.push(self.peak([*before, here, *after]));
                }
                (Some(_), Some(_)) => {}
                // An end is at the edge of the plane up to the step of the trace.
                _ => {
                    let width = self.axis.end() - self.axis.start();
                    let ends = [self.axis.start(), self.axis.end()];
                    let edge = ends.into_iter().find(|end| (here[0] - end).abs() < ASIDE * width);
                    let at_edge = |edge| Some([edge, self.boundary_at(edge, here[1], 1e-3 * here[1])?]);
                    peaks.push(edge.and_then(at_edge).unwrap_or(here));
                }
            }
        }
        peaks
    }

    /// The peak between three points of a boundary, by golden section.
    fn peak(&self, [before, here, after]: [[f64; 2]; 3]) -> [f64; 2] {
        let reach = 2.0 * (here[1] - before[1].min(after[1])).max(1e-6 * here[1]);
        let (mut low, mut high) = (before[0].min(after[0]), before[0].max(after[0]));
        let height = |value: f64| self.boundary_at(value, here[1], reach);
        let mut best = here;
        for _ in 0..GOLDEN_STEPS {
            let places = [high - SECTION * (high - low), low + SECTION * (high - low)];
            let [Some(left), Some(right)] = places.map(height) else { break };
            for (value, damping) in places.into_iter().zip([left, right]) {
                if damping > best[1] {
                    best = [value, damping];
                }
            }
            if left > right { high = places[1] } else { low = places[0] }
        }
        best
    }

    /// The damping near a guess at which the growth rate changes its sign at a value.
    fn boundary_at(&self, value: f64, guess: f64, reach: f64) -> Option<f64> {
        let rate = |damping: f64| {
            let wheel =
                self.at.with(self.axis.key(), value).and_then(|wheel| wheel.with(self.key, damping)).ok()?;
            Some(wheel.uniform_motion().ok()?.growth_rate())
        };
        let (low, high) = ((guess - reach).max(0.0), guess + reach);
        let below = rate(low)?;
        if (rate(high)? < 0.0) == (below < 0.0) {
            return None;
        }
        bisect(low, below, high, rate)
    }
}
