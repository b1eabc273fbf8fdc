//! Limit cycles: collocation, meshes, Floquet multipliers, special points.

mod collocation;
mod cyclic;
mod gauss;
mod problem;

pub use collocation::Collocation;
pub use gauss::Gauss;
pub use problem::{PeriodicProblem, Reference};
