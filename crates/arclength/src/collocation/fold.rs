//! Folds of curves of solutions of a boundary value problem, located by their defining system.
//!
//! With the null function `v` and the changes `sigma` of the scalars other than the parameter,
//!
//! ```text
//! y' = g(t, y, s),    b(y(0), y(1), s) = 0,                     integral conditions,
//! v' = g_y v + g_s sigma,    b_0 v(0) + b_1 v(1) + b_s sigma = 0,   their linearisation,
//! integral of |v|^2 + |sigma|^2 = 1
//! ```
//!
//! is a boundary value problem of its own that is regular at a fold (Moore and Spence, *SIAM J. Numer. Anal.* 17 (1980), equation
//! 2.1; Seydel, *Numer. Math.* 33 (1979), for boundary value problems).

use super::equations::Collocation;
use super::problem::{BoundaryValueEquations, BoundaryValueProblem, Reference};
use crate::continuation::{Adaptation, Curve, Discretised, Settings, correct};
use crate::differentiation::{Dual, Scalar};
use crate::erased::JacobianScalar;
use crate::error::Error;
use std::convert::Infallible;

/// The defining system. Its components are `(y, v)`, its scalars those of the problem, `sigma` and one without effect: the
/// system stands alone, and collocation leaves one condition to a border.
struct FoldProblem<'a, P> {
    problem: &'a P,
    /// Sizes of the components and of the scalars.
    sizes: &'a [f64],
}

impl<P: BoundaryValueProblem> FoldProblem<'_, P> {
    /// Values that change along `changes`.
    fn lift<T: Scalar>(values: &[T], changes: &[T]) -> Vec<Dual<T, 1>> {
        let changes = changes.iter().copied().chain(std::iter::repeat(T::zero()));
        values.iter().zip(changes).map(|(&value, change)| Dual { value, derivatives: [change] }).collect()
    }

    fn lift_state<T: Scalar>(&self, state: &[T]) -> Vec<Dual<T, 1>> {
        let (values, changes) = state.split_at(self.problem.dimension());
        Self::lift(values, changes)
    }

    fn lift_scalars<T: Scalar>(&self, scalars: &[T]) -> Vec<Dual<T, 1>> {
        let (values, rest) = scalars.split_at(self.problem.scalars());
        Self::lift(values, &rest[..values.len() - 1])
    }

    /// Writes values and, behind them, their derivatives.
    fn write<T: Scalar>(duals: &[Dual<T, 1>], target: &mut [T]) {
        let (values, derivatives) = target.split_at_mut(duals.len());
        for ((dual, value), derivative) in duals.iter().zip(values).zip(derivatives) {
            *value = dual.value;
            *derivative = dual.derivatives[0];
        }
    }

    fn base_boundary_conditions(&self) -> usize {
        self.problem.dimension() + self.problem.scalars() - 1 - self.problem.integral_conditions()
    }
}

impl<P: BoundaryValueProblem> BoundaryValueEquations for FoldProblem<'_, P> {
    fn dimension(&self) -> usize {
        2 * self.problem.dimension()
    }

    fn scalars(&self) -> usize {
        2 * self.problem.scalars()
    }

    fn integral_conditions(&self) -> usize {
        2 * self.problem.integral_conditions() + 1
    }

    fn field<T: JacobianScalar>(&self, time: f64, state: &[T], scalars: &[T], derivative: &mut [T]) {
        let mut duals = vec![Dual::zero(); self.problem.dimension()];
        self.problem.field(time, &self.lift_state(state), &self.lift_scalars(scalars), &mut duals);
        Self::write(&duals, derivative);
    }

    fn boundary_conditions<T: JacobianScalar>(
        &self,
        start: &[T],
        end: &[T],
        scalars: &[T],
        values: &mut [T],
    ) {
        let mut duals = vec![Dual::zero(); self.base_boundary_conditions()];
        let (start, end) = (self.lift_state(start), self.lift_state(end));
        self.problem.boundary_conditions(&start, &end, &self.lift_scalars(scalars), &mut duals);
        Self::write(&duals, values);
    }

    fn integrands<T: JacobianScalar>(
        &self,
        state: &[T],
        scalars: &[T],
        reference: Reference<'_>,
        values: &mut [T],
    ) {
        let (n, e) = (self.problem.dimension(), self.problem.scalars());
        let reference = Reference { state: &reference.state[..n], slope: &reference.slope[..n], ..reference };
        let mut duals = vec![Dual::zero(); self.problem.integral_conditions()];
        self.problem.integrands(&self.lift_state(state), &self.lift_scalars(scalars), reference, &mut duals);
        Self::write(&duals, values);
        let changes = state[n..].iter().chain(&scalars[e..2 * e - 1]);
        let squares = changes.zip(self.sizes).map(|(&change, size)| (change / *size) * (change / *size));
        values[2 * duals.len()] = squares.sum::<T>() - 1.0;
    }
}

