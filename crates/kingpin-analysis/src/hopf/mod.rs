//! Hopf points of the uniform motion along a parameter: where shimmy is born.

pub(crate) mod course;
mod motion;
mod request;
mod result;
pub(crate) mod search;

pub use motion::{BracketedResult, MotionResult};
pub use request::{HopfAnalysis, HopfRequest};
pub use result::{HopfPointResult, HopfResult};
