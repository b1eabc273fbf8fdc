//! `kingpin margin`: the smallest disturbance that does not return along a parameter, beside the unstable limit cycle.

use crate::classification_options::ClassificationOptions;
use crate::disturbance_options::DisturbanceOptions;
use crate::shard_options::{ShardOptions, run_shard};
use crate::wheel_options::{WheelOptions, parameter_help};
use arclength_analysis::SampledInterval;
use clap::Args;
use kingpin_analysis::margin::MarginRequest;
use kingpin_analysis::sharded::ShardedRequest;
use kingpin_terminal::{Failure, OutputOptions, ProgressDisplay};

const EXAMPLE: &str = "kingpin margin --along v=1:8:15 --kind release-angle -o margin.svg";

/// Safe disturbances along a parameter, beside the amplitude of the unstable limit cycle
///
/// At each value the smallest disturbance that does not return is found as by `safe-kick`, in both directions. The paper takes
/// the amplitude of the unstable cycle for the size of the basin; the ratio of the two tells how good an indicator it is.
/// With --out every finished part, the value of the parameter, is kept in PATH.journal until the result is written, so that an interrupted run can be
/// resumed.
#[derive(Args, Debug)]
#[command(after_help = format!("Example: {EXAMPLE}"), after_long_help = parameter_help(EXAMPLE))]
pub(crate) struct Margin {
    /// Parameter, from A to B at N values
    #[arg(long, value_name = "KEY=A:B:N", default_value_t = MarginRequest::default().along)]
    along: SampledInterval,

    #[command(flatten)]
    disturbance: DisturbanceOptions,
    #[command(flatten)]
    classification: ClassificationOptions,

    /// Go on with the run that is kept in PATH.journal
    #[arg(long, conflicts_with = "shard")]
    resume: bool,

    #[command(flatten)]
    shard: ShardOptions,

    #[command(flatten)]
    wheel: WheelOptions,
    #[command(flatten)]
    output: OutputOptions,
}

impl Margin {
    /// Runs the command.
    ///
    /// # Errors
    /// Why it failed.
    pub(crate) fn run(&self) -> Result<(), Failure> {
        let request = MarginRequest {
            wheel: self.wheel.request(),
            along: self.along.clone(),
            disturbance: (&self.disturbance).into(),
            classification: (&self.classification).into(),
        };
        if let Some(shard) = self.shard.shard {
            return run_shard(shard, &ShardedRequest::Margin(request), &self.output, "margin");
        }
        let output = self.output.prepare()?;
        let analysis = request.validate()?;
        let journal = analysis.journal(output.first_file(), self.resume)?;
        if self.resume {
            let (done, parts) = (journal.finished().len(), analysis.parts());
            output.note(&format!("{done} of {parts} parts were finished"));
        }
        let progress = ProgressDisplay::bar("margin", output.is_quiet());
        let (result, _) = output.watch(progress, |control| analysis.run(control, &journal));
        output.deliver(&result?)?;
        Ok(journal.finish()?)
    }
}
