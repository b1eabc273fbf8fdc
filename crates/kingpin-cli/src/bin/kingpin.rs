//! The towed wheel from the command line; `kingpin --help` says what it can do.

use clap::Parser;
use kingpin_cli::commands::Kingpin;
use kingpin_cli::terminal::say_failure;
use std::process::ExitCode;

fn main() -> ExitCode {
    match Kingpin::parse().run() {
        Ok(()) => ExitCode::SUCCESS,
        Err(failure) => {
            if failure.exit_code() != 0 {
                say_failure(&failure);
            }
            ExitCode::from(failure.exit_code())
        }
    }
}
