//! `kingpin cycles`: limit cycles from the Hopf points of an interval, a labelled point of an earlier result or samples of an orbit.

use crate::wheel_options::{WheelOptions, parameter_help};
use arclength_analysis::{CycleSource, Interval, Values};
use clap::Args;
use kingpin_analysis::cycles::CyclesRequest;
use kingpin_terminal::{
    Failure, MeshOptions, MonitorOptions, OutputOptions, ProgressDisplay, StepOptions, requested_values,
};

const EXAMPLE: &str = "kingpin cycles --along v=0.5:9 --at 1,2,4 -o cycles.json -o cycles.svg
         kingpin cycles --from cycles.json:AT3 --along r=1:inf";

/// Limit cycles along a parameter, from Hopf points, a labelled point of an earlier result or samples of an orbit
///
/// An expression of --monitor or --until may name the states, the parameters and friction_force, king_pin_force (N) and damper_power (W);
/// capital letters count: v is the towing speed, V that of the wheel.
#[derive(Args, Debug)]
#[command(after_help = format!("Example: {EXAMPLE}"), after_long_help = parameter_help(EXAMPLE))]
pub(crate) struct Cycles {
    /// Parameter and its interval; r may reach inf
    #[arg(long, value_name = "KEY=A:B")]
    along: Interval,

    /// Values of the parameter at which cycles are wanted exactly
    #[arg(long, value_name = "[KEY=]A,B,..", allow_hyphen_values = true)]
    at: Vec<Values>,

    /// Start from a labelled point of a file that `hopf`, `cycles` or `locus` wrote, with its wheel; or from samples of an
    /// orbit of the wheel over one period: a line of names, among them t and all states, and rows of which the last repeats
    /// the first
    #[arg(long, value_name = "FILE.json:LABEL|FILE.csv")]
    from: Option<CycleSource>,

    /// At a period doubling or a branch point follow the branch of the point itself, not the one that leaves there
    #[arg(long, requires = "from")]
    stay: bool,

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
    mesh: MeshOptions,
    #[command(flatten)]
    output: OutputOptions,
}

impl Cycles {
    /// Runs the command.
    ///
    /// # Errors
    /// Why it failed.
    pub(crate) fn run(&self) -> Result<(), Failure> {
        let output = self.output.prepare()?.explain(self.explain);
        let request = CyclesRequest {
            wheel: self.wheel.request(),
            along: self.along.clone(),
            at: requested_values(&self.at, &self.along.key, |given, key| given == key)?,
            from: self.from.clone(),
            stay: self.stay,
            monitors: self.monitors.asked(),
            steps: self.steps.into(),
            mesh: self.mesh.into(),
        };
        let analysis = request.validate()?;
        output.warn_of(&analysis.warnings());
        let progress = ProgressDisplay::spinner("cycles", output.is_quiet());
        let (result, interruption) = output.watch(progress, |control| analysis.run(control));
        let result = result?;
        output.warn_of(&result.warnings());
        output.deliver(&result)?;
        interruption.check_branch()
    }
}
