//! A stability chart as a result.

use crate::axis_label;
use crate::description;
use crate::error::Error;
use crate::neglected_dry_friction::NeglectedDryFriction;
use crate::parameters::parameters_of;
use arclength_analysis::Control;
use kingpin::{Axis, Curve, GrowthRateChart, Plane, Wheel};
use kingpin_figure::{ColorMap, Figure, FigureError, Grid, HeatMap, Legend, Line, Panel, palette};
use kingpin_report::numbers::{readable, significant};
use kingpin_report::{Columns, Parameters, Report, Schema};
use serde::Serialize;
use std::io::{self, Write};

/// Most characters across and down in the chart that is printed.
const PRINTED: [usize; 2] = [72, 24];
/// Part of the growth rates whose absolute values the colours resolve; the others have the colours of the ends.
const RESOLVED_PART: f64 = 0.85;

fn points_of(curves: Vec<Curve>) -> Vec<Vec<[f64; 2]>> {
    curves.into_iter().map(|curve| curve.points).collect()
}

/// An axis of the grid.
#[derive(Debug, Serialize)]
pub struct SampledAxis {
    /// Key of the parameter.
    pub key: &'static str,
    /// Its unit.
    pub unit: &'static str,
    /// The values.
    pub values: Vec<f64>,
}

impl SampledAxis {
    fn new(axis: &Axis, values: Vec<f64>) -> Self {
        Self { key: axis.key().name(), unit: axis.key().unit(), values }
    }
}

/// A chart, and the boundaries in it as curves of points `[x, y]`.
#[derive(Debug, Serialize)]
pub struct ChartResult {
    /// The wheel.
    #[serde(skip)]
    pub wheel: Wheel,
    /// The plane of the chart.
    #[serde(skip)]
    pub plane: Plane,
    /// The parameter across.
    pub x: SampledAxis,
    /// The parameter upwards.
    pub y: SampledAxis,
    /// Growth rate in 1/s row by row, nothing where there is no uniform motion.
    pub growth_rate: Vec<Option<f64>>,
    /// Whether it is stable; nothing where rounding could decide that either way.
    pub stable: Vec<Option<bool>>,
    /// Whether it rolls.
    pub rolls: Vec<bool>,
    /// The limit of stability, as curves of points.
    pub stability_boundary: Vec<Vec<[f64; 2]>>,
    /// The limit of rolling, as curves of points.
    pub rolling_limit: Vec<Vec<[f64; 2]>>,
    /// Dry friction about the king pin that was left out.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub dry_friction: Option<NeglectedDryFriction>,
}

impl ChartResult {
    /// The result of a chart of a wheel over a plane.
    ///
    /// # Errors
    /// [`Error::Stopped`] where the control stops the tracing of the boundaries.
    pub(super) fn new(
        wheel: Wheel,
        plane: Plane,
        chart: GrowthRateChart,
        control: &Control<'_>,
    ) -> Result<Self, Error> {
        let GrowthRateChart { x, y, growth_rate, stable, rolls } = chart;
        Ok(Self {
            wheel,
            x: SampledAxis::new(plane.x(), x),
            y: SampledAxis::new(plane.y(), y),
            growth_rate,
            stable,
            rolls,
            stability_boundary: points_of(wheel.stability_boundary(&plane, control)?),
            rolling_limit: points_of(wheel.rolling_limit(&plane, control)?),
            dry_friction: NeglectedDryFriction::of(&wheel, &[plane.x().key(), plane.y().key()]),
            plane,
        })
    }

    fn keys(&self) -> [kingpin::Key; 2] {
        [self.plane.x().key(), self.plane.y().key()]
    }

    fn symbol(&self, index: usize) -> char {
        match (self.growth_rate[index], self.stable[index], self.rolls[index]) {
            (None, ..) => ' ',
            (_, Some(true), true) => '+',
            (_, Some(true), false) => 's',
            (_, Some(false), true) => '-',
            (_, Some(false), false) => 'u',
            (_, None, _) => '?',
        }
    }

    /// The limit of the colours, about zero.
    fn color_limit(&self) -> Option<f64> {
        let mut sizes: Vec<f64> = self.growth_rate.iter().flatten().map(|rate| rate.abs()).collect();
        let last = sizes.len().checked_sub(1)?;
        let (_, limit, _) =
            sizes.select_nth_unstable_by((last as f64 * RESOLVED_PART) as usize, f64::total_cmp);
        Some(*limit).filter(|limit| *limit > 0.0)
    }
}

