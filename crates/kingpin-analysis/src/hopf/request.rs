//! What Hopf points are asked for by, and how they are found.

use super::result::HopfResult;
use super::search::search;
use crate::along::along;
use crate::error::Error;
use crate::monitors::{names, on_motions};
use crate::wheel_request::WheelRequest;
use arclength::equilibrium::equilibrium_settings;
use arclength_analysis::{Control, Interval, Monitored, Steps};
use kingpin::Wheel;
use kingpin::branches::{Along, MotionOptions};
use serde::{Deserialize, Serialize};

/// Hopf points of the uniform motion along a parameter.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct HopfRequest {
    /// Which wheel.
    #[serde(flatten)]
    pub wheel: WheelRequest,
    /// Parameter and its interval; r may reach infinity.
    pub along: Interval,
    /// What is recorded along the uniform motions, with values at which one is wanted or the search ends.
    #[serde(default)]
    pub monitors: Vec<Monitored>,
    /// How steps are taken.
    #[serde(flatten)]
    pub steps: Steps,
}

/// A request that makes sense, with its wheel.
#[derive(Clone, Debug)]
pub struct HopfAnalysis {
    wheel: Wheel,
    along: Along,
    options: MotionOptions,
}

impl HopfRequest {
    /// A request for the paper's wheel.
    pub fn new(along: Interval) -> Self {
        Self { wheel: WheelRequest::default(), along, monitors: Vec::new(), steps: Steps::default() }
    }

    /// Reads the wheel and checks every field.
    ///
    /// # Errors
    /// What is wrong with the wheel or the interval.
    pub fn validate(&self) -> Result<HopfAnalysis, Error> {
        self.steps.check()?;
        let wheel = self.wheel.read()?;
        let settings = self.steps.settings(equilibrium_settings());
        let mut options = MotionOptions::default().settings(settings);
        for asked in &self.monitors {
            options = options.monitor(on_motions(asked, &wheel)?);
        }
        Ok(HopfAnalysis { wheel, along: along(&self.along)?, options })
    }
}

impl HopfAnalysis {
    /// Follows the uniform motion and finds its Hopf points. Where the control stops it the result is what there is up to there.
    ///
    /// # Errors
    /// [`Error::NothingFound`] where there is none, [`Error::Stopped`] where there is none yet, and those of the search.
    pub fn run(&self, control: &Control<'_>) -> Result<HopfResult, Error> {
        let branch = search(&self.wheel, self.along, &self.options, control)?;
        Ok(HopfResult::new(self.wheel, self.along, &branch, &names(&self.options.monitors))?)
    }
}
