//! The wheels of the studies.

use kingpin::{Key, KingpinError, Wheel};

/// The paper's wheel with other values of some keys.
pub(super) fn wheel(values: &[(Key, f64)]) -> Result<Wheel, KingpinError> {
    values.iter().try_fold(Wheel::default(), |wheel, &(key, value)| wheel.with(key, value))
}
