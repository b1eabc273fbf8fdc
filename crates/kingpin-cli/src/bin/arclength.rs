//! Models in .ode files from the command line; `arclength --help` says what it can do.

use clap::Parser;
use kingpin_cli::models::Arclength;
use kingpin_cli::terminal::exit_code;
use std::process::ExitCode;

fn main() -> ExitCode {
    exit_code(Arclength::parse().run())
}
