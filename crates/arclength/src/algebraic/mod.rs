//! Systems of algebraic equations written once over any scalar: derivatives, Newton's method, scaling.
//!
//! Equilibria, the defining systems of their bifurcations and the curves of such points in two
//! parameters are all [`AlgebraicProblem`]s. Rows and columns are scaled before every factorisation,
//! so that nothing depends on the units of variables and equations.

mod jacobian;
mod newton;
mod scaled_lu;
pub(crate) mod scales;
mod system;

pub(crate) use jacobian::Differentiator;
pub(crate) use newton::{Solved, solve_square};
pub(crate) use scaled_lu::ScaledLu;
pub(crate) use system::{DenseSystem, length, position};

use crate::differentiation::Scalar;

/// Equations `F(z) = 0`.
pub trait AlgebraicProblem {
    /// Whether Jacobians of more than four unknowns are computed eight columns at a time instead of four: faster, but one
    /// more scalar to compile the problem for.
    const WIDE: bool = false;

    /// Number of unknowns.
    fn unknowns(&self) -> usize;

    /// Number of equations.
    fn equations(&self) -> usize;

    /// Writes `F(unknown)`; `scratch` is memory of any length that the problem may use.
    fn evaluate<T: Scalar>(&self, unknown: &[T], residual: &mut [T], scratch: &mut Vec<T>);
}
