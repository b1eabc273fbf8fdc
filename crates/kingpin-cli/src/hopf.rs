//! `kingpin hopf`: Hopf points of the uniform motion along a parameter.

use crate::wheel_options::{WheelOptions, parameter_help};
use arclength_analysis::Interval;
use clap::Args;
use kingpin_analysis::hopf::HopfRequest;
use kingpin_terminal::{Failure, OutputOptions};

const EXAMPLE: &str = "kingpin hopf --along v=0.5:12 -s l=0.1";

/// Hopf points of the uniform motion along a parameter: where shimmy is born
#[derive(Args, Debug)]
#[command(after_help = format!("Example: {EXAMPLE}"), after_long_help = parameter_help(EXAMPLE))]
pub struct Hopf {
    /// Parameter and its interval; r may reach inf
    #[arg(long, value_name = "KEY=A:B")]
    along: Interval,

    #[command(flatten)]
    wheel: WheelOptions,
    #[command(flatten)]
    output: OutputOptions,
}

impl Hopf {
    /// Runs the command.
    ///
    /// # Errors
    /// Why it failed.
    pub fn run(&self) -> Result<(), Failure> {
        let output = self.output.prepare_without_picture()?;
        let request = HopfRequest { wheel: self.wheel.request(), along: self.along.clone() };
        output.deliver(&request.validate()?.run()?)
    }
}
