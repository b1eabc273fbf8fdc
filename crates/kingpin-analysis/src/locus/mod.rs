//! A curve of Hopf points or of special cycles of a wheel in two parameters.

mod of_cycles;
mod of_motions;
mod request;
mod result;

pub use of_cycles::CycleLocusResult;
pub use of_motions::MotionLocusResult;
pub use request::{LocusAnalysis, LocusRequest};
pub use result::LocusResult;
