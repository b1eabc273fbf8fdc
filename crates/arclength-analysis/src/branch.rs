//! What results of every kind of branch have in common, as plain data that is written to files and read back.

use arclength::equilibrium::FoundBy;
use kingpin_report::NamedNumbers;
use kingpin_report::numbers::readable;
use num_complex::Complex64;
use serde::{Deserialize, Serialize};

/// What a branch was started from.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Origin {
    /// The label of the point, where it is one of an earlier result.
    pub label: Option<String>,
    /// What was done there, in words.
    pub how: String,
}

impl Origin {
    /// The initial state of the model.
    pub fn initial_state() -> Self {
        Self { label: None, how: "the equilibrium near the initial state".to_owned() }
    }

    /// An equilibrium that was sought from the initial state.
    pub fn sought(by: FoundBy) -> Self {
        let how = match by {
            FoundBy::FarNewton => {
                "the equilibrium, far from the initial state, to which Newton's method went from there"
                    .to_owned()
            }
            FoundBy::Flow => {
                "the equilibrium near a state to which the flow leads from the initial state".to_owned()
            }
            FoundBy::RandomStart(number) => format!(
                "the equilibrium near random start {number} around the motion from the initial state: others may be nearer"
            ),
            _ => return Self::initial_state(),
        };
        Self { label: None, how }
    }

    /// A labelled point.
    pub fn labelled(label: &str, how: &str) -> Self {
        Self { label: Some(label.to_owned()), how: how.to_owned() }
    }

    /// In words.
    pub fn text(&self) -> String {
        self.label.as_ref().map_or_else(|| self.how.clone(), |label| format!("{label}, {}", self.how))
    }
}

/// Complex numbers as pairs; what is not finite is nothing.
pub fn pairs(numbers: &[Complex64]) -> Vec<[Option<f64>; 2]> {
    let finite = |number: f64| Some(number).filter(|number| number.is_finite());
    numbers.iter().map(|number| [finite(number.re), finite(number.im)]).collect()
}

/// Test functions by name, without those that have no value.
pub fn tests<'a>(named: impl IntoIterator<Item = (&'a str, f64)>) -> NamedNumbers {
    let finite = named.into_iter().filter(|(_, value)| value.is_finite());
    NamedNumbers(finite.map(|(name, value)| (name.to_owned(), value)).collect())
}

/// Number of digits of a value that hold, given its error.
pub fn certain_digits(value: f64, error: f64) -> usize {
    const ALL: usize = 17;
    if value == 0.0 || error == 0.0 || !error.is_finite() {
        return ALL;
    }
    ((value / error).abs().log10().floor().max(1.0) as usize).min(ALL)
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

/// Where something is by its other parameters, with a blank before; nothing where there are none.
pub fn at_parameters(named: &[(String, f64)]) -> String {
    if named.is_empty() { String::new() } else { format!(" at {}", parameters(named)) }
}

/// Parameters as a line of text.
pub fn parameters(named: &[(String, f64)]) -> String {
    let texts: Vec<String> =
        named.iter().map(|(name, value)| format!("{name} = {}", readable(*value))).collect();
    texts.join(", ")
}

/// Warnings about changes that were not located: the first few, and how many there are beside them.
pub fn shortened(mut texts: Vec<String>) -> Vec<String> {
    const MOST: usize = 5;
    let left = texts.len().saturating_sub(MOST);
    texts.truncate(MOST);
    if left > 0 {
        texts.push(format!("and {left} more such changes, all named under `unlocated` in a .json result"));
    }
    texts
}
