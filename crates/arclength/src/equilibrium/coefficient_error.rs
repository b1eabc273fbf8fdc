//! Errors of normal-form coefficients at an equilibrium: how much they change when the equilibrium moves by its own error.
//!
//! A coefficient is a formula of the equilibrium, of eigenvectors and of linear systems that may be nearly singular. Computed anew
//! next to the equilibrium, within what rounding and the location leave open, it shows what all of them together make of that.

use super::problem::EquilibriumProblem;
use crate::random::Random;

/// Rounding of a state, as part of its size.
const ROUNDING: f64 = 8.0 * f64::EPSILON;
/// Equilibria nearby.
const TRIALS: usize = 3;
/// The largest change counts this many times.
const MARGIN: f64 = 3.0;

/// An equilibrium at which coefficients are computed, and how well it is known.
#[derive(Clone, Copy)]
pub(crate) struct UncertainEquilibrium<'a> {
    pub state: &'a [f64],
    pub parameters: &'a [f64],
    /// Indices of the parameters that were solved for with the state.
    pub active: &'a [usize],
    /// Sizes of the states, then those of these parameters.
    pub scales: &'a [f64],
    /// Error of the location as part of the sizes.
    pub location_error: f64,
}

impl<'a> UncertainEquilibrium<'a> {
    /// One on a branch along the first active parameter of `problem`, of which `location_error` is the error.
    pub(crate) fn on_branch(
        problem: &'a EquilibriumProblem<'_>,
        (state, parameters): (&'a [f64], &'a [f64]),
        scales: &'a [f64],
        location_error: f64,
    ) -> Self {
        let location_error = location_error / scales[state.len()];
        Self { state, parameters, active: &problem.active, scales, location_error }
    }

    /// State and parameters moved by the errors, at least by rounding, each up or down as `random` has it.
    fn moved(&self, random: &mut Random) -> (Vec<f64>, Vec<f64>) {
        let part = self.location_error.max(ROUNDING);
        let mut signed = |size: f64| size * if random.next_unit() < 0.5 { -1.0 } else { 1.0 };
        let (states, ranges) = self.scales.split_at(self.state.len());
        let state =
            self.state.iter().zip(states).map(|(value, scale)| value + signed(part * scale)).collect();
        let mut parameters: Vec<f64> =
            self.parameters.iter().map(|value| value + signed(f64::EPSILON * value.abs())).collect();
        // One that was solved for is known no better than its range allows, however small its value.
        for (&index, range) in self.active.iter().zip(ranges) {
            parameters[index] = self.parameters[index] + signed(part * range);
        }
        (state, parameters)
    }
}

/// Errors of the coefficients `known` at an equilibrium, which `coefficients` computes from state and parameters. `None` where there are
/// none nearby.
pub(crate) fn errors<const N: usize>(
    known: [f64; N],
    equilibrium: UncertainEquilibrium<'_>,
    coefficients: impl Fn(&[f64], &[f64]) -> Option<[f64; N]>,
) -> Option<[f64; N]> {
    let mut random = Random::new(1);
    let mut errors = [0.0_f64; N];
    for _ in 0..TRIALS {
        let (state, parameters) = equilibrium.moved(&mut random);
        for ((error, there), here) in errors.iter_mut().zip(coefficients(&state, &parameters)?).zip(known) {
            // What is not a number has no error.
            *error = if there.is_finite() { error.max(MARGIN * (there - here).abs()) } else { f64::NAN };
        }
    }
    errors.iter().all(|error| error.is_finite()).then_some(errors)
}
