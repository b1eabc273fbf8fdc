//! The program `arclength`: models in .ode files from the command line.

mod cycles;
mod equilibria;
mod locus;
mod model_options;
mod serve;
mod show;
mod simulate;

use clap::{Parser, Subcommand};
use kingpin_terminal::Failure;
use std::ffi::OsString;

/// Bifurcation analysis of models in XPPAUT's .ode files
///
/// Follows equilibria and limit cycles of ordinary differential equations along a parameter, and locates their
/// bifurcations. Result files hold the model and its parameters, so that every computation can start from a labelled point
/// of the one before, on any machine.
#[derive(Debug, Parser)]
#[command(name = "arclength", version, arg_required_else_help = true, max_term_width = 110)]
struct Arclength {
    #[command(subcommand)]
    command: Command,
}

#[derive(Debug, Subcommand)]
enum Command {
    Equilibria(equilibria::Equilibria),
    Cycles(cycles::Cycles),
    Locus(locus::Locus),
    Simulate(simulate::Simulate),
    Show(show::Show),
    Serve(serve::Serve),
}

impl Command {
    fn run(&self) -> Result<(), Failure> {
        match self {
            Self::Equilibria(command) => command.run(),
            Self::Cycles(command) => command.run(),
            Self::Locus(command) => command.run(),
            Self::Simulate(command) => command.run(),
            Self::Show(command) => command.run(),
            Self::Serve(command) => command.run(),
        }
    }
}

/// Runs the program with these arguments, of which the first is its name, and gives its exit code: 0 when it is done, 1 when the
/// computation failed, 2 for bad input. It listens to signals, starts threads and writes to the standard streams, as a process of
/// its own does; help and mistakes in the arguments may end the process.
pub fn run(arguments: impl IntoIterator<Item = OsString>) -> u8 {
    kingpin_terminal::run(arguments, |options: &Arclength| options.command.run())
}
