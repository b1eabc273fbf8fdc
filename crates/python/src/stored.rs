//! Any result of any analysis, as what a report is made of.

use kingpin_report::files::{FileFormat, Staged};
use kingpin_report::{Columns, Report, ReportError, Schema, Stoppable, json};
use std::path::Path;
use std::sync::atomic::AtomicBool;

/// A result, whatever its type.
pub(crate) trait Stored: Send + Sync {
    /// Name and version of its form in JSON.
    fn schema(&self) -> Schema;
    /// The text of its file, unless the flag is set meanwhile.
    fn json(&self, stop: &AtomicBool) -> Result<Vec<u8>, ReportError>;
    /// Its columns.
    fn columns(&self) -> Columns;
    /// Its table for people.
    fn table(&self) -> std::io::Result<Vec<u8>>;
    /// The story of the run, if there is one.
    fn story(&self) -> std::io::Result<Option<Vec<u8>>>;
    /// Its picture as SVG, if it has one.
    fn svg(&self) -> Result<Option<String>, ReportError>;
    /// Writes it to a file of the format that the ending says, unless the flag is set meanwhile.
    fn write(&self, path: &Path, stop: &AtomicBool) -> Result<(), ReportError>;
}

impl<R: Report + Send + Sync> Stored for R {
    fn schema(&self) -> Schema {
        Report::schema(self)
    }

    fn json(&self, stop: &AtomicBool) -> Result<Vec<u8>, ReportError> {
        let mut text = Vec::new();
        json::write(self, &mut Stoppable::new(&mut text, stop))?;
        Ok(text)
    }

    fn columns(&self) -> Columns {
        Report::columns(self)
    }

    fn table(&self) -> std::io::Result<Vec<u8>> {
        let mut text = Vec::new();
        self.write_table(&mut text)?;
        Ok(text)
    }

    fn story(&self) -> std::io::Result<Option<Vec<u8>>> {
        let told = Report::story(self).map(|story| {
            let mut text = Vec::new();
            story.write(&mut text).map(|()| text)
        });
        told.transpose()
    }

    fn svg(&self) -> Result<Option<String>, ReportError> {
        let Some(figure) = self.figure()? else { return Ok(None) };
        Ok(Some(figure.to_svg()?))
    }

    fn write(&self, path: &Path, stop: &AtomicBool) -> Result<(), ReportError> {
        let format = FileFormat::of(path, FileFormat::ALL)?;
        Staged::result_unless(stop, self, path, format)?.publish()
    }
}
