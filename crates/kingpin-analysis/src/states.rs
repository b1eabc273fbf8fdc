//! States of the wheel by name, and their units.

use kingpin::rolling::STATE_NAMES;
use kingpin_report::NamedNumbers;

/// A state of the wheel, by name, without what is not a number.
pub(crate) fn named_state(state: &[f64]) -> NamedNumbers {
    let numbers = STATE_NAMES.into_iter().map(str::to_owned).zip(state.iter().copied());
    NamedNumbers(numbers.filter(|(_, value)| !value.is_nan()).collect())
}

/// Units of the states `u q psi V Omega`.
pub(crate) const STATE_UNITS: [&str; 5] = ["m", "m", "rad", "m/s", "rad/s"];
