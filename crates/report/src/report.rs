//! What every result can be shown as.

use crate::columns::Columns;
use crate::parameters::Parameters;
use crate::schema::Schema;
use crate::story::Story;
use kingpin_figure::{Figure, FigureError};
use serde::Serialize;
use std::io::{self, Write};

/// The result of an analysis. Its fields, serialised, are those of the JSON object.
pub trait Report: Serialize {
    /// Name and version of its form in JSON.
    fn schema(&self) -> Schema;

    /// Every parameter that was used.
    fn parameters(&self) -> Parameters;

    /// Writes it for people.
    ///
    /// # Errors
    /// Those of the writer.
    fn write_table(&self, out: &mut dyn Write) -> io::Result<()>;

    /// Its rows, for CSV and Parquet.
    fn columns(&self) -> Columns;

    /// Its picture, where one makes sense.
    ///
    /// # Errors
    /// Those of the drawing.
    fn figure(&self) -> Result<Option<Figure>, FigureError> {
        Ok(None)
    }

    /// The story of the run, where there is one to tell.
    fn story(&self) -> Option<Story> {
        None
    }
}
