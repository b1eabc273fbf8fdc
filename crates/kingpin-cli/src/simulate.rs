//! `kingpin simulate`: a time history from the uniform motion with some states perturbed.

use crate::classification_options::ContactOption;
use crate::wheel_options::{WheelOptions, parameter_help};
use arclength_analysis::Assignment;
use clap::Args;
use kingpin_analysis::simulate::SimulateRequest;
use kingpin_report::NamedNumbers;
use kingpin_terminal::{Failure, OutputOptions, ProgressDisplay};

const EXAMPLE: &str = "kingpin simulate --duration 5 --perturb psi=0.1 -s v=8 -o history.svg";

/// Time history from the perturbed uniform motion
#[derive(Args, Debug)]
#[command(after_help = format!("Example: {EXAMPLE}"), after_long_help = parameter_help(EXAMPLE))]
pub(crate) struct Simulate {
    /// Time in s
    #[arg(long, value_name = "T", allow_negative_numbers = true)]
    duration: f64,

    /// Change a state (u, q, psi, V, Omega; with k_u = inf q, psi, Omega; with a tyre u, q, psi, V1, V2, Omega, y_t) at the
    /// start; repeatable
    #[arg(long, value_name = "KEY=DELTA", allow_hyphen_values = true)]
    perturb: Vec<Assignment>,

    /// Sideways blow in N s on the rim of the wheel, R ahead of its centre, at the start, as that of `safe-kick`
    #[arg(
        long,
        value_name = "N_S",
        allow_negative_numbers = true,
        default_value_t = 0.0,
        hide_default_value = true
    )]
    blow: f64,

    /// Number of samples, at equal distances from 0 to T
    #[arg(long, value_name = "N", default_value_t = SimulateRequest::default_points(), allow_negative_numbers = true,
          value_parser = clap::value_parser!(u64).range(SimulateRequest::POINTS))]
    points: u64,

    /// Whether the wheel may slide; then the states are u, q, psi, V1, V2, Omega, W, and V changes V1 and W
    #[arg(long, value_enum, default_value_t)]
    contact: ContactOption,

    #[command(flatten)]
    wheel: WheelOptions,
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
        let request = SimulateRequest {
            wheel: self.wheel.request(),
            duration: self.duration,
            perturb: NamedNumbers(self.perturb.iter().map(change).collect::<Result<_, _>>()?),
            blow: self.blow,
            points: self.points,
            contact: self.contact.into(),
        };
        let analysis = request.validate()?;
        let progress = ProgressDisplay::bar("motion", output.is_quiet());
        let (result, _) = output.watch(progress, |control| analysis.run(control));
        let result = result?;
        output.warn_of(&result.warnings());
        output.deliver(&result)
    }
}

/// The name of a state with its change; that it is finite is checked by the simulation.
fn change(perturbation: &Assignment) -> Result<(String, f64), Failure> {
    let change = perturbation.value.parse().map_err(|_| Failure::Option {
        option: "--perturb",
        given: format!("{}={}", perturbation.key, perturbation.value),
        problem: "the change is not a number".to_owned(),
        allowed: "a finite number in SI units".to_owned(),
    })?;
    Ok((perturbation.key.clone(), change))
}
