//! What Hopf points are asked for by, and how they are found.

use super::result::HopfResult;
use super::search::search;
use crate::along::along;
use crate::error::Error;
use crate::wheel_request::WheelRequest;
use arclength_analysis::Interval;
use kingpin::Wheel;
use kingpin::branches::Along;
use serde::{Deserialize, Serialize};

/// Hopf points of the uniform motion along a parameter.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct HopfRequest {
    /// Which wheel.
    #[serde(flatten)]
    pub wheel: WheelRequest,
    /// Parameter and its interval; r may reach infinity.
    pub along: Interval,
}

/// A request that makes sense, with its wheel.
#[derive(Clone, Debug)]
pub struct HopfAnalysis {
    wheel: Wheel,
    along: Along,
}

impl HopfRequest {
    /// A request for the paper's wheel.
    pub fn new(along: Interval) -> Self {
        Self { wheel: WheelRequest::default(), along }
    }

    /// Reads the wheel and checks every field.
    ///
    /// # Errors
    /// What is wrong with the wheel or the interval.
    pub fn validate(&self) -> Result<HopfAnalysis, Error> {
        Ok(HopfAnalysis { wheel: self.wheel.read()?, along: along(&self.along)? })
    }
}

impl HopfAnalysis {
    /// Follows the uniform motion and finds its Hopf points.
    ///
    /// # Errors
    /// [`Error::NothingFound`] where there is none, and those of the search.
    pub fn run(&self) -> Result<HopfResult, Error> {
        let search = search(&self.wheel, self.along)?;
        Ok(HopfResult::new(self.wheel, self.along, &search))
    }
}
