//! The parameter along which branches of the wheel are followed.

use arclength_analysis::{Interval, VaryingParameter};
use kingpin::branches::Along;
use kingpin::{Key, KingpinError};

/// The interval of a parameter of the wheel; `r` may end at infinity.
///
/// # Errors
/// An unknown key, or ends that the parameter may not take.
pub fn along(interval: &Interval) -> Result<Along, KingpinError> {
    Along::new(interval.key.parse()?, interval.start, interval.end)
}

/// The parameter and its interval, in results.
pub fn varying(along: &Along) -> VaryingParameter {
    let (start, end) = along.ends();
    let (key, unit) = (along.key().name().to_owned(), along.key().unit().to_owned());
    VaryingParameter { key, unit: Some(unit), start, end }
}

/// A value of the parameter as the continuation knows it, which follows `1/r` in place of `r`; and back.
pub fn as_followed(along: &Along, value: f64) -> f64 {
    if along.key() == Key::TurningRadius { value.recip() } else { value }
}

/// Where a value is drawn: an `r` that reaches infinity is drawn as a curvature.
pub fn drawn_as(along: &Along) -> (Key, fn(f64) -> f64) {
    if along.key() == Key::TurningRadius && along.ends().1.is_infinite() {
        (Key::Curvature, f64::recip)
    } else {
        (along.key(), |value| value)
    }
}
