//! Why an analysis of a wheel gives no result.

use arclength::control::Interrupted;
use arclength::integration::IntegrationError;
use arclength_analysis::{AnalysisError, Control, InvalidField};
use kingpin::KingpinError;
use kingpin::identification::IdentificationError;
use kingpin::shimmy::ShimmyError;
use kingpin::simulation::SimulationError;
use kingpin_figure::FigureError;
use kingpin_report::ReportError;
use kingpin_report::chunks::ChunkError;
use std::path::PathBuf;

/// Why an analysis of a wheel gives no result.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// A field of the request makes no sense.
    #[error(transparent)]
    Invalid(#[from] InvalidField),
    /// A labelled point of an earlier result that cannot be used.
    #[error(transparent)]
    Start(#[from] arclength_analysis::Error),
    /// The wheel is at fault, or has no such motion.
    #[error(transparent)]
    Wheel(KingpinError),
    /// A parameter that is set.
    #[error("{field} {given}: {source}")]
    Set {
        /// The field of the request in which it is.
        field: &'static str,
        /// What was given.
        given: String,
        /// What is wrong with it.
        source: Box<KingpinError>,
    },
    /// A simulation could not be run.
    #[error(transparent)]
    Simulation(SimulationError),
    /// A periodic motion with sliding phases could not be found or followed.
    #[error(transparent)]
    Shimmy(ShimmyError),
    /// Parameters could not be estimated.
    #[error(transparent)]
    Identification(IdentificationError),
    /// A file of a record could not be read.
    #[error("{}: {source}", path.display())]
    UnreadableRecord {
        /// The file.
        path: PathBuf,
        /// The cause.
        source: std::io::Error,
    },
    /// A file of a record that cannot be used.
    #[error(
        "{}: line {line}{}: {problem}",
        path.display(),
        column.as_ref().map(|column| format!(", column {column}")).unwrap_or_default()
    )]
    RecordFile {
        /// The file.
        path: PathBuf,
        /// The line, counted from 1.
        line: u64,
        /// The name of the column, where it is one that is at fault.
        column: Option<String>,
        /// What is wrong, and what is allowed.
        problem: String,
    },
    /// A record that cannot be used.
    #[error("{}: {problem}", path.display())]
    Record {
        /// Its file.
        path: PathBuf,
        /// What is wrong.
        problem: String,
    },
    /// A continuation failed.
    #[error(transparent)]
    Continuation(#[from] arclength::Error),
    /// A motion that cannot be followed to its end.
    #[error("the motion cannot be followed: {0}")]
    Integration(#[source] IntegrationError),
    /// Nothing was found where something was sought.
    #[error("{0}")]
    NothingFound(String),
    /// From no Hopf point a branch of cycles could be followed.
    #[error("{0}; try a shorter interval around the Hopf point, or shorter steps from it (--finer 10)")]
    NoBranch(String),
    /// Eigenvalues did not converge.
    #[error(transparent)]
    Eigenvalues(#[from] arclength::linear::eigenvalues::EigenvalueError),
    /// A branch of cycles could not be followed to the ends of its interval.
    #[error("the branch of cycles at {place} ends early: {reason}")]
    BranchEnds {
        /// Where.
        place: String,
        /// Why.
        reason: String,
    },
    /// The picture could not be drawn.
    #[error(transparent)]
    Figure(#[from] FigureError),
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
    /// The chunks of a run that is divided into shards could not be kept or put together.
    #[error(transparent)]
    Chunks(#[from] ChunkError),
    /// The control stopped a run of many parts.
    #[error("interrupted: {done} of {parts} parts are finished, {kept}")]
    Interrupted {
        /// Number of parts that are finished.
        done: usize,
        /// Number of all parts.
        parts: usize,
        /// Where they are kept.
        kept: String,
    },
    /// The control stopped the run before there was a result.
    #[error("interrupted before the result was complete; nothing was written")]
    Stopped,
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

    /// That something that was sought was not found at a place.
    pub(crate) fn not_found(what: &str, place: &str) -> Self {
        Self::NothingFound(format!("no {what} was found at {place}"))
    }
}

/// That the control has not stopped the run.
///
/// # Errors
/// [`Error::Stopped`].
pub(crate) fn unless_stopped(control: &Control<'_>) -> Result<(), Error> {
    if control.is_stopped() { Err(Error::Stopped) } else { Ok(()) }
}

// What was interrupted is told as that, however deep inside it happened.

impl From<Interrupted> for Error {
    fn from(_: Interrupted) -> Self {
        Self::Stopped
    }
}

impl From<KingpinError> for Error {
    fn from(error: KingpinError) -> Self {
        match error {
            KingpinError::Interrupted(interrupted) => interrupted.into(),
            error => Self::Wheel(error),
        }
    }
}

impl From<SimulationError> for Error {
    fn from(error: SimulationError) -> Self {
        match error {
            SimulationError::Interrupted(interrupted) => interrupted.into(),
            error => Self::Simulation(error),
        }
    }
}

impl From<ShimmyError> for Error {
    fn from(error: ShimmyError) -> Self {
        match error {
            ShimmyError::Interrupted(interrupted) => interrupted.into(),
            error => Self::Shimmy(error),
        }
    }
}

impl From<IdentificationError> for Error {
    fn from(error: IdentificationError) -> Self {
        match error {
            IdentificationError::Interrupted(interrupted) => interrupted.into(),
            IdentificationError::Wheel(error) => error.into(),
            error => Self::Identification(error),
        }
    }
}

impl From<IntegrationError> for Error {
    fn from(error: IntegrationError) -> Self {
        match error {
            IntegrationError::Interrupted(interrupted) => interrupted.into(),
            error => Self::Integration(error),
        }
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
            Self::Start(error) => error.is_bad_request(),
            Self::Report(error) => error.is_bad_request(),
            Self::Chunks(error) => !matches!(
                error,
                ChunkError::Missing { .. } | ChunkError::Damaged { .. } | ChunkError::Report(_)
            ),
            Self::Identification(error) => {
                !matches!(error, IdentificationError::NoStart(_) | IdentificationError::ManyMinima { .. })
            }
            Self::Invalid(_)
            | Self::Set { .. }
            | Self::Simulation(_)
            | Self::UnreadableRecord { .. }
            | Self::RecordFile { .. }
            | Self::Record { .. }
            | Self::Journal { .. } => true,
            Self::Shimmy(_)
            | Self::Integration(_)
            | Self::NothingFound(_)
            | Self::Eigenvalues(_)
            | Self::NoBranch(_)
            | Self::BranchEnds { .. }
            | Self::Figure(_)
            | Self::Interrupted { .. }
            | Self::Stopped => false,
        }
    }

    fn message(&self, name: &dyn Fn(&str) -> String) -> String {
        match self {
            Self::Invalid(field) => field.message(name),
            Self::Set { field, given, source } => format!("{} {given}: {source}", name(field)),
            Self::Start(error) => error.message(name),
            Self::Report(error) => error.message(name),
            other => other.to_string(),
        }
    }
}

fn is_bad_wheel(error: &KingpinError) -> bool {
    match error {
        KingpinError::NoUniformMotion { .. }
        | KingpinError::Interrupted(_)
        | KingpinError::Continuation(_) => false,
        KingpinError::InFile { source, .. } => is_bad_wheel(source),
        _ => true,
    }
}
