//! As much of a result of shimmy as its diagram shows, read back from its file.

use super::drawn_point::DrawnPoint;
use super::picture::diagram;
use super::result::ShimmyResult;
use crate::along::along;
use crate::error::Error;
use crate::parameters::wheel_of;
use arclength_analysis::{Interval, VaryingParameter};
use kingpin_figure::Figure;
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
