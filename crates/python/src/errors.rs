//! Errors of the analyses as exceptions of the package, which are classes of `arclength.errors`.

use arclength_analysis::{AnalysisError, InvalidField};
use kingpin::KingpinError;
use kingpin_report::ReportError;
use pyo3::prelude::*;
use pyo3::types::PyDict;

/// What went wrong, before it is an exception.
pub(crate) struct Failure {
    /// Name of the class.
    pub class: &'static str,
    /// What happened, with its causes.
    pub message: String,
    /// What was at fault, what it was, and what is allowed, where that is known.
    pub key: Option<String>,
    pub value: Option<String>,
    pub allowed: Option<String>,
}

const INVALID: &str = "InvalidInput";
const FAILED: &str = "ComputationFailed";
const INTERRUPTED: &str = "Interrupted";

impl Failure {
    fn new(class: &'static str, message: String) -> Self {
        Self { class, message, key: None, value: None, allowed: None }
    }

    /// A request that cannot be read.
    pub(crate) fn bad_request(message: impl Into<String>) -> Self {
        Self::new(INVALID, message.into())
    }

    /// Something inside went wrong that must not.
    pub(crate) fn internal(message: impl Into<String>) -> Self {
        Self::new(FAILED, message.into())
    }

    /// That it was stopped.
    pub(crate) fn interrupted(error: &ReportError) -> Self {
        Self::new(INTERRUPTED, error.to_string())
    }

    fn of<E: AnalysisError>(error: &E) -> Self {
        let class = if error.is_bad_request() { INVALID } else { FAILED };
        let mut message = error.message(&|field| field.to_owned());
        let mut cause = error.source();
        while let Some(error) = cause {
            let text = error.to_string();
            if !message.contains(&text) {
                message = format!("{message}: {text}");
            }
            cause = error.source();
        }
        Self::new(class, message)
    }

    fn detailed(
        mut self,
        key: impl Into<String>,
        value: impl Into<String>,
        allowed: impl Into<String>,
    ) -> Self {
        (self.key, self.value, self.allowed) = (Some(key.into()), Some(value.into()), Some(allowed.into()));
        self
    }

    fn field(self, field: &InvalidField) -> Self {
        self.detailed(field.fields.join(" and "), &field.given, &field.allowed)
    }

    fn continuation(self, error: &arclength::Error) -> Self {
        match error {
            arclength::Error::Invalid { name, value, allowed } => self.detailed(name, value, allowed),
            _ => self,
        }
    }

    fn wheel(mut self, error: &KingpinError) -> Self {
        match error {
            KingpinError::OutOfRange { key, value, .. } => {
                self.detailed(key.name(), value.to_string(), key.allowed().to_string())
            }
            KingpinError::NotANumber { key, given, .. } => {
                self.detailed(key.name(), given, key.allowed().to_string())
            }
            KingpinError::UnknownKey { given, .. } => {
                self.key = Some(given.clone());
                self
            }
            KingpinError::UnknownTyre { given, .. } => self.detailed("tyre", given, "rigid, linear, brush"),
            KingpinError::InFile { source, .. } => self.wheel(source),
            _ => self,
        }
    }

    fn analysis(self, error: &arclength_analysis::Error) -> Self {
        match error {
            arclength_analysis::Error::Invalid(field) => self.field(field),
            arclength_analysis::Error::Continuation(error) => self.continuation(error),
            arclength_analysis::Error::Model { .. } => Self { class: "InvalidModel", ..self },
            _ => self,
        }
    }
}

impl From<arclength_analysis::Error> for Failure {
    fn from(error: arclength_analysis::Error) -> Self {
        Self::of(&error).analysis(&error)
    }
}

impl From<kingpin_analysis::Error> for Failure {
    fn from(error: kingpin_analysis::Error) -> Self {
        use kingpin_analysis::Error;
        let failure = Self::of(&error);
        match &error {
            Error::Invalid(field) => failure.field(field),
            Error::Start(error) => failure.analysis(error),
            Error::Wheel(error) => failure.wheel(error),
            Error::Set { source, .. } => failure.wheel(source),
            Error::Continuation(error) => failure.continuation(error),
            Error::Interrupted { .. } | Error::Stopped => Self { class: INTERRUPTED, ..failure },
            _ => failure,
        }
    }
}

impl From<KingpinError> for Failure {
    fn from(error: KingpinError) -> Self {
        kingpin_analysis::Error::from(error).into()
    }
}

impl From<ReportError> for Failure {
    fn from(error: ReportError) -> Self {
        Self::of(&error)
    }
}

impl From<std::io::Error> for Failure {
    fn from(error: std::io::Error) -> Self {
        Self::new(FAILED, error.to_string())
    }
}

impl From<Failure> for PyErr {
    fn from(failure: Failure) -> Self {
        Python::attach(|py| {
            let exception = || {
                let details = PyDict::new(py);
                details.set_item("key", &failure.key)?;
                details.set_item("value", &failure.value)?;
                details.set_item("allowed", &failure.allowed)?;
                let class = py.import("arclength.errors")?.getattr(failure.class)?;
                class.call((&failure.message,), Some(&details))
            };
            exception().map_or_else(|error| error, PyErr::from_value)
        })
    }
}
