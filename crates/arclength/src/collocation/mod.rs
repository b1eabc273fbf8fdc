//! Orthogonal collocation of boundary value problems.
//!
//! A [`BoundaryValueProblem`] is `y' = g(t, y, s)` on the unit interval with boundary conditions `b(y(0), y(1), s) = 0` and
//! conditions on integrals; `s` are scalars such as parameters and the length of the interval. [`BoundaryValueCurve`] lets
//! [`follow`](crate::continuation::follow) trace its solutions along the last scalar on meshes that adapt, and locates folds:
//! the Bratu problem is an example (`examples/bratu.rs`). Periodic orbits are the special case `y(1) = y(0)`; what is
//! peculiar to them is in [`cycle`](crate::cycle).
//!
//! From the ground: `gauss` (points, weights, interpolation), `polynomials`, `problem`, `bidiagonal`, `interior` and `condensation` (the linear
//! algebra), `equations` and `linearization` ([`Collocation`]: residual and Jacobian), `mesh` (error estimate and adaptation), `global_error`, then
//! `curve` and `fold`; `linear_problem` serves normal forms.

pub(crate) mod bidiagonal;
pub(crate) mod condensation;
mod curve;
pub(crate) mod equations;
mod fold;
pub(crate) mod gauss;
pub(crate) mod global_error;
pub(crate) mod interior;
pub(crate) mod linear_problem;
mod linearization;
pub(crate) mod mesh;
pub(crate) mod polynomials;
pub(crate) mod problem;
pub(crate) mod resolution;

pub use curve::{BoundaryValueCurve, BoundaryValuePoint};
pub use equations::Collocation;
pub use gauss::Gauss;
pub use interior::Structure;
pub use polynomials::PiecewisePolynomial;
pub use problem::{BoundaryValueEquations, BoundaryValueProblem, Reference};
pub use resolution::Resolution;
