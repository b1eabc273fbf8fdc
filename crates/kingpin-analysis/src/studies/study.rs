//! What a study gives: findings, figures with their data, further pictures.

use kingpin_figure::Figure;
use kingpin_report::{Cell, Columns};

/// Significant digits of findings.
const DIGITS: usize = 9;

/// What a study gives.
#[derive(Debug, Default)]
pub(super) struct Study {
    /// The numbers that matter, in the order in which they are told.
    pub findings: Vec<Finding>,
    /// Its figures.
    pub drawings: Vec<Drawing>,
    /// Names and contents of further pictures.
    pub pictures: Vec<(&'static str, String)>,
    /// What is to be said in words: that nothing was found and what was searched, what was left out.
    pub notes: Vec<String>,
}

/// A number with what it is.
#[derive(Clone, Debug, PartialEq)]
pub struct Finding {
    /// What it is, with the parameters at which it was found.
    pub quantity: String,
    /// The value in SI units.
    pub value: f64,
    /// The unit; empty where there is none.
    pub unit: &'static str,
}

impl Finding {
    pub(super) fn new(quantity: impl Into<String>, value: f64, unit: &'static str) -> Self {
        Self { quantity: quantity.into(), value, unit }
    }

    /// The value as it is shown in tables.
    pub fn cell(&self) -> Cell {
        Cell::Digits(self.value, DIGITS)
    }
}

/// A figure with its number and its data.
#[derive(Debug)]
pub(super) struct Drawing {
    /// Its number; those up to 6 are the paper's.
    pub number: u8,
    /// The figure.
    pub figure: Figure,
    /// The data; columns are named with units in brackets.
    pub data: Columns,
}