/// A boundary value problem that stands alone, as far as Newton's method needs it.
struct Alone<P> {
    collocation: Collocation<P>,
    /// Sizes of the components and of the scalars.
    sizes: Vec<f64>,
}

impl<P: BoundaryValueEquations> Discretised for Alone<P> {
    type System = Collocation<P>;

    fn system(&self) -> &Self::System {
        &self.collocation
    }

    fn system_mut(&mut self) -> &mut Self::System {
        &mut self.collocation
    }
}

impl<P: BoundaryValueEquations> Curve for Alone<P> {
    type Point = ();
    type Kind = Infallible;
    type Reason = Infallible;

    fn apply_metric(&self, vector: &[f64], image: &mut [f64]) {
        self.collocation.apply_metric(&self.sizes, vector, image);
    }
    fn adapt(
        &mut self,
        _unknown: &mut Vec<f64>,
        _vectors: &mut [&mut Vec<f64>],
    ) -> Result<Adaptation, Error> {
        Ok(Adaptation::Unchanged)
    }
    fn may_stagnate(&self) -> bool {
        false
    }
    fn inspect(&mut self, _unknown: &[f64], _tangent: &[f64], _orientation: f64) -> Result<(), Error> {
        Ok(())
    }
    fn signature(&self, _unknown: &[f64]) -> Vec<(f64, f64)> {
        Vec::new()
    }
}

/// The unknowns at the fold near a solution, from the tangent there; `sizes` are those of the components and of the scalars.
///
/// # Errors
/// [`Error::NotFound`] when Newton's method does not converge.
pub(super) fn fold_near<P: BoundaryValueProblem>(
    collocation: &Collocation<P>,
    unknown: &[f64],
    tangent: &[f64],
    sizes: &[f64],
    settings: &Settings,
) -> Result<Vec<f64>, Error> {
    let problem = &collocation.problem;
    let (n, e) = (problem.dimension(), problem.scalars());
    let end = unknown.len() - e;
    let mesh = collocation.mesh().to_vec();
    let nodes = unknown[..end].chunks_exact(n).zip(tangent[..end].chunks_exact(n));
    // Next to a fold the tangent is nearly the null vector, of unit length in the metric.
    let mut start: Vec<f64> = nodes.flat_map(|(state, change)| state.iter().chain(change).copied()).collect();
    start.extend_from_slice(&unknown[end..]);
    start.extend_from_slice(&tangent[end..unknown.len() - 1]);
    start.push(0.0);
    let (components, scalars) = sizes.split_at(n);
    let changes = &scalars[..e - 1];
    // The change of a component or scalar counts as that itself.
    let changed: Vec<f64> = components.iter().chain(changes).copied().collect();
    let fold = FoldProblem { problem, sizes: &changed };
    let mut alone = Alone {
        collocation: Collocation::new(fold, mesh, collocation.gauss().degree()),
        sizes: [components, components, scalars, changes, &[1.0]].concat(),
    };
    alone.collocation.set_reference(&start);
    let mut border = vec![0.0; start.len()];
    border[start.len() - 1] = 1.0;
    correct(&mut alone, &mut start, &border, settings)
        .map_err(|cause| Error::NotFound { sought: "fold", cause })?;
    let mut fold: Vec<f64> =
        start[..2 * end].chunks_exact(2 * n).flat_map(|state| state[..n].iter().copied()).collect();
    fold.extend_from_slice(&start[2 * end..2 * end + e]);
    Ok(fold)
}
