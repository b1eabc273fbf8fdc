//! What a stability chart is asked for by, and how it is computed.

use super::overlay::{Overlay, wheels};
use super::result::{ChartResult, GROWTH_RATE, ROLLS, STABLE};
use crate::axis::{axis, conversion};
use crate::by_chunks::{ByChunks, Keep, in_a_chunk};
use crate::error::{Error, unless_stopped};
use crate::parameters::parameters_of;
use crate::wheel_request::WheelRequest;
use arclength_analysis::{Assignment, Control, SampledInterval};
use kingpin::{GrowthRateChart, Key, Plane, Wheel};
use kingpin_report::{Columns, Entries, Number};
use serde::{Deserialize, Serialize};
use serde_json::{Value, json};
use std::ops::Range;

/// Most points of a chart; with everything that is written of them they take about a gigabyte of memory.
const MOST_POINTS: usize = 10_000_000;

/// Most points of a chunk of a run that is divided into shards: some seconds of work with a tyre, less without.
const MOST_OF_A_CHUNK: usize = 1 << 16;

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
    /// What tells it from any other.
    computation: Value,
}

impl ChartRequest {
    /// Reads the wheel and checks every field.
    ///
    /// # Errors
    /// What is wrong with the wheel or an axis; too many points.
    pub fn validate(&self) -> Result<ChartAnalysis, Error> {
        self.validate_for(self.wheel.read()?)
    }

    /// The same for a wheel that was read.
    pub(crate) fn validate_for(&self, wheel: Wheel) -> Result<ChartAnalysis, Error> {
        self.x.check_count(&["x"])?;
        self.y.check_count(&["y"])?;
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
        let ends = |axis: &kingpin::Axis| (axis.key().name(), Number(axis.start()), Number(axis.end()));
        let overlaid = |(key, value, _): &(Key, f64, Wheel)| (key.name(), Number(*value));
        let computation = json!({
            "program": env!("CARGO_PKG_VERSION"),
            "command": "chart",
            "parameters": parameters_of(&wheel, &[plane.x().key(), plane.y().key()]),
            "axes": [ends(plane.x()), ends(plane.y())],
            "counts": points,
            "overlay": overlays.iter().map(overlaid).collect::<Vec<_>>(),
        });
        Ok(ChartAnalysis { wheel, plane, points, overlays, warnings, computation })
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
        self.result(chart, control)
    }

    /// The result of a chart, with all limits.
    fn result(&self, chart: GrowthRateChart, control: &Control<'_>) -> Result<ChartResult, Error> {
        let part = |index: usize| HALF + (1.0 - HALF) * index as f64 / self.overlays.len() as f64;
        let mut overlays = Vec::with_capacity(self.overlays.len());
        for (index, (key, value, wheel)) in self.overlays.iter().enumerate() {
            let control = control.part(part(index)..part(index + 1));
            overlays.push(Overlay::trace(*key, *value, wheel, &self.plane, &control)?);
        }
        let result = ChartResult::new(self.wheel, self.plane, chart, overlays, &control.quiet())?;
        // Whoever stopped it does not want to wait until it is written.
        unless_stopped(control)?;
        Ok(result)
    }
}

impl ByChunks for ChartAnalysis {
    type Result = ChartResult;

    fn computation(&self) -> &Value {
        &self.computation
    }

    fn points(&self) -> usize {
        self.points[0] * self.points[1]
    }

    fn chunk(&self, shards: usize) -> Result<usize, Error> {
        Ok(in_a_chunk(self.points(), MOST_OF_A_CHUNK, shards))
    }

    fn compute(&self, chunks: &[Range<usize>], keep: Keep<'_>, control: &Control<'_>) -> Result<(), Error> {
        let [x, y] = self.values();
        let part = |chunk: usize| chunk as f64 / chunks.len() as f64;
        for (index, chunk) in chunks.iter().enumerate() {
            let control = control.part(part(index)..part(index + 1));
            let rates = self.wheel.growth_rates(&self.plane, self.points, chunk.clone(), &control)?;
            let columns = Columns::new()
                .numbers(self.plane.x().key().name(), chunk.clone().map(|point| x[point % x.len()]))
                .numbers(self.plane.y().key().name(), chunk.clone().map(|point| y[point / x.len()]))
                .optional_numbers(GROWTH_RATE, rates.growth_rate)
                .booleans(STABLE, rates.stable)
                .booleans(ROLLS, rates.rolls.into_iter().map(Some));
            keep(index, &columns);
        }
        Ok(())
    }

    fn put_together(&self, columns: &Columns, control: &Control<'_>) -> Result<Option<ChartResult>, Error> {
        let [growth_rate, stable, rolls] = [GROWTH_RATE, STABLE, ROLLS].map(|name| columns.named(name));
        let (
            Some(Entries::Numbers(growth_rate)),
            Some(Entries::Booleans(stable)),
            Some(Entries::Booleans(rolls)),
        ) = (growth_rate, stable, rolls)
        else {
            return Ok(None);
        };
        let [x, y] = self.values();
        let rolls = rolls.iter().map(|rolls| *rolls == Some(true)).collect();
        let (growth_rate, stable) = (growth_rate.clone(), stable.clone());
        self.result(GrowthRateChart { x, y, growth_rate, stable, rolls }, control).map(Some)
    }
}

impl ChartAnalysis {
    /// The values of both parameters.
    fn values(&self) -> [Vec<f64>; 2] {
        [self.plane.x().values(self.points[0]), self.plane.y().values(self.points[1])]
    }
}
