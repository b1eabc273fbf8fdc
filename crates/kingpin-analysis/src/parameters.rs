//! The parameters of a wheel as they stand in results.

use kingpin::{Key, KingpinError, Wheel};
use kingpin_report::NamedNumbers;

/// Every parameter that a wheel stores, without those that vary.
pub(crate) fn parameters_of(wheel: &Wheel, varying: &[Key]) -> NamedNumbers {
    let fixed =
        wheel.parameters().filter(|(key, _)| !varying.iter().any(|active| active.sets().contains(key)));
    NamedNumbers(fixed.map(|(key, value)| (key.name().to_owned(), value)).collect())
}

/// The wheel with these parameters, the others being the paper's.
///
/// # Errors
/// An unknown key, or a value that a parameter may not take.
pub(crate) fn wheel_of(parameters: &[(String, f64)]) -> Result<Wheel, KingpinError> {
    let mut wheel = Wheel::default();
    for (name, value) in parameters {
        wheel.set_value(name.parse()?, *value)?;
    }
    Ok(wheel)
}
