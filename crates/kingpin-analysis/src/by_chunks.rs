//! What an analysis over many points is, of which any part can be computed by itself, for processes that know nothing of each other.

use crate::error::Error;
use arclength_analysis::Control;
use kingpin_report::{Columns, Report};
use serde_json::Value;
use std::ops::Range;

/// Fewest chunks for each shard where there are enough points: what takes longer at some of them is spread.
const CHUNKS_OF_A_SHARD: usize = 4;

/// Takes a finished chunk by its index among those that are asked for.
pub(crate) type Keep<'a> = &'a (dyn Fn(usize, &Columns) + Sync);

/// An analysis whose points are computed by chunks. The same numbers come out however they are divided.
pub(crate) trait ByChunks {
    /// The result of all points.
    type Result: Report;

    /// What tells it from any other.
    fn computation(&self) -> &Value;

    /// Number of points.
    fn points(&self) -> usize;

    /// Number of points of a chunk where so many shards share them.
    ///
    /// # Errors
    /// No uniform motion.
    fn chunk(&self, shards: usize) -> Result<usize, Error>;

    /// Computes chunks, and hands each over as soon as it is known, until all are or the control stops it.
    ///
    /// # Errors
    /// What cannot be computed; [`Error::Stopped`] or nothing where the control stops it.
    fn compute(&self, chunks: &[Range<usize>], keep: Keep<'_>, control: &Control<'_>) -> Result<(), Error>;

    /// The result of all points in their order; nothing where they are not those of such an analysis.
    ///
    /// # Errors
    /// [`Error::Stopped`] where the control stops it.
    fn put_together(&self, columns: &Columns, control: &Control<'_>) -> Result<Option<Self::Result>, Error>;
}

/// How many of the things of which there are so many make a chunk.
pub(crate) fn in_a_chunk(count: usize, most: usize, shards: usize) -> usize {
    (count / CHUNKS_OF_A_SHARD.saturating_mul(shards)).clamp(1, most.max(1))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn there_is_work_for_every_shard_and_no_chunk_is_too_large() {
        assert_eq!(in_a_chunk(33_840, 65_536, 10), 846);
        assert_eq!(in_a_chunk(10_000_000, 65_536, 10), 65_536);
        assert_eq!(in_a_chunk(3, 65_536, 10), 1);
        assert_eq!(in_a_chunk(3, 0, usize::MAX), 1);
    }
}
