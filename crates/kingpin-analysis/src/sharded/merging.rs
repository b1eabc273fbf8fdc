//! Shards put together: the result of a single process, with all that follows from the points.

use super::request::ShardedRequest;
use crate::basin::BasinResult;
use crate::by_chunks::ByChunks;
use crate::chart::ChartResult;
use crate::computation::difference;
use crate::error::Error;
use crate::margin::MarginResult;
use arclength_analysis::Control;
use kingpin_report::chunks::Plan;
use serde_json::Value;
use std::path::Path;

/// The result of shards.
#[derive(Debug)]
pub enum Merged {
    /// A stability chart.
    Chart(Box<ChartResult>),
    /// Where motions end.
    Basin(Box<BasinResult>),
    /// Safe disturbances along a parameter.
    Margin(Box<MarginResult>),
}

impl Merged {
    /// Puts together the chunks in a folder.
    ///
    /// # Errors
    /// [`Error::Chunks`] where chunks are missing, damaged, or those of another computation; [`Error::Invalid`] where another version has
    /// computed them; [`Error::Stopped`] where the control stops it.
    pub fn of_folder(folder: &Path, control: &Control<'_>) -> Result<Self, Error> {
        let plan = Plan::read(folder)?;
        let Some(found) = ShardedRequest::of_function(plan.function()) else {
            return Err(refused(&plan, "it tells of no computation of this program"));
        };
        let (request, wheel) = found?;
        Ok(match request {
            ShardedRequest::Chart(request) => {
                Self::Chart(Box::new(put_together(&plan, &request.validate_for(wheel)?, control)?))
            }
            ShardedRequest::Basin(request) => {
                Self::Basin(Box::new(put_together(&plan, &request.validate_for(wheel)?, control)?))
            }
            ShardedRequest::Margin(request) => {
                Self::Margin(Box::new(put_together(&plan, &request.validate_for(wheel)?, control)?))
            }
        })
    }
}

fn put_together<A: ByChunks>(plan: &Plan, analysis: &A, control: &Control<'_>) -> Result<A::Result, Error> {
    let parsed = |text: &str| serde_json::from_str::<Value>(text).unwrap_or(Value::Null);
    let kept = plan.function()["computation"].as_str().map(parsed).unwrap_or_default();
    if let Some(difference) = difference(&kept, &parsed(&analysis.computation().to_string())) {
        return Err(refused(plan, &format!("its computation would be another one now: {difference}")));
    }
    let columns = plan.put_together()?;
    let whole = analysis.put_together(&columns, control)?;
    whole.ok_or_else(|| refused(plan, "its chunks have other columns than the computation"))
}

fn refused(plan: &Plan, problem: &str) -> Error {
    let allowed = "a folder in which this version of the program keeps its chunks by --shard";
    Error::invalid(&["folder"], plan.path().display().to_string(), problem, allowed)
}
