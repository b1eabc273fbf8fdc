//! Why a result could not be written.

use kingpin_figure::FigureError;
use std::path::PathBuf;

/// Why a result could not be put into its format or its file.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum ReportError {
    /// The ending of a file is that of no format in which the result can be written.
    #[error("{}: the ending names no format of this result; allowed: {allowed}", path.display())]
    UnknownEnding {
        /// The file.
        path: PathBuf,
        /// The endings that are allowed.
        allowed: String,
    },
    /// A file could not be written.
    #[error("{}: cannot write there: {source}; no file was left behind", path.display())]
    Unwritable {
        /// The file.
        path: PathBuf,
        /// The cause.
        source: std::io::Error,
    },
    /// A result could not be put into its format, or whoever was to take it did not.
    #[error("cannot write the result as {format}: {source}")]
    Encoding {
        /// JSON, CSV, Parquet, text or a picture.
        format: &'static str,
        /// The cause.
        source: std::io::Error,
    },
    /// A picture was asked for of a result that has none.
    #[error("cannot write the result as a picture: there is nothing to draw")]
    NothingToDraw,
    /// Whoever waited for it stopped it.
    #[error("interrupted before the result was written; no file was left behind")]
    Stopped,
    /// The picture could not be drawn.
    #[error(transparent)]
    Figure(#[from] FigureError),
}

impl ReportError {
    /// What an error of the writer of a format means.
    pub(crate) fn encoding(format: &'static str) -> impl Fn(std::io::Error) -> Self {
        move |source| Self::Encoding { format, source }
    }
}
