//! What the programs share: options, where results go, progress on standard error, signals, and how a command fails.
//!
//! A program is one call of [`run`]. A command turns its options into a request, runs the analysis by [`Output::watch`], which
//! shows progress and lets a signal stop it, and hands the result to [`Output::deliver`].

mod exit;
mod failure;
mod interruption;
mod monitor_options;
mod options;
mod output;
mod progress;
mod serve;
mod shortened;
mod signals;
mod streams;

pub use exit::run;
pub use failure::Failure;
pub use interruption::Interruption;
pub use monitor_options::MonitorOptions;
pub use options::{
    MOST_THREADS, MeshOptions, OutputOptions, PlaneOptions, StepOptions, requested_values, start_threads,
};
pub use output::{Format, Output, publish};
pub use progress::ProgressDisplay;
pub use serve::ServeOptions;
pub use streams::{print, say};
