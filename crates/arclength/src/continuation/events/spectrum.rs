//! The growth exponents of a solution, whose crossings of the imaginary axis are its bifurcations.

use num_complex::Complex64;
use std::f64::consts::{PI, TAU};

/// Growth exponents of a solution: eigenvalues of an equilibrium, logarithms of the multipliers of a cycle.
#[derive(Clone, Debug, Default)]
pub struct Spectrum {
    /// The exponents; those with a positive real part are unstable.
    pub exponents: Vec<Complex64>,
    /// Number of unstable ones, decided or not.
    pub unstable: usize,
    /// Whether that number is beyond doubt.
    pub decided: bool,
    /// Real parts below this may be rounding.
    pub noise: f64,
    /// Whether imaginary parts are known up to multiples of 2 pi only.
    pub is_periodic: bool,
}

impl Spectrum {
    /// Whether an exponent is no member of a complex pair.
    pub(super) fn is_real(&self, exponent: Complex64) -> bool {
        exponent.im == 0.0 || self.is_periodic && exponent.im.abs() == PI
    }

    /// Distance of two exponents.
    pub(super) fn separation(&self, one: Complex64, other: Complex64) -> f64 {
        let difference = one - other;
        if self.is_periodic {
            let turns = (difference.im / TAU).round();
            difference.re.hypot(difference.im - turns * TAU)
        } else {
            difference.norm()
        }
    }
}
