//! Limit cycles: collocation, meshes, Floquet multipliers, special points.

mod branch;
pub(crate) mod collocation;
mod condensation;
pub(crate) mod curve;
mod cyclic;
pub(crate) mod defining;
pub(crate) mod eigenfunctions;
mod end;
mod ending;
pub(crate) mod extrema;
pub(crate) mod floquet;
mod gauss;
pub(crate) mod limit_cycle;
mod linear_problem;
pub(crate) mod locating;
pub(crate) mod mesh;
pub(crate) mod normal_form;
mod orbit;
pub(crate) mod problem;
pub(crate) mod sizes;
mod special;
mod start;
mod switching;

pub use branch::{CycleBranch, CyclePoint};
pub use curve::Resolution;
pub use end::CycleEnd;
pub use orbit::Orbit;
pub use start::{CycleProblem, CycleStart, Cycles};
pub use switching::{BranchDirection, Branching};
