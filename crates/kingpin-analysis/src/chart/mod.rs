//! Stability of the uniform motion over two parameters.

mod request;
mod result;

pub use request::{ChartAnalysis, ChartRequest};
pub use result::{ChartResult, SampledAxis};
