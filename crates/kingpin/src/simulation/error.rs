//! What can go wrong in a simulation.

use crate::error::KingpinError;
use arclength::control::Interrupted;
use arclength::integration::IntegrationError;

/// Why a motion could not be simulated.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum SimulationError {
    /// A state that the model does not have.
    #[error("unknown state `{given}`; the states are {allowed}")]
    UnknownState {
        /// What was given.
        given: String,
        /// Names of the states, separated by commas.
        allowed: String,
    },
    /// A state that follows from others.
    #[error(
        "`{given}` cannot be chosen: with lateral elasticity only, k_u = inf, u = 0 and V follows from the other states; \
         the states that can are {allowed}"
    )]
    DependentState {
        /// What was given.
        given: String,
        /// Names of the states that can be chosen, separated by commas.
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
    Wheel(KingpinError),
    /// The uniform motion itself takes more than the static friction: a wheel that may slide has none.
    #[error(
        "the uniform motion needs {needed:.4} N of friction, the ground can supply {available:.4} N: a wheel that may slide has no \
         such motion to return to; lower v, raise r, mu_s or the load -F_Az, or let it roll ideally"
    )]
    UniformMotionSlides {
        /// Friction force in N that rolling takes.
        needed: f64,
        /// Largest static friction in N.
        available: f64,
    },
    /// The motion came to where the equations cease to hold: with a tyre the wheel stops rolling forwards, with `k_u = inf` the caster lies
    /// across.
    #[error("the model ends after {time} s: {what}")]
    ModelEnds {
        /// Time in s after which it came there.
        time: f64,
        /// What happens there.
        what: &'static str,
    },
    /// The motion could not be followed to its end.
    #[error("the motion cannot be followed: {0}")]
    Integration(#[source] IntegrationError),
    /// The computation was stopped.
    #[error(transparent)]
    Interrupted(#[from] Interrupted),
}

// What was interrupted is told as that, however deep inside it happened.

impl From<KingpinError> for SimulationError {
    fn from(error: KingpinError) -> Self {
        match error {
            KingpinError::Interrupted(interrupted) => Self::Interrupted(interrupted),
            error => Self::Wheel(error),
        }
    }
}

impl From<IntegrationError> for SimulationError {
    fn from(error: IntegrationError) -> Self {
        match error {
            IntegrationError::Interrupted(interrupted) => Self::Interrupted(interrupted),
            error => Self::Integration(error),
        }
    }
}

impl SimulationError {
    pub(crate) fn out_of_range(name: &str, value: f64, allowed: &'static str) -> Self {
        Self::OutOfRange { name: name.to_owned(), value, allowed }
    }
}
