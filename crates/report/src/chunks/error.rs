//! What can be wrong with the folder of a divided computation.

use crate::error::ReportError;
use std::path::PathBuf;

/// Why chunks could not be kept or put together.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum ChunkError {
    /// A file could not be read or written.
    #[error("{}: {source}", path.display())]
    File {
        /// The file.
        path: PathBuf,
        /// The cause.
        source: std::io::Error,
    },
    /// There is no plan in the folder.
    #[error("{}: there is no such file; allowed: a folder in which a command with --shard keeps its chunks", path.display())]
    NoPlan {
        /// Where it would be.
        path: PathBuf,
    },
    /// A plan that cannot be used.
    #[error("{}: {problem}; allowed: {allowed}", path.display())]
    Plan {
        /// The plan.
        path: PathBuf,
        /// What is wrong with it.
        problem: String,
        /// What is allowed.
        allowed: String,
    },
    /// A chunk of another computation.
    #[error("{}: it is a chunk of another computation than {plan} tells of; allowed: chunks of one computation, so move it away", path.display())]
    Stranger {
        /// The chunk.
        path: PathBuf,
        /// Name of the plan.
        plan: &'static str,
    },
    /// A chunk that was changed after it was written.
    #[error("{}: it is not what was written: {problem}; run --shard {shard} again, which computes it anew", path.display())]
    Damaged {
        /// The chunk.
        path: PathBuf,
        /// What is wrong with it.
        problem: String,
        /// The shard that it belongs to.
        shard: String,
    },
    /// Chunks that are not there.
    #[error("{}: {missing} of {count} chunks are not there, of {shards}; run that again", folder.display())]
    Missing {
        /// The folder.
        folder: PathBuf,
        /// How many are missing.
        missing: usize,
        /// Of how many.
        count: usize,
        /// The shards that they belong to, as options.
        shards: String,
    },
    /// A chunk that could not be written as Parquet.
    #[error(transparent)]
    Report(#[from] ReportError),
}

impl ChunkError {
    /// What an error with a file means.
    pub(super) fn file(path: impl Into<PathBuf>) -> impl FnOnce(std::io::Error) -> Self {
        let path = path.into();
        move |source| Self::File { path, source }
    }
}
