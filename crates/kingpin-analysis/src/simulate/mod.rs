//! A time history from the uniform motion with some states perturbed.

mod loads;
mod phase;
mod request;
mod result;
mod rolling_result;
mod sliding_result;
mod tyre_result;

pub use loads::ForcesFromAbove;
pub use phase::Phase;
pub use request::{SimulateAnalysis, SimulateRequest};
pub use result::HistoryResult;
pub use rolling_result::RollingHistory;
pub use sliding_result::SlidingHistory;
pub use tyre_result::TyreHistoryResult;
