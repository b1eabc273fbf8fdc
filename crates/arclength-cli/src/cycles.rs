//! `arclength cycles`: a branch of limit cycles from a labelled point of an earlier result or from samples of an orbit.

use crate::model_options::ParameterOptions;
use arclength_analysis::cycles::CyclesRequest;
use arclength_analysis::{Along, CycleSource, ModelSource, Values};
use clap::Args;
use kingpin_terminal::{
    Failure, MeshOptions, MonitorOptions, OutputOptions, ProgressDisplay, StepOptions, requested_values,
};
use std::path::PathBuf;

/// Limit cycles along a parameter, from a point of an earlier result or from samples of an orbit
///
/// From a Hopf point (HB) the cycles that are born there are followed, from a period doubling (PD) the doubled ones, from a
/// branch point of cycles (BPC) the other branch, from any other cycle the branch through it, from the end (END) of a
/// time history the cycle on which it has settled, and from samples of an orbit the cycle nearest to them, stable or not.
#[derive(Args, Debug)]
#[command(
    after_help = "Example: arclength cycles --from equilibria.json:HB1 --along p=0:1 --at 0.5 -o cycles.json\n         \
                  arclength cycles model.ode --from orbit.csv -s p=0.5 --along p=0:1"
)]
pub(crate) struct Cycles {
    /// File of the model, with samples of an orbit only: a labelled point has its own
    #[arg(value_name = "MODEL.ode", help_heading = "Model")]
    model: Option<PathBuf>,

    /// Labelled point of a file that `equilibria`, `cycles` or `simulate` wrote, with its model and parameters; or samples
    /// of an orbit over one period: a line of names, among them t and all states, and rows of which the last repeats the
    /// first
    #[arg(long, value_name = "FILE.json:LABEL|FILE.csv")]
    from: CycleSource,

    /// Parameter and its interval [default: the model's @ parmin and parmax]
    #[arg(long, value_name = "KEY[=A:B]")]
    along: Along,

    /// Values of the parameter at which cycles are wanted exactly
    #[arg(long, value_name = "[KEY=]A,B,..", allow_hyphen_values = true)]
    at: Vec<Values>,

    /// Follow the branch of the labelled cycle itself, not the one that bifurcates there
    #[arg(long)]
    stay: bool,

    #[command(flatten)]
    monitors: MonitorOptions,

    /// Tell the story of the run after the table
    #[arg(long)]
    explain: bool,

    #[command(flatten)]
    parameters: ParameterOptions,
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
            from: self.from.clone(),
            model: self.model.clone().map(ModelSource::File),
            set: self.parameters.values()?,
            along: self.along.clone(),
            at: requested_values(&self.at, self.along.key(), str::eq_ignore_ascii_case)?,
            monitors: self.monitors.asked(),
            stay: self.stay,
            steps: self.steps.into(),
            mesh: self.mesh.into(),
        };
        let analysis = request.validate()?;
        output.warn_of(analysis.warnings());
        let progress = ProgressDisplay::spinner("cycles", output.is_quiet());
        let (result, interruption) = output.watch(progress, |control| analysis.run(control));
        let result = result?;
        output.warn_of(&result.warnings());
        output.deliver(&result)?;
        interruption.check_branch()
    }
}
