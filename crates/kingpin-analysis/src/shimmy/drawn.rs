//! As much of a result of shimmy as its diagram shows, read back from its file.

use super::picture::diagram;
use super::point::ShimmyPointResult;
use super::result::ShimmyResult;
use crate::along::along;
use crate::error::Error;
use crate::parameters::wheel_of;
use arclength_analysis::labels::is_bifurcation;
use arclength_analysis::{Interval, VaryingParameter};
use kingpin_figure::{Figure, Stability};
use kingpin_report::{Parameters, Schema};
use serde::Deserialize;

/// A result of shimmy that is to be drawn again.
#[derive(Clone, Debug, Deserialize)]
pub struct DrawnShimmy {
    schema: Schema,
    parameters: Parameters,
    along: VaryingParameter,
    points: Vec<DrawnPoint>,
}

/// A point of it.
#[derive(Clone, Debug, Deserialize)]
pub(super) struct DrawnPoint {
    pub branch: u64,
    pub label: Option<String>,
    #[serde(with = "kingpin_report::number")]
    pub value: f64,
    pub psi_max: f64,
    pub psi_min: f64,
    pub stable: Option<bool>,
}

impl DrawnPoint {
    pub(super) fn stability(&self) -> Stability {
        if is_bifurcation(self.label.as_deref()) {
            Stability::Changes
        } else {
            Stability::from(self.stable == Some(true))
        }
    }
}

impl From<&ShimmyPointResult> for DrawnPoint {
    fn from(point: &ShimmyPointResult) -> Self {
        Self {
            branch: point.branch,
            label: point.label.clone(),
            value: point.value,
            psi_max: point.psi_max,
            psi_min: point.psi_min,
            stable: point.stable,
        }
    }
}

impl DrawnShimmy {
    /// Reads a result file; nothing where it holds something else.
    pub fn of(text: &[u8]) -> Option<Self> {
        let read: Self = serde_json::from_slice(text).ok()?;
        (read.schema == Schema::first(ShimmyResult::SCHEMA)).then_some(read)
    }

    /// Its diagram, as the command that computed it draws it.
    ///
    /// # Errors
    /// Its wheel or its interval is not allowed.
    pub fn figure(&self) -> Result<Figure, Error> {
        let VaryingParameter { key, start, end, .. } = &self.along;
        let wheel = wheel_of(&self.parameters)?;
        Ok(diagram(&wheel, &along(&Interval::new(key, *start, *end))?, &self.points))
    }
}
