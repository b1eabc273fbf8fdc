//! Result files of all commands, read back: for `show`, and for computations that start from a labelled point.

use super::cycles::CyclesReport;
use super::equilibria::EquilibriaReport;
use super::locus::{CycleLocusReport, LocusReport};
use super::simulate::HistoryReport;
use crate::document::Schema;
use serde::Deserialize;
use serde::de::DeserializeOwned;
use std::path::Path;

/// What a result file holds.
#[derive(Debug)]
pub enum ResultFile {
    /// Of `equilibria`.
    Equilibria(EquilibriaReport),
    /// Of `cycles`.
    Cycles(CyclesReport),
    /// Of `locus`, of equilibria.
    Locus(LocusReport),
    /// Of `locus`, of cycles.
    CycleLocus(CycleLocusReport),
    /// Of `simulate`.
    History(HistoryReport),
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
        const ALLOWED: &str =
            "allowed: a file that --out FILE.json of arclength equilibria, cycles, locus or simulate wrote";
        fn parse<R: DeserializeOwned>(text: &[u8]) -> Result<R, String> {
            serde_json::from_slice(text).map_err(|error| format!("not a result file: {error}; {ALLOWED}"))
        }
        let text = std::fs::read(path).map_err(|error| format!("cannot be read: {error}"))?;
        let Header { schema: Schema { name, version } } = parse(&text)?;
        match (name.as_str(), version) {
            (EquilibriaReport::SCHEMA, 1) => parse(&text).map(Self::Equilibria),
            (CyclesReport::SCHEMA, 1) => parse(&text).map(Self::Cycles),
            (LocusReport::SCHEMA, 1) => parse(&text).map(Self::Locus),
            (CycleLocusReport::SCHEMA, 1) => parse(&text).map(Self::CycleLocus),
            (HistoryReport::SCHEMA, 1) => parse(&text).map(Self::History),
            _ => Err(format!("it is a {name} of version {version}; {ALLOWED}")),
        }
    }

    /// Labels of its points.
    pub fn labels(&self) -> Vec<String> {
        match self {
            Self::Equilibria(report) => {
                report.points.iter().filter_map(|point| point.label.clone()).collect()
            }
            Self::Cycles(report) => report.points.iter().filter_map(|point| point.label.clone()).collect(),
            Self::Locus(report) => report.points.iter().filter_map(|point| point.label.clone()).collect(),
            Self::CycleLocus(report) => {
                report.points.iter().filter_map(|point| point.label.clone()).collect()
            }
            Self::History(_) => vec![HistoryReport::END.to_owned()],
        }
    }
}
