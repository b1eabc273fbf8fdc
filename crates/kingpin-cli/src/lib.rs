//! The program `kingpin`: the towed wheel from the command line.

mod basin;
mod chart;
mod classification_options;
mod cycles;
mod damper;
mod disturbance_options;
mod fit;
mod folder_options;
mod hopf;
mod locus;
mod margin;
mod merge;
mod paper;
mod report;
mod safe_kick;
mod serve;
mod shard_options;
mod shimmy;
mod simulate;
mod stability;
mod steady;
mod study;
mod wheel_options;

use clap::{Parser, Subcommand};
use kingpin_terminal::Failure;
use std::ffi::OsString;

/// Finds out whether a towed wheel shimmies
///
/// A wheel on a caster is towed at constant speed along a circle or a straight line by an elastic king pin. The commands
/// compute its uniform motion, whether it is stable, and the oscillations that it can fall into.
#[derive(Debug, Parser)]
#[command(name = "kingpin", version, arg_required_else_help = true, max_term_width = 110)]
struct Kingpin {
    #[command(subcommand)]
    command: Command,
}

#[derive(Debug, Subcommand)]
enum Command {
    Paper(paper::Paper),
    Report(report::ReportCommand),
    Steady(steady::Steady),
    Stability(stability::Stability),
    Chart(chart::Chart),
    Hopf(hopf::Hopf),
    Cycles(cycles::Cycles),
    Locus(locus::Locus),
    Shimmy(shimmy::Shimmy),
    Simulate(simulate::Simulate),
    Study(study::StudyCommand),
    Basin(basin::Basin),
    SafeKick(safe_kick::SafeKick),
    Margin(margin::Margin),
    Merge(merge::Merge),
    Damper(damper::Damper),
    Fit(fit::Fit),
    Serve(serve::Serve),
}

impl Command {
    fn run(&self) -> Result<(), Failure> {
        match self {
            Self::Paper(command) => command.run(),
            Self::Report(command) => command.run(),
            Self::Steady(command) => command.run(),
            Self::Stability(command) => command.run(),
            Self::Chart(command) => command.run(),
            Self::Hopf(command) => command.run(),
            Self::Cycles(command) => command.run(),
            Self::Locus(command) => command.run(),
            Self::Shimmy(command) => command.run(),
            Self::Simulate(command) => command.run(),
            Self::Study(command) => command.run(),
            Self::Basin(command) => command.run(),
            Self::SafeKick(command) => command.run(),
            Self::Margin(command) => command.run(),
            Self::Merge(command) => command.run(),
            Self::Damper(command) => command.run(),
            Self::Fit(command) => command.run(),
            Self::Serve(command) => command.run(),
        }
    }
}

/// Runs the program with these arguments, of which the first is its name, and gives its exit code: 0 when it is done, 1 when the
/// computation failed, 2 for bad input. It listens to signals, starts threads and writes to the standard streams, as a process of
/// its own does; help and mistakes in the arguments may end the process.
pub fn run(arguments: impl IntoIterator<Item = OsString>) -> u8 {
    kingpin_terminal::run(arguments, |options: &Kingpin| options.command.run())
}
