//! Names as they are written in a model.

use crate::error::Span;

/// A name as written, and where.
#[derive(Clone, Debug)]
pub(crate) struct Name {
    pub text: String,
    pub span: Span,
}

impl Name {
    /// The name as XPPAUT compares names.
    pub(crate) fn key(&self) -> String {
        self.text.to_ascii_lowercase()
    }
}
