//! Why an analysis of a wheel gives no result.

use crate::paper::PaperError;
use arclength::integration::IntegrationError;
use arclength_analysis::{AnalysisError, InvalidField};
use kingpin::KingpinError;
use kingpin::simulation::SimulationError;
use kingpin_figure::FigureError;
use kingpin_report::ReportError;
use std::path::PathBuf;

/// Why an analysis of a wheel gives no result.
#[derive(Debug, thiserror::Error)]
pub enum Error {
    /// A field of the request makes no sense.
    #[error(transparent)]
    Invalid(#[from] InvalidField),
    /// A labelled point of an earlier result that cannot be used.
    #[error(transparent)]
    Start(#[from] arclength_analysis::Error),
    /// The wheel is at fault, or has no such motion.
    #[error(transparent)]
    Wheel(#[from] KingpinError),
    /// A parameter given with `--set`.
    #[error("set {given}: {source}")]
    Set {
        /// What was given.
        given: String,
        /// What is wrong with it.
        source: KingpinError,
    },
    /// A simulation could not be run.
    #[error(transparent)]
    Simulation(#[from] SimulationError),
    /// A periodic motion with sliding phases could not be found or followed.
    #[error(transparent)]
    Shimmy(#[from] kingpin::shimmy::ShimmyError),
    /// A continuation failed.
    #[error(transparent)]
    Continuation(#[from] arclength::Error),
    /// A motion that cannot be followed to its end.
    #[error("the motion cannot be followed: {0}")]
    Integration(#[from] IntegrationError),
    /// Nothing was found where something was sought.
    #[error("{0}")]
    NothingFound(String),
    /// The paper's results could not be had.
    #[error(transparent)]
    Paper(#[from] PaperError),
    /// The picture could not be drawn.
    #[error(transparent)]
    Figure(#[from] FigureError),
    /// The program could not do its part.
    #[error(transparent)]
    Terminal(#[from] kingpin_terminal::Failure),
    /// A file could not be written.
    #[error(transparent)]
    Report(#[from] ReportError),
    /// The journal of a long run could not be used.
    #[error("{}: the journal cannot be used: {source}", path.display())]
    Journal {
        /// The journal.
        path: PathBuf,
        /// The cause.
        source: std::io::Error,
    },
    /// Ctrl-C was pressed.
    #[error("interrupted: {done} of {parts} parts are finished, {kept}")]
    Interrupted {
        /// Number of parts that are finished.
        done: usize,
        /// Number of all parts.
        parts: usize,
        /// Where they are kept.
        kept: String,
    },
}

impl Error {
    /// That a field of the request makes no sense.
    pub fn invalid(
        fields: &'static [&'static str],
        given: impl Into<String>,
        problem: impl Into<String>,
        allowed: impl Into<String>,
    ) -> Self {
        let (given, problem, allowed) = (given.into(), problem.into(), allowed.into());
        InvalidField { fields, given, problem, allowed }.into()
    }
}

impl AnalysisError for Error {
    fn is_bad_request(&self) -> bool {
        match self {
            Self::Wheel(error) | Self::Simulation(SimulationError::Wheel(error)) => is_bad_wheel(error),
            Self::Simulation(
                SimulationError::Integration(_) | SimulationError::UniformMotionSlides { .. },
            ) => false,
            Self::Continuation(error) => matches!(error, arclength::Error::Invalid { .. }),
            Self::Paper(PaperError::Wheel(error)) => is_bad_wheel(error),
            Self::Paper(PaperError::UnknownFigure(_) | PaperError::Unwritable { .. }) => true,
            Self::Start(error) => error.is_bad_request(),
            Self::Report(error) => error.is_bad_request(),
            Self::Invalid(_) | Self::Set { .. } | Self::Simulation(_) | Self::Journal { .. } => true,
            Self::Shimmy(_)
            | Self::Integration(_)
            | Self::NothingFound(_)
            | Self::Paper(_)
            | Self::Figure(_)
            | Self::Terminal(_)
            | Self::Interrupted { .. } => false,
        }
    }

    fn message(&self, name: &dyn Fn(&str) -> String) -> String {
        match self {
            Self::Invalid(field) => field.message(name),
            Self::Set { given, source } => format!("{} {given}: {source}", name("set")),
            Self::Start(error) => error.message(name),
            Self::Report(error) => error.message(name),
            other => other.to_string(),
        }
    }
}

fn is_bad_wheel(error: &KingpinError) -> bool {
    match error {
        KingpinError::NoUniformMotion { .. } | KingpinError::Cancelled | KingpinError::Continuation(_) => {
            false
        }
        KingpinError::InFile { source, .. } => is_bad_wheel(source),
        _ => true,
    }
}
