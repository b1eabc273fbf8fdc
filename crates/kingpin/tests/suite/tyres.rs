//! Wheels with a tyre.

use kingpin::{Key, Tyre, Wheel};

/// The paper's wheel with a tyre and other values of some parameters.
pub(crate) fn wheel(tyre: Tyre, settings: &[(Key, f64)]) -> Wheel {
    let mut wheel = Wheel::default();
    wheel.set_tyre(tyre);
    settings.iter().fold(wheel, |wheel, &(key, value)| wheel.with(key, value).unwrap())
}
