//! The commands of `arclength`, for models in .ode files.

pub mod branch;
pub mod cycles;
pub mod equilibria;
pub mod locus;
pub mod model;
mod normal_form;
pub mod picture;
pub mod result_file;
pub mod show;
pub mod simulate;
mod start;
mod story;

use crate::failure::Failure;
use clap::{Parser, Subcommand};

/// Bifurcation analysis of models in XPPAUT's .ode files
///
/// Follows equilibria and limit cycles of ordinary differential equations along a parameter, and locates their
/// bifurcations. Result files hold the model and its parameters, so that every computation can start from a labelled point
/// of the one before, on any machine.
#[derive(Debug, Parser)]
#[command(name = "arclength", version, arg_required_else_help = true, max_term_width = 110)]
pub struct Arclength {
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
}

impl Arclength {
    /// Runs the command.
    ///
    /// # Errors
    /// Why it failed.
    pub fn run(&self) -> Result<(), Failure> {
        match &self.command {
            Command::Equilibria(command) => command.run(),
            Command::Cycles(command) => command.run(),
            Command::Locus(command) => command.run(),
            Command::Simulate(command) => command.run(),
            Command::Show(command) => command.run(),
        }
    }
}
