//! Numbers as people read them, in messages and in tables alike.

/// Significant digits in tables.
const DIGITS: usize = 8;

/// A number with eight significant digits, without trailing zeros, in scientific notation where that is shorter.
///
/// ```
/// use arclength_numbers::readable;
/// assert_eq!(readable(8.431036970140001), "8.431037");
/// assert_eq!(readable(0.0), "0");
/// assert_eq!(readable(-6.520929e-5), "-6.520929e-5");
/// assert_eq!(readable(f64::INFINITY), "inf");
/// ```
pub fn readable(value: f64) -> String {
    significant(value, DIGITS)
}

/// A number with as many significant digits as asked for.
pub fn significant(value: f64, digits: usize) -> String {
    if value == 0.0 || !value.is_finite() {
        return if value == 0.0 { "0".to_owned() } else { value.to_string() };
    }
    let scientific = format!("{value:.*e}", digits.saturating_sub(1));
    let Some((mantissa, exponent)) = scientific.split_once('e') else { return scientific };
    let power: i32 = exponent.parse().unwrap_or(0);
    if (-3..digits as i32).contains(&power) {
        let decimals = (digits as i32 - 1 - power).max(0) as usize;
        return trimmed(&format!("{value:.decimals$}")).to_owned();
    }
    format!("{}e{exponent}", trimmed(mantissa))
}

/// A number of things, with the word for one of them or for several.
///
/// ```
/// use arclength_numbers::counted;
/// assert_eq!(counted(1, "branch", "branches"), "1 branch");
/// assert_eq!(counted(0, "branch", "branches"), "0 branches");
/// ```
pub fn counted(number: usize, one: &str, several: &str) -> String {
    format!("{number} {}", if number == 1 { one } else { several })
}

fn trimmed(number: &str) -> &str {
    if number.contains('.') { number.trim_end_matches('0').trim_end_matches('.') } else { number }
}

/// The code of the README, which is tested.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn digits_and_zeros() {
        for (value, expected) in [
            (1.0, "1"),
            (100.0, "100"),
            (-0.0, "0"),
            (0.1 + 0.2, "0.3"),
            (12345678.9, "12345679"),
            (123456789.0, "1.2345679e8"),
            (0.00123, "0.00123"),
            (0.000123, "1.23e-4"),
            (9.99999999e-4, "0.001"),
            (99999999.9, "1e8"),
        ] {
            assert_eq!(readable(value), expected);
        }
    }
}
