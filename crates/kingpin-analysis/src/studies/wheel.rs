//! The wheels of the studies: the paper's with other values of some keys, or one that is given.

use crate::error::Error;
use crate::wheel_request::WheelRequest;
use kingpin::{Key, KingpinError, Wheel};

/// The paper's wheel with other values of some keys.
pub(super) fn wheel(values: &[(Key, f64)]) -> Result<Wheel, KingpinError> {
    values.iter().try_fold(Wheel::default(), |wheel, &(key, value)| wheel.with(key, value))
}

/// The wheel that is asked for; nothing where none is, and the study takes its own.
///
/// # Errors
/// What is wrong with it.
pub(super) fn given(request: &WheelRequest) -> Result<Option<Wheel>, Error> {
    let asked = *request != WheelRequest::default();
    asked.then(|| request.read()).transpose()
}

/// A number with two digits: scaled values are not told more precisely than they are meant.
pub(super) fn rounded(value: f64) -> f64 {
    let unit = 10_f64.powf(value.log10().floor() - 1.0);
    // Divided by a whole number, a decimal fraction is the nearest there is.
    let places = unit.recip().round();
    if unit < 1.0 { (value / unit).round() / places } else { (value / unit).round() * unit }
}

#[cfg(test)]
mod tests {
    use super::rounded;

    #[test]
    fn two_digits_are_kept() {
        for value in [0.05, 0.1, 0.011, 0.08, 1e-3, 60.0, 0.015, 10.0, 1.0, 120.0] {
            assert_eq!(rounded(value), value);
        }
        assert_eq!([0.1234, 3.456, 6789.0].map(rounded), [0.12, 3.5, 6800.0]);
    }
}
