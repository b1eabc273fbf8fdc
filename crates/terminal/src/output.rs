//! Where results go: to standard output in one format, and to files whose endings say theirs.

use crate::failure::Failure;
use crate::interruption::Interruption;
use crate::progress::ProgressDisplay;
use crate::streams::{print, say};
use arclength_analysis::Control;
use clap::ValueEnum;
use kingpin_report::files::{self, Staged};
use kingpin_report::{FileFormat, Report, ReportError, json};
use std::path::{Path, PathBuf};

/// Formats of standard output.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, ValueEnum)]
pub enum Format {
    /// For people.
    #[default]
    Table,
    /// One object.
    Json,
    /// Rows with a line of names.
    Csv,
}

/// Where the result of one command goes.
#[derive(Debug)]
pub struct Output {
    format: Format,
    files: Vec<(PathBuf, FileFormat)>,
    quiet: bool,
    explain: bool,
}

impl Output {
    /// Checks, before anything is computed, that the endings are allowed and the folders can be written to.
    ///
    /// # Errors
    /// [`ReportError::UnknownEnding`] and [`ReportError::Unwritable`].
    pub fn new(
        format: Format,
        paths: &[PathBuf],
        quiet: bool,
        allowed: &[FileFormat],
    ) -> Result<Self, Failure> {
        let mut files = Vec::new();
        for path in paths {
            let ending = FileFormat::of(path, allowed)?;
            files::check_writable(path)?;
            files.push((path.clone(), ending));
        }
        Ok(Self { format, files, quiet, explain: false })
    }

    /// Tells the story of the run after the table too, where that is wanted.
    pub fn explain(self, explain: bool) -> Self {
        Self { explain, ..self }
    }

    /// The first of the files.
    pub fn first_file(&self) -> Option<&Path> {
        self.files.first().map(|(path, _)| path.as_path())
    }

    /// Whether progress and warnings are unwanted.
    pub fn is_quiet(&self) -> bool {
        self.quiet
    }

    /// Warns on standard error.
    pub fn warn(&self, message: &str) {
        if !self.quiet {
            say("warning", message);
        }
    }

    /// Warns of several things on standard error.
    pub fn warn_of(&self, messages: &[String]) {
        messages.iter().for_each(|message| self.warn(message));
    }

    /// Says something worth knowing on standard error.
    pub fn note(&self, message: &str) {
        if !self.quiet {
            say("note", message);
        }
    }

    /// Runs an analysis under a control: its progress is shown, and a signal stops it. What it is about is said beside the
    /// progress.
    pub fn watch<T>(
        &self,
        progress: ProgressDisplay,
        analysis: impl FnOnce(&Control<'_>) -> T,
    ) -> (T, Interruption) {
        let interruption = Interruption::of_analysis();
        let outcome = analysis(&Control::new(interruption.flag(), &|reached| progress.show(reached)));
        drop(progress);
        interruption.analysis_has_ended();
        (outcome, interruption)
    }

    /// Warns of what is worth knowing of the parameters, writes the files, all or none, then standard output; the latter not where there are files and quiet was asked for.
    ///
    /// # Errors
    /// What the writers say.
    pub fn deliver<R: Report>(&self, result: &R) -> Result<(), Failure> {
        self.deliver_with(result, None)
    }

    /// The same with other files beside them.
    ///
    /// # Errors
    /// What the writers say.
    pub fn deliver_with<R: Report>(
        &self,
        result: &R,
        others: impl IntoIterator<Item = Result<Staged, ReportError>>,
    ) -> Result<(), Failure> {
        self.warn_of(&result.parameters().remarks);
        let stage = |(path, format): &(PathBuf, FileFormat)| Staged::result(result, path, *format);
        publish(self.files.iter().map(stage).chain(others), self.quiet)?;
        if self.quiet && !self.files.is_empty() {
            return Ok(());
        }
        let encoding = |format| move |source| ReportError::Encoding { format, source };
        print(|out| match self.format {
            Format::Table => result
                .write_table(out)
                .and_then(|()| match result.story().filter(|_| self.explain) {
                    Some(story) => story.write(out),
                    None => Ok(()),
                })
                .map_err(encoding("text")),
            Format::Json => json::write(result, out),
            Format::Csv => result.columns().write_csv(out).map_err(encoding("CSV")),
        })
    }
}

/// Gives files their places when all of them are complete, and tells which unless that is unwanted.
///
/// # Errors
/// What the writers say; then, as long as none has its place, no file is left behind.
pub fn publish(
    staged: impl Iterator<Item = Result<Staged, ReportError>>,
    quiet: bool,
) -> Result<(), Failure> {
    let complete = staged.collect::<Result<Vec<_>, _>>().map_err(Failure::of_output)?;
    for file in complete {
        let path = file.path().to_owned();
        file.publish().map_err(Failure::of_output)?;
        if !quiet {
            say("wrote", &path.display().to_string());
        }
    }
    Ok(())
}
