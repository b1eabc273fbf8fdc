//! Equilibria as algebraic equations in the state and the active parameters.

use crate::algebraic::AlgebraicEquations;
use crate::differentiation::Dual;
use crate::erased::{ErasedField, FieldScalar, NarrowScalar};
use crate::parameters::with_parameters;

/// `f(x, p) = 0` with the unknowns `(x, active parameters)`; the other parameters are fixed.
#[derive(Clone, Debug)]
pub(crate) struct EquilibriumProblem<'a> {
    pub field: ErasedField<'a>,
    pub parameters: Vec<f64>,
    pub active: Vec<usize>,
    pub dimension: usize,
    /// The parameters and behind them the cells of the piece in which the field is evaluated, if it is in one.
    values: Vec<f64>,
}

impl<'a> EquilibriumProblem<'a> {
    pub(crate) fn new(field: ErasedField<'a>, parameters: &[f64], active: &[usize]) -> Self {
        Self {
            field,
            parameters: parameters.to_vec(),
            active: active.to_vec(),
            dimension: field.dimension(),
            values: parameters.to_vec(),
        }
    }

    /// Evaluates the field by [one of its pieces](crate::pieces) from now on, beyond its borders too; without cells as it is.
    pub(super) fn enter(&mut self, cells: &[f64]) {
        self.values.truncate(self.parameters.len());
        self.values.extend_from_slice(cells);
    }

    /// The cells of the piece by which the field is evaluated; none where it is evaluated as it is.
    pub(super) fn cells(&self) -> &[f64] {
        &self.values[self.parameters.len()..]
    }

    /// The full list of parameters at `values` of the active ones.
    pub(crate) fn parameters_at(&self, values: &[f64]) -> Vec<f64> {
        let mut parameters = self.parameters.clone();
        for (&index, &value) in self.active.iter().zip(values) {
            parameters[index] = value;
        }
        parameters
    }

    /// Writes `f` at the unknowns `(x, active parameters)`, and the switch functions behind it where there is room.
    pub(super) fn write_field<T: FieldScalar>(&self, unknown: &[T], value: &mut [T]) {
        let (state, values) = unknown.split_at(self.dimension);
        let active = self.active.iter().copied().zip(values.iter().copied());
        with_parameters(&self.values, active, |parameters| self.field.evaluate(state, parameters, value));
    }

    /// Writes `f` into `value` and its derivative along `direction` into `image`; `direction` lies in the space of
    /// the unknowns and may stop after the states.
    pub(crate) fn derivative_along<T: FieldScalar>(
        &self,
        unknown: &[T],
        direction: &[T],
        value: &mut [T],
        image: &mut [T],
    ) where
        Dual<T, 1>: FieldScalar,
    {
        let lifted: Vec<Dual<T, 1>> = unknown
            .iter()
            .enumerate()
            .map(|(index, &value)| Dual {
                value,
                derivatives: [direction.get(index).copied().unwrap_or_else(T::zero)],
            })
            .collect();
        let mut result = vec![Dual::constant(T::zero()); self.dimension];
        self.write_field(&lifted, &mut result);
        for ((value, image), entry) in value.iter_mut().zip(image).zip(&result) {
            *value = entry.value;
            *image = entry.derivatives[0];
        }
    }
}

impl AlgebraicEquations for EquilibriumProblem<'_> {
    fn unknowns(&self) -> usize {
        self.dimension + self.active.len()
    }

    fn equations(&self) -> usize {
        self.dimension
    }

    fn evaluate<T: NarrowScalar>(&self, unknown: &[T], residual: &mut [T]) {
        self.write_field(unknown, residual);
    }

    fn evaluate_wide(&self, unknown: &[Dual<f64, 8>], residual: &mut [Dual<f64, 8>]) -> bool {
        self.write_field(unknown, residual);
        true
    }
}
