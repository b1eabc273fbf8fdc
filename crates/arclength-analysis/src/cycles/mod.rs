//! A branch of limit cycles of a model, from a labelled point of an earlier result.

mod cycle;
mod request;
mod result;
mod story;

pub use crate::unlocated::{UnlocatedResult, warnings};
pub use cycle::{AlongCycle, CycleResult};
pub use request::{CyclesAnalysis, CyclesRequest};
pub use result::CyclesResult;
pub use story::tell;
