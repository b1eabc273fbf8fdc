//! What a time history is asked for by, and how it is computed.

use super::result::HistoryResult;
use crate::error::Error;
use crate::model::ChosenModel;
use crate::model_request::{ModelRequest, OpenedModel};
use arclength::integration::{Integrator, from_fn};
use serde::{Deserialize, Serialize};
use std::ops::RangeInclusive;

/// Relative tolerance; the absolute one is a hundredth of it.
const TOLERANCE: f64 = 1e-10;

/// A time history from the initial state of the model.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct SimulateRequest {
    /// The model, or the labelled point.
    pub model: ModelRequest,
    /// Time.
    pub duration: f64,
    /// Number of samples, at equal distances from 0 to the end.
    #[serde(default = "SimulateRequest::default_points")]
    pub points: u64,
}

/// A request that makes sense, with its model.
#[derive(Clone, Debug)]
pub struct SimulateAnalysis {
    chosen: ChosenModel,
    warnings: Vec<String>,
    times: Vec<f64>,
}

impl SimulateRequest {
    /// Numbers of samples that are allowed.
    pub const POINTS: RangeInclusive<u64> = 2..=1_000_000;

    /// Number of samples where none was given.
    pub const fn default_points() -> u64 {
        1001
    }

    /// A request with the default of everything else.
    pub fn new(model: ModelRequest, duration: f64) -> Self {
        Self { model, duration, points: Self::default_points() }
    }

    /// Reads the model and checks every field.
    ///
    /// # Errors
    /// What is wrong with the model or a field.
    pub fn validate(&self) -> Result<SimulateAnalysis, Error> {
        if !(self.duration > 0.0 && self.duration.is_finite()) {
            let given = self.duration.to_string();
            return Err(Error::invalid(&["duration"], given, "not a duration", "positive and finite"));
        }
        if !Self::POINTS.contains(&self.points) {
            let allowed = format!("{} to {}", Self::POINTS.start(), Self::POINTS.end());
            return Err(Error::invalid(&["points"], self.points.to_string(), "too few or too many", allowed));
        }
        let OpenedModel { chosen, warnings, .. } = self.model.open()?;
        let last = (self.points - 1) as f64;
        let times = (0..self.points).map(|index| self.duration * (index as f64 / last)).collect();
        Ok(SimulateAnalysis { chosen, warnings, times })
    }
}

impl SimulateAnalysis {
    /// What is worth knowing before it runs.
    pub fn warnings(&self) -> &[String] {
        &self.warnings
    }

    /// Integrates the motion.
    ///
    /// # Errors
    /// [`Error::Integration`].
    pub fn run(&self) -> Result<HistoryResult, Error> {
        let chosen = &self.chosen;
        let system = from_fn(chosen.model.states().len(), |time, state, derivative| {
            chosen.model.evaluate_at(time, state, &chosen.parameters, derivative);
        });
        let solution = Integrator::with_tolerance(TOLERANCE).sample(system, &chosen.start, &self.times)?;
        let values = |index: usize| solution.samples().map(|(_, state)| state[index]).collect();
        let states = (0..chosen.model.states().len()).map(values).collect();
        Ok(HistoryResult::new(chosen, self.times.clone(), states))
    }
}
