//! The smallest towing speed at which the uniform motion changes its stability.
//!
//! Where it comes from: the plain wheel has it in closed form, `r w_crit(l)`; in rectilinear towing it is a root of a quadratic;
//! otherwise it is sought. Wherever it comes from, the stability on both sides has to be certain and different: a speed at which the
//! motion only ceases to exist is none.

use crate::arithmetic::Arithmetic;
use crate::body::Body;
use crate::parameters::{Key, Tyre};
use crate::wheel::Wheel;

/// Smallest speed in m/s at which a change of stability is looked for, unless straight towing has one at a smaller one; then it is this
/// part of that.
const SLOWEST: f64 = 1e-3;
const SLOWER: f64 = 0.1;
/// Number of speeds from that smallest one on, in geometric progression, between which changes of stability are looked for.
const SPEEDS: usize = 400;
const MOST_SPEEDS: f64 = 4000.0;
/// The interval of the critical speed is halved until it is this small, relative to the speed.
const TOLERANCE: f64 = 4.0 * f64::EPSILON;
/// Relative distances from a critical speed, one after the other, at which the stability on both sides is compared.
const SIDES: [f64; 3] = [1e-10, 1e-8, 1e-6];
/// So many times as far from it the growth rate changes by more than ten times as much, unless it jumps.
const FARTHER: f64 = 100.0;
const CONTINUOUS: f64 = 0.1;
/// Steps of the golden section by which an extremum of the growth rate between three speeds is narrowed down.
const GOLDEN_STEPS: usize = 60;
/// The golden section.
pub(crate) const SECTION: f64 = 0.618_033_988_749_894_9;

/// The speed at which the uniform motion loses (or gains) its stability.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CriticalSpeed {
    /// Towing speed in m/s.
    pub speed: f64,
    /// Yaw rate `omega = v/r` in rad/s.
    pub yaw_rate: f64,
    /// What is left of the growth rate there, in 1/s.
    pub residual: f64,
}

impl Wheel {
    /// The smallest towing speed at which the uniform motion changes its stability; `None` where no such speed is found.
    ///
    /// On a circle, but for the plain wheel, and with a tyre the growth rate is sampled at 400 speeds from 1 mm/s, or less where straight towing has a smaller
    /// critical speed, to the largest at which the motion exists, and at its extrema between them; its first zero is found by bisection.
    pub fn critical_speed(&self) -> Option<CriticalSpeed> {
        let speed = match self.changes_in_closed_form() {
            Some(speeds) => speeds.first().copied(),
            None => self.changes_sought().next(),
        }?;
        let residual = self.growth_rate_at(speed)?.abs();
        Some(CriticalSpeed { speed, yaw_rate: speed / self.get(Key::TurningRadius), residual })
    }

    /// All speeds at which the stability changes, in ascending order, where they are known in closed form.
    pub(crate) fn changes_in_closed_form(&self) -> Option<Vec<f64>> {
        let radius = self.get(Key::TurningRadius);
        let mut speeds = if radius.is_infinite() && self.tyre() == Tyre::Rigid {
            // The stability of a plain wheel does not depend on the speed there.
            self.critical_speeds_straight()
        } else if self.is_plain() {
            self.critical_yaw_rate().map(|yaw_rate| radius * yaw_rate).into_iter().collect()
        } else {
            return None;
        };
        speeds.retain(|&speed| self.changes_stability_at(speed));
        Some(speeds)
    }

    fn growth_rate_at(&self, speed: f64) -> Option<f64> {
        Some(self.with(Key::V, speed).ok()?.uniform_motion().ok()?.growth_rate())
    }

    fn is_stable_at(&self, speed: f64) -> Option<bool> {
        self.with(Key::V, speed).ok()?.uniform_motion().ok()?.is_stable()
    }

    /// Whether the uniform motion is certain to be stable on one side of the speed and unstable on the other, and its growth rate
    /// passes through zero there: where it jumps, one uniform motion only takes the place of another.
    pub(crate) fn changes_stability_at(&self, speed: f64) -> bool {
        let sides = |part: f64| {
            let [below, above] = [1.0 - part, 1.0 + part].map(|factor| self.is_stable_at(speed * factor));
            Some((part, below? != above?))
        };
        let change = |part: f64| {
            let [below, above] = [1.0 - part, 1.0 + part].map(|factor| self.growth_rate_at(speed * factor));
            Some((above? - below?).abs())
        };
        SIDES.into_iter().find_map(sides).is_some_and(|(part, differs)| {
            let changes = change(part).zip(change(FARTHER * part));
            differs && changes.is_some_and(|(near, far)| near < CONTINUOUS * far)
        })
    }

    /// In rectilinear towing, the positive roots of the Hopf condition of the lateral motion, which is quadratic in the speed,
    /// in ascending order.
    fn critical_speeds_straight(&self) -> Vec<f64> {
        let [a, b, c] = straight_hopf_condition(&self.body());
        let half = -0.5 * b;
        let discriminant = half * half - a * c;
        if discriminant < 0.0 {
            return Vec::new();
        }
        let larger = half + discriminant.sqrt().copysign(half);
        let mut roots = vec![larger / a, c / larger];
        roots.retain(|&root| root.is_finite() && root > 0.0);
        roots.sort_by(f64::total_cmp);
        roots
    }

