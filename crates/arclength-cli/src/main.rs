//! The program `arclength`: models in .ode files from the command line.

use std::process::ExitCode;

fn main() -> ExitCode {
    ExitCode::from(arclength_cli::run(std::env::args_os()))
}
