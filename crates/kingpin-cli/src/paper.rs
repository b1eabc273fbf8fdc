//! `kingpin paper`: the figures of the paper and a report on its statements.

use clap::Args;
use kingpin_analysis::paper::PaperRequest;
use kingpin_terminal::{Failure, Format, MOST_THREADS, Output, ProgressDisplay, start_threads};
use std::path::PathBuf;

/// Figures 2 to 6 of the paper with their data, and a report on what the paper says
#[derive(Args, Debug)]
#[command(after_help = "Example: kingpin paper --out paper")]
pub(crate) struct Paper {
    /// One figure only, 2 to 6
    #[arg(long, value_name = "N")]
    figure: Option<u8>,

    /// Folder for the files
    #[arg(short, long, value_name = "DIR", default_value_os_t = PaperRequest::default().out)]
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
    pub(crate) fn run(&self) -> Result<(), Failure> {
        start_threads(self.threads)?;
        let output = Output::new(self.format, &[], self.quiet, &[])?;
        let request = PaperRequest { figure: self.figure, out: self.out.clone() };
        let progress = ProgressDisplay::bar("paper", self.quiet);
        let (result, _) = output.watch(progress, |control| request.run(control));
        output.deliver(&result?)
    }
}
