//! Limit cycles: collocation, meshes, Floquet multipliers, special points.

mod branch;
mod collocation;
mod condensation;
mod curve;
mod cyclic;
mod defining;
mod extrema;
mod floquet;
mod gauss;
mod limit_cycle;
mod mesh;
mod orbit;
mod problem;
mod special;

pub use branch::{CycleBranch, CyclePoint, CycleStart, Cycles, Role};
pub use curve::Resolution;
pub use orbit::Orbit;
pub use special::{Special, Unlocated};
