//! `kingpin paper`: the figures of the paper and a report on its statements.

use crate::folder_options::FolderOptions;
use clap::Args;
use kingpin_analysis::paper::PaperRequest;
use kingpin_terminal::{Failure, ProgressDisplay};
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

    #[command(flatten)]
    options: FolderOptions,
}

impl Paper {
    /// Runs the command.
    ///
    /// # Errors
    /// Why it failed.
    pub(crate) fn run(&self) -> Result<(), Failure> {
        let output = self.options.prepare()?;
        let request = PaperRequest { figure: self.figure, out: self.out.clone() };
        let progress = ProgressDisplay::bar("paper", output.is_quiet());
        let (result, _) = output.watch(progress, |control| request.run(control));
        output.deliver(&result?)
    }
}
