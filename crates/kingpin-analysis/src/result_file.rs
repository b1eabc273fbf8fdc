//! Result files of `hopf`, `cycles` and `locus`, read back for computations that start from a labelled point.

use crate::cycles::CyclesResult;
use crate::hopf::HopfResult;
use crate::locus::{CycleLocusResult, MotionLocusResult};
use arclength_analysis::{Disk, Files};
use kingpin_report::Schema;
use serde::Deserialize;
use serde::de::DeserializeOwned;
use std::path::Path;

/// What a result file holds.
#[derive(Debug)]
pub enum ResultFile {
    /// Of `hopf`.
    Hopf(HopfResult),
    /// Of `cycles`.
    Cycles(CyclesResult),
    /// Of `locus`, of Hopf points.
    MotionLocus(MotionLocusResult),
    /// Of `locus`, of cycles.
    CycleLocus(CycleLocusResult),
}

/// What a file says about itself.
#[derive(Debug, Deserialize)]
struct Header {
    schema: Schema,
}

/// Results that can be started from, as an error names them.
const ALLOWED: &str =
    "allowed: a file that --out FILE.json of kingpin.hopf or kingpin.cycles or kingpin.locus wrote";

impl ResultFile {
    /// Reads a file; the error says what is wrong with it and what is allowed.
    ///
    /// # Errors
    /// It cannot be read, is no result file or not one of these.
    pub fn read(path: &Path) -> Result<Self, String> {
        Self::read_among(&Disk, path)
    }

    /// The same from other files than those of this machine.
    ///
    /// # Errors
    /// Those of [`read`](Self::read).
    pub fn read_among(files: &dyn Files, path: &Path) -> Result<Self, String> {
        fn parse<R: DeserializeOwned>(text: &[u8]) -> Result<R, String> {
            serde_json::from_slice(text)
                .map_err(|error| format!("not such a result file: {error}; {ALLOWED}"))
        }
        let text = files.read(path).map_err(|error| format!("cannot be read: {error}"))?;
        let Header { schema: Schema { name, version } } = parse(&text)?;
        match (name.as_str(), version) {
            (HopfResult::SCHEMA, 1) => parse(&text).map(Self::Hopf),
            (CyclesResult::SCHEMA, 1) => parse(&text).map(Self::Cycles),
            (MotionLocusResult::SCHEMA, 1) => parse(&text).map(Self::MotionLocus),
            (CycleLocusResult::SCHEMA, 1) => parse(&text).map(Self::CycleLocus),
            _ => Err(format!("it is of {name}, version {version}; {ALLOWED}")),
        }
    }

    /// Labels of its points.
    pub fn labels(&self) -> Vec<String> {
        match self {
            Self::Hopf(result) => result.points.iter().map(|point| point.label.clone()).collect(),
            Self::Cycles(result) => {
                result.points.iter().filter_map(|point| point.cycle.label.clone()).collect()
            }
            Self::MotionLocus(result) => {
                result.curve.points.iter().filter_map(|point| point.label.clone()).collect()
            }
            Self::CycleLocus(result) => {
                result.curve.points.iter().filter_map(|point| point.label.clone()).collect()
            }
        }
    }
}
