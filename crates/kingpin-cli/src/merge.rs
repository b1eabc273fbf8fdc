//! `kingpin merge`: shards put together.

use clap::Args;
use kingpin_analysis::sharded::Merged;
use kingpin_terminal::{Failure, OutputOptions, ProgressDisplay};
use std::path::PathBuf;

const EXAMPLE: &str = "kingpin basin -s v=6 --shard 1/2 --out cells
         kingpin basin -s v=6 --shard 2/2 --out cells
         kingpin merge cells -o basin.png -o basin.parquet";

/// Put together what chart, basin or margin has computed by --shard
///
/// The result is that of the same command in one process, to the last byte. Chunks that are not there are told by their shards; chunks that
/// were changed, or are those of another computation, are refused.
#[derive(Args, Debug)]
#[command(after_help = format!("Example: {EXAMPLE}"))]
pub(crate) struct Merge {
    /// Folder of the chunks
    #[arg(value_name = "FOLDER")]
    folder: PathBuf,

    #[command(flatten)]
    output: OutputOptions,
}

impl Merge {
    /// Runs the command.
    ///
    /// # Errors
    /// Why it failed.
    pub(crate) fn run(&self) -> Result<(), Failure> {
        let output = self.output.prepare()?;
        let progress = ProgressDisplay::bar("merge", output.is_quiet());
        let (merged, _) = output.watch(progress, |control| Merged::of_folder(&self.folder, control));
        match merged? {
            Merged::Chart(result) => output.deliver(&*result),
            Merged::Basin(result) => output.deliver(&*result),
            Merged::Margin(result) => output.deliver(&*result),
        }
    }
}
