//! Equilibria as an algebraic problem in the state and the active parameters.

use crate::algebraic::AlgebraicProblem;
use crate::differentiation::{Dual, Scalar};
use crate::erased::ErasedField;
use crate::field::VectorField;

/// `f(x, p) = 0` with the unknowns `(x, active parameters)`; the other parameters are fixed.
#[derive(Clone, Debug)]
pub(crate) struct EquilibriumProblem<'a> {
    pub field: ErasedField<'a>,
    pub parameters: Vec<f64>,
    pub active: Vec<usize>,
    pub dimension: usize,
}

impl<'a> EquilibriumProblem<'a> {
    pub fn new(field: ErasedField<'a>, parameters: &[f64], active: &[usize]) -> Self {
        Self { field, parameters: parameters.to_vec(), active: active.to_vec(), dimension: field.dimension() }
    }

    /// The full list of parameters at `values` of the active ones.
    pub fn parameters_at(&self, values: &[f64]) -> Vec<f64> {
        let mut parameters = self.parameters.clone();
        for (&index, &value) in self.active.iter().zip(values) {
            parameters[index] = value;
        }
        parameters
    }

    /// The full list of parameters as numbers of type `T`.
    fn fill<T: Scalar>(&self, values: &[T], parameters: &mut Vec<T>) {
        parameters.clear();
        parameters.extend(self.parameters.iter().map(|&value| T::from(value)));
        for (&index, &value) in self.active.iter().zip(values) {
            parameters[index] = value;
        }
    }

    /// Writes `f` into `value` and its derivative along `direction` into `image`; `direction` lies in the space of
    /// the unknowns and may stop after the states.
    pub fn derivative_along<T: Scalar>(
        &self,
        unknown: &[T],
        direction: &[T],
        value: &mut [T],
        image: &mut [T],
    ) {
        let lifted: Vec<Dual<T, 1>> = unknown
            .iter()
            .enumerate()
            .map(|(index, &value)| Dual {
                value,
                derivatives: [direction.get(index).copied().unwrap_or_else(T::zero)],
            })
            .collect();
        let (state, values) = lifted.split_at(self.dimension);
        let mut parameters = Vec::with_capacity(self.parameters.len());
        self.fill(values, &mut parameters);
        let mut result = vec![Dual::constant(T::zero()); self.dimension];
        self.field.evaluate(state, &parameters, &mut result);
        for ((value, image), entry) in value.iter_mut().zip(image).zip(&result) {
            *value = entry.value;
            *image = entry.derivatives[0];
        }
    }
}

impl AlgebraicProblem for EquilibriumProblem<'_> {
    const WIDE: bool = true;

    fn unknowns(&self) -> usize {
        self.dimension + self.active.len()
    }

    fn equations(&self) -> usize {
        self.dimension
    }

    fn evaluate<T: Scalar>(&self, unknown: &[T], residual: &mut [T], scratch: &mut Vec<T>) {
        let (state, values) = unknown.split_at(self.dimension);
        self.fill(values, scratch);
        self.field.evaluate(state, scratch, residual);
    }
}
