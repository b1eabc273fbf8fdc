//! The search for Hopf points, which must find one.

use crate::description;
use crate::error::Error;
use arclength_analysis::Control;
use kingpin::branches::{Along, HopfSearch};
use kingpin::{Key, Wheel};
use kingpin_report::numbers::readable;

/// The Hopf points of the interval, of which there must be one.
///
/// # Errors
/// [`Error::NothingFound`] with the stability at both ends, and those of the search.
pub fn search(wheel: &Wheel, along: Along) -> Result<HopfSearch, Error> {
    let search = wheel.hopf_points(along, &Control::none())?;
    if !search.points.is_empty() {
        return Ok(search);
    }
    let stability = |stable: Option<bool>| match stable {
        Some(true) => "stable",
        Some(false) => "unstable",
        None => "neither clearly stable nor clearly unstable",
    };
    let (low, high) = search.searched;
    let (start, end) = along.ends();
    let mut message = format!(
        "no Hopf point for {} from {} to {} at {}: the uniform motion is {} at {} and {} at {}",
        along.key(),
        readable(start),
        readable(end),
        description::of(wheel, &[along.key()]),
        stability(search.stable_at_ends.0),
        description::quantity(along.key(), low),
        stability(search.stable_at_ends.1),
        description::quantity(along.key(), high),
    );
    for (reached, wanted, stop) in [(low, start, &search.stops.0), (high, end, &search.stops.1)] {
        if reached != wanted {
            message += &format!("; beyond {} it could not be followed ({stop})", readable(reached));
        }
    }
    let straight = wheel.get(Key::TurningRadius).is_infinite() && along.key() != Key::TurningRadius;
    if straight && wheel.get(Key::CU) == 0.0 && !wheel.has_lateral_elasticity_only() {
        message += "; on a straight path without c_u the longitudinal motion is undamped, which hides Hopf points: \
                    set a small c_u, or follow cycles from a circle with `kingpin cycles --along r=A:inf`";
        return Err(Error::NothingFound(message));
    }
    message += "; try a wider interval, or see with `kingpin chart` where the stability changes";
    Err(Error::NothingFound(message))
}

/// Label of the Hopf point with an index.
pub fn label(index: usize) -> String {
    format!("HB{}", index + 1)
}
