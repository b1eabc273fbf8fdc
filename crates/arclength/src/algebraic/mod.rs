//! Systems of algebraic equations written once over any scalar: derivatives, Newton's method, scaling, curves of solutions.
//!
//! An [`AlgebraicProblem`] is any smooth `F(z) = 0`. [`solve_square`] solves it where there are as many equations as unknowns;
//! with one unknown more, the last of which is a parameter, [`AlgebraicCurve`] lets
//! [`follow`](crate::continuation::follow) trace its solutions, locates folds and, by test functions and defining
//! systems of a user's own, special points of other kinds. Fixed points of a map are an example (`examples/map.rs`).
//!
//! Equilibria, the defining systems of their bifurcations and the curves of such points in two parameters are all
//! [`AlgebraicEquations`] on a [`DenseSystem`]. Rows and columns are scaled before every factorisation, so that nothing
//! depends on the units of variables and equations.

mod curve;
mod fold;
mod jacobian;
mod newton;
mod problem;
mod scaled_lu;
pub(crate) mod scales;
mod system;

pub use curve::{AlgebraicCurve, AlgebraicPoint};
pub use jacobian::Differentiator;
pub use newton::{Solved, solve_square};
pub use problem::{AlgebraicEquations, AlgebraicProblem};
pub(crate) use scaled_lu::ScaledLu;
pub use system::DenseSystem;
pub(crate) use system::{grown, length, position};
