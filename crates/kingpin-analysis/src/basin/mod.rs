//! Where motions end, depending on where they start.

mod request;
mod result;

pub use request::{BasinAnalysis, BasinRequest};
pub use result::{BasinResult, FractionResult, StateValues};
