//! The contract of a periodic boundary value problem that collocation can discretise.

use crate::differentiation::Scalar;

/// `y' = g(y, s)` on the unit interval with `y(1) = +-y(0)` componentwise and integral conditions.
///
/// `s` are scalar unknowns such as the period and parameters. There is one condition fewer than there are
/// scalars, so that solutions form curves.
pub trait PeriodicProblem {
    /// Number of components of `y`.
    fn dimension(&self) -> usize;

    /// Number of scalar unknowns.
    fn scalars(&self) -> usize;

    /// Whether a component returns to its negative after one period.
    fn is_antiperiodic(&self, _component: usize) -> bool {
        false
    }

    /// Index of a scalar, not zero, that does nothing but multiply `g`, so that its derivative is known without differentiation.
    fn factor(&self) -> Option<usize> {
        None
    }

    /// Writes `g(state, scalars)`.
    fn field<T: Scalar>(&self, state: &[T], scalars: &[T], derivative: &mut [T]);

    /// Writes the integrands whose integrals over the unit interval vanish (`scalars - 1` of them).
    fn integrands<T: Scalar>(&self, state: &[T], scalars: &[T], reference: Reference<'_>, values: &mut [T]);
}

/// The solution that phase and normalisation conditions refer to, at one point in time.
#[derive(Clone, Copy, Debug)]
pub struct Reference<'a> {
    /// Its state.
    pub state: &'a [f64],
    /// Its derivative with respect to the unit time.
    pub slope: &'a [f64],
}
