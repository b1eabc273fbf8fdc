//! A curve of special points as a result, of Hopf points or of cycles.

use super::of_cycles::CycleLocusResult;
use super::of_motions::MotionLocusResult;
use kingpin_figure::{Figure, FigureError};
use kingpin_report::{Columns, Parameters, Report, Schema, Story};
use serde::Serialize;
use std::io::{self, Write};

/// A curve of special points in two parameters.
#[derive(Clone, Debug, Serialize)]
#[serde(untagged)]
pub enum LocusResult {
    /// Of uniform motions, Hopf points among them.
    Motions(MotionLocusResult),
    /// Of special cycles.
    Cycles(CycleLocusResult),
}

impl LocusResult {
    /// What was detected but not located.
    pub fn warnings(&self) -> Vec<String> {
        match self {
            Self::Motions(_) => Vec::new(),
            Self::Cycles(result) => result.curve.warnings(),
        }
    }
}

impl Report for LocusResult {
    fn schema(&self) -> Schema {
        match self {
            Self::Motions(result) => result.schema(),
            Self::Cycles(result) => result.schema(),
        }
    }

    fn parameters(&self) -> Parameters {
        match self {
            Self::Motions(result) => result.parameters(),
            Self::Cycles(result) => result.parameters(),
        }
    }

    fn write_table(&self, out: &mut dyn Write) -> io::Result<()> {
        match self {
            Self::Motions(result) => result.write_table(out),
            Self::Cycles(result) => result.write_table(out),
        }
    }

    fn columns(&self) -> Columns {
        match self {
            Self::Motions(result) => result.columns(),
            Self::Cycles(result) => result.columns(),
        }
    }

    fn figure(&self) -> Result<Option<Figure>, FigureError> {
        match self {
            Self::Motions(result) => result.figure(),
            Self::Cycles(result) => result.figure(),
        }
    }

    fn story(&self) -> Option<Story> {
        match self {
            Self::Motions(result) => result.story(),
            Self::Cycles(result) => result.story(),
        }
    }
}
