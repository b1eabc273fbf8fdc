//! The program `kingpin`: the towed wheel from the command line.

use std::process::ExitCode;

fn main() -> ExitCode {
    ExitCode::from(kingpin_cli::run(std::env::args_os()))
}
