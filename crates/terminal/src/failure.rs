//! How a command fails, and with which exit code.

use arclength_analysis::AnalysisError;
use kingpin_report::ReportError;
use std::error::Error;
use std::io::ErrorKind;

/// Exit code of a computation that failed.
const COMPUTATION_FAILED: u8 = 1;
/// Exit code of bad input.
const BAD_INPUT: u8 = 2;

/// Why a command did not deliver its result.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum Failure {
    /// Whoever read the standard output has closed it: the command ends quietly.
    #[error("standard output was closed")]
    OutputClosed,
    /// An option that makes no sense.
    #[error("{option} {given}: {problem}; allowed: {allowed}")]
    Option {
        /// The option, such as `--at`.
        option: &'static str,
        /// What was given.
        given: String,
        /// What is wrong with it.
        problem: String,
        /// What is allowed.
        allowed: String,
    },
    /// What was asked for makes no sense, or could not be computed or written.
    #[error("{message}")]
    Analysis {
        /// The message, with options in place of the fields of a request.
        message: String,
        /// Whether what was asked for is at fault, not the computation.
        bad_request: bool,
        /// The error itself.
        source: Box<dyn Error + Send + Sync>,
    },
    /// A signal came on the way along a branch; the result has been delivered.
    #[error("interrupted: what was computed before is in the result, which can be continued from its ends")]
    BranchInterrupted,
    /// Signals could not be listened to.
    #[error("cannot listen to signals: {0}")]
    Signals(#[source] std::io::Error),
    /// The page could not be served.
    #[error(transparent)]
    Server(arclength_page::ServeError),
    /// Threads could not be started.
    #[error("cannot start the threads: {0}")]
    Threads(#[source] rayon::ThreadPoolBuildError),
}

impl<E: AnalysisError> From<E> for Failure {
    fn from(error: E) -> Self {
        Self::Analysis {
            message: error.message(&option),
            bad_request: error.is_bad_request(),
            source: error.into(),
        }
    }
}

/// The option by which a field of a request is given; the file of a model and the folder of chunks need none.
fn option(field: &str) -> String {
    match field {
        "model" => "MODEL.ode".to_owned(),
        "folder" => "FOLDER".to_owned(),
        field => format!("--{}", field.replace('_', "-")),
    }
}

impl Failure {
    /// What it means that a result could not be written: a closed standard output is no failure.
    pub fn of_output(error: ReportError) -> Self {
        match error {
            ReportError::Encoding { source, .. } if source.kind() == ErrorKind::BrokenPipe => {
                Self::OutputClosed
            }
            error => error.into(),
        }
    }

    /// 0 when nobody reads the output any more, 1 when the computation failed, 2 for bad input.
    pub fn exit_code(&self) -> u8 {
        let bad_input = match self {
            Self::OutputClosed => return 0,
            Self::Option { .. } => true,
            Self::Analysis { bad_request, .. } => *bad_request,
            Self::Server(error) => matches!(error, arclength_page::ServeError::Port { .. }),
            Self::BranchInterrupted | Self::Signals(_) | Self::Threads(_) => false,
        };
        if bad_input { BAD_INPUT } else { COMPUTATION_FAILED }
    }
}
