//! `arclength simulate`: a time history of a model.

use crate::model_options::ModelOptions;
use arclength_analysis::simulate::SimulateRequest;
use clap::Args;
use kingpin_terminal::{Failure, OutputOptions};

/// Time history from the initial state of the model
#[derive(Args, Debug)]
#[command(after_help = "Example: arclength simulate model.ode --duration 100 --start x=1 -o history.svg")]
pub(crate) struct Simulate {
    #[command(flatten)]
    model: ModelOptions,

    /// Time
    #[arg(long, value_name = "T", allow_negative_numbers = true)]
    duration: f64,

    /// Number of samples, at equal distances from 0 to T
    #[arg(long, value_name = "N", default_value_t = SimulateRequest::default_points(),
          value_parser = clap::value_parser!(u64).range(SimulateRequest::POINTS))]
    points: u64,

    #[command(flatten)]
    output: OutputOptions,
}

impl Simulate {
    /// Runs the command.
    ///
    /// # Errors
    /// Why it failed.
    pub(crate) fn run(&self) -> Result<(), Failure> {
        let output = self.output.prepare()?;
        let request =
            SimulateRequest { model: self.model.request()?, duration: self.duration, points: self.points };
        let analysis = request.validate()?;
        output.warn_of(analysis.warnings());
        output.deliver(&analysis.run()?)
    }
}
