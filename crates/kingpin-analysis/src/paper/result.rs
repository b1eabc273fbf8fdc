//! What was written of the paper, as a result.

use super::claims::Claim;
use kingpin_report::{Columns, Parameters, Report, Schema};
use serde::Serialize;
use std::io::{self, Write};
use std::path::PathBuf;

/// The files that were written.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct PaperResult {
    /// The files.
    pub files: Vec<PathBuf>,
    /// The statements of the paper; none where one figure only was asked for.
    #[serde(skip)]
    pub claims: Vec<Claim>,
}

impl Report for PaperResult {
    fn schema(&self) -> Schema {
        Schema::first("kingpin.paper")
    }

    fn parameters(&self) -> Parameters {
        // The figures say with what they were computed.
        Parameters::default()
    }

    fn write_table(&self, out: &mut dyn Write) -> io::Result<()> {
        self.files.iter().try_for_each(|file| writeln!(out, "{}", file.display()))
    }

    fn columns(&self) -> Columns {
        Columns::new().texts("file", self.files.iter().map(|file| Some(file.display().to_string())))
    }
}
