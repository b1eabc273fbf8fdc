//! `arclength show`: the labelled points of a result file.

use crate::document::{Number, Schema};
use crate::failure::Failure;
use crate::table::Table;
use crate::terminal;
use clap::Args;
use serde::Deserialize;
use std::path::PathBuf;

/// Labelled points of a result file, from which computations can start
#[derive(Args, Debug)]
#[command(after_help = "Example: arclength show cycles.json")]
pub struct Show {
    /// File that one of the commands wrote
    #[arg(value_name = "FILE.json")]
    file: PathBuf,
}

#[derive(Debug, Deserialize)]
struct ShownFile {
    schema: Schema,
    along: ShownParameter,
    points: Vec<ShownPoint>,
}

#[derive(Debug, Deserialize)]
struct ShownParameter {
    key: String,
}

#[derive(Debug, Deserialize)]
struct ShownPoint {
    value: Number,
    label: Option<String>,
    period: Option<f64>,
    stable: Option<bool>,
}

impl Show {
    /// Runs the command.
    ///
    /// # Errors
    /// Why it failed.
    pub fn run(&self) -> Result<(), Failure> {
        let failure = |problem: String| Failure::ResultFile { path: self.file.clone(), problem };
        let bytes = std::fs::read(&self.file)
            .map_err(|source| Failure::Unreadable { path: self.file.clone(), source })?;
        let file: ShownFile = serde_json::from_slice(&bytes).map_err(|error| {
            failure(format!("not a result file with labelled points: {error}; allowed: what `equilibria` and `cycles` write"))
        })?;
        let mut table = Table::new(["label", file.along.key.as_str(), "period", ""]);
        let labelled = file.points.iter().filter(|point| point.label.is_some());
        for point in labelled {
            let stability = match point.stable {
                Some(true) => "stable",
                Some(false) => "unstable",
                None => "",
            };
            table.row([
                point.label.clone().into(),
                point.value.0.into(),
                point.period.into(),
                stability.into(),
            ]);
        }
        terminal::print(|out| {
            writeln!(out, "{}, {} points\n", file.schema.name, file.points.len())
                .and_then(|()| table.write(out))
                .map_err(|error| terminal::output_failure(error, "text"))
        })
    }
}
