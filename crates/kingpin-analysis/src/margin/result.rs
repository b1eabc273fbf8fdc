//! Safe disturbances along a parameter as a result.

use super::found::Found;
use super::unstable_cycles::UnstableCycles;
use crate::along::varying;
use crate::disturbance::Edge;
use crate::parameters::parameters_over;
use crate::{axis_label, description};
use arclength_analysis::VaryingParameter;
use kingpin::basin::{ContactModel, Disturbance};
use kingpin::branches::Along;
use kingpin::{Key, Wheel};
use kingpin_figure::{Axis, Figure, FigureError, Legend, Line, Marker, MarkerShape, Markers, Panel, palette};
use kingpin_report::numbers::{counted, readable};
use kingpin_report::{Cell, Columns, Parameters, Report, Schema, Table};
use serde::Serialize;
use std::io::{self, Write};

/// What is said where nothing is safe at any value.
const NONE_IS_SAFE: &str = "at all of these values small motions grow: no disturbance is safe, and there is no limit cycle that bounds what is";

/// One value of the parameter.
#[derive(Debug, Serialize)]
pub struct MarginPoint {
    /// Value of the parameter.
    pub value: f64,
    /// Distance of the disturbances that were tried: failures in a narrower range may lie below an edge.
    pub resolution: f64,
    /// What was found there.
    #[serde(flatten)]
    pub found: Found,
    /// The largest disturbance that returned in the direction in which fewer do; nothing where it is undecided what lies beyond.
    pub safe: Option<f64>,
    /// Half the range of the caster angle of the unstable limit cycle, in rad; nothing where no disturbance is safe, and it bounds nothing.
    pub unstable_amplitude: Option<f64>,
    /// The safe disturbance in units of it.
    pub ratio: Option<f64>,
}

impl MarginPoint {
    fn new(value: f64, resolution: f64, found: Found, unstable_amplitude: Option<f64>) -> Self {
        let edges = [found.positive, found.negative].into_iter().flatten();
        let nearest = edges.min_by(|a, b| a.fails.abs().total_cmp(&b.fails.abs()));
        let safe = nearest.filter(|edge| !edge.is_undecided()).map(|edge| edge.returns.abs());
        let unstable_amplitude = unstable_amplitude.filter(|_| safe != Some(0.0));
        let ratio = safe.zip(unstable_amplitude).map(|(safe, amplitude)| safe / amplitude);
        Self { value, resolution, found, safe, unstable_amplitude, ratio }
    }

    /// What is to be said of it beside the numbers; `dry` tells of dry friction about the king pin.
    fn remark(&self, dry: bool) -> String {
        if let Some(problem) = &self.found.problem {
            return problem.clone();
        }
        let edges = [self.found.positive, self.found.negative];
        if edges.iter().all(Option::is_none) {
            return "all that were tried return".to_owned();
        }
        if self.safe == Some(0.0) {
            let dry_or_not = if dry {
                "small motions grow in spite of dry friction"
            } else {
                "the uniform motion is unstable"
            };
            return dry_or_not.to_owned();
        }
        let ends: Vec<&str> = edges.into_iter().flatten().map(|edge| edge.ending()).collect();
        let mut distinct = ends.clone();
        distinct.dedup();
        distinct.join(", ")
    }

    fn is_undecided(&self) -> bool {
        let edges = [self.found.positive, self.found.negative].into_iter().flatten();
        edges.min_by(|a, b| a.fails.abs().total_cmp(&b.fails.abs())).is_some_and(|edge| edge.is_undecided())
    }
}

/// How the ratio of the safe disturbance to the amplitude of the unstable cycle varies.
#[derive(Debug, Serialize)]
pub struct Indicator {
    /// Number of values with both.
    pub values: usize,
    /// The smallest ratio.
    pub smallest_ratio: f64,
    /// The largest ratio.
    pub largest_ratio: f64,
    /// Correlation coefficient of the two (Pearson).
    pub correlation: Option<f64>,
}

impl Indicator {
    fn of(points: &[MarginPoint]) -> Option<Self> {
        let pairs: Vec<(f64, f64)> =
            points.iter().filter_map(|point| point.safe.zip(point.unstable_amplitude)).collect();
        let ratios = pairs.iter().map(|(safe, amplitude)| safe / amplitude);
        let [smallest_ratio, largest_ratio] = ratios
            .fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], ratio| [low.min(ratio), high.max(ratio)]);
        (pairs.len() >= 2).then(|| Self {
            values: pairs.len(),
            smallest_ratio,
            largest_ratio,
            // Two pairs lie on a straight line whatever they are.
            correlation: (pairs.len() >= 3).then(|| correlation(&pairs)).flatten(),
        })
    }
}

