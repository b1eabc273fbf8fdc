//! `arclength show`: result files as tables of their special points, and all of them in one diagram.

use arclength_analysis::diagram::diagram;
use arclength_analysis::{Error, ResultFile};
use clap::Args;
use kingpin_report::files::{self, Staged};
use kingpin_report::{PictureFormat, Report, ReportError};
use kingpin_terminal::{Failure, print, publish};
use std::io::{self, Write};
use std::path::PathBuf;

/// The special points of result files with their normal forms, from which computations can start
///
/// Several files of one model, along the same parameter or in the same two, are drawn in one diagram.
#[derive(Args, Debug)]
#[command(after_help = "Example: arclength show cycles.json\n         \
                        arclength show equilibria.json cycles.json -o diagram.svg")]
pub(crate) struct Show {
    /// Files that the other commands wrote
    #[arg(value_name = "FILE.json", required = true)]
    files: Vec<PathBuf>,

    /// Tell the story of every run after its table
    #[arg(long)]
    explain: bool,

    /// Draw everything in one diagram (.svg, .png, .pdf); repeatable
    #[arg(short, long, value_name = "PATH")]
    out: Vec<PathBuf>,

    /// With --out nothing on standard output
    #[arg(short, long)]
    quiet: bool,
}

impl Show {
    /// Runs the command.
    ///
    /// # Errors
    /// Why it failed.
    pub(crate) fn run(&self) -> Result<(), Failure> {
        let mut pictures = Vec::new();
        for path in &self.out {
            pictures.push((path.clone(), PictureFormat::of(path)?));
            files::check_writable(path)?;
        }
        let mut results = Vec::new();
        for (index, path) in self.files.iter().enumerate() {
            results.push(ResultFile::read(path).map_err(|problem| self.failure(index, problem))?);
        }
        if !self.out.is_empty() {
            let figure = diagram(&results).map_err(|(index, problem)| self.failure(index, problem))?;
            let stage = |(path, format): &(PathBuf, PictureFormat)| Staged::picture(&figure, path, *format);
            publish(pictures.iter().map(stage), self.quiet)?;
            if self.quiet {
                return Ok(());
            }
        }
        print(|out| {
            self.write(&results, out).map_err(|source| ReportError::Encoding { format: "text", source })
        })
    }

    fn failure(&self, index: usize, problem: String) -> Error {
        Error::ResultFile { path: self.files.get(index).cloned().unwrap_or_default(), problem }
    }

    fn write(&self, results: &[ResultFile], out: &mut dyn Write) -> io::Result<()> {
        for (index, result) in results.iter().enumerate() {
            if index > 0 {
                writeln!(out)?;
            }
            match result {
                ResultFile::Equilibria(result) => self.tell(result, out)?,
                ResultFile::Cycles(result) => self.tell(result, out)?,
                ResultFile::Locus(result) => self.tell(result, out)?,
                ResultFile::CycleLocus(result) => self.tell(result, out)?,
                ResultFile::History(result) => self.tell(result, out)?,
            }
        }
        Ok(())
    }

    fn tell<R: Report>(&self, result: &R, out: &mut dyn Write) -> io::Result<()> {
        result.write_table(out)?;
        match result.story().filter(|_| self.explain) {
            Some(story) => story.write(out),
            None => Ok(()),
        }
    }
}
