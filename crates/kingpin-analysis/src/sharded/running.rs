//! One shard: its chunks that are not there yet are computed into the folder.

use super::request::ShardedRequest;
use super::shard::Shard;
use crate::by_chunks::ByChunks;
use crate::computation::difference;
use crate::error::Error;
use arclength_analysis::Control;
use kingpin_report::Columns;
use kingpin_report::chunks::{ChunkError, Plan};
use serde_json::Value;
use std::ops::Range;
use std::path::Path;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Mutex, PoisonError};

/// What there is of a shard when it is done.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ShardResult {
    /// Its chunks.
    pub chunks: usize,
    /// How many of them were there before.
    pub were_there: usize,
}

impl ShardedRequest {
    /// Computes what is not there yet of a shard into a folder, which is made where there is none. What is worth knowing before is told to
    /// `warn`.
    ///
    /// # Errors
    /// What is wrong with the request; [`Error::Invalid`] where another computation, or another number of shards, is in the folder;
    /// [`Error::Chunks`]; [`Error::Interrupted`] where the control stops it.
    pub fn run_shard(
        &self,
        shard: Shard,
        folder: &Path,
        warn: impl FnOnce(&[String]),
        control: &Control<'_>,
    ) -> Result<ShardResult, Error> {
        match self {
            Self::Chart(request) => {
                let analysis = request.validate()?;
                warn(analysis.warnings());
                self.run(&analysis, shard, folder, control)
            }
            Self::Basin(request) => {
                let analysis = request.validate()?;
                warn(analysis.warnings());
                self.run(&analysis, shard, folder, control)
            }
            Self::Margin(request) => self.run(&request.validate()?, shard, folder, control),
        }
    }

    fn run(
        &self,
        analysis: &impl ByChunks,
        shard: Shard,
        folder: &Path,
        control: &Control<'_>,
    ) -> Result<ShardResult, Error> {
        let numbers = [analysis.points(), analysis.chunk(shard.of())?, shard.of()];
        let plan = Plan::in_folder(folder, &self.function(analysis.computation())?, numbers)?;
        check_is_the_same(&plan, analysis.computation(), shard)?;
        let chunks: Vec<usize> = plan.chunks_of(shard.number()).collect();
        let mut wanted = Vec::new();
        for &chunk in &chunks {
            if !plan.is_kept(chunk)? {
                wanted.push(chunk);
            }
        }
        let were_there = chunks.len() - wanted.len();
        let (lost, kept) = (Mutex::new(None::<ChunkError>), AtomicUsize::new(were_there));
        let keep = |index: usize, columns: &Columns| match plan.keep(wanted[index], columns) {
            Ok(()) => _ = kept.fetch_add(1, Ordering::Relaxed),
            // What cannot be kept need not be computed.
            Err(error) => {
                *lost.lock().unwrap_or_else(PoisonError::into_inner) = Some(error);
                control.stop().store(true, Ordering::Relaxed);
            }
        };
        let rows: Vec<Range<usize>> = wanted.iter().map(|&chunk| plan.rows(chunk)).collect();
        let outcome = analysis.compute(&rows, &keep, control);
        if let Some(error) = lost.into_inner().unwrap_or_else(PoisonError::into_inner) {
            return Err(error.into());
        }
        let done = kept.into_inner();
        match outcome {
            Err(error) if !matches!(error, Error::Stopped) => Err(error),
            _ if done < chunks.len() => Err(Error::Interrupted {
                done,
                parts: chunks.len(),
                kept: format!("kept in {}; the same command goes on", folder.display()),
            }),
            _ => Ok(ShardResult { chunks: chunks.len(), were_there }),
        }
    }
}

/// Refuses a folder in which there is something else.
fn check_is_the_same(plan: &Plan, computation: &Value, shard: Shard) -> Result<(), Error> {
    let kept = plan.function()["computation"].as_str().and_then(|text| serde_json::from_str(text).ok());
    let kept: Value = kept.unwrap_or(Value::Null);
    // As it is read back, so that only what differs is told.
    let asked: Value = serde_json::from_str(&computation.to_string()).unwrap_or(Value::Null);
    let refused = |problem: String, allowed: &str| {
        Err(Error::invalid(&["out"], plan.path().display().to_string(), problem, allowed))
    };
    if let Some(difference) = difference(&kept, &asked) {
        let problem = format!("it is the plan of another computation: {difference}");
        return refused(problem, "the same command, or another folder");
    }
    if plan.shards() != shard.of() {
        let problem =
            format!("the computation was divided into {} shards, now into {}", plan.shards(), shard.of());
        return refused(problem, "the same number of shards, or another folder");
    }
    Ok(())
}
