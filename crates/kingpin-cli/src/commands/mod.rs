//! The commands of `kingpin`.

pub mod basin;
pub mod chart;
pub mod cycles;
pub mod hopf;
pub mod margin;
pub mod paper;
pub mod safe_kick;
pub mod simulate;
mod sliding_history;
pub mod stability;
pub mod steady;
pub mod study;

use crate::error::Error;
use clap::{Parser, Subcommand};
use kingpin_terminal::Failure;

/// Finds out whether a towed wheel shimmies
///
/// A wheel on a caster is towed at constant speed along a circle or a straight line by an elastic king pin. The commands
/// compute its uniform motion, whether it is stable, and the oscillations that it can fall into.
#[derive(Debug, Parser)]
#[command(name = "kingpin", version, arg_required_else_help = true, max_term_width = 110)]
pub struct Kingpin {
    #[command(subcommand)]
    command: Command,
}

#[derive(Debug, Subcommand)]
enum Command {
    Paper(paper::Paper),
    Steady(steady::Steady),
    Stability(stability::Stability),
    Chart(chart::Chart),
    Hopf(hopf::Hopf),
    Cycles(cycles::Cycles),
    Simulate(simulate::Simulate),
    Study(study::StudyCommand),
    Basin(basin::Basin),
    SafeKick(safe_kick::SafeKick),
    Margin(margin::Margin),
}

impl Kingpin {
    /// Runs the command.
    ///
    /// # Errors
    /// Why it failed.
    pub fn run(&self) -> Result<(), Failure> {
        let outcome = match &self.command {
            Command::Paper(command) => command.run(),
            Command::Steady(command) => command.run(),
            Command::Stability(command) => command.run(),
            Command::Chart(command) => command.run(),
            Command::Hopf(command) => command.run(),
            Command::Cycles(command) => command.run(),
            Command::Simulate(command) => command.run(),
            Command::Study(command) => command.run(),
            Command::Basin(command) => command.run(),
            Command::SafeKick(command) => command.run(),
            Command::Margin(command) => command.run(),
        };
        outcome.map_err(|error| match error {
            Error::Terminal(failure) => failure,
            other => other.into(),
        })
    }
}
