//! Limit cycles: collocation, meshes, Floquet multipliers, special points.

mod along_orbit;
mod borders;
mod branch;
mod confirmation;
mod contract;
pub(crate) mod curve;
pub(crate) mod defining;
pub(crate) mod eigenfunctions;
mod end;
mod ending;
mod expansion;
mod exponentials;
pub(crate) mod extrema;
pub(crate) mod floquet;
pub(crate) mod gate;
mod grazing;
mod hopf_start;
pub(crate) mod limit_cycle;
pub(crate) mod locating;
pub(crate) mod normal_form;
mod orbit;
mod passages;
pub(crate) mod segments;
pub(crate) mod sizes;
pub(crate) mod slow_passage;
mod special;
mod start;
mod switching;
mod variational;

pub use crate::collocation::resolution::Resolution;
pub use branch::{CycleBranch, CyclePoint};
pub use end::{CycleEnd, Grazed};
pub use orbit::Orbit;
pub use slow_passage::SlowPassage;
pub use start::{CycleProblem, CycleStart, Cycles};
pub use switching::{BranchDirection, Branching};
