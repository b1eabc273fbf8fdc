//! `arclength equilibria`: a branch of equilibria of a model, from its initial state or from a labelled point.

use crate::model_options::ModelOptions;
use arclength_analysis::equilibria::EquilibriaRequest;
use arclength_analysis::{Along, Assignment, ModelRequest, Values};
use clap::Args;
use kingpin_terminal::{
    Failure, MonitorOptions, OutputOptions, ProgressDisplay, StepOptions, requested_values,
};

/// Equilibria along a parameter, with folds, branch points and Hopf points
///
/// Starts at the equilibrium near the initial state of the model, or at a labelled point of an earlier result: from a
/// branch point the other branch is followed, from any other point the branch through it.
#[derive(Args, Debug)]
#[command(after_help = "Example: arclength equilibria model.ode --along p=0:1 -o equilibria.json\n         \
                        arclength equilibria --from equilibria.json:BP1 --along p=0:1 -o other.json")]
pub(crate) struct Equilibria {
    #[command(flatten)]
    model: ModelOptions,

    /// Parameter and its interval [default: the model's @ parmin and parmax]
    #[arg(long, value_name = "KEY[=A:B]")]
    along: Along,

    /// Values of the parameter at which equilibria are wanted exactly
    #[arg(long, value_name = "[KEY=]A,B,..", allow_hyphen_values = true)]
    at: Vec<Values>,

    #[command(flatten)]
    monitors: MonitorOptions,

    /// Freeze the time of a model whose right-hand side depends on it
    #[arg(long, value_name = "t=VALUE")]
    freeze: Option<Assignment>,

    /// Tell the story of the run after the table
    #[arg(long)]
    explain: bool,

    #[command(flatten)]
    steps: StepOptions,
    #[command(flatten)]
    output: OutputOptions,
}

impl Equilibria {
    /// The time at which the right-hand side is frozen.
    fn freeze(&self) -> Result<Option<f64>, Failure> {
        let Some(asked) = &self.freeze else { return Ok(None) };
        let (name, value) = asked.number(&["freeze"])?;
        if name.eq_ignore_ascii_case("t") {
            return Ok(Some(value));
        }
        Err(Failure::Option {
            option: "--freeze",
            given: format!("{}={}", asked.key, asked.value),
            problem: "only the time can be frozen".to_owned(),
            allowed: "t=VALUE; a parameter stays at its value without being frozen".to_owned(),
        })
    }

    /// Runs the command.
    ///
    /// # Errors
    /// Why it failed.
    pub(crate) fn run(&self) -> Result<(), Failure> {
        let output = self.output.prepare()?.explain(self.explain);
        let request = EquilibriaRequest {
            model: ModelRequest { freeze: self.freeze()?, ..self.model.request()? },
            along: self.along.clone(),
            at: requested_values(&self.at, self.along.key(), str::eq_ignore_ascii_case)?,
            monitors: self.monitors.asked(),
            steps: self.steps.into(),
        };
        let analysis = request.validate()?;
        output.warn_of(analysis.warnings());
        let progress = ProgressDisplay::spinner("equilibria", output.is_quiet());
        let (result, interruption) = output.watch(progress, |control| analysis.run(control));
        let result = result?;
        output.warn_of(&result.warnings());
        output.deliver(&result)?;
        interruption.check_branch()
    }
}
