//! What can go wrong in the search for periodic motions.

use crate::error::KingpinError;
use crate::simulation::SimulationError;
use arclength::control::Interrupted;
use arclength::integration::IntegrationError;

/// Why a periodic motion was not found or could not be followed.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum ShimmyError {
    /// The motion dies out: the wheel rolls or slides steadily in the end.
    #[error(
        "the motion dies out: in the last {window} s the caster angle varies by {range:.1e} rad only; start from a larger disturbance"
    )]
    DiesOut {
        /// Time in s that was looked at.
        window: f64,
        /// Range of the caster angle in it in rad.
        range: f64,
    },
    /// The motion does not repeat itself.
    #[error(
        "the motion does not repeat itself within {longest_period} s (it comes back to {nearest:.1e} of its size at best): \
         let it settle for longer than {settling_time} s, or allow a longer period; it may be irregular"
    )]
    NotPeriodic {
        /// Longest period in s that was allowed.
        longest_period: f64,
        /// Time in s for which it was left to settle.
        settling_time: f64,
        /// Smallest distance of a return, relative to the size of the motion.
        nearest: f64,
    },
    /// The motion passes near an unstable periodic one, on which it will not stay.
    #[error(
        "the motion has not settled after {settling_time} s: it passes an unstable periodic motion of period {period} s,          on which it will not stay; let it settle for longer; it may be irregular"
    )]
    NotSettled {
        /// Time in s for which it was left to settle.
        settling_time: f64,
        /// Period of the unstable motion in s.
        period: f64,
    },
    /// Newton's method did not converge from the motion that was found.
    #[error(
        "Newton's method does not converge to a periodic motion: {cause}; let the motion settle for longer"
    )]
    NotConverged {
        /// What happened.
        cause: Refusal,
    },
    /// The cycle on which a damped motion settled is lost as the damper is taken away.
    #[error(
        "the motion settles with a longitudinal damper, c_u = {c_u} N s/m, and its cycle is lost as that is taken away"
    )]
    LostWithoutDamper {
        /// The damper in N s/m.
        c_u: f64,
    },
    /// A motion could not be simulated.
    #[error(transparent)]
    Simulation(SimulationError),
    /// The computation was stopped.
    #[error(transparent)]
    Interrupted(#[from] Interrupted),
    /// A branch could not be followed.
    #[error(transparent)]
    Continuation(#[from] arclength::Error),
}

impl From<SimulationError> for ShimmyError {
    fn from(error: SimulationError) -> Self {
        match error {
            SimulationError::Interrupted(interrupted) => Self::Interrupted(interrupted),
            error => Self::Simulation(error),
        }
    }
}

impl From<KingpinError> for ShimmyError {
    fn from(error: KingpinError) -> Self {
        SimulationError::from(error).into()
    }
}

impl From<Refusal> for ShimmyError {
    fn from(cause: Refusal) -> Self {
        match cause {
            Refusal::Interrupted(interrupted) => Self::Interrupted(interrupted),
            cause => Self::NotConverged { cause },
        }
    }
}

/// Why a return map is not defined at a state.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum Refusal {
    /// The phases are not those of the motion sought.
    #[error("{0}")]
    Grazing(Grazing),
    /// The motion cannot be followed.
    #[error("{0}")]
    Integration(String),
    /// The computation was stopped.
    #[error(transparent)]
    Interrupted(#[from] Interrupted),
    /// The linear equations of Newton's method are singular.
    #[error("the linear equations are singular")]
    Singular,
    /// Period and extrema of the motion are known too badly.
    #[error("the motion is known to a part of {error:.1e} only")]
    Inexact {
        /// Error relative to the period and the range of the angle.
        error: f64,
    },
    /// The updates do not become small.
    #[error("the last update is {update:.1e} of the size of the motion")]
    Diverged {
        /// Length of the last update.
        update: f64,
    },
}

impl From<SimulationError> for Refusal {
    fn from(error: SimulationError) -> Self {
        match error {
            SimulationError::Interrupted(interrupted) => Self::Interrupted(interrupted),
            SimulationError::Integration(error) => error.into(),
            error => Self::Integration(error.to_string()),
        }
    }
}

impl From<IntegrationError> for Refusal {
    fn from(error: IntegrationError) -> Self {
        match error {
            IntegrationError::Interrupted(interrupted) => Self::Interrupted(interrupted),
            // Steps shrink to nothing only where slip does: there the direction of the friction is undefined, and nothing else is.
            IntegrationError::StepTooSmall { .. } => Self::Grazing(Grazing::SlipVanishes),
            error => Self::Integration(error.to_string()),
        }
    }
}

/// How the sequence of phases changes.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, thiserror::Error)]
pub enum Grazing {
    /// The friction force of a rolling phase touches the static limit: a sliding phase appears.
    #[error(
        "the friction force of a rolling phase touches the static limit, where another sliding phase begins"
    )]
    StaticLimitReached,
    /// The friction force of a rolling phase no longer reaches the static limit: a sliding phase disappears.
    #[error(
        "the friction force of a rolling phase no longer reaches the static limit, so that a sliding phase is lost"
    )]
    StaticLimitMissed,
    /// Slip that did not vanish passes through zero.
    #[error("the slip of a sliding phase passes through zero, where another phase begins")]
    SlipVanishes,
    /// Slip that used to vanish misses zero: a rolling phase is lost.
    #[error("the slip of a sliding phase misses zero, so that the phase after it is lost")]
    SlipMissesZero,
    /// Where slip vanishes the static friction no longer holds the wheel.
    #[error(
        "where slip vanishes the static friction no longer holds the wheel: it slides on instead of rolling"
    )]
    HoldsNoLonger,
    /// Where slip vanishes the static friction now holds the wheel.
    #[error("where slip vanishes the static friction holds the wheel: it rolls instead of sliding on")]
    HoldsAgain,
    /// A rest about the king pin begins between two swings, or is lost.
    #[error("between two swings the caster begins or ceases to stick about its king pin")]
    KingPin,
}
