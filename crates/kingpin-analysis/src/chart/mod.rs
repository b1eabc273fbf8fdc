//! Stability of the uniform motion over two parameters.

mod overlay;
mod request;
mod result;

pub use overlay::Overlay;
pub(crate) use overlay::{COLORS, LimitPoint};
pub use request::{ChartAnalysis, ChartRequest};
pub use result::{ChartResult, SampledAxis};
