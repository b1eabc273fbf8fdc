//! What results of every kind of branch have in common, as plain data that is written to files and read back.

use super::model::ChosenModel;
use crate::document::NamedNumbers;
use crate::failure::Failure;
use crate::journal::interruption;
use crate::labels;
use crate::numbers::{readable, significant};
use crate::range::Range;
use arclength::Error;
use arclength::continuation::{Settings, Stop};
use clap::Args;
use num_complex::Complex64;
use serde::{Deserialize, Serialize};
use std::ops::ControlFlow;
use std::sync::atomic::{AtomicBool, Ordering};

/// A model with its text, so that a result can be continued where the model's file is not.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct StoredModel {
    /// Name of the file that it was read from.
    pub name: String,
    /// The text of that file.
    pub source: String,
}

/// A parameter that varies and its interval.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct VaryingParameter {
    /// Its name.
    pub key: String,
    /// The lower end.
    pub start: f64,
    /// The upper end.
    pub end: f64,
}

impl From<&Range> for VaryingParameter {
    fn from(range: &Range) -> Self {
        Self { key: range.key.clone(), start: range.start, end: range.end }
    }
}

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

    /// A labelled point.
    pub fn labelled(label: &str, how: &str) -> Self {
        Self { label: Some(label.to_owned()), how: how.to_owned() }
    }

    /// In words.
    pub fn text(&self) -> String {
        self.label.as_ref().map_or_else(|| self.how.clone(), |label| format!("{label}, {}", self.how))
    }
}

/// Why a branch ends in one direction, and what can be done.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct End {
    /// The cause.
    pub cause: String,
    /// The last good point.
    pub last: NamedNumbers,
    /// What to try, where anything is left to do.
    pub remedy: Option<String>,
}

impl End {
    /// The end of a branch, with its last good point, along parameters with these names.
    pub fn of(stop: &Stop, keys: &[&str], last: NamedNumbers) -> Self {
        let key = keys.first().copied().unwrap_or_default();
        let (cause, remedy) = match stop {
            Stop::RangeEnd { bound, value } => {
                let key = keys.get(*bound).copied().unwrap_or(key);
                (format!("reached the end of the interval, {key} = {}", readable(*value)), None)
            }
            Stop::Closed => ("the branch is closed: it came back to where it started".to_owned(), None),
            Stop::StepTooSmall { cause } => (
                format!("the step became too small: {cause}"),
                Some(
                    "shorter steps from the start (--finer 10); if they end here too, the field may not be smooth here, or \
                     the curve turns more sharply than double precision tells",
                ),
            ),
            Stop::MostSteps => (
                "the most steps allowed were taken".to_owned(),
                Some("allow more with --steps, or start again from this end"),
            ),
            Stop::HopfPoint { parameter, frequency, located: false } => (
                format!(
                    "the cycles shrink to a Hopf point near {key} = {} with an angular frequency of about {}; it was not located",
                    significant(*parameter, 3),
                    significant(*frequency, 3)
                ),
                Some("shorter steps (--finer 10)"),
            ),
            Stop::HopfPoint { parameter, frequency, .. } => (
                format!(
                    "the cycles shrink to a Hopf point at {key} = {} with angular frequency {}",
                    readable(*parameter),
                    readable(*frequency)
                ),
                None,
            ),
            Stop::GeneralizedHopfPoint { values: [first, second], frequency } => (
                format!(
                    "the cycles shrink to a generalised Hopf point at {key} = {}, {} = {} with angular frequency {}",
                    readable(*first),
                    keys.get(1).copied().unwrap_or_default(),
                    readable(*second),
                    readable(*frequency)
                ),
                None,
            ),
            Stop::PeriodDoubling { parameter, period } => (
                format!(
                    "the doubled cycles end at a period doubling at {key} = {}, where the single cycle has the period {}",
                    readable(*parameter),
                    readable(*period)
                ),
                None,
            ),
            Stop::StrongResonance { order } => (
                format!(
                    "the curve of torus bifurcations ends at a 1:{order} resonance, where its multipliers meet"
                ),
                None,
            ),
            Stop::PeriodUnbounded { period, parameter } => (
                format!(
                    "the period grows without bound ({} at {key} = {}): a homoclinic or heteroclinic orbit is near",
                    readable(*period),
                    readable(*parameter)
                ),
                None,
            ),
            Stop::StateUnbounded { parameter } => (
                format!("the state grows without bound while {key} tends to {}", readable(*parameter)),
                Some("nothing, if it does in truth; else other coordinates, such as reciprocals"),
            ),
            Stop::Interrupted => ("interrupted".to_owned(), Some("start again from this end")),
            Stop::Failed(Error::MeshLimit { limit, error_estimate }) => (
                format!(
                    "the cycle needs more than {limit} mesh intervals (error estimate {})",
                    readable(*error_estimate)
                ),
                Some("more with --intervals, or a larger --tolerance"),
            ),
            Stop::Failed(error) => (error.to_string(), Some("shorter steps from the start (--finer 10)")),
        };
        Self { cause, last, remedy: remedy.map(str::to_owned) }
    }

