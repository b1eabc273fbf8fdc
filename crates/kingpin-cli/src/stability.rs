//! `kingpin stability`: eigenvalues of the uniform motion and its critical speed.

use crate::wheel_options::{WheelOptions, parameter_help};
use clap::Args;
use kingpin_analysis::stability::StabilityRequest;
use kingpin_terminal::{Failure, OutputOptions};

const EXAMPLE: &str = "kingpin stability -s v=9 -s l=0.08";

/// Linear stability of the uniform motion: eigenvalues and critical speed
#[derive(Args, Debug)]
#[command(after_help = format!("Example: {EXAMPLE}"), after_long_help = parameter_help(EXAMPLE))]
pub(crate) struct Stability {
    #[command(flatten)]
    wheel: WheelOptions,
    #[command(flatten)]
    output: OutputOptions,
}

impl Stability {
    /// Runs the command.
    ///
    /// # Errors
    /// Why it failed.
    pub(crate) fn run(&self) -> Result<(), Failure> {
        let output = self.output.prepare_without_picture()?;
        output.deliver(&StabilityRequest { wheel: self.wheel.request() }.run()?)
    }
}
