//! `kingpin steady`: the uniform motion at one parameter point, or along a parameter.

use crate::wheel_options::{WheelOptions, parameter_help};
use arclength_analysis::SampledInterval;
use clap::Args;
use kingpin_analysis::steady::SteadyRequest;
use kingpin_analysis::steady_along::SteadyAlongRequest;
use kingpin_terminal::{Failure, OutputOptions};

const EXAMPLE: &str = "kingpin steady -s v=6 -s l=0.1 --format json
         kingpin steady --along v=0.5:10:20 -o steady.svg";

/// Uniform motion of the wheel
#[derive(Args, Debug)]
#[command(after_help = format!("Example: {EXAMPLE}"), after_long_help = parameter_help(EXAMPLE))]
pub(crate) struct Steady {
    /// Parameter, from A to B at N values, in place of one parameter point
    #[arg(long, value_name = "KEY=A:B:N")]
    along: Option<SampledInterval>,

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
        let wheel = self.wheel.request();
        match &self.along {
            None => {
                let output = self.output.prepare_without_picture()?;
                output.deliver(&SteadyRequest { wheel }.run()?)
            }
            Some(along) => {
                let output = self.output.prepare()?;
                output.deliver(&SteadyAlongRequest { wheel, along: along.clone() }.run()?)
            }
        }
    }
}
