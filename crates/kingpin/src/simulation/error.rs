//! What can go wrong in a simulation.

use crate::error::KingpinError;
use arclength::integration::IntegrationError;

/// Why a motion could not be simulated.
#[derive(Debug, thiserror::Error)]
pub enum SimulationError {
    /// A state that the model does not have.
    #[error("unknown state `{given}`; the states are {allowed}")]
    UnknownState {
        /// What was given.
        given: String,
        /// Names of the states, separated by commas.
        allowed: String,
    },
    /// A number that is out of range.
    #[error("{name} = {value} is not allowed: {allowed}")]
    OutOfRange {
        /// What was given.
        name: String,
        /// Its value.
        value: f64,
        /// What is allowed.
        allowed: &'static str,
    },
    /// The wheel itself is at fault, or it has no uniform motion to start from.
    #[error(transparent)]
    Wheel(#[from] KingpinError),
    /// The motion could not be followed to its end.
    #[error("the motion cannot be followed: {0}")]
    Integration(#[from] IntegrationError),
}

impl SimulationError {
    pub(crate) fn out_of_range(name: &str, value: f64, allowed: &'static str) -> Self {
        Self::OutOfRange { name: name.to_owned(), value, allowed }
    }
}
