//! Labels of axes, in the markup of figures.

use kingpin::Key;

/// Symbol and unit of a parameter, `$J_{w\xi}$ (kg m$^2$)`.
pub(crate) fn of(key: Key) -> String {
    match key.unit() {
        "1" => symbol(key),
        unit => format!("{} ({})", symbol(key), unit.replace("^2", "$^2$")),
    }
}

/// The symbol of a parameter, `$J_{w\xi}$`.
pub(crate) fn symbol(key: Key) -> String {
    let symbol = match key.symbol().split_once('_') {
        Some((letter, index)) => {
            // Greek indices are variables, letters name things.
            let index: String = index.chars().map(command).collect();
            let index = if index.contains('\\') { index } else { format!("\\mathrm{{{index}}}") };
            format!("{}_{{{index}}}", letter.chars().map(command).collect::<String>())
        }
        None => key.symbol().chars().map(command).collect(),
    };
    format!("${symbol}$")
}

/// The markup for a character of a symbol.
fn command(character: char) -> String {
    match character {
        'ξ' => "\\xi ".to_owned(),
        'ζ' => "\\zeta ".to_owned(),
        'μ' => "\\mu ".to_owned(),
        'ψ' => "\\psi ".to_owned(),
        'σ' => "\\sigma ".to_owned(),
        'α' => "\\alpha ".to_owned(),
        'κ' => "\\kappa ".to_owned(),
        other => other.to_string(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_key_has_a_label() {
        assert_eq!(of(Key::V), "$v$ (m/s)");
        assert_eq!(of(Key::MuS), "$\\mu _{\\mathrm{s}}$");
        assert_eq!(of(Key::JWxi), "$J_{w\\xi }$ (kg m$^2$)");
        for key in Key::ALL {
            assert!(of(key).is_ascii(), "{}", of(key));
        }
    }
}
