//! Numbers as they are printed in the report.

use kingpin_report::numbers::significant;

/// A number with so many significant digits, as it is printed: powers of ten raised, a minus sign for a hyphen.
pub(super) fn number(value: f64, digits: usize) -> String {
    const RAISED: [char; 10] = ['⁰', '¹', '²', '³', '⁴', '⁵', '⁶', '⁷', '⁸', '⁹'];
    let plain = significant(value, digits);
    let (mantissa, exponent) = plain.split_once('e').unwrap_or((&plain, ""));
    let mut printed = mantissa.replace('-', "−");
    if !exponent.is_empty() {
        printed.push_str("·10");
        printed.extend(exponent.chars().map(|character| match character.to_digit(10) {
            Some(digit) => RAISED[digit as usize],
            None => '⁻',
        }));
    }
    printed
}

/// A ratio in per cent, with two significant digits but no power of ten.
pub(super) fn per_cent(ratio: f64) -> String {
    let value = 100.0 * ratio;
    if value.abs() < 10.0 { format!("{} %", number(value, 2)) } else { format!("{value:.0} %") }
}

/// The largest of some numbers that are not negative.
pub(super) fn largest(numbers: impl IntoIterator<Item = f64>) -> f64 {
    numbers.into_iter().fold(0.0, f64::max)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_printed_as_in_a_text() {
        assert_eq!(number(4.4e-16, 2), "4.4·10⁻¹⁶");
        assert_eq!(number(-2.5, 2), "−2.5");
        assert_eq!(per_cent(2.49), "249 %");
        assert_eq!(per_cent(-0.0234), "−2.3 %");
    }
}
