//! A time history of a model.

mod accuracy;
mod condition;
mod events;
mod flow;
mod motion;
mod phase;
mod request;
mod result;
mod samples;

pub use request::{IntegrationMethod, SimulateAnalysis, SimulateRequest};
pub use result::{Histories, HistoryResult};
