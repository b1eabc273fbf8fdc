//! A report on any wheel: whether it shimmies, in words first, with pictures and data, and how each statement was checked.
//!
//! Every subject has a file here that computes it and says it; what could not be computed or decided is said as well.
//! [`ReportRequest`] does everything and writes the files when all are ready.

mod blow;
mod cycles;
mod dampers;
mod families;
mod finding;
mod found;
mod illustration;
mod limits;
mod margin;
mod page;
mod request;
mod result;
mod rolling;
mod shimmy;
mod speeds;
mod verdict;

pub use finding::Finding;
pub use request::{ReportAnalysis, ReportRequest};
pub use result::ReportResult;
