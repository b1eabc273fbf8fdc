//! Under what an analysis runs: the engine's own control.

pub use arclength::control::{Control, Progress};
