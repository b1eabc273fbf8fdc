//! A time history of a model.

mod flow;
mod motion;
mod phase;
mod request;
mod result;

pub use request::{IntegrationMethod, SimulateAnalysis, SimulateRequest};
pub use result::{Histories, HistoryResult};
