//! What the studies found as a result.

use super::name::StudyName;
use super::study::Finding;
use crate::description;
use crate::parameters::parameters_of;
use kingpin::Wheel;
use kingpin_report::{Cell, Columns, Parameters, Report, Schema, Table};
use serde::Serialize;
use std::io::{self, Write};
use std::path::PathBuf;

/// What was found, and where the figures are.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct StudyResult {
    /// The wheel that was given, if one was.
    pub wheel: Option<Wheel>,
    /// The findings of every study.
    pub findings: Vec<(StudyName, Finding)>,
    /// What every study says in words: that nothing was found and what was searched, what was left out.
    pub notes: Vec<(StudyName, String)>,
    /// The files that were written.
    pub files: Vec<PathBuf>,
}

impl Serialize for StudyResult {
    fn serialize<S: serde::Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        #[derive(Serialize)]
        struct Row<'a> {
            study: &'static str,
            quantity: &'a str,
            value: f64,
            unit: &'a str,
        }
        #[derive(Serialize)]
        struct Fields<'a> {
            findings: Vec<Row<'a>>,
            notes: Vec<Note<'a>>,
            files: &'a [PathBuf],
        }
        #[derive(Serialize)]
        struct Note<'a> {
            study: &'static str,
            text: &'a str,
        }
        let notes = self.notes.iter().map(|(name, text)| Note { study: name.as_str(), text }).collect();
        let row = |(name, finding): &'_ (StudyName, Finding)| -> (&'static str, f64) {
            (name.as_str(), finding.value)
        };
        let findings = self
            .findings
            .iter()
            .map(|entry| {
                let (study, value) = row(entry);
                Row { study, quantity: &entry.1.quantity, value, unit: entry.1.unit }
            })
            .collect();
        Fields { findings, notes, files: &self.files }.serialize(serializer)
    }
}

impl Report for StudyResult {
    fn schema(&self) -> Schema {
        Schema::first("kingpin.study")
    }

    fn parameters(&self) -> Parameters {
        // Otherwise every study has its own wheels; the quantities say which.
        self.wheel.as_ref().map_or_else(Parameters::default, |wheel| parameters_of(wheel, &[]))
    }

    fn write_table(&self, out: &mut dyn Write) -> io::Result<()> {
        if let Some(wheel) = &self.wheel {
            writeln!(out, "wheel at {}\n", description::on_lines(wheel, &[]))?;
        }
        let mut study = None;
        let mut table = Table::new(["", "", ""]);
        for (name, finding) in &self.findings {
            if study.is_some_and(|before| before != *name) {
                table.write(out)?;
                writeln!(out)?;
                table = Table::new(["", "", ""]);
            }
            if study != Some(*name) {
                writeln!(out, "{}: {}", name.as_str(), name.subject())?;
            }
            study = Some(*name);
            table.row([Cell::from(finding.quantity.clone()), finding.cell(), finding.unit.into()]);
        }
        table.write(out)?;
        for (name, note) in &self.notes {
            writeln!(out, "\n{}: {note}", name.as_str())?;
        }
        writeln!(out)?;
        self.files.iter().try_for_each(|file| writeln!(out, "{}", file.display()))
    }

    fn columns(&self) -> Columns {
        let findings = || self.findings.iter();
        Columns::new()
            .texts("study", findings().map(|(name, _)| Some(name.as_str().to_owned())))
            .texts("quantity", findings().map(|(_, finding)| Some(finding.quantity.clone())))
            .numbers("value", findings().map(|(_, finding)| finding.value))
            .texts("unit", findings().map(|(_, finding)| Some(finding.unit.to_owned())))
    }
}
