//! A curve of special points of a model in two parameters.

mod cycle_curve;
mod equilibrium_curve;
mod of_cycles;
mod of_equilibria;
mod quantities;
mod request;
mod result;

pub use crate::unlocated::UnlocatedChangeResult;
pub use cycle_curve::{CycleCurve, CycleCurvePoint};
pub use equilibrium_curve::{EquilibriumCurve, EquilibriumCurvePoint};
pub use of_cycles::CycleLocusResult;
pub use of_equilibria::EquilibriumLocusResult;
pub use quantities::Quantities;
pub use request::{LocusAnalysis, LocusRequest};
pub use result::LocusResult;