    /// In one line.
    pub fn text(&self) -> String {
        let last: Vec<String> =
            self.last.0.iter().map(|(name, value)| format!("{name} = {}", readable(*value))).collect();
        match &self.remedy {
            Some(remedy) => {
                format!("{}; last good point: {}; try: {remedy}", self.cause, last.join(", "))
            }
            None => self.cause.clone(),
        }
    }
}

/// Labels the first and the last of the points that have none as ends of a branch.
pub fn label_ends<P>(points: &mut [P], label: impl Fn(&mut P) -> &mut Option<String>) {
    let last = points.len().saturating_sub(1);
    for (number, index) in [(1, 0), (2, last)] {
        if let Some(point) = points.get_mut(index) {
            label(point).get_or_insert_with(|| labels::end(number));
        }
    }
}

/// Ends a branch at the step that it is at once Ctrl-C was pressed.
#[derive(Clone, Copy, Debug)]
pub struct Interruption(&'static AtomicBool);

impl Interruption {
    /// # Errors
    /// [`Failure::Signals`]
    pub fn watch() -> Result<Self, Failure> {
        interruption().map(Self)
    }

    /// Whether to go on.
    pub fn flow(self) -> ControlFlow<()> {
        if self.0.load(Ordering::Relaxed) { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
    }

    /// # Errors
    /// [`Failure::BranchInterrupted`] if the branch was ended; its result has been delivered.
    pub fn report(self) -> Result<(), Failure> {
        if self.flow().is_break() { Err(Failure::BranchInterrupted) } else { Ok(()) }
    }
}

/// How steps along a branch are taken.
#[derive(Args, Clone, Copy, Debug)]
#[command(next_help_heading = "Steps")]
pub struct StepOptions {
    /// Most steps in one direction
    #[arg(long, value_name = "N", default_value_t = 10_000,
          value_parser = clap::value_parser!(u32).range(1..=10_000_000))]
    steps: u32,

    /// Take steps K times shorter, so that special points that lie close together are told apart
    #[arg(long, value_name = "K", default_value_t = 1,
          value_parser = clap::value_parser!(u32).range(1..=100_000))]
    finer: u32,
}

impl StepOptions {
    /// Settings with these steps.
    pub fn apply(&self, settings: Settings) -> Settings {
        let finer = f64::from(self.finer);
        Settings {
            most_steps: self.steps as usize,
            initial_step: settings.initial_step / finer,
            largest_step: settings.largest_step / finer,
            largest_parameter_change: settings.largest_parameter_change / finer,
            // The distance between prediction and solution falls with the square of the step.
            predictor_error: settings.predictor_error / (finer * finer),
            smallest_step: settings.smallest_step.min(settings.initial_step / finer / 1e3),
            ..settings
        }
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

/// A model, its fixed parameters and what is known of all branches of it.
pub fn named_parameters(chosen: &ChosenModel, varying: &[usize]) -> NamedNumbers {
    let named = chosen.model.parameters().iter().cloned().zip(chosen.parameters.iter().copied());
    let fixed = named.enumerate().filter(|(index, _)| !varying.contains(index));
    NamedNumbers(fixed.map(|(_, entry)| entry).collect())
}
