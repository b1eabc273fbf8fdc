//! `kingpin study`: what goes beyond the paper, each study with its figures, data and findings.

use crate::folder_options::FolderOptions;
use crate::wheel_options::WheelOptions;
use clap::{Args, ValueEnum};
use kingpin_analysis::studies::{StudyName, StudyRequest};
use kingpin_terminal::{Failure, ProgressDisplay};
use std::path::PathBuf;

/// Studies beyond the paper: damping, isola, sliding, basin, step-steer
#[derive(Args, Debug)]
#[command(after_help = "Example: kingpin study isola --out studies")]
pub(crate) struct StudyCommand {
    /// Which study; all writes the figures of all of them
    #[arg(value_enum, value_name = "NAME")]
    name: Selection,

    /// Folder for the figures and their data
    #[arg(short, long, value_name = "DIR", default_value_os_t = StudyRequest::default().out)]
    out: PathBuf,

    #[command(flatten)]
    wheel: WheelOptions,
    #[command(flatten)]
    options: FolderOptions,
}

/// One study or all of them.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum Selection {
    /// How the stability boundary moves with the dampers, and when shimmy disappears
    Damping,
    /// Large oscillations that are detached from straight running
    Isola,
    /// Large stable shimmy of a wheel that rolls and slides in turn, and an animation of it
    Sliding,
    /// Where kicked wheels end
    Basin,
    /// Driving straight, then suddenly round a curve
    StepSteer,
    /// Every one
    All,
}

impl Selection {
    fn studies(self) -> Vec<StudyName> {
        match self {
            Self::Damping => vec![StudyName::Damping],
            Self::Isola => vec![StudyName::Isola],
            Self::Sliding => vec![StudyName::Sliding],
            Self::Basin => vec![StudyName::Basin],
            Self::StepSteer => vec![StudyName::StepSteer],
            Self::All => StudyName::ALL.to_vec(),
        }
    }
}

impl StudyCommand {
    /// Runs the command. The files of a study are written as soon as it is finished.
    ///
    /// # Errors
    /// Why it failed.
    pub(crate) fn run(&self) -> Result<(), Failure> {
        let output = self.options.prepare()?;
        let request =
            StudyRequest { studies: self.name.studies(), wheel: self.wheel.request(), out: self.out.clone() };
        let progress = ProgressDisplay::bar("study", output.is_quiet());
        let (result, _) = output.watch(progress, |control| request.run(control));
        output.deliver(&result?)
    }
}
