//! The contract of a boundary value problem that collocation can discretise.

use super::interior::Structure;
use crate::differentiation::Scalar;
use crate::erased::JacobianScalar;

/// `y' = g(t, y, s)` on the unit interval with boundary conditions `b(y(0), y(1), s) = 0` and conditions on integrals of `y`.
///
/// `s` are scalar unknowns: parameters, or the length of the interval that was scaled to one. With `n` components and `E`
/// scalars there are `n + E - 1` conditions, one fewer than a solution that stands alone needs, so that solutions form curves
/// (Ascher, Mattheij and Russell, *Numerical Solution of Boundary Value Problems for Ordinary Differential Equations* (1995),
/// section 1.2). The last scalar is the parameter along which [`BoundaryValueCurve`](super::BoundaryValueCurve) follows them.
///
/// ```
/// use arclength::Scalar;
/// use arclength::collocation::BoundaryValueProblem;
///
/// /// The Bratu problem `u'' + lambda exp(u) = 0`, `u(0) = u(1) = 0`.
/// struct Bratu;
/// impl BoundaryValueProblem for Bratu {
///     fn dimension(&self) -> usize { 2 }
///     fn scalars(&self) -> usize { 1 }
///     fn field<T: Scalar>(&self, _time: f64, state: &[T], scalars: &[T], derivative: &mut [T]) {
///         derivative[0] = state[1];
///         derivative[1] = -(scalars[0] * state[0].exp());
///     }
///     fn boundary_conditions<T: Scalar>(&self, start: &[T], end: &[T], _scalars: &[T], values: &mut [T]) {
///         values[0] = start[0];
///         values[1] = end[0];
///     }
/// }
/// ```
pub trait BoundaryValueProblem {
    /// Number `n` of components of `y`.
    fn dimension(&self) -> usize;

    /// Number `E` of scalar unknowns, one at least.
    fn scalars(&self) -> usize;

    /// Number of conditions on integrals; the other `n + E - 1` are boundary conditions.
    fn integral_conditions(&self) -> usize {
        0
    }

    /// Writes `g(time, state, scalars)` into `derivative` (`n` entries).
    fn field<T: Scalar>(&self, time: f64, state: &[T], scalars: &[T], derivative: &mut [T]);

    /// Writes `b(start, end, scalars)` into `values` (an entry for every boundary condition).
    fn boundary_conditions<T: Scalar>(&self, start: &[T], end: &[T], scalars: &[T], values: &mut [T]);

    /// Writes the integrands whose integrals over the unit interval vanish into `values` (an entry for each).
    fn integrands<T: Scalar>(
        &self,
        _state: &[T],
        _scalars: &[T],
        _reference: Reference<'_>,
        _values: &mut [T],
    ) {
    }
}

/// The solution that phase and normalisation conditions refer to, at one point in time.
#[derive(Clone, Copy, Debug)]
pub struct Reference<'a> {
    /// The time.
    pub time: f64,
    /// Its state.
    pub state: &'a [f64],
    /// Its derivative with respect to the unit time.
    pub slope: &'a [f64],
}

/// What collocation asks of a boundary value problem: as [`BoundaryValueProblem`], which every one of these is, but only for
/// the scalars that Jacobians are computed with.
///
/// Problems made of a field of unknown type, and defining systems made of other problems, serve these only.
pub trait BoundaryValueEquations {
    /// As [`BoundaryValueProblem::dimension`].
    fn dimension(&self) -> usize;

    /// As [`BoundaryValueProblem::scalars`].
    fn scalars(&self) -> usize;

    /// As [`BoundaryValueProblem::integral_conditions`].
    fn integral_conditions(&self) -> usize;

    /// What is known of the derivatives of `g` in the components.
    fn structure(&self) -> Structure {
        Structure::Dense
    }

    /// The rate at which functions [turn](Structure::Turning) into each other.
    fn rotation(&self, _scalars: &[f64]) -> f64 {
        0.0
    }

