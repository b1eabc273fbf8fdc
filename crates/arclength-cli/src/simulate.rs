//! `arclength simulate`: a time history of a model.

use crate::model_options::ModelOptions;
use arclength_analysis::simulate::{IntegrationMethod, SimulateRequest};
use clap::{Args, ValueEnum};
use kingpin_terminal::{Failure, OutputOptions};

/// Time history from the initial state of the model
///
/// What is not said here is as the model says in its lines @.
#[derive(Args, Debug)]
#[command(after_help = "Example: arclength simulate model.ode --duration 100 --start x=1 -o history.svg")]
pub(crate) struct Simulate {
    #[command(flatten)]
    model: ModelOptions,

    /// How long the motion lasts [default: the model's @ total]
    #[arg(long, value_name = "T", allow_negative_numbers = true)]
    duration: Option<f64>,

    /// Number of samples, at equal distances to the end [default: one for every @ dt of the model, or 1001]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u64).range(SimulateRequest::POINTS))]
    points: Option<u64>,

    /// Time at which it starts [default: the model's @ t0, or 0]
    #[arg(long, value_name = "T", allow_negative_numbers = true)]
    t0: Option<f64>,

    /// Time before which there are no samples [default: the model's @ trans]
    #[arg(long, value_name = "T", allow_negative_numbers = true)]
    transient: Option<f64>,

    /// Magnitude of a state at which it stops [default: the model's @ bound]
    #[arg(long, value_name = "X")]
    bound: Option<f64>,

    /// Relative error allowed in a step; the absolute one is a hundredth of it, times the size of a state smaller than 0.01
    /// [default: the model's @ toler where that is smaller than 1e-10, or 1e-10]
    #[arg(long, value_name = "X")]
    tolerance: Option<f64>,

    /// Largest step. Switches on a state are located inside steps; a visit beyond one that is much shorter than a step, on a way that
    /// touches it, may be missed. What switches on the time is always met
    #[arg(long, value_name = "T")]
    max_step: Option<f64>,

    /// Method of integration; auto is the explicit one, and the implicit one where the model is stiff
    #[arg(long, value_enum, default_value = "auto")]
    method: Method,

    #[command(flatten)]
    output: OutputOptions,
}

/// Names of methods of integration.
#[derive(Clone, Copy, Debug, ValueEnum)]
enum Method {
    Auto,
    Explicit,
    Implicit,
}

impl From<Method> for IntegrationMethod {
    fn from(method: Method) -> Self {
        match method {
            Method::Auto => Self::Auto,
            Method::Explicit => Self::Explicit,
            Method::Implicit => Self::Implicit,
        }
    }
}

impl Simulate {
    /// Runs the command.
    ///
    /// # Errors
    /// Why it failed.
    pub(crate) fn run(&self) -> Result<(), Failure> {
        let output = self.output.prepare()?;
        let request = SimulateRequest {
            model: self.model.request()?,
            duration: self.duration,
            points: self.points,
            t0: self.t0,
            transient: self.transient,
            bound: self.bound,
            tolerance: self.tolerance,
            max_step: self.max_step,
            method: self.method.into(),
        };
        let analysis = request.validate()?;
        output.warn_of(analysis.warnings());
        let result = analysis.run()?;
        output.warn_of(&result.warnings);
        output.deliver(&result)
    }
}
