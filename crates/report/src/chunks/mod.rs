//! The folder of a computation that is divided into chunks, so that processes that know nothing of each other share it.
//!
//! `sweep.json` is the [`Plan`]: what is computed, at how many points, how many of them make a chunk. Whoever comes first writes it, all
//! others go by it. Each chunk is a Parquet file whose name is the hash of all that it depends on, with its own hash beside it in a
//! `.sha256` file as `sha256sum --check` reads it; both are written under other names, forced to the disk, and renamed. When all are there
//! they are put together, and `manifest.json` tells of each. The sweeps of the Python package `arclength` have the same folders.

mod canonical;
mod chunk;
mod error;
mod manifest;
mod plan;
mod published;
mod whole;

pub use error::ChunkError;
pub use plan::Plan;
