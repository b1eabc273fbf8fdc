//! A time history as a result, of a wheel that rolls, of one that may slide or of one with a tyre.

use super::rolling_result::RollingHistory;
use super::sliding_result::SlidingHistory;
use super::tyre_result::TyreHistoryResult;
use kingpin_figure::{Figure, FigureError};
use kingpin_report::{Columns, Parameters, Report, Schema};
use serde::Serialize;
use std::io::{self, Write};

/// A time history.
#[derive(Debug, Serialize)]
#[serde(untagged)]
pub enum HistoryResult {
    /// Of a wheel that rolls.
    Rolling(RollingHistory),
    /// Of a wheel that rolls or slides.
    Sliding(SlidingHistory),
    /// Of a wheel with a tyre.
    Tyre(TyreHistoryResult),
}

impl HistoryResult {
    /// What is worth knowing about it.
    pub fn warnings(&self) -> Vec<String> {
        match self {
            Self::Rolling(history) => history.warnings(),
            Self::Sliding(_) => Vec::new(),
            Self::Tyre(history) => history.warnings(),
        }
    }
}

impl Report for HistoryResult {
    fn schema(&self) -> Schema {
        match self {
            Self::Rolling(history) => history.schema(),
            Self::Sliding(history) => history.schema(),
            Self::Tyre(history) => history.schema(),
        }
    }

    fn parameters(&self) -> Parameters {
        match self {
            Self::Rolling(history) => history.parameters(),
            Self::Sliding(history) => history.parameters(),
            Self::Tyre(history) => history.parameters(),
        }
    }

    fn write_table(&self, out: &mut dyn Write) -> io::Result<()> {
        match self {
            Self::Rolling(history) => history.write_table(out),
            Self::Sliding(history) => history.write_table(out),
            Self::Tyre(history) => history.write_table(out),
        }
    }

    fn columns(&self) -> Columns {
        match self {
            Self::Rolling(history) => history.columns(),
            Self::Sliding(history) => history.columns(),
            Self::Tyre(history) => history.columns(),
        }
    }

    fn figure(&self) -> Result<Option<Figure>, FigureError> {
        match self {
            Self::Rolling(history) => history.figure(),
            Self::Sliding(history) => history.figure(),
            Self::Tyre(history) => history.figure(),
        }
    }
}
