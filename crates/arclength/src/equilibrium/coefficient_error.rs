//! Errors of normal-form coefficients at an equilibrium: how much they change when the equilibrium moves by its own error.
//!
//! A coefficient is a formula of the equilibrium, of eigenvectors and of linear systems that may be nearly singular. Computed anew
//! next to the equilibrium, within what rounding and the location leave open, it shows what all of them together make of that.

use crate::random::Random;

/// Rounding of a state, as part of its size.
const ROUNDING: f64 = 8.0 * f64::EPSILON;
/// Equilibria nearby.
const TRIALS: usize = 3;
/// The largest change counts this many times.
const MARGIN: f64 = 3.0;

/// Errors of the coefficients `known` of an equilibrium, which `coefficients` computes from state and parameters. States move by
/// parts of their sizes, `scales`, at least by the part `location_error`. `None` where there are none nearby.
pub(crate) fn errors<const N: usize>(
    known: [f64; N],
    (state, parameters): (&[f64], &[f64]),
    scales: &[f64],
    location_error: f64,
    coefficients: impl Fn(&[f64], &[f64]) -> Option<[f64; N]>,
) -> Option<[f64; N]> {
    let part = location_error.max(ROUNDING);
    let mut random = Random::new(1);
    let mut signed = |size: f64| size * if random.next_unit() < 0.5 { -1.0 } else { 1.0 };
    let mut errors = [0.0_f64; N];
    for _ in 0..TRIALS {
        let state: Vec<f64> =
            state.iter().zip(scales).map(|(value, scale)| value + signed(part * scale)).collect();
        let parameters: Vec<f64> =
            parameters.iter().map(|value| value + signed(f64::EPSILON * value.abs())).collect();
        for ((error, there), here) in errors.iter_mut().zip(coefficients(&state, &parameters)?).zip(known) {
            // What is not a number has no error.
            *error = if there.is_finite() { error.max(MARGIN * (there - here).abs()) } else { f64::NAN };
        }
    }
    errors.iter().all(|error| error.is_finite()).then_some(errors)
}