    /// Whether the derivative of `g` in a scalar is [known](Self::known_derivative) without differentiation. The integrands of a
    /// [dense](Structure::Dense) problem must not depend on such a scalar.
    fn is_known(&self, _scalar: usize) -> bool {
        false
    }

    /// Writes the derivative of `g` in a scalar, given the `value` of `g`.
    fn known_derivative(
        &self,
        _scalar: usize,
        _state: &[f64],
        _scalars: &[f64],
        _value: &[f64],
        _derivative: &mut [f64],
    ) {
    }

    /// Whether the boundary conditions are linear, so that their derivatives never change.
    fn has_linear_boundary_conditions(&self) -> bool {
        false
    }

    /// Whether the problem serves fewer directions at a time only, as where it differentiates a field twice more.
    fn takes_few_directions(&self) -> bool {
        false
    }

    /// Times at which the solution is handed on by [`jump`](Self::jump), in ascending order: inner points of every mesh.
    fn jumps(&self) -> &[f64] {
        &[]
    }

    /// Writes the state behind jump number `index` from that before it.
    fn jump<T: JacobianScalar>(&self, _index: usize, before: &[T], _scalars: &[T], after: &mut [T]) {
        after.copy_from_slice(before);
    }

    /// How much later than the time of jump number `index` what it stands for takes place; `None` where it does not.
    fn delay(&self, _index: usize, _before: &[f64], _scalars: &[f64]) -> Option<f64> {
        Some(0.0)
    }

    /// The states where jump number `index` takes place, before and behind it, from the state before it at its mesh point; `None` where
    /// it does not take place, or takes place at the mesh point.
    fn at_jump(&self, _index: usize, _before: &[f64], _scalars: &[f64]) -> Option<[Vec<f64>; 2]> {
        None
    }

    /// Sets the times of the jumps.
    fn move_jumps(&mut self, _times: &[f64]) {}

    /// As [`BoundaryValueProblem::field`]; at the time of a jump that behind it.
    fn field<T: JacobianScalar>(&self, time: f64, state: &[T], scalars: &[T], derivative: &mut [T]);

    /// As [`BoundaryValueProblem::boundary_conditions`].
    fn boundary_conditions<T: JacobianScalar>(&self, start: &[T], end: &[T], scalars: &[T], values: &mut [T]);

    /// As [`BoundaryValueProblem::integrands`].
    fn integrands<T: JacobianScalar>(
        &self,
        state: &[T],
        scalars: &[T],
        reference: Reference<'_>,
        values: &mut [T],
    );
}

impl<P: BoundaryValueProblem> BoundaryValueEquations for P {
    #[inline(always)]
    fn dimension(&self) -> usize {
        BoundaryValueProblem::dimension(self)
    }
    #[inline(always)]
    fn scalars(&self) -> usize {
        BoundaryValueProblem::scalars(self)
    }
    #[inline(always)]
    fn integral_conditions(&self) -> usize {
        BoundaryValueProblem::integral_conditions(self)
    }
    #[inline(always)]
    fn field<T: JacobianScalar>(&self, time: f64, state: &[T], scalars: &[T], derivative: &mut [T]) {
        BoundaryValueProblem::field(self, time, state, scalars, derivative);
    }
    #[inline(always)]
    fn boundary_conditions<T: JacobianScalar>(
        &self,
        start: &[T],
        end: &[T],
        scalars: &[T],
        values: &mut [T],
    ) {
        BoundaryValueProblem::boundary_conditions(self, start, end, scalars, values);
    }
    #[inline(always)]
    fn integrands<T: JacobianScalar>(
        &self,
        state: &[T],
        scalars: &[T],
        reference: Reference<'_>,
        values: &mut [T],
    ) {
        BoundaryValueProblem::integrands(self, state, scalars, reference, values);
    }
}
