//! What a stability chart is asked for by, and how it is computed.

use super::overlay::{Overlay, wheels};
use super::result::ChartResult;
use crate::axis::{axis, conversion};
use crate::error::Error;
use crate::wheel_request::WheelRequest;
use arclength_analysis::{Assignment, Control, SampledInterval};
use kingpin::{Key, Plane, Wheel};
use serde::{Deserialize, Serialize};

/// Most points of a chart; with everything that is written of them they take about a gigabyte of memory.
const MOST_POINTS: usize = 10_000_000;

/// Part of the time that the chart itself takes where there are overlays, roughly.
const HALF: f64 = 0.5;

/// A stability chart over any two parameters.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct ChartRequest {
    /// Which wheel.
    #[serde(flatten)]
    pub wheel: WheelRequest,
    /// Parameter across.
    pub x: SampledInterval,
    /// Parameter upwards.
    pub y: SampledInterval,
    /// Third parameters with lists of values, `r=0.5,1,inf`, for each of which the limits are drawn over the chart.
    pub overlay: Vec<Assignment>,
}

impl Default for ChartRequest {
    fn default() -> Self {
        Self {
            wheel: WheelRequest::default(),
            x: SampledInterval::new("v", 0.1, 12.0, 240),
            y: SampledInterval::new("l", 0.02, 0.3, 141),
            overlay: Vec::new(),
        }
    }
}

/// A request that makes sense, with its wheel.
#[derive(Clone, Debug)]
pub struct ChartAnalysis {
    wheel: Wheel,
    plane: Plane,
    points: [usize; 2],
    /// The wheels of the overlays, with the parameter in which they differ and its value.
    overlays: Vec<(Key, f64, Wheel)>,
    warnings: Vec<String>,
}

impl ChartRequest {
    /// Reads the wheel and checks every field.
    ///
    /// # Errors
    /// What is wrong with the wheel or an axis; too many points.
    pub fn validate(&self) -> Result<ChartAnalysis, Error> {
        self.x.check_count(&["x"])?;
        self.y.check_count(&["y"])?;
        let wheel = self.wheel.read()?;
        let plane = Plane::new(axis(&self.x.interval)?, axis(&self.y.interval)?)?;
        let points = [self.x.count, self.y.count];
        if points[0].checked_mul(points[1]).is_none_or(|points| points > MOST_POINTS) {
            return Err(Error::invalid(
                &["x", "y"],
                format!("{} x {} points", points[0], points[1]),
                "too many",
                format!("at most {MOST_POINTS} points in all"),
            ));
        }
        let axes = [(&self.x.interval, plane.x()), (&self.y.interval, plane.y())];
        let warnings = axes.into_iter().filter_map(|(interval, axis)| conversion(interval, axis)).collect();
        let overlays = wheels(&self.overlay, &wheel, &plane)?;
        Ok(ChartAnalysis { wheel, plane, points, overlays, warnings })
    }
}

impl ChartAnalysis {
    /// What is worth knowing before it runs.
    pub fn warnings(&self) -> &[String] {
        &self.warnings
    }

    /// Computes the chart.
    ///
    /// # Errors
    /// [`Error::Wheel`], and [`Error::Stopped`] where the control stops it.
    pub fn run(&self, control: &Control<'_>) -> Result<ChartResult, Error> {
        let on_the_way = if self.overlays.is_empty() { 1.0 } else { HALF };
        let chart = self.wheel.growth_rate_chart(&self.plane, self.points, &control.part(0.0..on_the_way))?;
        let part = |index: usize| HALF + (1.0 - HALF) * index as f64 / self.overlays.len() as f64;
        let mut overlays = Vec::with_capacity(self.overlays.len());
        for (index, (key, value, wheel)) in self.overlays.iter().enumerate() {
            let control = control.part(part(index)..part(index + 1));
            overlays.push(Overlay::trace(*key, *value, wheel, &self.plane, &control)?);
        }
        ChartResult::new(self.wheel, self.plane, chart, overlays, &control.quiet())
    }
}
