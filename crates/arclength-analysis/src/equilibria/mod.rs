//! A branch of equilibria of a model, from its initial state or from a labelled point.

mod request;
mod result;

pub use request::{EquilibriaAnalysis, EquilibriaRequest};
pub use result::{EquilibriaResult, EquilibriumResult};
