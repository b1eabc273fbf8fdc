//! What can go wrong in an identification.

use crate::error::KingpinError;
use crate::parameters::Key;
use crate::simulation::SimulationError;
use arclength::control::Interrupted;

/// Why parameters could not be estimated.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum IdentificationError {
    /// A record that makes no sense.
    #[error("record {}: {problem}", record + 1)]
    Record {
        /// Its index, from 0.
        record: usize,
        /// What is wrong.
        problem: String,
    },
    /// There is nothing to learn from.
    #[error("there is no record")]
    NoRecord,
    /// A parameter that cannot be estimated.
    #[error("{key} cannot be estimated: {problem}")]
    NotEstimated {
        /// Which.
        key: Key,
        /// Why not.
        problem: &'static str,
    },
    /// A state that the wheel does not have.
    #[error("`{given}` is no state that can be given here; allowed: {allowed}")]
    UnknownState {
        /// What was given.
        given: String,
        /// What is allowed.
        allowed: String,
    },
    /// Fewer measured values than unknowns.
    #[error(
        "{values} measured values for {unknowns} unknowns ({names}); estimate fewer parameters, or add samples"
    )]
    TooFewValues {
        /// Number of values.
        values: usize,
        /// Number of unknowns.
        unknowns: usize,
        /// What is unknown.
        names: String,
    },
    /// A standard deviation that makes no sense.
    #[error("{state}: the standard deviation {value} is not allowed: positive and finite")]
    Deviation {
        /// Of which state.
        state: String,
        /// What was given.
        value: f64,
    },
    /// The wheel is at fault.
    #[error(transparent)]
    Wheel(KingpinError),
    /// No motion could be followed with the values to start from.
    #[error("no motion can be followed with the values to start from: {0}; set other ones")]
    NoStart(#[source] SimulationError),
    /// The smallest sum of squares could not be made out.
    #[error(
        "the sum of squares has many minima: {returns} times a smaller one lay beside the smallest; estimate fewer parameters, or add \
         samples"
    )]
    ManyMinima {
        /// How often.
        returns: usize,
    },
    /// The computation was stopped.
    #[error(transparent)]
    Interrupted(#[from] Interrupted),
}

// What was interrupted is told as that, however deep inside it happened.

impl From<KingpinError> for IdentificationError {
    fn from(error: KingpinError) -> Self {
        match error {
            KingpinError::Interrupted(interrupted) => Self::Interrupted(interrupted),
            error => Self::Wheel(error),
        }
    }
}

impl From<SimulationError> for IdentificationError {
    fn from(error: SimulationError) -> Self {
        match error {
            SimulationError::Interrupted(interrupted) => Self::Interrupted(interrupted),
            SimulationError::Wheel(error) => Self::Wheel(error),
            error => Self::NoStart(error),
        }
    }
}
