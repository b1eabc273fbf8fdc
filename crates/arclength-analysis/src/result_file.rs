//! Result files of all commands, read back: for `show`, and for computations that start from a labelled point.

use crate::cycles::CyclesResult;
use crate::equilibria::EquilibriaResult;
use crate::files::{Disk, Files};
use crate::locus::{CycleLocusResult, EquilibriumLocusResult};
use crate::simulate::HistoryResult;
use kingpin_report::Schema;
use serde::Deserialize;
use serde::de::DeserializeOwned;
use std::path::Path;

/// What a result file holds.
#[derive(Debug)]
pub enum ResultFile {
    /// Of `equilibria`.
    Equilibria(EquilibriaResult),
    /// Of `cycles`.
    Cycles(CyclesResult),
    /// Of `locus`, of equilibria.
    Locus(EquilibriumLocusResult),
    /// Of `locus`, of cycles.
    CycleLocus(CycleLocusResult),
    /// Of `simulate`.
    History(HistoryResult),
}

/// What a file says about itself.
#[derive(Debug, Deserialize)]
struct Header {
    schema: Schema,
}

impl ResultFile {
    /// Reads a file; the error says what is wrong with it and what is allowed.
    ///
    /// # Errors
    /// It cannot be read, is no result file or not one of `arclength`.
    pub fn read(path: &Path) -> Result<Self, String> {
        Self::read_among(&Disk, path)
    }

    /// Reads one of other files than those of this machine.
    ///
    /// # Errors
    /// Those of [`read`](Self::read).
    pub fn read_among(files: &dyn Files, path: &Path) -> Result<Self, String> {
        const ALLOWED: &str =
            "allowed: a file that --out FILE.json of arclength equilibria, cycles, locus or simulate wrote";
        fn parse<R: DeserializeOwned>(text: &[u8]) -> Result<R, String> {
            serde_json::from_slice(text).map_err(|error| format!("not a result file: {error}; {ALLOWED}"))
        }
        let text = files.read(path).map_err(|error| format!("cannot be read: {error}"))?;
        let Header { schema: Schema { name, version } } = parse(&text)?;
        match (name.as_str(), version) {
            (EquilibriaResult::SCHEMA, 1) => parse(&text).map(Self::Equilibria),
            (CyclesResult::SCHEMA, 1) => parse(&text).map(Self::Cycles),
            (EquilibriumLocusResult::SCHEMA, 1) => parse(&text).map(Self::Locus),
            (CycleLocusResult::SCHEMA, 1) => parse(&text).map(Self::CycleLocus),
            (HistoryResult::SCHEMA, 1) => parse(&text).map(Self::History),
            _ => Err(format!("it is of {name}, version {version}; {ALLOWED}")),
        }
    }

    /// Labels of its points.
    pub fn labels(&self) -> Vec<String> {
        match self {
            Self::Equilibria(result) => {
                result.points.iter().filter_map(|point| point.label.clone()).collect()
            }
            Self::Cycles(result) => result.points.iter().filter_map(|point| point.label.clone()).collect(),
            Self::Locus(result) => {
                result.curve.points.iter().filter_map(|point| point.label.clone()).collect()
            }
            Self::CycleLocus(result) => {
                result.curve.points.iter().filter_map(|point| point.label.clone()).collect()
            }
            Self::History(_) => vec![HistoryResult::END.to_owned()],
        }
    }
}
