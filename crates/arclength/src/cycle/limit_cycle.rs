//! The boundary value problem of a limit cycle: `u' = T f(u, p)`, `u(1) = u(0)`, with the integral phase
//! condition of Doedel (1981).

use crate::collocation::problem::{PeriodicProblem, Reference};
use crate::differentiation::Scalar;
use crate::erased::ErasedField;
use crate::field::VectorField;

/// A limit cycle with scalars `(T, p)`: period and active parameter.
#[derive(Debug, Clone)]
pub struct LimitCycle<'a> {
    /// The vector field.
    pub field: ErasedField<'a>,
    /// All parameters; the active one is replaced by the unknown.
    pub parameters: Vec<f64>,
    /// Index of the active parameter.
    pub active: usize,
    /// Sizes of the state variables, for conditions that mix them.
    pub scales: Vec<f64>,
}

impl PeriodicProblem for LimitCycle<'_> {
    #[inline(always)]
    fn dimension(&self) -> usize {
        self.scales.len()
    }

    #[inline(always)]
    fn scalars(&self) -> usize {
        2
    }

    #[inline(always)]
    fn factor(&self) -> Option<usize> {
        Some(0)
    }

    #[inline(always)]
    fn field<T: Scalar>(&self, state: &[T], scalars: &[T], derivative: &mut [T]) {
        with_parameters(&self.parameters, &[(self.active, scalars[1])], |parameters| {
            self.field.evaluate(state, parameters, derivative);
        });
        for entry in derivative.iter_mut() {
            *entry *= scalars[0];
        }
    }

    #[inline(always)]
    fn integrands<T: Scalar>(&self, state: &[T], _scalars: &[T], reference: Reference<'_>, values: &mut [T]) {
        values[0] = phase_integrand(state, reference, &self.scales);
    }
}

/// Integrand of the phase condition: `(u - u_ref) . u_ref'` in scaled variables.
#[inline(always)]
pub(crate) fn phase_integrand<T: Scalar>(state: &[T], reference: Reference<'_>, scales: &[f64]) -> T {
    let mut sum = T::zero();
    for (index, scale) in scales.iter().enumerate() {
        sum += (state[index] - reference.state[index]) * (reference.slope[index] / (scale * scale));
    }
    sum
}

/// Calls `action` with the parameters, some of them replaced, without allocating for the usual numbers of them.
#[inline(always)]
pub(crate) fn with_parameters<T: Scalar, R>(
    parameters: &[f64],
    replaced: &[(usize, T)],
    action: impl FnOnce(&[T]) -> R,
) -> R {
    // Dual numbers are large, so memory is not much more than is needed.
    match parameters.len() {
        0..=4 => with_memory::<T, R, 4>(parameters, replaced, action),
        5..=10 => with_memory::<T, R, 10>(parameters, replaced, action),
        11..=24 => with_memory::<T, R, 24>(parameters, replaced, action),
        count => action(fill(&mut vec![T::zero(); count], parameters, replaced)),
    }
}

#[inline(always)]
fn with_memory<T: Scalar, R, const MOST: usize>(
    parameters: &[f64],
    replaced: &[(usize, T)],
    action: impl FnOnce(&[T]) -> R,
) -> R {
    action(fill(&mut [T::zero(); MOST][..parameters.len()], parameters, replaced))
}

#[inline(always)]
fn fill<'a, T: Scalar>(memory: &'a mut [T], parameters: &[f64], replaced: &[(usize, T)]) -> &'a [T] {
    for (entry, value) in memory.iter_mut().zip(parameters) {
        *entry = T::from(*value);
    }
    for (index, value) in replaced {
        memory[*index] = *value;
    }
    memory
}
