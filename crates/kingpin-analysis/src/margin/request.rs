//! What safe disturbances along a parameter are asked for by, and how they are found.

use super::found::Found;
use super::result::MarginResult;
use super::unstable_cycles::unstable_cycles;
use crate::along::along;
use crate::classification::{Classification, Contact};
use crate::disturbance::{DisturbanceRequest, reached};
use crate::error::{Error, unless_stopped};
use crate::journal::Journal;
use crate::parameters::parameters_of;
use crate::wheel_request::WheelRequest;
use arclength_analysis::{Control, SampledInterval};
use kingpin::Wheel;
use kingpin::basin::SafeKick;
use kingpin::branches::Along;
use kingpin::parallel;
use serde::{Deserialize, Serialize};
use serde_json::{Value, json};
use std::path::Path;

/// Most values of the parameter.
const MOST_POINTS: usize = 10_000;

/// Safe disturbances along a parameter, beside the amplitude of the unstable limit cycle.
///
/// At each value the smallest disturbance that does not return is found as by `safe-kick`, in both directions. The paper takes
/// the amplitude of the unstable cycle for the size of the basin; the ratio of the two tells how good an indicator it is.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct MarginRequest {
    /// Which wheel.
    #[serde(flatten)]
    pub wheel: WheelRequest,
    /// Parameter and its values.
    pub along: SampledInterval,
    /// Which disturbance.
    #[serde(flatten)]
    pub disturbance: DisturbanceRequest,
    /// How motions are followed.
    #[serde(flatten)]
    pub classification: Classification,
}

impl Default for MarginRequest {
    fn default() -> Self {
        Self {
            wheel: WheelRequest::default(),
            along: SampledInterval::new("v", 1.0, 8.0, 15),
            disturbance: DisturbanceRequest::default(),
            classification: Classification::default(),
        }
    }
}

/// A request that makes sense, with its wheel.
#[derive(Clone, Debug)]
pub struct MarginAnalysis {
    wheel: Wheel,
    along: Along,
    values: Vec<f64>,
    disturbance: DisturbanceRequest,
    classification: Classification,
    contact: Contact,
    /// What the journal says that it belongs to.
    computation: Value,
}

impl MarginRequest {
    /// Reads the wheel and checks every field.
    ///
    /// # Errors
    /// What is wrong with the wheel or a field.
    pub fn validate(&self) -> Result<MarginAnalysis, Error> {
        self.validate_for(self.wheel.read()?)
    }

    /// The same for a wheel that was read.
    pub(crate) fn validate_for(&self, wheel: Wheel) -> Result<MarginAnalysis, Error> {
        let along = along(&self.along.interval)?;
        let (key, count) = (along.key(), self.along.count);
        if !(2..=MOST_POINTS).contains(&count) || self.along.interval.end.is_infinite() {
            return Err(Error::invalid(
                &["along"],
                format!("{count} values up to {}", self.along.interval.end),
                "too many, or infinite",
                format!("at most {MOST_POINTS} finite values; `curvature` goes to 0 where r goes to inf"),
            ));
        }
        let (start, end) = along.ends();
        self.disturbance.check(&wheel.with(key, end)?)?;
        if self.classification.duration.is_some() {
            // A duration that makes no sense is refused before anything is computed.
            self.classification.settings(&wheel.with(key, start)?)?;
        }
        let contact = self.classification.contact_by_load(&wheel);
        let computation = json!({
            "program": env!("CARGO_PKG_VERSION"),
            "command": "margin",
            "parameters": parameters_of(&wheel, &[key]),
            "along": (key.name(), start, end, count),
            "kind": self.disturbance.disturbance().name(),
            "largest": self.disturbance.largest,
            "contact": contact.model().name(),
            "duration": self.classification.duration,
        });
        Ok(MarginAnalysis {
            wheel,
            along,
            values: (0..count)
                .map(|index| start + (end - start) * (index as f64 / (count - 1) as f64))
                .collect(),
            disturbance: self.disturbance,
            classification: self.classification,
            contact,
            computation,
        })
    }
}

