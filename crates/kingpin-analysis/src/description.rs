//! Wheels in words.

use kingpin::{Key, Tyre, Wheel};
use kingpin_report::numbers::readable;

/// Speed, caster length and radius, and every other parameter that is not the paper's; without those that vary.
pub(crate) fn of(wheel: &Wheel, varying: &[Key]) -> String {
    let always = [Key::V, Key::L, Key::TurningRadius];
    let varies = |key: Key| wheel.varies_with(key, varying);
    let worth_saying =
        |&(key, value): &(Key, f64)| !varies(key) && (always.contains(&key) || value != key.default_value());
    let tyre = Some(wheel.tyre()).filter(|tyre| *tyre != Tyre::Rigid);
    let tyre = tyre.map(|tyre| format!("{} = {tyre}", Tyre::KEY));
    let numbers = wheel.parameters().filter(worth_saying).map(|(key, value)| quantity(key, value));
    numbers.chain(tyre).collect::<Vec<_>>().join(", ")
}

/// `v = 4 m/s`.
pub(crate) fn quantity(key: Key, value: f64) -> String {
    let unit = if key.unit() == "1" || value.is_infinite() { "" } else { key.unit() };
    format!("{key} = {} {unit}", readable(value)).trim_end().to_owned()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_not_the_papers_is_told() {
        let wheel = Wheel::default().with(Key::CQ, 0.05).unwrap();
        assert_eq!(of(&wheel, &[Key::V]), "l = 0.08 m, r = 1 m, c_q = 0.05 N s/m");
    }
}
