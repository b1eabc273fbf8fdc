//! The smallest disturbance of the uniform motion that does not return.

mod request;
mod result;

pub use request::{SafeKickAnalysis, SafeKickRequest};
pub use result::{DisturbedMotionResult, SafeKickResult};
