//! Analyses over many points that processes share which know nothing of each other, such as the jobs of an array: each computes its
//! shard into a folder, and what is there is put together to the very result of a single process.
//!
//! A chunk that is there as it was written is not computed again, so a shard that was stopped or killed goes on when it is run again.

mod merging;
mod request;
mod running;
mod shard;

pub use merging::Merged;
pub use request::ShardedRequest;
pub use running::ShardResult;
pub use shard::{InvalidShard, Shard};
