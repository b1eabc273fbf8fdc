//! The parameters of a wheel as they stand in results.

use crate::description::quantity;
use kingpin::{Key, KingpinError, Tyre, Wheel};
use kingpin_report::numbers::readable;
use kingpin_report::{NamedNumbers, Parameters};

/// Every parameter that a wheel uses, without those that vary; the tyre where it is none that is rigid.
pub(crate) fn parameters_of(wheel: &Wheel, varying: &[Key]) -> Parameters {
    let fixed = wheel.parameters().filter(|(key, _)| !wheel.varies_with(*key, varying));
    let numbers = NamedNumbers(fixed.map(|(key, value)| (key.name().to_owned(), value)).collect());
    let tyre = Some(wheel.tyre()).filter(|tyre| *tyre != Tyre::Rigid);
    let words = tyre.map(|tyre| (Tyre::KEY.to_owned(), tyre.name().to_owned()));
    let load = lifted(wheel, varying);
    let remarks = remarks(wheel).into_iter().chain(doubts(wheel, varying)).chain(load).collect();
    Parameters { words: words.into_iter().collect(), numbers, remarks }
}

/// The same where it is known over which values some parameters vary: that nothing presses the wheel on the ground over a part of them.
pub(crate) fn parameters_over(wheel: &Wheel, varying: &[(Key, [f64; 2])]) -> Parameters {
    let keys: Vec<Key> = varying.iter().map(|(key, _)| *key).collect();
    let mut parameters = parameters_of(wheel, &keys);
    parameters.remarks.extend(lifted_over(wheel, varying));
    parameters
}

/// What of the parameters no built wheel has, in sentences.
pub(crate) fn doubts(wheel: &Wheel, varying: &[Key]) -> Vec<String> {
    wheel.implausible(varying).iter().map(ToString::to_string).collect()
}

/// What presses the wheel on the ground.
const NORMAL_FORCE: &str = "N = -F_Az + (m_w + m_c) g";
/// What follows where nothing does.
const CANNOT_PULL: &str = "the ground cannot pull, and what is said of a wheel that rolls has no meaning";

/// That nothing presses the wheel on the ground; nothing where something does, or where that varies.
pub(crate) fn lifted(wheel: &Wheel, varying: &[Key]) -> Option<String> {
    let normal = wheel.normal_force();
    if normal > 0.0 || bears_on_the_load(varying.iter().copied()).next().is_some() {
        return None;
    }
    let load = wheel.get(Key::FAz);
    let remedy = if load > 0.0 {
        format!("; {} pulls upwards, a load that presses down is negative", quantity(Key::FAz, load))
    } else {
        String::new()
    };
    Some(format!(
        "nothing presses the wheel on the ground, {NORMAL_FORCE} = {} N: {CANNOT_PULL}{remedy}",
        readable(normal)
    ))
}

/// The same over values of some of the parameters that bear on it.
fn lifted_over(wheel: &Wheel, varying: &[(Key, [f64; 2])]) -> Option<String> {
    let keys: Vec<Key> = bears_on_the_load(varying.iter().map(|(key, _)| *key)).collect();
    // The force is monotonic in each of them.
    let mut corners = if keys.is_empty() { Vec::new() } else { vec![*wheel] };
    for (key, ends) in varying.iter().filter(|(key, _)| keys.contains(key)) {
        let at_ends = |wheel: &Wheel| ends.map(|end| wheel.with(*key, end));
        corners = corners.iter().flat_map(at_ends).collect::<Result<_, _>>().ok()?;
    }
    let forces = || corners.iter().map(Wheel::normal_force);
    let [lowest, highest] = [forces().reduce(f64::min)?, forces().reduce(f64::max)?];
    if lowest > 0.0 {
        return None;
    }
    let over = keys.into_iter().map(Key::name).collect::<Vec<_>>().join(" and ");
    let place = if highest > 0.0 { format!("over a part of {over}") } else { format!("at any {over} here") };
    Some(format!(
        "nothing presses the wheel on the ground {place}, {NORMAL_FORCE} goes from {} to {} N: there {CANNOT_PULL}",
        readable(lowest),
        readable(highest)
    ))
}

/// Those of some keys on which it depends what presses the wheel on the ground.
fn bears_on_the_load(keys: impl Iterator<Item = Key>) -> impl Iterator<Item = Key> {
    keys.filter(|key| [Key::FAz, Key::MW, Key::MC, Key::G].contains(key))
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
