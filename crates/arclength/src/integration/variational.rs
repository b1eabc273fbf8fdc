//! The variational equations: how a solution depends on its initial state.

use super::{IntegrationError, Integrator, System};
use crate::VectorField;
use crate::differentiation::{Dual, Scalar};

/// Columns that one evaluation with dual numbers carries.
const COLUMNS: usize = 4;

/// A vector field together with its variational equations `Y' = Df(x) Y`.
///
/// The state is `x` followed by the columns of `Y`, each of the dimension of the field.
#[derive(Debug)]
pub struct VariationalEquations<F> {
    field: F,
    dimension: usize,
    columns: usize,
    parameters: Vec<Dual<f64, COLUMNS>>,
    state: Vec<Dual<f64, COLUMNS>>,
    derivative: Vec<Dual<f64, COLUMNS>>,
}

impl<F: VectorField> VariationalEquations<F> {
    /// The equations for `columns` columns at the given parameters.
    pub fn new(field: F, parameters: &[f64], columns: usize) -> Self {
        let dimension = field.dimension();
        Self {
            field,
            dimension,
            columns,
            parameters: parameters.iter().map(|&p| Dual::from(p)).collect(),
            state: vec![Dual::zero(); dimension],
            derivative: vec![Dual::zero(); dimension],
        }
    }
}

impl<F: VectorField> System for VariationalEquations<F> {
    fn dimension(&self) -> usize {
        self.dimension * (1 + self.columns)
    }

    fn evaluate(&mut self, _time: f64, state: &[f64], derivative: &mut [f64]) {
        let n = self.dimension;
        // Without columns the field itself is still evaluated once.
        for first in (0..self.columns.max(1)).step_by(COLUMNS) {
            let count = COLUMNS.min(self.columns - first.min(self.columns));
            for (i, dual) in self.state.iter_mut().enumerate() {
                *dual = Dual::from(state[i]);
                for column in 0..count {
                    dual.derivatives[column] = state[n * (1 + first + column) + i];
                }
            }
            self.field.evaluate(&self.state, &self.parameters, &mut self.derivative);
            for (i, dual) in self.derivative.iter().enumerate() {
                derivative[i] = dual.value;
                for column in 0..count {
                    derivative[n * (1 + first + column) + i] = dual.derivatives[column];
                }
            }
        }
    }
}

/// A final state with its derivative with respect to the initial state.
#[derive(Clone, Debug, PartialEq)]
pub struct StateTransition {
    /// State at the end.
    pub state: Vec<f64>,
    /// State transition matrix, column by column: `matrix[j * n + i]` is the derivative of component `i` of
    /// the final state with respect to component `j` of the initial state.
    pub matrix: Vec<f64>,
}

/// Integrates the field and its variational equations over `duration`, which may be negative.
///
/// Over one period of a limit cycle the matrix is the monodromy matrix; its eigenvalues are the Floquet
/// multipliers.
///
/// # Errors
/// As [`Integrator::integrate`].
pub fn state_transition_matrix<F: VectorField>(
    integrator: &Integrator,
    field: F,
    parameters: &[f64],
    initial: &[f64],
    duration: f64,
) -> Result<StateTransition, IntegrationError> {
    let n = field.dimension();
    if initial.len() != n {
        return Err(IntegrationError::WrongLength {
            name: "the initial state",
            found: initial.len(),
            expected: n,
        });
    }
    let mut extended = vec![0.0; n * (n + 1)];
    extended[..n].copy_from_slice(initial);
    for i in 0..n {
        extended[n * (1 + i) + i] = 1.0;
    }
    let system = VariationalEquations::new(field, parameters, n);
    let mut end = integrator.integrate(system, 0.0, &extended, duration)?.state;
    let matrix = end.split_off(n);
    Ok(StateTransition { state: end, matrix })
}
