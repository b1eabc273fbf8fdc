//! A Hopf point as far as the first cycle needs it, and how large that cycle is.

use num_complex::Complex64;

/// Amplitude of the first cycle, as part of the amplitude at which the normal form has moved the parameter by
/// the length of its range.
const FIRST_AMPLITUDE: f64 = 0.02;
/// Largest amplitude of the first cycle relative to the natural size of a state.
const LARGEST_FIRST_AMPLITUDE: f64 = 0.02;
/// A Hopf point as far as the first cycle needs it.
pub(super) struct HopfStart<'a> {
    pub state: &'a [f64],
    pub frequency: f64,
    pub eigenvector: &'a [Complex64],
    pub crossing_speed: f64,
    pub cubic_coefficient: f64,
}

impl HopfStart<'_> {
    /// Amplitude to start with, so that the first cycle is some part of the parameter's range `width` away; `scales` are the
    /// sizes of the states.
    pub(super) fn first_amplitude(&self, width: f64, scales: &[f64]) -> f64 {
        // In the normal form the squared amplitude at distance dp is |crossing speed dp / cubic coefficient|.
        let natural = (width * self.crossing_speed / self.cubic_coefficient).abs().sqrt();
        let limits = scales
            .iter()
            .zip(self.eigenvector)
            .map(|(scale, component)| LARGEST_FIRST_AMPLITUDE * scale / component.norm().max(1e-300));
        let natural_start = FIRST_AMPLITUDE * natural;
        if natural_start.is_finite() && natural_start > 0.0 {
            natural_start.min(limits.fold(0.0, f64::max))
        } else {
            // Only the sizes of the states tell, and some may take no part.
            limits.fold(f64::INFINITY, f64::min)
        }
    }
}
