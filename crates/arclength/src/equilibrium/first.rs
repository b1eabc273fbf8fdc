//! The first equilibrium, from a start that may be far from one.
//!
//! Newton's method and pseudo-transient steps come first. Where they fail the flow itself is followed, since most starts that
//! models come with lead to an equilibrium or at least to the part of the state space where one is; then starts are drawn at
//! random from there, always the same ones.

use super::newton::find_erased;
use crate::algebraic::scales::natural_scales;
use crate::differentiation::Dual;
use crate::erased::ErasedField;
use crate::error::Error;
use crate::field::VectorField;
use crate::integration::{Integrator, Method, Stepper, System, exact_jacobian};
use crate::random::Random;

/// How an equilibrium was found.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum FoundBy {
    /// By Newton's method, perhaps behind implicit steps with the flow, from the start: it is near.
    Newton,
    /// By Newton's method from the start, far away from it; the flow leads to none that is nearer.
    FarNewton,
    /// By Newton's method from a state to which the flow leads from the start.
    Flow,
    /// By Newton's method from the random start of this number, counted from 1.
    RandomStart(usize),
}

/// An equilibrium and how it was found.
#[derive(Clone, Debug, PartialEq)]
pub struct FoundEquilibrium {
    /// The state.
    pub state: Vec<f64>,
    /// How it was found.
    pub by: FoundBy,
}

/// Distance of an equilibrium from the start, in natural sizes of the states, that still is near.
const NEAR: f64 = 5.0;
/// Tolerance of the flow that is followed, and accepted steps in all; Newton's method is tried at powers of two of them.
const FLOW_TOLERANCE: f64 = 1e-6;
const FLOW_STEPS: u32 = 4096;
const FIRST_TRIAL: u32 = 16;
/// A flow is followed no longer than this.
const FLOW_TIME: f64 = 1e12;
/// Random starts.
const RANDOM_STARTS: usize = 200;
/// Part of the range of a state along the flow by which random starts exceed it.
const MARGIN: f64 = 0.5;

/// An equilibrium of `field` at `parameters`, sought from `start` by Newton's method, then along the flow, then from random starts
/// around what the flow visits.
///
/// ```
/// use arclength::{Scalar, VectorField, equilibrium::{FoundBy, seek_equilibrium}};
/// struct Decay;
/// impl VectorField for Decay {
///     fn state_names(&self) -> Vec<String> { vec!["x".into()] }
///     fn parameter_names(&self) -> Vec<String> { vec!["p".into()] }
///     fn evaluate<T: Scalar>(&self, x: &[T], p: &[T], derivative: &mut [T]) {
///         derivative[0] = p[0] - x[0] * x[0] * x[0];
///     }
/// }
/// let found = seek_equilibrium(&Decay, &[3.0], &[8.0])?;
/// assert_eq!(found.by, FoundBy::Newton);
/// assert!((found.state[0] - 2.0).abs() < 1e-15);
/// # Ok::<(), arclength::Error>(())
/// ```
///
/// # Errors
/// [`Error::NotFound`] with why Newton's method failed from the start; [`Error::Invalid`] when `start` or `parameters` have the
/// wrong length or are not finite.
pub fn seek_equilibrium<F: VectorField>(
    field: &F,
    start: &[f64],
    parameters: &[f64],
) -> Result<FoundEquilibrium, Error> {
    seek_erased(field.erased(), start, parameters)
}

