//! Parameters of a wheel from records of its motion, and what follows from them.

mod consequences;
mod estimate;
mod fitted;
mod picture;
mod record_file;
mod record_request;
mod request;
mod result;

pub use consequences::{Consequence, Consequences};
pub use estimate::EstimateResult;
pub use fitted::{FittedColumnResult, FittedRecordResult};
pub use record_request::RecordRequest;
pub use request::{FitAnalysis, FitRequest};
pub use result::{Correlations, FitResult, NotSeparatedResult};
