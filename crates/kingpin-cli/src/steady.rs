//! `kingpin steady`: the uniform motion at one parameter point.

use crate::wheel_options::{WheelOptions, parameter_help};
use clap::Args;
use kingpin_analysis::steady::SteadyRequest;
use kingpin_terminal::{Failure, OutputOptions};

const EXAMPLE: &str = "kingpin steady -s v=6 -s l=0.1 --format json";

/// Uniform motion of the wheel
#[derive(Args, Debug)]
#[command(after_help = format!("Example: {EXAMPLE}"), after_long_help = parameter_help(EXAMPLE))]
pub(crate) struct Steady {
    #[command(flatten)]
    wheel: WheelOptions,
    #[command(flatten)]
    output: OutputOptions,
}

impl Steady {
    /// Runs the command.
    ///
    /// # Errors
    /// Why it failed.
    pub(crate) fn run(&self) -> Result<(), Failure> {
        let output = self.output.prepare_without_picture()?;
        output.deliver(&SteadyRequest { wheel: self.wheel.request() }.run()?)
    }
}