/// The largest disturbance that returned, unless it is undecided what lies beyond.
fn safe(edge: Option<Edge>) -> Cell {
    match edge {
        Some(edge) if edge.is_undecided() => "undecided".into(),
        edge => edge.map(|edge| edge.returns).into(),
    }
}

fn correlation(pairs: &[(f64, f64)]) -> Option<f64> {
    let count = pairs.len() as f64;
    let mean = |of: fn(&(f64, f64)) -> f64| pairs.iter().map(of).sum::<f64>() / count;
    let (a, b) = (mean(|pair| pair.0), mean(|pair| pair.1));
    let [mut covariance, mut first, mut second] = [0.0; 3];
    for (x, y) in pairs {
        covariance += (x - a) * (y - b);
        first += (x - a).powi(2);
        second += (y - b).powi(2);
    }
    let value = covariance / (first * second).sqrt();
    value.is_finite().then_some(value)
}

/// Safe disturbances along a parameter.
#[derive(Debug, Serialize)]
pub struct MarginResult {
    /// The wheel.
    #[serde(skip)]
    pub wheel: Wheel,
    /// The parameter and its interval.
    #[serde(skip)]
    pub interval: Along,
    /// The parameter that varies.
    pub along: VaryingParameter,
    /// The kind of disturbance.
    pub kind: &'static str,
    /// Its unit.
    pub unit: &'static str,
    /// `rolling` or `sliding`.
    pub contact: &'static str,
    /// What was found at its values.
    pub points: Vec<MarginPoint>,
    /// How good an indicator the amplitude is; nothing without two values that have both.
    pub indicator: Option<Indicator>,
    /// Why there is no unstable limit cycle at some values.
    pub remarks: Vec<String>,
}

impl MarginResult {
    /// The result of what was found at each value, which comes with the distance of the disturbances that were tried there.
    pub(super) fn new(
        wheel: Wheel,
        interval: Along,
        kind: Disturbance,
        model: ContactModel,
        values: Vec<(f64, f64)>,
        cells: Vec<Found>,
        cycles: UnstableCycles,
    ) -> Self {
        let points: Vec<MarginPoint> = values
            .into_iter()
            .zip(cells)
            .zip(cycles.amplitudes)
            .map(|(((value, resolution), cell), amplitude)| {
                MarginPoint::new(value, resolution, cell, amplitude)
            })
            .collect();
        let mut remarks = cycles.remarks;
        if !points.is_empty() && points.iter().all(|point| point.safe == Some(0.0)) {
            // Which cycles there are elsewhere is of no use then.
            remarks = vec![NONE_IS_SAFE.to_owned()];
        }
        Self {
            wheel,
            interval,
            along: varying(&interval),
            kind: kind.name(),
            unit: kind.unit(),
            contact: model.name(),
            indicator: Indicator::of(&points),
            remarks,
            points,
        }
    }

    fn described(&self, wheel: impl Fn(&Wheel, &[Key]) -> String) -> String {
        let how = if self.contact == "rolling" { "ideal rolling" } else { "rolling and sliding" };
        format!("{how} at {}", wheel(&self.wheel, &[self.interval.key()]))
    }

    fn curve(&self, of: impl Fn(&MarginPoint) -> Option<f64>) -> Vec<(f64, f64)> {
        self.points.iter().map(|point| (point.value, of(point).unwrap_or(f64::NAN))).collect()
    }
}

impl MarginResult {
    /// Whether dry friction acts about the king pin at a point.
    fn is_dry(&self, point: &MarginPoint) -> bool {
        let varies = self.interval.key() == Key::MF;
        if varies { point.value > 0.0 } else { self.wheel.get(Key::MF) > 0.0 }
    }
}

impl Report for MarginResult {
    fn schema(&self) -> Schema {
        Schema::first("kingpin.margin")
    }

    fn parameters(&self) -> Parameters {
        parameters_over(&self.wheel, &[(self.interval.key(), self.interval.ends().into())])
    }

