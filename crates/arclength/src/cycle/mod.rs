//! Limit cycles: collocation, meshes, Floquet multipliers, special points.

mod branch;
pub(crate) mod curve;
pub(crate) mod defining;
pub(crate) mod eigenfunctions;
pub(crate) mod extrema;
pub(crate) mod floquet;
pub(crate) mod limit_cycle;
pub(crate) mod locating;
pub(crate) mod normal_form;
mod orbit;
pub(crate) mod sizes;
mod special;
mod switching;

pub use branch::{CycleBranch, CyclePoint, CycleStart, Cycles, Role};
pub use curve::Resolution;
pub use orbit::Orbit;
pub use special::{Special, Unlocated};
pub use switching::{BranchDirection, Branching};
