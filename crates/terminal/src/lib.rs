//! What the programs share: options, where results go, progress on standard error, Ctrl-C, and how a command fails.
//!
//! A command turns its options into a request, runs the analysis by [`Output::watch`], which shows progress and listens to
//! Ctrl-C, and hands the result to [`Output::deliver`].

mod exit;
mod failure;
mod interruption;
mod options;
mod output;
mod progress;
mod streams;

pub use exit::exit_code;
pub use failure::Failure;
pub use interruption::Interruption;
pub use options::{
    MOST_THREADS, MeshOptions, OutputOptions, PlaneOptions, StepOptions, requested_values, start_threads,
};
pub use output::{Format, Output};
pub use progress::ProgressDisplay;
pub use streams::{print, say};
