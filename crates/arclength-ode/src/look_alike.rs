//! Characters that look like signs of the language and are none, as word processors and web pages write them.

/// The sign that is meant by a character that looks like it.
fn meant(character: char) -> Option<&'static str> {
    Some(match character {
        '\u{2010}'..='\u{2015}' | '\u{2212}' | '\u{fe63}' | '\u{ff0d}' => "-",
        '\u{ff0b}' => "+",
        '\u{b7}' | '\u{d7}' | '\u{2217}' | '\u{22c5}' | '\u{2219}' | '\u{ff0a}' => "*",
        '\u{f7}' | '\u{2044}' | '\u{2215}' | '\u{ff0f}' => "/",
        '\u{b2}' => "^2",
        '\u{b3}' => "^3",
        '\u{b4}' | '\u{2018}' | '\u{2019}' | '\u{2032}' | '\u{ff07}' | '`' => "'",
        '\u{2264}' => "<=",
        '\u{2265}' => ">=",
        '\u{2260}' => "!=",
        '\u{ff1d}' => "=",
        '\u{ff08}' => "(",
        '\u{ff09}' => ")",
        '\u{ff0c}' => ",",
        '\u{3c0}' => "pi",
        _ => return None,
    })
}

/// Whether a character is meant as the prime of a derivative.
pub(crate) fn is_prime(character: char) -> bool {
    meant(character) == Some("'")
}

/// What to do about a character that is not known: `; write -`, or nothing.
pub(crate) fn remedy(character: char) -> String {
    meant(character).map(|sign| format!("; write {sign}")).unwrap_or_default()
}
