//! A time history as a result, of a wheel that rolls or of one that may slide.

use super::rolling_result::RollingHistory;
use super::sliding_result::SlidingHistory;
use kingpin_figure::{Figure, FigureError};
use kingpin_report::{Columns, NamedNumbers, Report, Schema};
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
}

impl HistoryResult {
    /// What is worth knowing about it.
    pub fn warnings(&self) -> Vec<String> {
        match self {
            Self::Rolling(history) => history.warnings(),
            Self::Sliding(_) => Vec::new(),
        }
    }
}

impl Report for HistoryResult {
    fn schema(&self) -> Schema {
        match self {
            Self::Rolling(history) => history.schema(),
            Self::Sliding(history) => history.schema(),
        }
    }

    fn parameters(&self) -> NamedNumbers {
        match self {
            Self::Rolling(history) => history.parameters(),
            Self::Sliding(history) => history.parameters(),
        }
    }

    fn write_table(&self, out: &mut dyn Write) -> io::Result<()> {
        match self {
            Self::Rolling(history) => history.write_table(out),
            Self::Sliding(history) => history.write_table(out),
        }
    }

    fn columns(&self) -> Columns {
        match self {
            Self::Rolling(history) => history.columns(),
            Self::Sliding(history) => history.columns(),
        }
    }

    fn figure(&self) -> Result<Option<Figure>, FigureError> {
        match self {
            Self::Rolling(history) => history.figure(),
            Self::Sliding(history) => history.figure(),
        }
    }
}
