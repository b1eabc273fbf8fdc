//! The option that divides a command among processes that know nothing of each other.

use clap::Args;
use kingpin_analysis::sharded::{Shard, ShardedRequest};
use kingpin_report::numbers::counted;
use kingpin_terminal::{Failure, Output, OutputOptions, ProgressDisplay, start_threads};
use std::path::Path;

/// Which part is computed.
#[derive(Args, Clone, Copy, Debug)]
pub(crate) struct ShardOptions {
    /// Compute the I-th of N shards only, as one job of an array, into the folder that --out names; `kingpin merge` puts them together.
    /// What is there already is not computed again
    #[arg(long, value_name = "I/N", requires = "out")]
    pub shard: Option<Shard>,
}

/// Runs a shard of a command.
///
/// # Errors
/// Why it failed.
pub(crate) fn run_shard(
    shard: Shard,
    request: &ShardedRequest,
    options: &OutputOptions,
    what: &'static str,
) -> Result<(), Failure> {
    let folder = folder_of(options)?;
    start_threads(options.threads)?;
    // Its files are the chunks.
    let output = Output::new(options.format, &[], options.quiet, &[])?;
    let progress = ProgressDisplay::bar(what, output.is_quiet());
    let warn = |warnings: &[String]| output.warn_of(warnings);
    let (result, _) = output.watch(progress, |control| request.run_shard(shard, folder, warn, control));
    let result = result?;
    let chunks = counted(result.chunks, "chunk", "chunks");
    let before = result.were_there;
    output.note(&format!(
        "shard {shard}: {chunks} in {}, of which {before} were there before",
        folder.display()
    ));
    Ok(())
}

/// The folder of the chunks.
fn folder_of(options: &OutputOptions) -> Result<&Path, Failure> {
    match options.out.as_slice() {
        [folder] => Ok(folder),
        several => Err(Failure::Option {
            option: "--out",
            given: several.iter().map(|path| path.display().to_string()).collect::<Vec<_>>().join(" and "),
            problem: "with --shard the chunks go into one folder".to_owned(),
            allowed: "one folder; `kingpin merge` writes files of every format from it".to_owned(),
        }),
    }
}
