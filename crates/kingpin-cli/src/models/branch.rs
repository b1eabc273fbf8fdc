//! What results of both kinds of branches have in common.

use crate::document::Number;
use crate::numbers::readable;
use crate::range::Range;
use num_complex::Complex64;
use serde::Serialize;

/// The parameter that varies and its interval.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct VaryingParameter {
    /// Its name.
    pub key: String,
    /// The lower end.
    pub start: Number,
    /// The upper end.
    pub end: Number,
}

impl From<&Range> for VaryingParameter {
    fn from(range: &Range) -> Self {
        Self { key: range.key.clone(), start: Number(range.start), end: Number(range.end) }
    }
}

/// Complex numbers as pairs.
pub fn pairs(numbers: &[Complex64]) -> Vec<[f64; 2]> {
    numbers.iter().map(|number| [number.re, number.im]).collect()
}

/// Stability as a word.
pub fn stability(stable: Option<bool>, bifurcation: bool) -> &'static str {
    match stable {
        Some(true) => "stable",
        Some(false) => "unstable",
        None if bifurcation => "",
        None => "undecided",
    }
}

/// Parameters as a line of text.
pub fn parameters(named: &[(String, f64)]) -> String {
    if named.is_empty() {
        return "no other parameters".to_owned();
    }
    let texts: Vec<String> =
        named.iter().map(|(name, value)| format!("{name} = {}", readable(*value))).collect();
    texts.join(", ")
}
