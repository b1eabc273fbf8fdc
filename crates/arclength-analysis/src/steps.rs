//! How steps along a branch are taken, and how finely cycles are resolved: parts of many requests.

use crate::error::InvalidField;
use arclength::continuation::Settings;
use arclength::cycle::Resolution;
use serde::{Deserialize, Serialize};
use std::ops::RangeInclusive;

/// How steps along a branch are taken.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct Steps {
    /// Most steps in one direction.
    pub steps: u32,
    /// Steps are so many times shorter, so that special points that lie close together are told apart.
    pub finer: u32,
}

impl Default for Steps {
    fn default() -> Self {
        Self { steps: 10_000, finer: 1 }
    }
}

impl Steps {
    /// Numbers of steps that are allowed.
    pub const STEPS: RangeInclusive<u32> = 1..=10_000_000;
    /// Factors that are allowed.
    pub const FINER: RangeInclusive<u32> = 1..=100_000;

    /// That both are allowed.
    ///
    /// # Errors
    /// The field that is not.
    pub fn check(&self) -> Result<(), InvalidField> {
        check_count(&["steps"], self.steps, &Self::STEPS)?;
        check_count(&["finer"], self.finer, &Self::FINER)
    }

    /// The settings of a continuation with these steps.
    pub fn settings(&self, settings: Settings) -> Settings {
        let finer = f64::from(self.finer);
        settings
            .most_steps(self.steps as usize)
            .initial_step(settings.initial_step / finer)
            .largest_step(settings.largest_step / finer)
            .largest_parameter_change(settings.largest_parameter_change / finer)
            // The distance between prediction and solution falls with the square of the step.
            .predictor_error(settings.predictor_error / (finer * finer))
            .smallest_step(settings.smallest_step.min(settings.initial_step / finer / 1e3))
    }
}

/// How finely cycles are resolved.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct Mesh {
    /// Error estimate, relative to the amplitude, that no cycle exceeds; the mesh follows from it.
    pub tolerance: f64,
    /// Most mesh intervals.
    pub intervals: u32,
}

impl Default for Mesh {
    fn default() -> Self {
        Self { tolerance: Resolution::default().tolerance, intervals: 2000 }
    }
}

impl Mesh {
    /// Tolerances that are allowed.
    pub const TOLERANCE: RangeInclusive<f64> = 1e-13..=0.1;
    /// Numbers of intervals that are allowed.
    pub const INTERVALS: RangeInclusive<u32> = 4..=100_000;

    /// That both are allowed.
    ///
    /// # Errors
    /// The field that is not.
    pub fn check(&self) -> Result<(), InvalidField> {
        if !Self::TOLERANCE.contains(&self.tolerance) {
            return Err(InvalidField {
                fields: &["tolerance"],
                given: self.tolerance.to_string(),
                problem: "out of range".to_owned(),
                allowed: format!("{:e} to {}", Self::TOLERANCE.start(), Self::TOLERANCE.end()),
            });
        }
        check_count(&["intervals"], self.intervals, &Self::INTERVALS)
    }

    /// The resolution of the collocation.
    pub fn resolution(&self) -> Resolution {
        Resolution { most_intervals: self.intervals as usize, ..Resolution::with_tolerance(self.tolerance) }
    }
}

fn check_count(
    fields: &'static [&'static str],
    given: u32,
    allowed: &RangeInclusive<u32>,
) -> Result<(), InvalidField> {
    if allowed.contains(&given) {
        return Ok(());
    }
    Err(InvalidField {
        fields,
        given: given.to_string(),
        problem: "out of range".to_owned(),
        allowed: format!("{} to {}", allowed.start(), allowed.end()),
    })
}
