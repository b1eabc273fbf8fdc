//! Chooses the ticks of an axis and writes their labels.

/// Ticks of one axis, in units of the data.
#[derive(Debug, Clone, PartialEq, Default)]
pub(crate) struct Ticks {
    /// Long ticks with their labels in markup; a label may be empty.
    pub major: Vec<(f64, String)>,
    /// Short ticks without labels.
    pub minor: Vec<f64>,
    /// Power of ten by which every label is to be multiplied, 0 for none.
    pub exponent: i32,
}

/// Labels carry a common power of ten when they would be at least this large or at most this small.
const LARGE: f64 = 1e5;
const SMALL: f64 = 1e-3;
/// Room for rounding when deciding whether a tick lies within the limits, in steps.
const ROUNDING: f64 = 1e-6;

/// Below this span the powers of ten of the steps leave the range of the numbers.
const NARROWEST: f64 = 1e-290;

/// Ticks at 1, 2 or 5 times a power of ten, about `target` of them, at least two where the numbers allow.
pub(crate) fn linear(low: f64, high: f64, target: usize) -> Ticks {
    let (low, high) = (low.min(high), low.max(high));
    let span = high - low;
    // Too narrow for the precision of the numbers: one tick, labelled with the value itself.
    if !span.is_finite() || span <= 1e-12 * low.abs().max(high.abs()) || span < NARROWEST {
        return Ticks { major: vec![(low, plain(low, 6))], ..Ticks::default() };
    }
    let (mut mantissa, mut power) = step(span, target);
    while count(low, high, f64::from(mantissa) * 10f64.powi(power)) < 2 {
        (mantissa, power) = match mantissa {
            5 => (2, power),
            2 => (1, power),
            _ => (5, power - 1),
        };
    }
    let minor_parts = if mantissa == 2 { 4 } else { 5 };
    // A power of ten is exact as a divisor but not as a factor below one: 3 * 0.1 is not 0.3, 3 / 10 is.
    let value = |index: f64| match power {
        0.. => index * f64::from(mantissa) * 10f64.powi(power),
        _ => index * f64::from(mantissa) / 10f64.powi(-power),
    };
    let step = value(1.0);
    let first = (low / step - ROUNDING).ceil();
    let last = (high / step + ROUNDING).floor();
    let largest = value(first).abs().max(value(last).abs());
    let exponent = if largest >= LARGE || (largest <= SMALL && largest > 0.0) {
        (largest * (1.0 + 1e-12)).log10().floor() as i32
    } else {
        0
    };
    let decimals = (exponent - power).max(0) as usize;
    let mut ticks = Ticks { exponent, ..Ticks::default() };
    let mut index = first;
    while index <= last {
        let at = value(index);
        ticks.major.push((at, signed(&format!("{:.decimals$}", at / 10f64.powi(exponent)))));
        index += 1.0;
    }
    let small = step / f64::from(minor_parts);
    let (from, to) = ((low / small - ROUNDING).ceil() as i64, (high / small + ROUNDING).floor() as i64);
    ticks.minor =
        (from..=to).filter(|i| i.rem_euclid(minor_parts.into()) != 0).map(|i| i as f64 * small).collect();
    ticks
}

/// The step nearest to span / target of the form {1, 2, 5} x 10^power.
fn step(span: f64, target: usize) -> (u8, i32) {
    let raw = span / target.max(1) as f64;
    let power = raw.log10().floor() as i32;
    let fraction = raw / 10f64.powi(power);
    match fraction {
        f if f < 1.5 => (1, power),
        f if f < 3.5 => (2, power),
        f if f < 7.5 => (5, power),
        _ => (1, power + 1),
    }
}

fn count(low: f64, high: f64, step: f64) -> i64 {
    ((high / step + ROUNDING).floor() - (low / step - ROUNDING).ceil()) as i64 + 1
}

/// Ticks of a logarithmic axis between positive limits: decades, and 2 and 5 between them where there is room.
pub(crate) fn logarithmic(low: f64, high: f64, target: usize) -> Ticks {
    let (low, high) = (low.min(high), low.max(high));
    let decades = (high / low).log10();
    if decades < 1.0 {
        return linear(low, high, target);
    }
    let (first, last) = ((low.log10() - ROUNDING).floor() as i32, (high.log10() + ROUNDING).ceil() as i32);
    let every = (decades / target.max(1) as f64).ceil().max(1.0) as i32;
    let labelled: &[u8] = if 3.0 * decades <= target as f64 { &[1, 2, 5] } else { &[1] };
    let inside = |value: f64| value >= low * (1.0 - ROUNDING) && value <= high * (1.0 + ROUNDING);
    let plain_decades = low >= 0.99e-3 && high <= 1.01e4 && decades <= 4.0;
    let mut ticks = Ticks::default();
    for power in first..=last {
        for mantissa in 1..=9_u8 {
            let value = match power {
                0.. => f64::from(mantissa) * 10f64.powi(power),
                _ => f64::from(mantissa) / 10f64.powi(-power),
            };
            if !inside(value) {
                continue;
            }
            if labelled.contains(&mantissa) && power.rem_euclid(every) == 0 {
                let label = if plain_decades {
                    plain(value, 6)
                } else if mantissa == 1 {
                    format!("$10^{{{power}}}$")
                } else {
                    format!("${mantissa}\\times 10^{{{power}}}$")
                };
                ticks.major.push((value, label));
            } else if mantissa == 1 || every == 1 {
                ticks.minor.push(value);
            }
        }
    }
    ticks
}

