//! Folds of equilibria and their quadratic coefficient.

use super::coefficient_error::{self, UncertainEquilibrium};
use super::multilinear::MultilinearForms;
use super::problem::EquilibriumProblem;
use crate::algebraic::{AlgebraicEquations, Differentiator, length};
use crate::error::Error;
use crate::linear::eigenvectors::{left_eigenvector, right_eigenvector};
use num_complex::Complex64;
use serde::{Deserialize, Serialize};

/// A fold, located by Newton's method on its defining system, with its normal form.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct FoldPoint {
    /// All parameters.
    pub parameters: Vec<f64>,
    /// Index of the parameter along which it was found.
    pub active: usize,
    /// Value of that parameter.
    #[serde(rename = "parameter")]
    pub value: f64,
    /// Error estimate of that value.
    pub location_error: f64,
    /// The equilibrium.
    pub state: Vec<f64>,
    /// Null vector `q` of the Jacobian, `<q, q> = 1`, its largest component positive.
    pub null_vector: Vec<f64>,
    /// Coefficient `a = <p, B(q, q)>/2` of the normal form `w' = a w^2` on the centre manifold, with `<p, q> = 1`
    /// (Kuznetsov, equation 5.23); `None` where zero is a double eigenvalue, so that `<p, q> = 0`.
    pub quadratic: Option<f64>,
    /// Error of that coefficient: how much it changes where the equilibrium moves by its own error.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub quadratic_error: Option<f64>,
    /// Speed `<p, f_p>` with which the parameter unfolds the fold; `None` as for `quadratic`.
    pub unfolding: Option<f64>,
}

/// Product of unit null vectors below which zero counts as a double eigenvalue.
const DOUBLE: f64 = 1e-9;

/// Null vectors of the Jacobian at an equilibrium.
pub(crate) struct NullVectors {
    /// `q`, with `<q, q> = 1`.
    pub right: Vec<f64>,
    /// `p`, with `<p, q> = 1` if that is possible.
    pub left: Vec<f64>,
    /// Whether it is: zero is a simple eigenvalue.
    pub is_simple: bool,
}

/// The null vectors at an equilibrium; `scales` are the sizes of the states.
pub(crate) fn null_vectors(
    problem: &EquilibriumProblem<'_>,
    unknown: &[f64],
    scales: &[f64],
) -> Result<NullVectors, Error> {
    let n = problem.dimension;
    let mut matrix = vec![0.0; n * unknown.len()];
    let mut residual = vec![0.0; n];
    Differentiator::default().jacobian(problem, unknown, &mut residual, &mut matrix, n);
    let failed = |_| Error::Eigenvalues { quantity: "null vectors" };
    let real = |vector: Vec<Complex64>| -> Vec<f64> { vector.into_iter().map(|entry| entry.re).collect() };
    let right = real(right_eigenvector(&matrix[..n * n], n, Complex64::ZERO).map_err(failed)?.vector);
    let mut left = real(left_eigenvector(&matrix[..n * n], n, Complex64::ZERO).map_err(failed)?.vector);
    let product: f64 = left.iter().zip(&right).map(|(p, q)| p * q).sum();
    // Neither depends on units. The terms alone say nothing where those that do not cancel are rounding themselves.
    let size: f64 = left.iter().zip(&right).map(|(p, q)| (p * q).abs()).sum();
    let left_size = left.iter().zip(scales).map(|(p, scale)| (p * scale).powi(2)).sum::<f64>().sqrt();
    let sizes = left_size * length(&right, &scales[..n]);
    let is_simple = product.abs() > DOUBLE * size.max(sizes);
    if is_simple {
        left.iter_mut().for_each(|entry| *entry /= product);
    }
    Ok(NullVectors { right, left, is_simple })
}

impl FoldPoint {
    /// The fold at a located singular equilibrium.
    pub(crate) fn at(
        problem: &EquilibriumProblem<'_>,
        unknown: &[f64],
        scales: &[f64],
        location_error: f64,
    ) -> Result<Self, Error> {
        let n = problem.dimension;
        debug_assert_eq!(problem.unknowns(), unknown.len());
        let state = unknown[..n].to_vec();
        let parameters = problem.parameters_at(&unknown[n..]);
        let active = problem.active[0];
        let NullVectors { right: null_vector, left, is_simple } = null_vectors(problem, unknown, scales)?;
        let forms = MultilinearForms { field: problem.field, state: &state, parameters: &parameters };
        let project = |image: Vec<f64>| -> f64 { image.iter().zip(&left).map(|(value, p)| value * p).sum() };
        let mut along = vec![0.0; n + parameters.len()];
        along[n + active] = 1.0;
        let quadratic = is_simple.then(|| 0.5 * project(forms.real(&[&null_vector, &null_vector])));
        let unfolding = is_simple.then(|| project(forms.real(&[&along])));
        let quadratic_error = quadratic.and_then(|value| {
            let equilibrium =
                UncertainEquilibrium::on_branch(problem, (&state, &parameters), scales, location_error);
            let [error] = coefficient_error::errors([value], equilibrium, |state, parameters| {
                let moved = EquilibriumProblem::new(problem.field, parameters, &[]);
                let NullVectors { right, left, is_simple } = null_vectors(&moved, state, scales).ok()?;
                let square =
                    MultilinearForms { field: problem.field, state, parameters }.real(&[&right, &right]);
                let product: f64 = square.iter().zip(&left).map(|(value, p)| value * p).sum();
                // A null vector may have either sign.
                let sign = right.iter().zip(&null_vector).map(|(a, b)| a * b).sum::<f64>().signum();
                is_simple.then_some([0.5 * sign * product])
            })?;
            Some(error)
        });
        Ok(Self {
            quadratic,
            quadratic_error,
            unfolding,
            value: parameters[active],
            parameters,
            active,
            location_error,
            state,
            null_vector,
        })
    }
}
