//! Parameters of a wheel from records of its motion, and what follows from them.

mod consequences;
mod picture;
mod record_file;
mod record_request;
mod request;
mod result;

pub use consequences::{Consequence, Consequences};
pub use record_request::RecordRequest;
pub use request::{FitAnalysis, FitRequest};
pub use result::{Correlations, EstimateResult, FitResult, FittedColumnResult, FittedRecordResult};
