//! A curve of special points of a model in two parameters.

mod of_cycles;
mod of_equilibria;
mod request;
mod result;

pub use of_cycles::{CycleLocusPointResult, CycleLocusResult, UnlocatedChangeResult};
pub use of_equilibria::{EquilibriumLocusPointResult, EquilibriumLocusResult};
pub use request::{LocusAnalysis, LocusRequest};
pub use result::LocusResult;