/// As [`seek_equilibrium`].
pub(crate) fn seek_erased(
    field: ErasedField<'_>,
    start: &[f64],
    parameters: &[f64],
) -> Result<FoundEquilibrium, Error> {
    // The natural sizes of many states take long: where the states themselves are as large they are not asked for.
    let is_beside = |state: &[f64]| {
        state.iter().zip(start).all(|(there, here)| (there - here).abs() <= NEAR * here.abs())
    };
    let found = match find_erased(field, start, parameters) {
        Ok(state) if is_beside(&state) => return Ok(FoundEquilibrium { state, by: FoundBy::Newton }),
        Err(error) if !matches!(error, Error::NotFound { .. }) => return Err(error),
        found => found,
    };
    let natural = natural_scales(&field, start, parameters, &vec![0.0; start.len()]);
    let sizes: Vec<f64> = natural.iter().zip(start).map(|(size, value)| size.max(value.abs())).collect();
    let between = |one: &[f64], other: &[f64]| {
        let parts = one.iter().zip(other).zip(&sizes).map(|((one, other), size)| (one - other).abs() / size);
        parts.fold(0.0, f64::max)
    };
    let distance = |state: &[f64]| between(state, start);
    let found = match found {
        Ok(state) if distance(&state) <= NEAR => return Ok(FoundEquilibrium { state, by: FoundBy::Newton }),
        found => found,
    };
    let found_from = |state: &[f64]| find_erased(field, state, parameters).ok();
    let mut visited: Vec<[f64; 2]> = start.iter().map(|value| [*value; 2]).collect();
    // From a state on the way Newton's method may leave for far away, too.
    let from_flow =
        |state: &[f64]| found_from(state).filter(|there| found.is_err() || between(there, state) <= NEAR);
    let along = along_flow(field, start, parameters, &mut visited, from_flow);
    let failure = match (found, along) {
        // Newton's method may have left for far away, although the flow leads to one that is nearer.
        (Ok(state), Some(along)) if distance(&along) >= distance(&state) => {
            return Ok(FoundEquilibrium { state, by: FoundBy::FarNewton });
        }
        (Ok(state), None) => return Ok(FoundEquilibrium { state, by: FoundBy::FarNewton }),
        (_, Some(state)) => return Ok(FoundEquilibrium { state, by: FoundBy::Flow }),
        (Err(failure), None) => failure,
    };
    let mut random = Random::new(1);
    for number in 1..=RANDOM_STARTS {
        let drawn: Vec<f64> = visited
            .iter()
            .zip(&sizes)
            .map(|([low, high], size)| {
                let margin = MARGIN * (high - low) + size;
                (low - margin) + random.next_unit() * (high - low + 2.0 * margin)
            })
            .collect();
        if let Some(state) = found_from(&drawn) {
            return Ok(FoundEquilibrium { state, by: FoundBy::RandomStart(number) });
        }
    }
    Err(failure)
}

/// The flow of a field of unknown type.
struct Flow<'a> {
    field: ErasedField<'a>,
    parameters: &'a [f64],
    dimension: usize,
}

impl System for Flow<'_> {
    fn dimension(&self) -> usize {
        self.dimension
    }

    fn evaluate(&mut self, _time: f64, state: &[f64], derivative: &mut [f64]) {
        self.field.evaluate(state, self.parameters, derivative);
    }

    fn jacobian(&mut self, _time: f64, state: &[f64], jacobian: &mut [f64]) {
        let parameters: Vec<_> = self.parameters.iter().map(|value| Dual::constant(*value)).collect();
        exact_jacobian(|state, slope| self.field.evaluate(state, &parameters, slope), state, jacobian);
    }
}

/// The first equilibrium that is found from a state on the way of the flow; `visited` grows to the ranges of the states.
fn along_flow(
    field: ErasedField<'_>,
    start: &[f64],
    parameters: &[f64],
    visited: &mut [[f64; 2]],
    found_from: impl Fn(&[f64]) -> Option<Vec<f64>>,
) -> Option<Vec<f64>> {
    let system = Flow { field, parameters, dimension: start.len() };
    let integrator = Integrator::with_tolerance(FLOW_TOLERANCE).method(Method::Automatic);
    let mut stepper = Stepper::new(system, &integrator, 0.0, start, FLOW_TIME).ok()?;
    for step in 1..=FLOW_STEPS {
        if stepper.is_finished() || stepper.advance().is_err() {
            return found_from(stepper.state());
        }
        for ([low, high], value) in visited.iter_mut().zip(stepper.state()) {
            (*low, *high) = (low.min(*value), high.max(*value));
        }
        if step >= FIRST_TRIAL
            && step.is_power_of_two()
            && let Some(state) = found_from(stepper.state())
        {
            return Some(state);
        }
    }
    None
}
