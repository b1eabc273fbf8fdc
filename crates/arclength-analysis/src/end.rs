//! Why a branch ends, as results tell it.

use crate::varying_parameter::VaryingParameter;
use arclength::continuation::{Reason, Stop, Wording};
use kingpin_report::NamedNumbers;
use kingpin_report::numbers::readable;
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
    pub fn of<R: Reason>(stop: &Stop<R>, varying: &[VaryingParameter], last: NamedNumbers) -> Self {
        Self::told(stop, varying, &[], last)
    }

    fn told<R: Reason>(
        stop: &Stop<R>,
        varying: &[VaryingParameter],
        monitors: &[String],
        last: NamedNumbers,
    ) -> Self {
        let named = varying.iter().map(|parameter| (parameter.key.as_str(), parameter.unit.as_deref()));
        let wording = Wording::of(named).monitors(monitors.iter().map(String::as_str));
        let explanation = stop.explain(&wording);
        Self { cause: explanation.cause, last, remedy: explanation.remedy.map(str::to_owned) }
    }

    /// The same where a branch may start at a point of another one: then there is no stop.
    pub fn of_either<R: Reason>(
        stop: Option<&Stop<R>>,
        varying: &[VaryingParameter],
        last: NamedNumbers,
    ) -> Self {
        Self::monitored(stop, varying, &[], last)
    }

    /// The same where monitors were asked for, with their names.
    pub fn monitored<R: Reason>(
        stop: Option<&Stop<R>>,
        varying: &[VaryingParameter],
        monitors: &[String],
        last: NamedNumbers,
    ) -> Self {
        match stop {
            Some(stop) => Self::told(stop, varying, monitors, last),
            None => Self::start(last),
        }
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
