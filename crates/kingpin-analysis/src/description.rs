//! Wheels in words: all that is to be said, for a table on lines that are not too long.

use kingpin::{Key, Tyre, Wheel};
use kingpin_report::numbers::readable;

/// Characters that the parameters may take on one line of a heading, and with the file.
const LONGEST: usize = 110;
const LONGEST_WITH_FILE: usize = 150;
/// What begins a further line of a heading.
const FURTHER: &str = "\n    ";

/// Speed, caster length and radius; what was changed of the wheel of a file, or is not the paper's where there is no file; all that
/// the wheel has and need not have, such as dampers and a load; and the file. Without those that vary.
pub(crate) fn of(wheel: &Wheel, varying: &[Key]) -> String {
    let [parameters, file] = parts(wheel, varying);
    [parameters.join(", "), file.join(" ")]
        .into_iter()
        .filter(|part| !part.is_empty())
        .collect::<Vec<_>>()
        .join(" ")
}

/// The same as the end of a heading, on further lines where it is long.
pub(crate) fn on_lines(wheel: &Wheel, varying: &[Key]) -> String {
    let [parameters, file] = parts(wheel, varying);
    let lines = wrapped(&parameters.iter().map(|item| format!("{item},")).collect::<Vec<_>>(), LONGEST);
    let told = lines.join(FURTHER).trim_end_matches(',').to_owned();
    let last = lines.last().map_or(0, |line| line.chars().count());
    let (whole, fits) = (file.join(" "), last + file.join(" ").chars().count() <= LONGEST_WITH_FILE);
    match (told.is_empty(), whole.is_empty()) {
        (_, true) => told,
        (true, _) => whole,
        _ if fits => format!("{told} {whole}"),
        _ => format!("{told}{FURTHER}{}", wrapped(&file, LONGEST).join(FURTHER)),
    }
}

/// What is told of the parameters, and the file, in pieces.
fn parts(wheel: &Wheel, varying: &[Key]) -> [Vec<String>; 2] {
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
    let parameters: Vec<String> = all.collect();
    let file = match wheel.file_name() {
        Some(file) if parameters.is_empty() => vec![file.to_owned()],
        Some(file) => format!("({})", of_file(wheel, file, varying)).split(' ').map(str::to_owned).collect(),
        None => Vec::new(),
    };
    [parameters, file]
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

/// Words on lines of at most so many characters.
fn wrapped(words: &[String], longest: usize) -> Vec<String> {
    let mut lines: Vec<String> = Vec::new();
    for word in words {
        match lines.last_mut() {
            Some(line) if line.chars().count() + 1 + word.chars().count() <= longest => {
                line.push(' ');
                line.push_str(word);
            }
            _ => lines.push(word.clone()),
        }
    }
    lines
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
    fn many_changes_are_all_told_on_lines_that_are_not_too_long() {
        let mut wheel = Wheel::default();
        for (key, _) in Wheel::default().parameters() {
            let value = wheel.get(key);
            wheel.set_value(key, 1.5 * value + f64::from(u8::from(value == 0.0))).unwrap();
        }
        for wheel in [wheel, wheel.from_file("cart.toml").with(Key::L, 0.3).unwrap()] {
            let told = on_lines(&wheel, &[]);
            assert!(
                told.lines().count() > 1 && told.lines().all(|line| line.chars().count() < 160),
                "{told}"
            );
            assert_eq!(told.replace(FURTHER, " "), of(&wheel, &[]));
        }
        let told = on_lines(&wheel, &[]);
        for (key, _) in wheel.parameters() {
            assert!(told.contains(&format!("{key} = ")), "{key}: {told}");
        }
    }
}
