//! How a command fails, and with which exit code.

use crate::paper::PaperError;
use arclength::integration::IntegrationError;
use arclength_ode::OdeError;
use kingpin::KingpinError;
use kingpin::simulation::SimulationError;
use kingpin_figure::FigureError;
use std::path::PathBuf;

/// Exit code of a computation that failed.
const COMPUTATION_FAILED: u8 = 1;
/// Exit code of bad input.
const BAD_INPUT: u8 = 2;

/// Why a command did not deliver its result.
#[derive(Debug, thiserror::Error)]
pub enum Failure {
    /// Whoever read the standard output has closed it: the command ends quietly.
    #[error("standard output was closed")]
    OutputClosed,
    /// An option that makes no sense.
    #[error("{option} {given}: {problem}; allowed: {allowed}")]
    Option {
        /// The option, such as `--out`.
        option: &'static str,
        /// What was given.
        given: String,
        /// What is wrong with it.
        problem: String,
        /// What is allowed.
        allowed: String,
    },
    /// The wheel is at fault, or has no such motion.
    #[error(transparent)]
    Wheel(#[from] KingpinError),
    /// A parameter given with `--set`.
    #[error("--set {given}: {source}")]
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
    /// A text model that cannot be read.
    #[error("{}: {}", path.display(), source.snippet())]
    Model {
        /// The file.
        path: PathBuf,
        /// What is wrong, and where.
        source: Box<OdeError>,
    },
    /// A file that cannot be read.
    #[error("{}: cannot be read: {source}", path.display())]
    Unreadable {
        /// The file.
        path: PathBuf,
        /// The cause.
        source: std::io::Error,
    },
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
    /// A result could not be put into its format.
    #[error("cannot write the result as {format}: {cause}")]
    Encoding {
        /// JSON, CSV or Parquet.
        format: &'static str,
        /// The cause.
        cause: String,
    },
    /// A file could not be written.
    #[error("--out {}: cannot write there: {source}; no file was left behind", path.display())]
    Unwritable {
        /// The file.
        path: PathBuf,
        /// The cause.
        source: std::io::Error,
    },
    /// A result file that cannot be used.
    #[error("{}: {problem}", path.display())]
    ResultFile {
        /// The file.
        path: PathBuf,
        /// What is wrong, and what is allowed.
        problem: String,
    },
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
    /// Ctrl-C was pressed on the way along a branch.
    #[error("interrupted: what was computed before is in the result, which can be continued from its ends")]
    BranchInterrupted,
    /// Ctrl-C could not be listened to.
    #[error("cannot listen to Ctrl-C: {0}")]
    Signals(#[from] ctrlc::Error),
    /// Threads could not be started.
    #[error("cannot start the threads: {0}")]
    Threads(#[from] rayon::ThreadPoolBuildError),
}

impl Failure {
    /// 0 when nobody reads the output any more, 1 when the computation failed, 2 for bad input.
    pub fn exit_code(&self) -> u8 {
        match self {
            Self::OutputClosed => 0,
            Self::Wheel(error) => wheel_exit_code(error),
            Self::Simulation(SimulationError::Wheel(error)) => wheel_exit_code(error),
            Self::Simulation(
                SimulationError::Integration(_) | SimulationError::UniformMotionSlides { .. },
            ) => COMPUTATION_FAILED,
            Self::Continuation(arclength::Error::Invalid { .. }) => BAD_INPUT,
            Self::Paper(PaperError::Wheel(error)) => wheel_exit_code(error),
            Self::Paper(PaperError::UnknownFigure(_) | PaperError::Unwritable { .. }) => BAD_INPUT,
            Self::Option { .. }
            | Self::Set { .. }
            | Self::Simulation(_)
            | Self::Unwritable { .. }
            | Self::Model { .. }
            | Self::Unreadable { .. }
            | Self::Journal { .. }
            | Self::ResultFile { .. } => BAD_INPUT,
            Self::Continuation(_)
            | Self::Shimmy(_)
            | Self::Integration(_)
            | Self::NothingFound(_)
            | Self::Paper(_)
            | Self::Figure(_)
            | Self::Encoding { .. }
            | Self::Interrupted { .. }
            | Self::BranchInterrupted
            | Self::Signals(_)
            | Self::Threads(_) => COMPUTATION_FAILED,
        }
    }
}

fn wheel_exit_code(error: &KingpinError) -> u8 {
    match error {
        KingpinError::NoUniformMotion { .. } | KingpinError::Cancelled | KingpinError::Continuation(_) => {
            COMPUTATION_FAILED
        }
        KingpinError::InFile { source, .. } => wheel_exit_code(source),
        _ => BAD_INPUT,
    }
}
