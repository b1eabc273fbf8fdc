//! Large shimmy along a parameter: periodic motions of a wheel that may slide, each with its phases of rolling and sliding.

mod drawn;
mod drawn_point;
mod picture;
mod point;
mod request;
mod result;
mod search;

pub use drawn::DrawnShimmy;
pub use point::{ShimmyPhase, ShimmyPointResult};
pub use request::{ShimmyAnalysis, ShimmyRequest};
pub use result::{ShimmyBranchResult, ShimmyResult};
pub use search::Attempt;
