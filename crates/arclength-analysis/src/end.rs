//! Why a branch ends, as results tell it.

use arclength::Error;
use arclength::continuation::Stop;
use kingpin_report::NamedNumbers;
use kingpin_report::numbers::{readable, significant};
use serde::{Deserialize, Serialize};

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