/// The value with at most `digits` significant digits, without superfluous zeros, in markup.
pub(crate) fn plain(value: f64, digits: usize) -> String {
    if value == 0.0 || !value.is_finite() {
        return "0".to_owned();
    }
    let magnitude = value.abs().log10().floor() as i32;
    if (-4..6).contains(&magnitude) {
        let decimals = (digits as i32 - 1 - magnitude).max(0) as usize;
        return signed(trimmed(&format!("{value:.decimals$}")));
    }
    let mantissa = format!("{:.*}", digits - 1, value / 10f64.powi(magnitude));
    format!("{}$\\times 10^{{{magnitude}}}$", signed(trimmed(&mantissa)))
}

fn trimmed(number: &str) -> &str {
    if number.contains('.') { number.trim_end_matches('0').trim_end_matches('.') } else { number }
}

/// A number with a true minus sign, and none before zero.
fn signed(number: &str) -> String {
    match number.strip_prefix('-') {
        Some(magnitude) if magnitude.chars().all(|c| c == '0' || c == '.') => magnitude.to_owned(),
        Some(magnitude) => format!("−{magnitude}"),
        None => number.to_owned(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn labels(ticks: &Ticks) -> Vec<&str> {
        ticks.major.iter().map(|(_, label)| label.as_str()).collect()
    }

    #[test]
    fn limits_at_the_ends_of_the_number_range_give_few_ticks() {
        for (low, high) in
            [(-1e-310, 0.0), (0.0, 5e-324), (-1e-300, 1e-300), (-1e308, 1e308), (0.0, f64::MAX)]
        {
            let count = linear(low, high, 6).major.len();
            assert!((1..=20).contains(&count), "{low} to {high}: {count}");
        }
    }

    #[test]
    fn round_limits_give_the_expected_ticks() {
        assert_eq!(labels(&linear(0.0, 12.0, 6)), ["0", "2", "4", "6", "8", "10", "12"]);
        assert_eq!(labels(&linear(0.0, 0.3, 6)), ["0.00", "0.05", "0.10", "0.15", "0.20", "0.25", "0.30"]);
        assert_eq!(labels(&linear(-1.0, 1.0, 4)), ["−1.0", "−0.5", "0.0", "0.5", "1.0"]);
    }

    #[test]
    fn very_large_and_small_numbers_share_a_power_of_ten() {
        let ticks = linear(0.0, 4e-5, 4);
        assert_eq!((ticks.exponent, labels(&ticks)), (-5, vec!["0", "1", "2", "3", "4"]));
        assert_eq!(linear(0.0, 3e7, 4).exponent, 7);
    }

    #[test]
    fn decades_are_labelled_as_powers_when_many() {
        assert_eq!(
            labels(&logarithmic(1e-6, 1e2, 4)),
            ["$10^{-6}$", "$10^{-4}$", "$10^{-2}$", "$10^{0}$", "$10^{2}$"]
        );
        assert_eq!(labels(&logarithmic(0.1, 100.0, 4)), ["0.1", "1", "10", "100"]);
    }

    #[test]
    fn numbers_are_written_without_superfluous_zeros() {
        for (value, label) in
            [(0.25, "0.25"), (-3.0, "−3"), (1e-7, "1$\\times 10^{-7}$"), (200000.0, "200000")]
        {
            assert_eq!(plain(value, 6), label);
        }
    }

    proptest! {
        #[test]
        fn ticks_are_even_inside_and_neither_too_few_nor_too_many(
            low in -1e6..1e6_f64, log_span in -3.0..6.0_f64, target in 2..12_usize,
        ) {
            let high = low + 10f64.powf(log_span);
            let ticks = linear(low, high, target);
            let values: Vec<f64> = ticks.major.iter().map(|(value, _)| *value).collect();
            prop_assert!(values.len() >= 2 && values.len() <= 2 * target + 2);
            let step = values[1] - values[0];
            let slack = 1e-5 * step;
            prop_assert!(values[0] >= low - slack && *values.last().unwrap() <= high + slack);
            prop_assert!(values[0] - step < low && values.last().unwrap() + step > high);
            for pair in values.windows(2) {
                prop_assert!((pair[1] - pair[0] - step).abs() < slack + 1e-9);
            }
            let mut different: Vec<&String> = ticks.major.iter().map(|(_, label)| label).collect();
            different.dedup();
            prop_assert_eq!(different.len(), values.len());
        }

        #[test]
        fn logarithmic_ticks_lie_inside(low in -9.0..5.0_f64, decades in 1.0..12.0_f64, target in 2..9_usize) {
            let (low, high) = (10f64.powf(low), 10f64.powf(low + decades));
            let ticks = logarithmic(low, high, target);
            for value in ticks.major.iter().map(|(value, _)| value).chain(&ticks.minor) {
                prop_assert!(*value >= low * 0.999 && *value <= high * 1.001);
            }
        }
    }
}
