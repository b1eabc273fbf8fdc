//! A curve of special points as a result, of equilibria or of cycles.

use super::of_cycles::CycleLocusResult;
use super::of_equilibria::EquilibriumLocusResult;
use kingpin_figure::{Figure, FigureError};
use kingpin_report::{Columns, Parameters, Report, Schema, Story};
use serde::Serialize;
use std::io::{self, Write};

/// A curve of special points in two parameters.
#[derive(Clone, Debug, Serialize)]
#[serde(untagged)]
pub enum LocusResult {
    /// Of special equilibria.
    Equilibria(EquilibriumLocusResult),
    /// Of special cycles.
    Cycles(CycleLocusResult),
}

impl LocusResult {
    /// What was detected but not located.
    pub fn warnings(&self) -> Vec<String> {
        match self {
            Self::Equilibria(result) => result.curve.warnings(),
            Self::Cycles(result) => result.curve.warnings(),
        }
    }
}

impl Report for LocusResult {
    fn schema(&self) -> Schema {
        match self {
            Self::Equilibria(result) => result.schema(),
            Self::Cycles(result) => result.schema(),
        }
    }

    fn parameters(&self) -> Parameters {
        match self {
            Self::Equilibria(result) => result.parameters(),
            Self::Cycles(result) => result.parameters(),
        }
    }

    fn write_table(&self, out: &mut dyn Write) -> io::Result<()> {
        match self {
            Self::Equilibria(result) => result.write_table(out),
            Self::Cycles(result) => result.write_table(out),
        }
    }

    fn columns(&self) -> Columns {
        match self {
            Self::Equilibria(result) => result.columns(),
            Self::Cycles(result) => result.columns(),
        }
    }

    fn figure(&self) -> Result<Option<Figure>, FigureError> {
        match self {
            Self::Equilibria(result) => result.figure(),
            Self::Cycles(result) => result.figure(),
        }
    }

    fn story(&self) -> Option<Story> {
        match self {
            Self::Equilibria(result) => result.story(),
            Self::Cycles(result) => result.story(),
        }
    }
}
