//! What can go wrong in an integration.

use crate::control::Interrupted;
use thiserror::Error;

/// Why an integration stopped early or could not start.
#[derive(Clone, Debug, Error, PartialEq)]
#[non_exhaustive]
pub enum IntegrationError {
    /// The step that the tolerances ask for is below the resolution of time.
    #[error(
        "the step size {step:e} at t = {time} is below the resolution of time: the solution is singular there or the tolerances are too small"
    )]
    StepTooSmall {
        /// Time that was reached.
        time: f64,
        /// Step that was refused.
        step: f64,
    },
    /// The right-hand side is not finite however small the step is.
    #[error("the right-hand side is not finite at t = {time}")]
    NotFinite {
        /// Time that was reached.
        time: f64,
    },
    /// The limit on the number of steps was reached.
    #[error(
        "{steps} steps were taken and only t = {time} was reached: raise the limit or the tolerances, or use an implicit method if the problem is stiff"
    )]
    TooManySteps {
        /// Time that was reached.
        time: f64,
        /// Number of steps that were taken.
        steps: usize,
    },
    /// The right-hand side switches again and again without time passing.
    #[error(
        "at t = {time} the right-hand side switches again and again while no time passes: the motion is held at several switches at once, passes them within the resolution of time, or comes to an end there"
    )]
    SwitchesWithoutEnd {
        /// Time that was reached.
        time: f64,
    },
    /// Whoever waits for the solution asked for the end.
    #[error(transparent)]
    Interrupted(#[from] Interrupted),
    /// A tolerance or limit is out of range.
    #[error("{name} = {value} is not allowed: {allowed}")]
    BadSetting {
        /// Name of the setting.
        name: &'static str,
        /// Its value.
        value: f64,
        /// What is allowed.
        allowed: &'static str,
    },
    /// A vector has the wrong length.
    #[error("{name} has {found} components, but the system needs {expected}")]
    WrongLength {
        /// Which vector.
        name: &'static str,
        /// Its length.
        found: usize,
        /// The length that is needed.
        expected: usize,
    },
    /// The sampling times do not run from the start towards the end.
    #[error("sampling time {time} is outside the interval of integration or out of order")]
    BadSamplingTime {
        /// The first time that is wrong.
        time: f64,
    },
}
