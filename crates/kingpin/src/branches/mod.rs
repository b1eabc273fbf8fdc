//! Branches of the wheel along one of its parameters: Hopf points of the uniform motion and the limit cycles
//! that are born there.
//!
//! The turning radius may be followed to infinity: behind the scenes `r` is then replaced by `1/r`.

mod birth;
mod curves;
mod cycles;
mod hopf;
mod motion_monitor;

pub use birth::{Birth, Mode};
pub use curves::{CurveOptions, CycleCurve, MotionCurve};
pub use cycles::{CycleOptions, WheelCycles};
pub use hopf::{HopfPoint, HopfSearch, MotionBranch, MotionOptions};
pub use motion_monitor::MotionMonitor;

use crate::{Key, KingpinError, Tyre, Wheel};
use arclength::branch::WithParameters;
use arclength::continuation::Stop;

/// What ends branches and curves of cycles of a wheel with a tyre, in words: they are followed as long as this is above
/// [`SLOWEST_ON_CYCLES`].
pub const SPEED_MONITOR: &str =
    "the smallest V1/v on the cycles, which a tyre takes only while it is positive,";

/// What ends branches of uniform motions of a wheel with a tyre, in words: they are followed as long as this is above [`STANDING`].
pub const FORWARD_MONITOR: &str = "V1/v of the uniform motion, which a tyre takes only while it is positive,";

/// The `V1/v` of uniform motions of a wheel with a tyre at which their branches end.
pub const STANDING: f64 = 0.0;

/// What ends branches of uniform motions of a rigid wheel, in words: they are followed as long as this is above [`RACING`]. On a circle the
/// motion ends where the forward speed of the wheel grows beyond all bounds, at `m omega^2 = k_q l` without a spring about the king pin;
/// thousands of motions could be found on the way there.
pub const RACING_MONITOR: &str = "v/V of the uniform motion, whose speed V grows without bound there,";

/// The value of [`RACING_MONITOR`] at which they end.
pub const RACING: f64 = 1e-4;

/// What is recorded along branches of cycles, in words: where it is 1, a cycle is located.
pub const FRICTION_MONITOR: &str = "the largest friction force over mu_s N";

/// What ends branches and curves of cycles of a wheel with lateral elasticity only, in words: they are followed as long as this is
/// above [`SMALLEST_COSINE`].
pub const COSINE_MONITOR: &str =
    "the smallest cos(psi) on the cycles, without which V does not follow from q, psi and Omega,";

/// The smallest `cos(psi)` of cycles with lateral elasticity only, at which their branches and curves end.
pub const SMALLEST_COSINE: f64 = 1e-3;

/// The smallest `V1/v` of cycles of a wheel with a tyre, at which their branches and curves end.
pub const SLOWEST_ON_CYCLES: f64 = 0.01;

/// A parameter and the interval in which it varies.
///
/// ```
/// use kingpin::{Key, branches::Along};
/// let along = Along::new(Key::V, 0.5, 9.0)?;
/// assert_eq!(along.key(), Key::V);
/// assert!(Along::new(Key::V, 9.0, 9.0).is_err());
/// # Ok::<(), kingpin::KingpinError>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Along {
    key: Key,
    start: f64,
    end: f64,
}

impl Wheel {
    /// What ends branches of its cycles where its equations cease to hold, in words, and the value at which they end; nothing where
    /// they always hold.
    pub fn border_of_cycles(&self) -> Option<(&'static str, f64)> {
        if self.tyre() != Tyre::Rigid {
            return Some((SPEED_MONITOR, SLOWEST_ON_CYCLES));
        }
        self.has_lateral_elasticity_only().then_some((COSINE_MONITOR, SMALLEST_COSINE))
    }
}

impl Along {
    /// An interval of a parameter; `r` may end at infinity.
    ///
    /// # Errors
    /// [`KingpinError::EmptyInterval`] unless `start < end`, [`KingpinError::OutOfRange`] for values that the
    /// parameter may not take, [`KingpinError::InfiniteEnd`] for `k_u = inf`.
    pub fn new(key: Key, start: f64, end: f64) -> Result<Self, KingpinError> {
        for value in [start, end] {
            if !key.allowed().contains(value) {
                return Err(KingpinError::OutOfRange { key, value, position: None });
            }
            if value.is_infinite() && key != Key::TurningRadius {
                return Err(KingpinError::InfiniteEnd { key });
            }
        }
        if start < end {
            Ok(Self { key, start, end })
        } else {
            Err(KingpinError::EmptyInterval { key, start, end })
        }
    }

    /// The parameter.
    pub fn key(&self) -> Key {
        self.key
    }

    /// Both ends, in ascending order.
    pub fn ends(&self) -> (f64, f64) {
        (self.start, self.end)
    }

    /// Whether the value is inside, ends included.
    pub fn contains(&self, value: f64) -> bool {
        (self.start..=self.end).contains(&value)
    }

    /// The parameter that is followed in place of the key.
    pub(crate) fn followed(&self) -> Key {
        if self.key == Key::TurningRadius { Key::Curvature } else { self.key }
    }

    /// A value of the key as a value of the parameter that is followed, and back: both are the same map.
    pub(crate) fn convert(&self, value: f64) -> f64 {
        if self.key == Key::TurningRadius { value.recip() } else { value }
    }

    /// A value of the parameter that is followed as one of the key: where it lies beyond the interval by an error of the computation, the end.
    pub(crate) fn told(&self, followed: f64) -> f64 {
        let range = self.range();
        self.convert(if followed.is_nan() { followed } else { followed.clamp(*range.start(), *range.end()) })
    }

    /// A value of the key that was asked for as it is found on a branch: a radius has gone through `1/r` and back.
    pub fn as_found(&self, value: f64) -> f64 {
        self.convert(self.convert(value))
    }

    /// Why a branch of the parameter that is followed ends, in values of the key.
    pub(crate) fn convert_stop<R: WithParameters>(&self, stop: Stop<R>) -> Stop<R> {
        stop.with_parameters(|_, value| self.convert(value))
    }

    /// An error of the parameter that is followed as one of the key, next to a value of the key.
    pub(crate) fn convert_error(&self, value: f64, error: f64) -> f64 {
        // |dr| = r^2 |d(1/r)|
        if self.key == Key::TurningRadius { value * value * error } else { error }
    }

    /// The interval of the parameter that is followed.
    pub(crate) fn range(&self) -> std::ops::RangeInclusive<f64> {
        let (a, b) = (self.convert(self.start), self.convert(self.end));
        a.min(b)..=a.max(b)
    }

    /// The wheel's own value where it is inside, then values spread over the interval.
    fn candidates(&self, wheel: &Wheel) -> Vec<f64> {
        const SPREAD: usize = 32;
        let own = wheel.get(self.key);
        let range = self.range();
        let (lower, upper) = (*range.start(), *range.end());
        let spread = (0..=SPREAD).map(|index| lower + (upper - lower) * index as f64 / SPREAD as f64);
        let own = self.contains(own).then(|| self.convert(own));
        own.into_iter().chain(spread).collect()
    }
}
