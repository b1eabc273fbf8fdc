//! What can go wrong when a figure is built, drawn or written.

use std::path::PathBuf;

/// Errors of this crate.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum FigureError {
    /// The ending of the file names no format this crate writes.
    #[error("cannot tell the picture format of '{}': the ending must be .svg, .png or .pdf", path.display())]
    UnknownFormat {
        /// The path as it was given.
        path: PathBuf,
    },
    /// The file could not be written.
    #[error("cannot write '{}'", path.display())]
    Io {
        /// The file that was to be written.
        path: PathBuf,
        /// What the operating system said.
        #[source]
        source: std::io::Error,
    },
    /// The number of values does not fit the grid.
    #[error("a grid of {columns} columns and {rows} rows needs {expected} values, but {found} were given", expected = columns.saturating_mul(*rows))]
    GridShape {
        /// Columns of the grid (values of x).
        columns: usize,
        /// Rows of the grid (values of y).
        rows: usize,
        /// How many values were given.
        found: usize,
    },
    /// The nodes of a grid cannot be used.
    #[error("the {axis} nodes of a grid must be finite, at least one, and rise or fall throughout")]
    GridAxis {
        /// `x` or `y`.
        axis: &'static str,
    },
    /// The raster resolution is not usable.
    #[error(
        "a resolution of {dpi} dpi cannot be drawn: it must be finite, at least {lowest} and at most {highest} for this figure"
    )]
    Resolution {
        /// Dots per inch that were asked for.
        dpi: f64,
        /// The smallest resolution allowed.
        lowest: f64,
        /// The largest resolution allowed for the size of this figure.
        highest: f64,
    },
    /// The PNG encoder failed.
    #[error("cannot encode the picture as PNG")]
    Png(#[from] png::EncodingError),
}
