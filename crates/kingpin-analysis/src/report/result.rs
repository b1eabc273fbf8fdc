//! A report as a result: what was found, and the files that were written.

use super::finding::Finding;
use crate::description;
use crate::parameters::parameters_of;
use kingpin::Wheel;
use kingpin_report::numbers::readable;
use kingpin_report::{Columns, Parameters, Report, Schema};
use serde::Serialize;
use std::io::{self, Write};
use std::path::PathBuf;

/// What was found, and the files.
#[derive(Clone, Debug, Serialize)]
pub struct ReportResult {
    /// The wheel.
    #[serde(skip)]
    pub wheel: Wheel,
    /// The largest speed that was looked at, in m/s.
    pub up_to: f64,
    /// What was found.
    pub findings: Vec<Finding>,
    /// The files that were written.
    pub files: Vec<PathBuf>,
}

impl Report for ReportResult {
    fn schema(&self) -> Schema {
        Schema::first("kingpin.report")
    }

    fn parameters(&self) -> Parameters {
        parameters_of(&self.wheel, &[])
    }

    fn write_table(&self, out: &mut dyn Write) -> io::Result<()> {
        let up_to = readable(self.up_to);
        writeln!(
            out,
            "the wheel at {}, and up to v = {up_to} m/s\n",
            description::on_lines(&self.wheel, &[])
        )?;
        for Finding { subject, text, undecided, .. } in &self.findings {
            writeln!(out, "{subject}{}\n  {text}", if *undecided { " (undecided)" } else { "" })?;
        }
        writeln!(out)?;
        self.files.iter().try_for_each(|file| writeln!(out, "{}", file.display()))
    }

    fn columns(&self) -> Columns {
        let findings = || self.findings.iter();
        Columns::new()
            .texts("subject", findings().map(|finding| Some(finding.subject.clone())))
            .texts("text", findings().map(|finding| Some(finding.text.clone())))
            .texts("check", findings().map(|finding| Some(finding.check.clone())))
            .booleans("undecided", findings().map(|finding| finding.undecided))
    }
}