    /// Speeds in ascending order at which the growth rate is looked at, up to the largest one at which the motion exists.
    pub(crate) fn scanned_speeds(&self) -> Vec<f64> {
        let radius = self.get(Key::TurningRadius);
        let body = self.body();
        let limit = (body.lateral_stiffness * body.caster_length / body.static_moment).sqrt() * radius;
        let fastest = Key::V.allowed().highest;
        let fastest = if limit < fastest { limit } else { fastest };
        let slowest = self.slowest_speed();
        let intervals = (SPEEDS - 1) as f64 * (fastest / slowest).ln() / (fastest / SLOWEST).ln();
        let count = intervals.round().clamp(1.0, MOST_SPEEDS) as usize;
        let ratio = (fastest / slowest).powf(1.0 / count as f64);
        (0..=count).map(|index| slowest * ratio.powi(index as i32)).collect()
    }

    /// Smallest speed in m/s at which a change of stability is looked for.
    fn slowest_speed(&self) -> f64 {
        let straight = match self.tyre() {
            Tyre::Rigid => self.critical_speeds_straight(),
            _ => Vec::new(),
        };
        straight.first().map_or(SLOWEST, |speed| SLOWEST.min(SLOWER * speed))
    }

    /// Speeds in ascending order at which the growth rate between those that are looked at passes through zero.
    pub(crate) fn changes_sought(&self) -> impl Iterator<Item = f64> {
        let rate = |speed: f64| self.growth_rate_at(speed);
        let mut before: [Option<(f64, f64)>; 2] = [None, None];
        self.scanned_speeds().into_iter().flat_map(move |speed| {
            let here = rate(speed).map(|rate| (speed, rate));
            let mut places = Vec::new();
            if let [Some(first), Some(middle)] = before
                && let Some(last) = here
                && let Some(turn) = beyond_zero([first, middle, last], rate)
            {
                places.extend([[first, turn], [turn, last]]);
            }
            if let (Some(slower), Some(faster)) = (before[1], here) {
                places.push([slower, faster]);
            }
            before = [before[1], here];
            let changes = places.into_iter().filter(|[one, other]| (one.1 < 0.0) != (other.1 < 0.0));
            let speeds = changes.filter_map(|[one, other]| bisect(one.0, one.1, other.0, rate));
            speeds.filter(|&speed| self.changes_stability_at(speed)).collect::<Vec<_>>()
        })
    }
}

/// `[a, b, c]` of the Hopf condition `a v^2 + b v + c = 0` of the lateral motion in rectilinear towing: the product of the first two
/// coefficients of its characteristic polynomial less the third, times `J^2`.
pub(crate) fn straight_hopf_condition<T: Arithmetic>(body: &Body<T>) -> [T; 3] {
    let l = body.caster_length;
    let damping = body.rotational_damping + body.lateral_damping * l * l;
    let stiffness = body.rotational_stiffness + l * l * body.lateral_stiffness;
    let (moment, viscous) = (body.static_moment, l * body.lateral_damping);
    let elastic = body.yaw_inertia * l * body.lateral_stiffness;
    [moment * viscous, moment * stiffness + damping * viscous - elastic, damping * stiffness]
}

/// Where the function has the other sign between three points, with the middle one closest to zero; nothing where it has not.
fn beyond_zero(
    [first, middle, last]: [(f64, f64); 3],
    function: impl Fn(f64) -> Option<f64>,
) -> Option<(f64, f64)> {
    let sign = middle.1.signum();
    let [one, closest, other] = [first, middle, last].map(|(_, value)| sign * value);
    if !(closest > 0.0 && one > closest && other > closest) {
        return None;
    }
    let (mut low, mut high) = (first.0, last.0);
    for _ in 0..GOLDEN_STEPS {
        let left = high - SECTION * (high - low);
        let right = low + SECTION * (high - low);
        let values = [left, right].map(|place| Some((place, function(place)?)));
        let [Some(left), Some(right)] = values else { return None };
        if let Some(beyond) = [left, right].into_iter().find(|(_, value)| sign * value < 0.0) {
            return Some(beyond);
        }
        if sign * left.1 < sign * right.1 { high = right.0 } else { low = left.0 }
    }
    None
}

/// The zero of a function between two points where its signs differ.
pub(crate) fn bisect(
    mut low: f64,
    low_value: f64,
    mut high: f64,
    function: impl Fn(f64) -> Option<f64>,
) -> Option<f64> {
    while high - low > TOLERANCE * high {
        let middle = 0.5 * (low + high);
        if (function(middle)? < 0.0) == (low_value < 0.0) { low = middle } else { high = middle }
    }
    Some(0.5 * (low + high))
}
