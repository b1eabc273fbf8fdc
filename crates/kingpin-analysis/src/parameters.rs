//! The parameters of a wheel as they stand in results.

use kingpin::{Key, KingpinError, Tyre, Wheel};
use kingpin_report::{NamedNumbers, Parameters};

/// Every parameter that a wheel uses, without those that vary; the tyre where it is none that is rigid.
pub(crate) fn parameters_of(wheel: &Wheel, varying: &[Key]) -> Parameters {
    let fixed = wheel.parameters().filter(|(key, _)| !wheel.varies_with(*key, varying));
    let numbers = NamedNumbers(fixed.map(|(key, value)| (key.name().to_owned(), value)).collect());
    let tyre = Some(wheel.tyre()).filter(|tyre| *tyre != Tyre::Rigid);
    let words = tyre.map(|tyre| (Tyre::KEY.to_owned(), tyre.name().to_owned()));
    Parameters { words: words.into_iter().collect(), numbers }
}

/// The wheel with these parameters, the others being the paper's.
///
/// # Errors
/// An unknown key, or a value that a parameter may not take.
pub(crate) fn wheel_of(parameters: &Parameters) -> Result<Wheel, KingpinError> {
    let mut wheel = Wheel::default();
    for (name, word) in &parameters.words {
        wheel.set(name, word)?;
    }
    for (name, value) in &parameters.numbers.0 {
        let key: Key = name.parse()?;
        // What follows from others goes on to follow them.
        if wheel.get(key) != *value {
            wheel.set_value(key, *value)?;
        }
    }
    Ok(wheel)
}
