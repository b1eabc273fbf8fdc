//! Options of commands that write a folder of files, beside which folder.

use clap::Args;
use kingpin_terminal::{Failure, Format, MOST_THREADS, Output, start_threads};

/// How such a command runs and what it prints.
#[derive(Args, Clone, Debug)]
pub(crate) struct FolderOptions {
    /// Format of what is printed
    #[arg(long, value_enum, default_value_t)]
    format: Format,

    /// Number of threads; results do not depend on it [default: one per core]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=MOST_THREADS))]
    threads: Option<u16>,

    /// No progress
    #[arg(short, long)]
    quiet: bool,
}

impl FolderOptions {
    /// Starts the threads; what is printed goes to standard output.
    ///
    /// # Errors
    /// The threads cannot be started.
    pub(crate) fn prepare(&self) -> Result<Output, Failure> {
        start_threads(self.threads)?;
        Output::new(self.format, &[], self.quiet, &[])
    }
}
