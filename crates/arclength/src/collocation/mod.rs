//! Orthogonal collocation of boundary value problems.

pub(crate) mod bidiagonal;
pub(crate) mod condensation;
pub(crate) mod equations;
pub(crate) mod gauss;
pub(crate) mod linear_problem;
pub(crate) mod mesh;
pub(crate) mod problem;
pub(crate) mod resolution;
