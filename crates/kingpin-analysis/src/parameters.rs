//! The parameters of a wheel as they stand in results.

use crate::description::quantity;
use kingpin::{Key, KingpinError, Tyre, Wheel};
use kingpin_report::{NamedNumbers, Parameters};

/// Every parameter that a wheel uses, without those that vary; the tyre where it is none that is rigid.
pub(crate) fn parameters_of(wheel: &Wheel, varying: &[Key]) -> Parameters {
    let fixed = wheel.parameters().filter(|(key, _)| !wheel.varies_with(*key, varying));
    let numbers = NamedNumbers(fixed.map(|(key, value)| (key.name().to_owned(), value)).collect());
    let tyre = Some(wheel.tyre()).filter(|tyre| *tyre != Tyre::Rigid);
    let words = tyre.map(|tyre| (Tyre::KEY.to_owned(), tyre.name().to_owned()));
    Parameters { words: words.into_iter().collect(), numbers, remarks: remarks(wheel) }
}

/// What is worth knowing of how the parameters were given.
fn remarks(wheel: &Wheel) -> Vec<String> {
    let mut remarks = Vec::new();
    let left: Vec<&str> = wheel.left_to_the_paper().map(Key::name).collect();
    if let Some(file) = wheel.file_name()
        && !left.is_empty()
    {
        remarks.push(format!("{file} does not say {}: taken from the paper's wheel", left.join(", ")));
    }
    if wheel.stiffness_is_given_twice() {
        let [longitudinal, lateral] = [Key::KU, Key::KQ].map(|key| quantity(key, wheel.get(key)));
        remarks.push(format!(
            "`k` sets k_u and k_q, one of which is given too: {longitudinal}, {lateral} (in a file k_u and k_q win, else the last)"
        ));
    }
    if wheel.radius_is_given_twice() {
        let radius = quantity(Key::TurningRadius, wheel.get(Key::TurningRadius));
        remarks.push(format!(
            "`curvature` sets r, which is given too: {radius} (in a file r wins, else the last)"
        ));
    }
    remarks
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
        let may_follow = [Key::MuD, Key::TP].contains(&key);
        if !may_follow || wheel.get(key) != *value {
            wheel.set_value(key, *value)?;
        }
    }
    Ok(wheel)
}
