//! `arclength show`: result files as tables of their special points, and all of them in one diagram.

use super::picture::{self, Curve};
use super::result_file::ResultFile;
use crate::failure::Failure;
use crate::output::write_pictures;
use crate::report::Report;
use crate::terminal;
use clap::Args;
use kingpin_figure::Figure;
use std::io::{self, Write};
use std::path::PathBuf;

/// The special points of result files with their normal forms, from which computations can start
///
/// Several files of one model, along the same parameter or in the same two, are drawn in one diagram.
#[derive(Args, Debug)]
#[command(after_help = "Example: arclength show cycles.json\n         \
                        arclength show equilibria.json cycles.json -o diagram.svg")]
pub struct Show {
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
    pub fn run(&self) -> Result<(), Failure> {
        let mut results = Vec::new();
        for path in &self.files {
            let failure = |problem: String| Failure::ResultFile { path: path.clone(), problem };
            results.push(ResultFile::read(path).map_err(failure)?);
        }
        if !self.out.is_empty() {
            write_pictures(
                &diagram(&results).map_err(|(index, problem)| self.failure(index, problem))?,
                &self.out,
            )?;
            for path in self.out.iter().filter(|_| !self.quiet) {
                terminal::say("wrote", &path.display().to_string());
            }
            if self.quiet {
                return Ok(());
            }
        }
        terminal::print(|out| {
            self.write(&mut results, out).map_err(|error| terminal::output_failure(error, "text"))
        })
    }

    fn failure(&self, index: usize, problem: String) -> Failure {
        Failure::ResultFile { path: self.files.get(index).cloned().unwrap_or_default(), problem }
    }

    fn write(&self, results: &mut [ResultFile], out: &mut dyn Write) -> io::Result<()> {
        for (index, result) in results.iter_mut().enumerate() {
            if index > 0 {
                writeln!(out)?;
            }
            match result {
                ResultFile::Equilibria(report) => {
                    report.explain = self.explain;
                    report.write_table(out)?;
                }
                ResultFile::Cycles(report) => {
                    report.explain = self.explain;
                    report.write_table(out)?;
                }
                ResultFile::Locus(report) => {
                    report.explain = self.explain;
                    report.write_table(out)?;
                }
                ResultFile::CycleLocus(report) => {
                    report.explain = self.explain;
                    report.write_table(out)?;
                }
                ResultFile::History(report) => report.write_table(out)?,
            }
        }
        Ok(())
    }
}

/// Everything in one diagram; the error says which file does not fit to the first one.
///
/// # Errors
/// A time history, or files over different parameters.
pub fn diagram(results: &[ResultFile]) -> Result<Figure, (usize, String)> {
    let axes = |result: &ResultFile| -> Option<Vec<String>> {
        match result {
            ResultFile::Equilibria(report) => Some(vec![report.along.key.clone()]),
            ResultFile::Cycles(report) => Some(vec![report.along.key.clone()]),
            ResultFile::Locus(report) => Some(report.keys().map(str::to_owned).to_vec()),
            ResultFile::CycleLocus(report) => Some(report.keys().map(str::to_owned).to_vec()),
            ResultFile::History(_) => None,
        }
    };
    let first = results.first().and_then(axes).unwrap_or_default();
    let (mut states, mut name): (Vec<String>, String) = (Vec::new(), String::new());
    for (index, result) in results.iter().enumerate() {
        match axes(result) {
            Some(own) if own == first => {}
            Some(own) => {
                let problem = format!("it is over {}, not over {}", own.join(" and "), first.join(" and "));
                return Err((
                    index,
                    format!("{problem} as the first file; allowed: files over the same parameters"),
                ));
            }
            None => {
                let problem =
                    "a time history has no place in a bifurcation diagram; allowed: `simulate -o x.svg`";
                return Err((index, problem.to_owned()));
            }
        }
        let (own, model) = match result {
            ResultFile::Equilibria(report) => (report.states(), &report.model),
            ResultFile::Cycles(report) => (report.states(), &report.model),
            ResultFile::Locus(report) => (Vec::new(), &report.model),
            ResultFile::CycleLocus(report) => (Vec::new(), &report.model),
            ResultFile::History(_) => continue,
        };
        if index == 0 {
            states = own.into_iter().map(str::to_owned).collect();
            name.clone_from(&model.name);
        }
    }
    if let [one, two] = &first[..] {
        let curves: Vec<Curve> = results
            .iter()
            .filter_map(|result| match result {
                ResultFile::Locus(report) => Some(report.curve()),
                ResultFile::CycleLocus(report) => Some(report.curve()),
                _ => None,
            })
            .collect();
        return Ok(picture::plane(&format!("Special points of {name}"), [one, two], &curves));
    }
    let panels = states.iter().map(|state| {
        let curves = results.iter().flat_map(|result| match result {
            ResultFile::Equilibria(report) => report.curves(state),
            ResultFile::Cycles(report) => report.curves(state),
            _ => Vec::new(),
        });
        (state.clone(), curves.collect::<Vec<Curve>>())
    });
    let key = first.first().map_or("", String::as_str);
    Ok(picture::bifurcation_diagram(&format!("Bifurcation diagram of {name}"), key, panels))
}
