//! Why a branch ends, as results tell it.

use crate::varying_parameter::VaryingParameter;
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
    /// The start of a branch at a point where it begins.
    pub fn start(last: NamedNumbers) -> Self {
        Self { cause: "starts there".to_owned(), last, remedy: None }
    }

    /// The end of a branch along these parameters, with its last good point. Where the parameters have units, they are those of
    /// the SI.
    pub fn of(stop: &Stop, varying: &[VaryingParameter], last: NamedNumbers) -> Self {
        let [second, radians] =
            if varying.iter().any(|parameter| parameter.unit.is_some()) { [" s", " rad/s"] } else { [""; 2] };
        let at = |index: usize, value: f64| match varying.get(index).or(varying.first()) {
            Some(parameter) => parameter.at(value),
            None => readable(value),
        };
        let near = |value: f64| match varying.first() {
            Some(parameter) => parameter.near(value),
            None => significant(value, 3),
        };
        let key = varying.first().map(|parameter| parameter.key.as_str()).unwrap_or_default();
        let (cause, remedy) = match stop {
            Stop::RangeEnd { bound, value } => {
                (format!("reached the end of the interval, {}", at(*bound, *value)), None)
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
                    "the cycles shrink to a Hopf point near {} with an angular frequency of about {}{radians}; it was not located",
                    near(*parameter),
                    significant(*frequency, 3)
                ),
                Some("shorter steps (--finer 10)"),
            ),
            Stop::HopfPoint { parameter, frequency, .. } => (
                format!(
                    "the cycles shrink to a Hopf point at {} with angular frequency {}{radians}",
                    at(0, *parameter),
                    readable(*frequency)
                ),
                None,
            ),
            Stop::GeneralizedHopfPoint { values: [first, second], frequency } => (
                format!(
                    "the cycles shrink to a generalised Hopf point at {}, {} with angular frequency {}{radians}",
                    at(0, *first),
                    at(1, *second),
                    readable(*frequency)
                ),
                None,
            ),
            Stop::PeriodDoubling { parameter, period } => (
                format!(
                    "the doubled cycles end at a period doubling at {}, where the single cycle has the period {}{second}",
                    at(0, *parameter),
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
                    "the period grows without bound ({}{second} at {}): a homoclinic or heteroclinic orbit is near",
                    readable(*period),
                    at(0, *parameter)
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
