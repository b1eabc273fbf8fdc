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
pub use collocation::Collocation;
pub use curve::{CycleCurve, CycleInspection, Resolution};
pub use defining::{Defining, Kind};
pub use floquet::Floquet;
pub use gauss::Gauss;
pub use limit_cycle::LimitCycle;
pub use orbit::Orbit;
pub use problem::{PeriodicProblem, Reference};
pub use special::{Special, Unlocated};
