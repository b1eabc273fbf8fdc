//! `kingpin report`: everything about a wheel on one page.

use crate::folder_options::FolderOptions;
use crate::wheel_options::{WheelOptions, parameter_help};
use arclength_analysis::Assignment;
use clap::Args;
use kingpin_analysis::report::ReportRequest;
use kingpin_terminal::{Failure, ProgressDisplay};
use std::path::PathBuf;

const EXAMPLE: &str = "kingpin report --wheel trolley.toml --up-to v=3 --out report";

/// Report on your wheel: whether it shimmies, what blow starts it, what damper it takes
///
/// A verdict in one sentence; then its stability straight and on a circle (its own, or 2 m), up to which speed it rolls, what dry friction
/// about the king pin does, the dampers with which it is stable at every speed, its limit cycles, also with other caster lengths and on other
/// circles, the shimmy that remains where it may slide, and the smallest sideways blow from which it does not return, rolling and sliding,
/// at its own speed and over the speed; with pictures, their data, and how each statement was checked.
#[derive(Args, Debug)]
#[command(after_help = format!("Example: {EXAMPLE}"), after_long_help = parameter_help(EXAMPLE))]
pub(crate) struct ReportCommand {
    /// Largest speed that is looked at [default: twice that of the wheel, or 1.2 times a critical speed that is not far]
    #[arg(long, value_name = "v=VALUE")]
    up_to: Option<Assignment>,

    /// Folder for the files
    #[arg(short, long, value_name = "DIR", default_value_os_t = ReportRequest::default().out)]
    out: PathBuf,

    #[command(flatten)]
    options: FolderOptions,

    #[command(flatten)]
    wheel: WheelOptions,
}

impl ReportCommand {
    /// Runs the command.
    ///
    /// # Errors
    /// Why it failed.
    pub(crate) fn run(&self) -> Result<(), Failure> {
        let output = self.options.prepare()?;
        let request =
            ReportRequest { wheel: self.wheel.request(), up_to: self.up_to.clone(), out: self.out.clone() };
        let analysis = request.validate()?;
        let progress = ProgressDisplay::bar("report", output.is_quiet());
        let (result, _) = output.watch(progress, |control| analysis.run(control));
        output.deliver(&result?)
    }
}
