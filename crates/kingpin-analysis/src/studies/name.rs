//! The studies by name.

use super::study::Study;
use super::{basin, damping, isola, sliding, step_steer};
use crate::error::Error;
use arclength_analysis::Control;
use kingpin::Wheel;
use serde::{Deserialize, Serialize};

/// The studies.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum StudyName {
    /// Damping and the boundary of stability.
    Damping,
    /// Branches of cycles that are detached from the uniform motion.
    Isola,
    /// Large shimmy with sliding phases.
    Sliding,
    /// Where kicked wheels end.
    Basin,
    /// From straight towing to a curve at once.
    StepSteer,
}

impl StudyName {
    /// All studies in the order of their figures.
    pub const ALL: [Self; 5] = [Self::Isola, Self::Sliding, Self::Damping, Self::Basin, Self::StepSteer];

    /// The name as it is given to the command.
    pub const fn as_str(self) -> &'static str {
        match self {
            Self::Damping => "damping",
            Self::Isola => "isola",
            Self::Sliding => "sliding",
            Self::Basin => "basin",
            Self::StepSteer => "step-steer",
        }
    }

    /// What it is about.
    pub const fn subject(self) -> &'static str {
        match self {
            Self::Damping => "the stability boundary with dampers",
            Self::Isola => "large motions detached from straight running",
            Self::Sliding => "large stable shimmy with sliding phases",
            Self::Basin => "where kicked wheels end",
            Self::StepSteer => "driving straight, then suddenly round a curve",
        }
    }

    /// Whether it can be about another wheel than the paper's.
    pub const fn takes_a_wheel(self) -> bool {
        matches!(self, Self::Isola | Self::Sliding)
    }

    /// Computes and draws the study, of a wheel where it takes one. The control is told the part that is done.
    ///
    /// # Errors
    /// What could not be computed; [`Error::Stopped`].
    pub(super) fn compute(self, wheel: Option<&Wheel>, control: &Control<'_>) -> Result<Study, Error> {
        match self {
            Self::Isola => isola::study(wheel, control),
            Self::Sliding => sliding::study(wheel, control),
            Self::Damping => damping::study(control),
            Self::Basin => basin::study(control),
            Self::StepSteer => step_steer::study(control),
        }
    }
}
