//! A time history of a model.

mod motion;
mod request;
mod result;

pub use request::{SimulateAnalysis, SimulateRequest};
pub use result::{Histories, HistoryResult};
