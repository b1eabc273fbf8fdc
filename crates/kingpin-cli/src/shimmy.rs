//! `kingpin shimmy`: large shimmy of a wheel that may slide or has a tyre, along a parameter.

use crate::wheel_options::{WheelOptions, parameter_help};
use arclength_analysis::{Interval, Values};
use clap::Args;
use kingpin_analysis::shimmy::ShimmyRequest;
use kingpin_terminal::{Failure, OutputOptions, ProgressDisplay, requested_values};

const EXAMPLE: &str =
    "kingpin shimmy --along v=7:9.6 -s F_Az=-100 -s c_u=0.1 -s c_q=0.1 -o shimmy.json -o shimmy.svg";

/// Large shimmy in which the wheel rolls and slides by turns, or swings on its tyre, along a parameter
///
/// At five values spread over the interval the wheel is kicked, from an angle of 1.2 rad down to 0.2 rad and by a blow. A motion that
/// settles on shimmy with sliding is refined to a periodic one and followed both ways, stable or not, through the changes of its
/// phases. With a tyre shimmy is a smooth cycle; a small release is tried too, and all different cycles are followed. What was tried is
/// told with --explain, and where nothing is found.
#[derive(Args, Debug)]
#[command(after_help = format!("Example: {EXAMPLE}"), after_long_help = parameter_help(EXAMPLE))]
pub(crate) struct Shimmy {
    /// Parameter and its interval; r may reach inf
    #[arg(long, value_name = "KEY=A:B")]
    along: Interval,

    /// Values of the parameter at which motions are wanted exactly
    #[arg(long, value_name = "[KEY=]A,B,..", allow_hyphen_values = true)]
    at: Vec<Values>,

    /// Most steps in one direction
    #[arg(long, value_name = "N", default_value_t = 500)]
    steps: u32,

    /// Tell what was tried after the table
    #[arg(long)]
    explain: bool,

    #[command(flatten)]
    wheel: WheelOptions,
    #[command(flatten)]
    output: OutputOptions,
}

impl Shimmy {
    /// Runs the command.
    ///
    /// # Errors
    /// Why it failed.
    pub(crate) fn run(&self) -> Result<(), Failure> {
        let output = self.output.prepare()?.explain(self.explain);
        let request = ShimmyRequest {
            wheel: self.wheel.request(),
            along: self.along.clone(),
            at: requested_values(&self.at, &self.along.key, |given, key| given == key)?,
            steps: self.steps,
        };
        let analysis = request.validate()?;
        let progress = ProgressDisplay::spinner("shimmy", output.is_quiet());
        let (result, interruption) = output.watch(progress, |control| analysis.run(control));
        let result = result?;
        output.warn_of(&result.warnings());
        output.deliver(&result)?;
        interruption.check_branch()
    }
}
