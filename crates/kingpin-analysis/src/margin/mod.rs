//! The smallest disturbance that does not return along a parameter, beside the unstable limit cycle.

mod by_chunks;
mod found;
mod request;
mod result;
mod unstable_cycles;

pub use found::Found;
pub use request::{MarginAnalysis, MarginRequest};
pub use result::{Indicator, MarginPoint, MarginResult};
