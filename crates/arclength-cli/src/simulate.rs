//! `arclength simulate`: a time history of a model.

use crate::model_options::ModelOptions;
use arclength_analysis::Interval;
use arclength_analysis::simulate::{IntegrationMethod, PlotRequest, SectionRequest, SimulateRequest};
use clap::{Args, ValueEnum};
use kingpin_terminal::{Failure, Format, OutputOptions};

/// Time history from the initial state of the model
///
/// What is not said here is as the model says in its lines @.
#[derive(Args, Debug)]
#[command(
    after_help = "Example: arclength simulate model.ode --duration 100 --start x=1 -o history.svg\n         \
                        arclength simulate model.ode --plot x,y --plot t,x,power -o motion.svg\n         \
                        arclength simulate model.ode --duration 5000 --section x=0:+ -o section.csv -o returns.svg"
)]
pub(crate) struct Simulate {
    #[command(flatten)]
    model: ModelOptions,

    /// How long the motion lasts [default: the model's @ total, or 20 as in XPPAUT]
    #[arg(long, value_name = "T", allow_negative_numbers = true)]
    duration: Option<f64>,

    /// Number of samples, at equal distances to the end [default: one for every @ dt of the model and one at the end, or 1001]
    #[arg(long, value_name = "N", allow_negative_numbers = true, value_parser = clap::value_parser!(u64).range(SimulateRequest::POINTS))]
    points: Option<u64>,

    /// Time at which it starts [default: where the motion ended that it goes on from if the model depends on the time, or
    /// the model's @ t0, or 0]
    #[arg(long, value_name = "T", allow_negative_numbers = true)]
    t0: Option<f64>,

    /// Time before which there are no samples [default: the model's @ trans]
    #[arg(long, value_name = "T", allow_negative_numbers = true)]
    transient: Option<f64>,

    /// Magnitude of a state at which it stops [default: the model's @ bound]
    #[arg(long, value_name = "X", allow_negative_numbers = true)]
    bound: Option<f64>,

    /// Relative error allowed in a step; the absolute one is a hundredth of it, times the size of a state smaller than 0.01
    /// [default: the model's @ toler where that is smaller than 1e-10, or 1e-10]
    #[arg(long, value_name = "X", allow_negative_numbers = true)]
    tolerance: Option<f64>,

    /// Largest step. Switches on a state are located inside steps; a visit beyond one that is much shorter than a step, on a way that
    /// touches it, may be missed. What switches on the time is always met; a smooth stimulus much shorter than a step may be missed
    /// [default: where the model depends on the time, five sampling times, of at least 1001 over the whole]
    #[arg(long, value_name = "T", allow_negative_numbers = true)]
    max_step: Option<f64>,

    /// Method of integration; auto is the explicit one, and the implicit one where the model is stiff
    #[arg(long, value_enum, default_value = "auto")]
    method: Method,

    /// What the picture shows; repeatable. Two states x,y: their phase plane (y over x), for a model of two states with nullclines,
    /// directions, equilibria and the manifolds of saddles. Other lists, as v,ica or t,x,y: each over the time. x:y: always y
    /// over x. Auxiliary quantities and expressions too
    #[arg(long, value_name = "X,Y|A,B,..|X:Y", allow_hyphen_values = true)]
    plot: Vec<PlotRequest>,

    /// Limits of axes of the picture [default: the model's @ xlo, xhi, ylo, yhi for what its @ xp, yp name, or what there is to see]
    #[arg(long, value_name = "KEY=A:B,..", value_delimiter = ',', requires = "plot")]
    window: Vec<Interval>,

    /// Samples at the crossings of a Poincaré section, as x=0 or "y-0.3", with :+ or :- in one direction only; the picture shows the
    /// return maps, or the crossings as --plot says
    #[arg(
        long,
        value_name = "EXPRESSION[=VALUE][:+|:-]",
        allow_hyphen_values = true,
        conflicts_with = "points"
    )]
    section: Option<SectionRequest>,

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
        if !self.plot.is_empty() && self.output.out.is_empty() && self.output.format != Format::Json {
            return Err(Failure::Option {
                option: "--plot",
                given: "without a file".to_owned(),
                problem: "nothing is drawn".to_owned(),
                allowed:
                    "with it --out FILE.svg, .png or .pdf, or JSON, which has the curves of phase planes"
                        .to_owned(),
            });
        }
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
            plots: self.plot.clone(),
            window: self.window.clone(),
            section: self.section.clone(),
        };
        let analysis = request.validate()?;
        output.warn_of(analysis.warnings());
        let result = analysis.run()?;
        output.warn_of(&result.warnings);
        output.deliver(&result)
    }
}
