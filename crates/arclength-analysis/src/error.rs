//! Why an analysis gives no result, as every face can tell it.

use arclength::integration::IntegrationError;
use arclength_ode::{NotFinite, OdeError};
use kingpin_report::ReportError;
use std::path::PathBuf;

/// An error of an analysis. A face needs to know two things: who is at fault, and how it names the fields of a request.
pub trait AnalysisError: std::error::Error + Send + Sync + 'static {
    /// Whether what was asked for is at fault, not the computation.
    fn is_bad_request(&self) -> bool;

    /// The message, with the fields of the request as the face names them: `--along` where it is an option.
    fn message(&self, _name: &dyn Fn(&str) -> String) -> String {
        self.to_string()
    }
}

/// A field of a request, or several together, that make no sense.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("{}", self.message(&|field| field.to_owned()))]
pub struct InvalidField {
    /// The fields.
    pub fields: &'static [&'static str],
    /// What was given.
    pub given: String,
    /// What is wrong with it.
    pub problem: String,
    /// What is allowed.
    pub allowed: String,
}

impl InvalidField {
    /// The message, with the fields as a face names them.
    pub fn message(&self, name: &dyn Fn(&str) -> String) -> String {
        let fields: Vec<String> = self.fields.iter().map(|field| name(field)).collect();
        format!("{} {}: {}; allowed: {}", fields.join(" and "), self.given, self.problem, self.allowed)
    }
}

impl AnalysisError for InvalidField {
    fn is_bad_request(&self) -> bool {
        true
    }

    fn message(&self, name: &dyn Fn(&str) -> String) -> String {
        Self::message(self, name)
    }
}

impl AnalysisError for ReportError {
    fn is_bad_request(&self) -> bool {
        matches!(self, Self::UnknownEnding { .. } | Self::Unwritable { .. })
    }

    fn message(&self, name: &dyn Fn(&str) -> String) -> String {
        if self.is_bad_request() { format!("{} {self}", name("out")) } else { self.to_string() }
    }
}

/// Why an analysis of a model gives no result.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// A field of the request makes no sense.
    #[error(transparent)]
    Invalid(#[from] InvalidField),
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
    /// A model whose right-hand side depends on the time has neither equilibria nor cycles of its own.
    #[error(
        "{model}: the right-hand side depends on the time: it has no equilibria and no cycles of its own; try: --freeze t=0 (equilibria \
         with everything as it is at that time), or for a periodic force an oscillator in place of the time (u'=u*(1-u^2-v^2)-w*v, \
         v'=v*(1-u^2-v^2)+w*u: v is sin(w*t))\n{snippet}"
    )]
    TimeDependent {
        /// Name of the model.
        model: String,
        /// Where the time occurs.
        snippet: String,
    },
    /// A result file that cannot be used.
    #[error("{}: {problem}", path.display())]
    ResultFile {
        /// The file.
        path: PathBuf,
        /// What is wrong, and what is allowed.
        problem: String,
    },
    /// A file of samples of an orbit that cannot be used.
    #[error(
        "{}: line {line}{}: {problem}",
        path.display(),
        column.as_ref().map_or(String::new(), |name| format!(", column {name}"))
    )]
    OrbitFile {
        /// The file.
        path: PathBuf,
        /// The line, from 1.
        line: u64,
        /// The column, where it is one that is at fault.
        column: Option<String>,
        /// What is wrong, and what is allowed.
        problem: String,
    },
    /// A continuation failed.
    #[error(transparent)]
    Continuation(#[from] arclength::Error),
    /// A motion that cannot be followed to its end.
    #[error("the motion cannot be followed: {0}")]
    Integration(#[from] IntegrationError),
    /// A motion that has no beginning.
    #[error(
        "the motion cannot be followed: at t = {time} {because}; start where it is finite: other initial values (x(0)=.. or init, \
         or --start) or parameters (--set)\n{}",
        because.place.snippet()
    )]
    NotFiniteAtStart {
        /// Where it would begin.
        time: f64,
        /// What is not finite.
        because: NotFinite,
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

    /// The same with other fields at fault, where fields are.
    pub fn in_fields(self, fields: &'static [&'static str]) -> Self {
        match self {
            Self::Invalid(invalid) => Self::Invalid(InvalidField { fields, ..invalid }),
            other => other,
        }
    }
}

impl AnalysisError for Error {
    fn is_bad_request(&self) -> bool {
        match self {
            Self::Continuation(error) => matches!(error, arclength::Error::Invalid { .. }),
            Self::Integration(_) | Self::NotFiniteAtStart { .. } => false,
            _ => true,
        }
    }

    fn message(&self, name: &dyn Fn(&str) -> String) -> String {
        match self {
            Self::Invalid(field) => field.message(name),
            other => other.to_string(),
        }
    }
}
