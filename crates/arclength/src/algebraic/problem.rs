//! The contract of a system of algebraic equations.

use crate::differentiation::{Dual, Scalar};
use crate::erased::NarrowScalar;

/// Equations `F(z) = 0`, written once over any scalar so that all derivatives come from automatic differentiation.
pub trait AlgebraicProblem {
    /// Number of unknowns.
    fn unknowns(&self) -> usize;

    /// Number of equations: that of the unknowns where a solution stands alone, one fewer where solutions form curves.
    fn equations(&self) -> usize;

    /// Writes `F(unknown)` into `residual` (an entry for every equation).
    ///
    /// Outside its domain `F` writes numbers that are not finite; it does not panic.
    fn evaluate<T: Scalar>(&self, unknown: &[T], residual: &mut [T]);
}

/// What Newton's method and continuation ask of equations: as [`AlgebraicProblem`], which every one of these is, but only for the
/// scalars that Jacobians are computed with.
///
/// Equations made of a field of unknown type, and defining systems made of other equations, serve these only.
pub trait AlgebraicEquations {
    /// As [`AlgebraicProblem::unknowns`].
    fn unknowns(&self) -> usize;

    /// As [`AlgebraicProblem::equations`].
    fn equations(&self) -> usize;

    /// As [`AlgebraicProblem::evaluate`].
    fn evaluate<T: NarrowScalar>(&self, unknown: &[T], residual: &mut [T]);

    /// As [`evaluate`](Self::evaluate) in eight directions at a time, which is faster where there are many unknowns. Returns
    /// whether the equations serve this scalar, too; if not, nothing is written.
    fn evaluate_wide(&self, _unknown: &[Dual<f64, 8>], _residual: &mut [Dual<f64, 8>]) -> bool {
        false
    }
}

impl<P: AlgebraicProblem> AlgebraicEquations for P {
    fn unknowns(&self) -> usize {
        AlgebraicProblem::unknowns(self)
    }
    fn equations(&self) -> usize {
        AlgebraicProblem::equations(self)
    }
    fn evaluate<T: NarrowScalar>(&self, unknown: &[T], residual: &mut [T]) {
        AlgebraicProblem::evaluate(self, unknown, residual);
    }
    fn evaluate_wide(&self, unknown: &[Dual<f64, 8>], residual: &mut [Dual<f64, 8>]) -> bool {
        AlgebraicProblem::evaluate(self, unknown, residual);
        true
    }
}
