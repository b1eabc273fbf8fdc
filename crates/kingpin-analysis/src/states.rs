//! States of the wheel by name, and their units.

use kingpin::rolling::STATE_NAMES;
use kingpin::tyre::TYRE_STATE_NAMES;
use kingpin_report::NamedNumbers;

/// All states of a wheel, by name, without what is not a number; as many are given as a wheel with a tyre has, or without one.
pub(crate) fn named_state(state: &[f64]) -> NamedNumbers {
    let names: &[&str] = if state.len() == TYRE_STATE_NAMES.len() { &TYRE_STATE_NAMES } else { &STATE_NAMES };
    let numbers = names.iter().map(|&name| name.to_owned()).zip(state.iter().copied());
    NamedNumbers(numbers.filter(|(_, value)| !value.is_nan()).collect())
}

/// The unit of a state.
pub(crate) fn unit(name: &str) -> &'static str {
    match name {
        "u" | "q" | "y_t" => "m",
        "psi" => "rad",
        "Omega" => "rad/s",
        _ => "m/s",
    }
}

/// What a state is.
pub(crate) fn meaning(name: &str) -> &'static str {
    match name {
        "u" => "longitudinal displacement of the king pin",
        "q" => "lateral displacement of the king pin",
        "psi" => "caster angle",
        "V2" => "lateral speed of the wheel",
        "Omega" => "yaw rate",
        "y_t" => "lateral deflection of the tyre",
        _ => "forward speed of the wheel",
    }
}
