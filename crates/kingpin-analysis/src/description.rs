//! Wheels in words: one line, however much there is to say.

use kingpin::{Key, Tyre, Wheel};
use kingpin_report::numbers::readable;

/// Characters that the parameters may take; what does not fit is counted.
const LONGEST: usize = 110;

/// Speed, caster length and radius; what was changed of the wheel of a file, or is not the paper's where there is no file; all that
/// the wheel has and need not have, such as dampers and a load; and the file. Without those that vary.
pub(crate) fn of(wheel: &Wheel, varying: &[Key]) -> String {
    let always = [Key::V, Key::L, Key::TurningRadius];
    let is_extra = |key: Key, value: f64| {
        let from_nothing = key.default_value() == 0.0 && !key.is_of_the_tyre();
        value != key.default_value() && (from_nothing || value.is_infinite())
    };
    let fixed = || wheel.parameters().filter(|(key, _)| !wheel.varies_with(*key, varying));
    let (first, rest): (Vec<_>, Vec<_>) = fixed().partition(|(key, _)| always.contains(key));
    let (changed, rest): (Vec<_>, Vec<_>) = rest.into_iter().partition(|(key, _)| wheel.is_changed(*key));
    let extra = rest.into_iter().filter(|&(key, value)| is_extra(key, value));
    let tyre = Some(wheel.tyre()).filter(|tyre| *tyre != Tyre::Rigid);
    let tyre = tyre.map(|tyre| format!("{} = {tyre}", Tyre::KEY));
    let quantities = |list: Vec<(Key, f64)>| list.into_iter().map(|(key, value)| quantity(key, value));
    let all = quantities(first).chain(tyre).chain(quantities(changed)).chain(quantities(extra.collect()));
    let parameters = shortened(all.collect());
    match wheel.file_name() {
        Some(file) if parameters.is_empty() => file.to_owned(),
        Some(file) => format!("{parameters} ({})", of_file(wheel, file, varying)),
        None => parameters,
    }
}

/// The file, and that something was changed in it.
fn of_file(wheel: &Wheel, file: &str, varying: &[Key]) -> String {
    let keys = wheel.parameters().map(|(key, _)| key);
    let changed: Vec<&str> = keys
        .filter(|key| wheel.is_changed(*key) && !wheel.varies_with(*key, varying))
        .map(Key::name)
        .collect();
    match changed.as_slice() {
        [] => file.to_owned(),
        changed => format!("{file} but for {}", changed.join(", ")),
    }
}

/// As many quantities as fit, and how many more there are.
fn shortened(quantities: Vec<String>) -> String {
    let mut text = String::new();
    for (index, quantity) in quantities.iter().enumerate() {
        let joined = if text.is_empty() { quantity.clone() } else { format!("{text}, {quantity}") };
        if joined.chars().count() > LONGEST && index > 0 {
            return format!("{text} and {} more", quantities.len() - index);
        }
        text = joined;
    }
    text
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

    #[test]
    fn a_file_is_named_with_what_was_changed() {
        let text = "v = 1.5\nm_w = 2\nm_c = 0.3\nR = 0.1\nl_c = 0.03\nk = 5000\nF_Az = -100\nM_f = 0.02";
        let wheel = Wheel::from_toml(text).unwrap().from_file("cart.toml");
        let told = "v = 1.5 m/s, l = 0.08 m, r = 1 m, F_Az = -100 N, M_f = 0.02 N m (cart.toml)";
        assert_eq!(of(&wheel, &[]), told);
        let changed = wheel.with(Key::L, 0.2).unwrap().with(Key::KQ, 400.0).unwrap();
        let told =
            "l = 0.2 m, r = 1 m, k_q = 400 N/m, F_Az = -100 N, M_f = 0.02 N m (cart.toml but for l, k_q)";
        assert_eq!(of(&changed, &[Key::V]), told);
        assert_eq!(
            of(&changed, &[Key::V, Key::KQ]),
            told.replace(" k_q = 400 N/m,", "").replace(", k_q", "")
        );
    }

    #[test]
    fn many_changes_stay_on_one_line() {
        let mut wheel = Wheel::default();
        for (key, _) in Wheel::default().parameters() {
            let value = wheel.get(key);
            wheel.set_value(key, 1.5 * value + f64::from(u8::from(value == 0.0))).unwrap();
        }
        let told = of(&wheel, &[]);
        assert!(
            told.starts_with("v = 6 m/s, l = 0.12 m, r = 1.5 m, m_w = ") && told.ends_with(" more"),
            "{told}"
        );
        assert!(told.len() < 130, "{told}");
    }
}
