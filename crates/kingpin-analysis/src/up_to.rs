//! The largest speed that an analysis looks at, as it is asked for.

use crate::error::Error;
use arclength_analysis::Assignment;
use kingpin::{Key, Wheel};

/// The speed in m/s of `v=VALUE`, one that the wheel may have, above 0.
///
/// # Errors
/// Another key, or no such speed.
pub(crate) fn speed(wheel: &Wheel, Assignment { key, value }: &Assignment) -> Result<f64, Error> {
    let given = || format!("{key}={value}");
    if !matches!(key.parse(), Ok(Key::V)) {
        return Err(Error::invalid(&["up_to"], given(), "not a speed", "v=VALUE, in m/s"));
    }
    let mut fastest = *wheel;
    fastest.set(key, value).map_err(|source| Error::Set {
        field: "up_to",
        given: given(),
        source: Box::new(source),
    })?;
    let speed = fastest.get(Key::V);
    if speed <= 0.0 {
        return Err(Error::invalid(&["up_to"], given(), "no speed", "a speed above 0, in m/s"));
    }
    Ok(speed)
}
