//! Hopf points of the uniform motion along a parameter: where shimmy is born.

mod request;
mod result;
pub(crate) mod search;

pub use request::{HopfAnalysis, HopfRequest};
pub use result::{BracketedResult, HopfPointResult, HopfResult, MotionResult};
