//! Axes of charts, as they are asked for by intervals.

use arclength_analysis::Interval;
use kingpin::{Axis, Key, KingpinError};
use kingpin_report::numbers::readable;

/// The axis of an interval of a parameter. An interval of `r` that reaches to infinity becomes one of `curvature`.
///
/// # Errors
/// An unknown key, or ends that the parameter may not take.
pub fn axis(interval: &Interval) -> Result<Axis, KingpinError> {
    let key: Key = interval.key.parse()?;
    if key == Key::TurningRadius && interval.end == f64::INFINITY {
        // The largest radius at the other end gives the smallest curvature, zero.
        let smallest = Axis::new(key, interval.start..=key.allowed().highest)?.start();
        return Axis::new(Key::Curvature, 0.0..=smallest.recip());
    }
    Axis::new(key, interval.start..=interval.end)
}

/// That an interval of `r` became one of `curvature`, in words.
pub fn conversion(interval: &Interval, axis: &Axis) -> Option<String> {
    (interval.key == Key::TurningRadius.name() && axis.key() == Key::Curvature).then(|| {
        format!(
            "r reaches inf: curvature = 1/r varies instead, from {} to {} 1/m",
            axis.start(),
            readable(axis.end())
        )
    })
}
