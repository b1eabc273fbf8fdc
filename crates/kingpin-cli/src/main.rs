//! The towed wheel from the command line; `kingpin --help` says what it can do.

use clap::Parser;
use kingpin_cli::commands::Kingpin;
use kingpin_terminal::exit_code;
use std::process::ExitCode;

fn main() -> ExitCode {
    exit_code(Kingpin::parse().run())
}