impl Report for ChartResult {
    fn schema(&self) -> Schema {
        Schema::first("kingpin.chart")
    }

    fn parameters(&self) -> Parameters {
        parameters_of(&self.wheel, &self.keys())
    }

    fn write_table(&self, out: &mut dyn Write) -> io::Result<()> {
        let stable = self.stable.iter().filter(|stable| **stable == Some(true)).count();
        let undecided = self.stable.iter().filter(|stable| stable.is_none()).count();
        let points = self.growth_rate.len();
        let exists = self.growth_rate.iter().flatten().count();
        writeln!(out, "uniform motion at {}", description::of(&self.wheel, &self.keys()))?;
        writeln!(
            out,
            "{points} points: it exists at {exists}, is stable at {}, rolls at {}\n",
            stable,
            self.rolls.iter().filter(|rolls| **rolls).count()
        )?;
        let [across, down] = [self.x.values.len().min(PRINTED[0]), self.y.values.len().min(PRINTED[1])];
        let nearest = |place: usize, places: usize, count: usize| place * (count - 1) / (places - 1);
        let labels: Vec<String> = (0..down)
            .map(|place| significant(self.y.values[nearest(place, down, self.y.values.len())], 3))
            .collect();
        let width = labels.iter().map(String::len).max().unwrap_or(0);
        writeln!(out, "{:>width$} ({})", self.y.key, self.y.unit)?;
        for place in (0..down).rev() {
            let row = nearest(place, down, self.y.values.len());
            let symbols: String = (0..across)
                .map(|column| nearest(column, across, self.x.values.len()))
                .map(|column| self.symbol(row * self.x.values.len() + column))
                .collect();
            writeln!(out, "{:>width$} {}", labels[place], symbols.trim_end())?;
        }
        let ends = [readable(self.plane.x().start()), readable(self.plane.x().end())];
        let gap = across.saturating_sub(ends[0].len() + ends[1].len());
        writeln!(out, "{:width$} {}{:gap$}{} {} ({})", "", ends[0], "", ends[1], self.x.key, self.x.unit)?;
        writeln!(
            out,
            "\n+ stable, - unstable; s stable, u unstable, but the friction does not suffice; blank: no motion"
        )?;
        if undecided > 0 {
            writeln!(out, "? undecided, at {undecided} points: rounding could make it stable or unstable")?;
        }
        NeglectedDryFriction::tell(self.dry_friction.as_ref(), out)
    }

    fn columns(&self) -> Columns {
        let [x, y] = [&self.x.values, &self.y.values];
        Columns::new()
            .numbers(self.x.key, y.iter().flat_map(|_| x.iter().copied()))
            .unit(self.x.unit)
            .numbers(self.y.key, y.iter().flat_map(|&y| x.iter().map(move |_| y)))
            .unit(self.y.unit)
            .optional_numbers("growth_rate", self.growth_rate.iter().copied())
            .unit("1/s")
            .booleans("stable", self.stable.iter().copied())
            .booleans("rolls", self.rolls.iter().copied())
    }

    fn figure(&self) -> Result<Option<Figure>, FigureError> {
        let rates: Vec<f64> = self.growth_rate.iter().map(|rate| rate.unwrap_or(f64::NAN)).collect();
        let mut map = HeatMap::new(Grid::new(self.x.values.clone(), self.y.values.clone())?, rates)?
            .color_map(ColorMap::Diverging)
            .label("growth rate (1/s)");
        if let Some(limit) = self.color_limit() {
            map = map.limits(-limit, limit);
        }
        let axes = [self.plane.x(), self.plane.y()].map(|axis| {
            kingpin_figure::Axis::new(axis_label::of(axis.key())).limits(axis.start(), axis.end())
        });
        let [x, y] = axes;
        let mut panel = Panel::new(x, y).map(map).legend(Legend::Below);
        for (index, curve) in self.stability_boundary.iter().enumerate() {
            let line = Line::new(curve.iter().copied()).color(palette::BLACK);
            panel = panel.curve(if index == 0 { line.legend("limit of stability") } else { line });
        }
        for (index, curve) in self.rolling_limit.iter().enumerate() {
            let line = Line::new(curve.iter().copied()).dashed().color(palette::BLACK);
            panel = panel.curve(if index == 0 { line.legend("limit of rolling") } else { line });
        }
        let description = format!(
            "Growth rate of the uniform motion at {} against {} and {}",
            description::of(&self.wheel, &self.keys()),
            self.x.key,
            self.y.key
        );
        Ok(Some(Figure::single_column().description(description).panel(panel)))
    }
}
