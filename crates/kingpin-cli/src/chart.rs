//! `kingpin chart`: stability of the uniform motion over two parameters.

use crate::shard_options::{ShardOptions, run_shard};
use crate::wheel_options::{WheelOptions, parameter_help};
use arclength_analysis::{Assignment, SampledInterval};
use clap::Args;
use kingpin_analysis::chart::ChartRequest;
use kingpin_analysis::sharded::ShardedRequest;
use kingpin_terminal::{Failure, OutputOptions, ProgressDisplay};

const EXAMPLE: &str = "kingpin chart --x v=0.1:12:600 --y l=0.02:0.3:400 -o chart.svg";

/// Stability chart over any two parameters
#[derive(Args, Debug)]
#[command(after_help = format!("Example: {EXAMPLE}"), after_long_help = parameter_help(EXAMPLE))]
pub(crate) struct Chart {
    /// Parameter across, from A to B at N points
    #[arg(long, value_name = "KEY=A:B:N", default_value_t = ChartRequest::default().x)]
    x: SampledInterval,

    /// Parameter upwards, from A to B at N points
    #[arg(long, value_name = "KEY=A:B:N", default_value_t = ChartRequest::default().y)]
    y: SampledInterval,

    /// Draw the limits for several values of a third parameter; repeatable, for example --overlay r=0.5,1,3,inf
    #[arg(long, value_name = "KEY=A,B,C")]
    overlay: Vec<Assignment>,

    #[command(flatten)]
    shard: ShardOptions,

    #[command(flatten)]
    wheel: WheelOptions,
    #[command(flatten)]
    output: OutputOptions,
}

impl Chart {
    /// Runs the command.
    ///
    /// # Errors
    /// Why it failed.
    pub(crate) fn run(&self) -> Result<(), Failure> {
        let request = ChartRequest {
            wheel: self.wheel.request(),
            x: self.x.clone(),
            y: self.y.clone(),
            overlay: self.overlay.clone(),
        };
        if let Some(shard) = self.shard.shard {
            return run_shard(shard, &ShardedRequest::Chart(request), &self.output, "chart");
        }
        let analysis = request.validate()?;
        let output = self.output.prepare()?;
        output.warn_of(analysis.warnings());
        let progress = ProgressDisplay::bar("chart", output.is_quiet());
        let (result, _) = output.watch(progress, |control| analysis.run(control));
        output.deliver(&result?)
    }
}
