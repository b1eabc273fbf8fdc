//! A branch of limit cycles of a model, from a labelled point of an earlier result.

mod request;
mod result;

pub use request::{CyclesAnalysis, CyclesRequest};
pub use result::{CycleResult, CyclesResult};
