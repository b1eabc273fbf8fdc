//! What a report says of one subject.

use crate::error::Error;
use serde::Serialize;

/// What was found on one subject.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Finding {
    /// The subject.
    pub subject: String,
    /// What was found, in words; or why nothing was.
    pub text: String,
    /// How it was checked.
    pub check: String,
    /// Whether the question is left open, wholly or in part.
    pub undecided: bool,
}

impl Finding {
    /// What was found and how it was checked.
    pub(super) fn new(subject: impl Into<String>, text: String, check: impl Into<String>) -> Self {
        Self { subject: subject.into(), text, check: check.into(), undecided: false }
    }

    /// The same, with the question left open.
    pub(super) fn undecided_if(self, undecided: bool) -> Self {
        Self { undecided, ..self }
    }

    /// The same, with what is to be added.
    pub(super) fn and(self, sentence: &str) -> Self {
        Self { text: format!("{} {sentence}", self.text), ..self }
    }

    /// That it could not be computed, and why.
    pub(super) fn not_computed(subject: impl Into<String>, error: &Error) -> Self {
        let text = format!("Not computed: {error}.");
        Self { subject: subject.into(), text, check: String::new(), undecided: true }
    }
}
