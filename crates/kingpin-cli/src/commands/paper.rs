//! `kingpin paper`: the figures of the paper and a report on its statements.

use crate::error::Error;
use kingpin_report::Columns;
use kingpin_report::{NamedNumbers, Schema};
use kingpin_terminal::{MOST_THREADS, start_threads};

use crate::paper::{PaperOptions, run};
use arclength_analysis::Progress as Step;
use clap::Args;
use kingpin_report::Report;
use kingpin_terminal::Progress;
use kingpin_terminal::{Format, Output};
use serde::Serialize;
use std::io::{self, Write};
use std::ops::ControlFlow;
use std::path::PathBuf;

/// Figures 2 to 6 of the paper with their data, and a report on what the paper says
#[derive(Args, Debug)]
#[command(after_help = "Example: kingpin paper --out paper")]
pub struct Paper {
    /// One figure only, 2 to 6
    #[arg(long, value_name = "N")]
    figure: Option<u8>,

    /// Folder for the files
    #[arg(short, long, value_name = "DIR", default_value = "paper")]
    out: PathBuf,

    /// Format in which the files are listed
    #[arg(long, value_enum, default_value_t)]
    format: Format,

    /// Number of threads; results do not depend on it [default: one per core]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=MOST_THREADS))]
    threads: Option<u16>,

    /// No progress
    #[arg(short, long)]
    quiet: bool,
}

impl Paper {
    /// Runs the command.
    ///
    /// # Errors
    /// Why it failed.
    pub fn run(&self) -> Result<(), Error> {
        start_threads(self.threads)?;
        let output = Output::new(self.format, &[], self.quiet, &[])?;
        let progress = Progress::bar("paper", self.quiet);
        let options = PaperOptions { figure: self.figure, out: self.out.clone() };
        let report = run(&options, &|part| {
            progress.show(Step::Done(part));
            ControlFlow::Continue(())
        })?;
        drop(progress);
        Ok(output.deliver(&FileList { files: report.files })?)
    }
}

/// The files that were written.
#[derive(Debug, Serialize)]
struct FileList {
    files: Vec<PathBuf>,
}

impl Report for FileList {
    fn schema(&self) -> Schema {
        Schema::first("kingpin.paper")
    }

    fn parameters(&self) -> NamedNumbers {
        // The figures say with what they were computed.
        NamedNumbers::default()
    }

    fn write_table(&self, out: &mut dyn Write) -> io::Result<()> {
        self.files.iter().try_for_each(|file| writeln!(out, "{}", file.display()))
    }

    fn columns(&self) -> Columns {
        Columns::new().texts("file", self.files.iter().map(|file| Some(file.display().to_string())))
    }
}
