//! `kingpin study`: what goes beyond the paper, each study with its figures, data and findings.

use crate::error::Error;
use kingpin_report::Columns;
use kingpin_report::{NamedNumbers, Schema};
use kingpin_terminal::{MOST_THREADS, start_threads};

use crate::studies::{Finding, Name, Study, write};
use arclength_analysis::Progress as Step;
use clap::Args;
use kingpin_report::Report;
use kingpin_report::{Cell, Table};
use kingpin_terminal::Progress;
use kingpin_terminal::{Format, Output};
use serde::Serialize;
use std::io::{self, Write};
use std::path::PathBuf;

/// Studies beyond the paper: damping, isola, sliding, basin, step-steer
#[derive(Args, Debug)]
#[command(after_help = "Example: kingpin study isola --out studies")]
pub struct StudyCommand {
    /// Which study; all writes the figures of all of them
    #[arg(value_enum, value_name = "NAME")]
    name: Selection,

    /// Folder for the figures and their data
    #[arg(short, long, value_name = "DIR", default_value = "studies")]
    out: PathBuf,

    /// Format in which the findings are told
    #[arg(long, value_enum, default_value_t)]
    format: Format,

    /// Number of threads; results do not depend on it [default: one per core]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=MOST_THREADS))]
    threads: Option<u16>,

    /// No progress
    #[arg(short, long)]
    quiet: bool,
}

/// One study or all of them.
#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum)]
enum Selection {
    /// How the stability boundary moves with the dampers, and when shimmy disappears
    Damping,
    /// Large oscillations that are detached from straight running
    Isola,
    /// Large stable shimmy of a wheel that rolls and slides in turn, and an animation of it
    Sliding,
    /// Where kicked wheels end
    Basin,
    /// Driving straight, then suddenly round a curve
    StepSteer,
    /// Every one
    All,
}

impl Selection {
    fn names(self) -> Vec<Name> {
        match self {
            Self::Damping => vec![Name::Damping],
            Self::Isola => vec![Name::Isola],
            Self::Sliding => vec![Name::Sliding],
            Self::Basin => vec![Name::Basin],
            Self::StepSteer => vec![Name::StepSteer],
            Self::All => Name::ALL.to_vec(),
        }
    }
}

impl StudyCommand {
    /// Runs the command. The files of a study are written as soon as it is finished.
    ///
    /// # Errors
    /// Why it failed.
    pub fn run(&self) -> Result<(), Error> {
        start_threads(self.threads)?;
        let output = Output::new(self.format, &[], self.quiet, &[])?;
        std::fs::create_dir_all(&self.out)
            .map_err(|source| kingpin_report::ReportError::Unwritable { path: self.out.clone(), source })?;
        let mut told = Findings { findings: Vec::new(), files: Vec::new() };
        for name in self.name.names() {
            let progress = Progress::bar(name.as_str(), self.quiet);
            let Study { findings, drawings, pictures } =
                name.compute(&|part| progress.show(Step::Done(part)))?;
            drop(progress);
            told.files.extend(write(&self.out, &drawings, &pictures)?);
            told.findings.extend(findings.into_iter().map(|finding| (name, finding)));
        }
        Ok(output.deliver(&told)?)
    }
}

/// What was found, and where the figures are.
#[derive(Debug)]
struct Findings {
    findings: Vec<(Name, Finding)>,
    files: Vec<PathBuf>,
}

impl Serialize for Findings {
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
            files: &'a [PathBuf],
        }
        let row =
            |(name, finding): &'_ (Name, Finding)| -> (&'static str, f64) { (name.as_str(), finding.value) };
        let findings = self
            .findings
            .iter()
            .map(|entry| {
                let (study, value) = row(entry);
                Row { study, quantity: &entry.1.quantity, value, unit: entry.1.unit }
            })
            .collect();
        Fields { findings, files: &self.files }.serialize(serializer)
    }
}

impl Report for Findings {
    fn schema(&self) -> Schema {
        Schema::first("kingpin.study")
    }

    fn parameters(&self) -> NamedNumbers {
        // Every study has its own wheels; the quantities say which.
        NamedNumbers::default()
    }

    fn write_table(&self, out: &mut dyn Write) -> io::Result<()> {
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