impl MarginAnalysis {
    /// The journal of the run beside a result file, where its finished parts are kept.
    ///
    /// # Errors
    /// [`Error::Invalid`] and [`Error::Journal`].
    pub fn journal(&self, result: Option<&Path>, resume: bool) -> Result<Journal<Found>, Error> {
        Journal::open(result, &self.computation, resume)
    }

    /// Number of parts in which it runs: the values of the parameter.
    pub fn parts(&self) -> usize {
        self.values.len()
    }

    /// Seeks the edges at every value that the journal has not, and the unstable limit cycles.
    ///
    /// # Errors
    /// A motion that cannot be followed, [`Error::Journal`], and [`Error::Interrupted`] where the control stops it.
    pub fn run(&self, control: &Control<'_>, journal: &Journal<Found>) -> Result<MarginResult, Error> {
        let finished = journal.finished();
        let wanted: Vec<usize> =
            (0..self.values.len()).filter(|index| !finished.contains_key(index)).collect();
        let known = finished.len() as f64 / self.values.len() as f64;
        let keep = |index: usize, found: &Found| journal.keep(index, found, control.stop());
        let computed = self.seek(&wanted, &keep, &control.part(known..1.0))?;
        let found = journal.checked(computed, self.values.len())?;
        self.result(found, control).map_err(|error| match error {
            Error::Stopped => journal.interrupted(self.values.len(), self.values.len()),
            error => error,
        })
    }

    /// Seeks the edges at some of the values, and hands each over as soon as it is known, until all are or the control stops it.
    ///
    /// # Errors
    /// A motion that cannot be followed.
    pub(super) fn seek(
        &self,
        wanted: &[usize],
        keep: &(dyn Fn(usize, &Found) + Sync),
        control: &Control<'_>,
    ) -> Result<Vec<(usize, Found)>, Error> {
        let progress = control.count(wanted.len());
        let seek = |&index: &usize| {
            let wheel = self.wheel.with(self.along.key(), self.values[index])?;
            let found =
                Found::seek(&wheel, &self.disturbance, &self.classification, self.contact, &control.quiet())?;
            keep(index, &found);
            progress.advance(1);
            Ok((index, found))
        };
        let computed = parallel::try_map(wanted, |index| {
            if control.is_stopped() {
                return Ok(None);
            }
            match seek(index) {
                Ok(found) => Ok(Some(found)),
                Err(Error::Stopped) => Ok(None),
                Err(error) => Err(error),
            }
        })?;
        Ok(computed.into_iter().flatten().collect())
    }

    /// The result of what was found at all values, beside the unstable limit cycles.
    ///
    /// # Errors
    /// [`Error::Stopped`] where the control stops it.
    pub(super) fn result(&self, found: Vec<Found>, control: &Control<'_>) -> Result<MarginResult, Error> {
        let cycles = unstable_cycles(&self.wheel, self.along, &self.values, control)?;
        unless_stopped(control)?;
        let directions = self.disturbance.disturbance().directions();
        let resolution = |(&value, found): (&f64, &Found)| {
            let largest = self.disturbance.largest(&self.wheel.with(self.along.key(), value)?);
            let edges = [found.positive, found.negative].into_iter().take(directions);
            Ok((value, SafeKick::resolution(reached(edges, largest))))
        };
        let values = self.values.iter().zip(&found).map(resolution).collect::<Result<Vec<_>, Error>>()?;
        Ok(MarginResult::new(
            self.wheel,
            self.along,
            self.disturbance.disturbance(),
            self.contact.model(),
            values,
            found,
            cycles,
        ))
    }

    /// The values of the parameter.
    pub(super) fn values(&self) -> &[f64] {
        &self.values
    }

    /// The parameter.
    pub(super) fn along(&self) -> Along {
        self.along
    }

    /// What tells it from any other.
    pub(super) fn computation(&self) -> &Value {
        &self.computation
    }
}
