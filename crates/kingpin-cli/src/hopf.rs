//! `kingpin hopf`: Hopf points of the uniform motion along a parameter.

use crate::wheel_options::{WheelOptions, parameter_help};
use arclength_analysis::Interval;
use clap::Args;
use kingpin_analysis::hopf::HopfRequest;
use kingpin_terminal::{Failure, MonitorOptions, OutputOptions, ProgressDisplay, StepOptions};

const EXAMPLE: &str = "kingpin hopf --along v=0.5:12 -s l=0.1";

/// Hopf points of the uniform motion along a parameter: where shimmy is born
///
/// An expression of --monitor or --until may name the states, the parameters and friction_force, king_pin_force (N) and damper_power (W);
/// capital letters count: v is the towing speed, V that of the wheel.
#[derive(Args, Debug)]
#[command(after_help = format!("Example: {EXAMPLE}"), after_long_help = parameter_help(EXAMPLE))]
pub(crate) struct Hopf {
    /// Parameter and its interval; r may reach inf
    #[arg(long, value_name = "KEY=A:B")]
    along: Interval,

    #[command(flatten)]
    monitors: MonitorOptions,

    /// Tell the story of the run after the table
    #[arg(long)]
    explain: bool,

    #[command(flatten)]
    wheel: WheelOptions,
    #[command(flatten)]
    steps: StepOptions,
    #[command(flatten)]
    output: OutputOptions,
}

impl Hopf {
    /// Runs the command.
    ///
    /// # Errors
    /// Why it failed.
    pub(crate) fn run(&self) -> Result<(), Failure> {
        let output = self.output.prepare_without_picture()?.explain(self.explain);
        let request = HopfRequest {
            wheel: self.wheel.request(),
            along: self.along.clone(),
            monitors: self.monitors.asked(),
            steps: self.steps.into(),
        };
        let analysis = request.validate()?;
        let progress = ProgressDisplay::spinner("uniform motions", output.is_quiet());
        let (result, interruption) = output.watch(progress, |control| analysis.run(control));
        let result = result?;
        output.warn_of(&result.warnings());
        output.deliver(&result)?;
        interruption.check_branch()
    }
}