    fn write_table(&self, out: &mut dyn Write) -> io::Result<()> {
        let (key, unit) = (self.interval.key(), self.unit);
        writeln!(out, "{}", self.described(description::on_lines))?;
        writeln!(out, "largest safe {} in either direction, and the unstable limit cycle\n", self.kind)?;
        let mut table = Table::new([
            format!("{key} ({})", key.unit()),
            format!("positive ({unit})"),
            format!("negative ({unit})"),
            "amplitude of psi (rad)".to_owned(),
            "ratio".to_owned(),
            "beyond".to_owned(),
        ]);
        for point in &self.points {
            table.row([
                point.value.into(),
                safe(point.found.positive),
                safe(point.found.negative),
                point.unstable_amplitude.into(),
                point.ratio.into(),
                point.remark(self.is_dry(point)).into(),
            ]);
        }
        table.write(out)?;
        if let Some(indicator) = &self.indicator {
            writeln!(
                out,
                "\nat {} the safe {} is {} to {} {unit} per rad of amplitude{}",
                counted(indicator.values, "value", "values"),
                self.kind,
                readable(indicator.smallest_ratio),
                readable(indicator.largest_ratio),
                indicator.correlation.map_or(String::new(), |value| format!(", correlation {value:.3}")),
            )?;
        }
        self.remarks.iter().try_for_each(|remark| writeln!(out, "\n{remark}"))
    }

    fn columns(&self) -> Columns {
        let points = || self.points.iter();
        let key = self.interval.key();
        Columns::new()
            .numbers(key.name(), points().map(|point| point.value))
            .unit(key.unit())
            .optional_numbers("positive_returns", points().map(|p| p.found.positive.map(|edge| edge.returns)))
            .unit(self.unit)
            .optional_numbers("positive_fails", points().map(|p| p.found.positive.map(|edge| edge.fails)))
            .unit(self.unit)
            .optional_numbers("negative_returns", points().map(|p| p.found.negative.map(|edge| edge.returns)))
            .unit(self.unit)
            .optional_numbers("negative_fails", points().map(|p| p.found.negative.map(|edge| edge.fails)))
            .unit(self.unit)
            .optional_numbers("unstable_amplitude", points().map(|point| point.unstable_amplitude))
            .unit("rad")
            .optional_numbers("ratio", points().map(|point| point.ratio))
            .texts("beyond", points().map(|point| Some(point.remark(self.is_dry(point)))))
    }

    fn figure(&self) -> Result<Option<Figure>, FigureError> {
        let (start, end) = self.interval.ends();
        let label = axis_label::of(self.interval.key());
        let x = || Axis::new(label.clone()).limits(start, end);
        let largest = |values: &[(f64, f64)]| values.iter().fold(0.0_f64, |top, point| top.max(point.1));
        let decided = |edge: Option<Edge>| edge.filter(|edge| !edge.is_undecided());
        let positive = self.curve(|point| decided(point.found.positive).map(|edge| edge.returns));
        let negative = self.curve(|point| decided(point.found.negative).map(|edge| edge.returns.abs()));
        let amplitude = self.curve(|point| point.unstable_amplitude);
        let top = 1.1 * largest(&positive).max(largest(&negative));
        let name = self.kind.replace('-', " ");
        let mut kicks = Panel::new(
            x().without_labels(),
            Axis::new(format!("safe {name} ({})", self.unit)).limits(0.0, top),
        )
        .curve(Line::new(positive).color(palette::BLUE).legend("positive"))
        .curve(Line::new(negative).color(palette::VERMILION).dashed().legend("negative"));
        let undecided: Vec<(f64, f64)> =
            self.points.iter().filter(|point| point.is_undecided()).map(|point| (point.value, 0.0)).collect();
        if !undecided.is_empty() {
            let marker = Marker::new(MarkerShape::Circle).open().color(palette::BLACK);
            kicks = kicks.markers(Markers::new(undecided, marker).legend("undecided"));
        }
        let top = 1.1 * largest(&amplitude);
        let cycles = Panel::new(x(), Axis::new("amplitude of $\\psi$ (rad)").limits(0.0, top))
            .curve(Line::new(amplitude).color(palette::BLACK).legend("unstable limit cycle"))
            .legend(Legend::Emptiest);
        let description = format!(
            "Largest safe {} and amplitude of the unstable limit cycle against {}: {}",
            self.kind,
            self.interval.key(),
            self.described(description::of)
        );
        let figure = Figure::single_column().columns(1).height_mm(110.0).description(description);
        Ok(Some(figure.panel(kicks).panel(cycles)))
    }
}
