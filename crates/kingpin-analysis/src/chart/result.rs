//! A stability chart as a result.

use super::overlay::{LimitPoint, Overlay, color_of, label_of, points_of};
use crate::axis_label;
use crate::description;
use crate::error::Error;
use crate::neglected_dry_friction::NeglectedDryFriction;
use crate::parameters::parameters_over;
use arclength_analysis::Control;
use kingpin::{Axis, GrowthRateChart, Key, Plane, Wheel};
use kingpin_figure::{
    CategoryMap, ColorMap, Dash, Figure, FigureError, Grid, HeatMap, Legend, LegendEntry, Line, Panel,
    palette,
};
use kingpin_report::numbers::{counted, readable, significant};
use kingpin_report::{Columns, Parameters, Report, Schema, Table};
use serde::Serialize;
use std::io::{self, Write};
use std::iter::repeat_n;

/// Columns of what is known at every point.
pub(super) const GROWTH_RATE: &str = "growth_rate";
pub(super) const STABLE: &str = "stable";
pub(super) const ROLLS: &str = "rolls";

/// Most characters across and down in the chart that is printed.
const PRINTED: [usize; 2] = [72, 24];
/// Part of the growth rates whose absolute values the colours resolve; the others have the colours of the ends.
const RESOLVED_PART: f64 = 0.85;

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
    /// Towed straight over the speed, the limit up to which small motions die out with dry friction about the king pin, where there is
    /// some, as curves of points; its moment does not matter.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub friction_boundary: Vec<Vec<[f64; 2]>>,
    /// The limits with other values of a third parameter.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub overlays: Vec<Overlay>,
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
        overlays: Vec<Overlay>,
        control: &Control<'_>,
    ) -> Result<Self, Error> {
        let over_speed = [plane.x().key(), plane.y().key()].contains(&Key::V);
        let friction_boundary = match wheel.get(Key::MF) > 0.0 && over_speed {
            true => points_of(wheel.swing_boundary(&plane, control)?),
            false => Vec::new(),
        };
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
            friction_boundary,
            overlays,
            dry_friction: NeglectedDryFriction::of(&wheel, &[plane.x().key(), plane.y().key()]),
            plane,
        })
    }

    fn keys(&self) -> [Key; 2] {
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
        parameters_over(
            &self.wheel,
            &[self.plane.x(), self.plane.y()].map(|axis| (axis.key(), [axis.start(), axis.end()])),
        )
    }

    fn write_table(&self, out: &mut dyn Write) -> io::Result<()> {
        let stable = self.stable.iter().filter(|stable| **stable == Some(true)).count();
        let undecided = self.stable.iter().filter(|stable| stable.is_none()).count();
        let points = self.growth_rate.len();
        let exists = self.growth_rate.iter().flatten().count();
        writeln!(out, "uniform motion at {}", description::on_lines(&self.wheel, &self.keys()))?;
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
            let undecided = counted(undecided, "point", "points");
            writeln!(out, "? undecided, at {undecided}: rounding could make it stable or unstable")?;
        }
        self.write_overlays(out)?;
        NeglectedDryFriction::tell(self.dry_friction.as_ref(), out)?;
        self.write_friction_boundary(out)
    }

    /// The grid row by row, then the points of the limits of every overlay.
    fn columns(&self) -> Columns {
        let [x, y] = [&self.x.values, &self.y.values];
        let limits: Vec<LimitPoint<'_>> = self.overlays.iter().flat_map(Overlay::points).collect();
        let (grid, points) = (self.growth_rate.len(), limits.len());
        let columns = Columns::new()
            .numbers(
                self.x.key,
                y.iter().flat_map(|_| x.iter().copied()).chain(limits.iter().map(|point| point.at[0])),
            )
            .unit(self.x.unit)
            .numbers(
                self.y.key,
                y.iter()
                    .flat_map(|&y| x.iter().map(move |_| y))
                    .chain(limits.iter().map(|point| point.at[1])),
            )
            .unit(self.y.unit)
            .optional_numbers(GROWTH_RATE, self.growth_rate.iter().copied().chain(repeat_n(None, points)))
            .unit("1/s")
            .booleans(STABLE, self.stable.iter().copied().chain(repeat_n(None, points)))
            .booleans(ROLLS, self.rolls.iter().copied().map(Some).chain(repeat_n(None, points)));
        if self.overlays.is_empty() {
            return columns;
        }
        let texts = |text: fn(&LimitPoint<'_>) -> String| {
            repeat_n(None, grid).chain(limits.iter().map(move |point| Some(text(point))))
        };
        columns
            .texts("limit", texts(|point| point.limit.to_owned()))
            .texts("overlay", texts(|point| point.overlay.key.name().to_owned()))
            .optional_numbers(
                "overlay_value",
                repeat_n(None, grid).chain(limits.iter().map(|point| Some(point.overlay.value))),
            )
            .texts("curve", texts(|point| point.curve.to_string()))
    }

    fn figure(&self) -> Result<Option<Figure>, FigureError> {
        let axes = [self.plane.x(), self.plane.y()].map(|axis| {
            kingpin_figure::Axis::new(axis_label::of(axis.key())).limits(axis.start(), axis.end())
        });
        let [x, y] = axes;
        let panel = Panel::new(x, y).legend(Legend::Below);
        let panel = if self.overlays.is_empty() { self.growth_rates(panel)? } else { self.limits(panel)? };
        let what =
            if self.overlays.is_empty() { "Growth rate" } else { "Limits of stability and of rolling" };
        let description = format!(
            "{what} of the uniform motion at {} against {} and {}",
            description::of(&self.wheel, &self.keys()),
            self.x.key,
            self.y.key
        );
        Ok(Some(Figure::single_column().description(description).panel(panel)))
    }
}

impl ChartResult {
    /// The growth rate in colours, with both limits.
    fn growth_rates(&self, mut panel: Panel) -> Result<Panel, FigureError> {
        let rates: Vec<f64> = self.growth_rate.iter().map(|rate| rate.unwrap_or(f64::NAN)).collect();
        let mut map = HeatMap::new(Grid::new(self.x.values.clone(), self.y.values.clone())?, rates)?
            .color_map(ColorMap::Diverging)
            .label("growth rate (1/s)");
        if let Some(limit) = self.color_limit() {
            map = map.limits(-limit, limit);
        }
        panel = panel.map(map);
        for (index, curve) in self.stability_boundary.iter().enumerate() {
            let line = Line::new(curve.iter().copied()).color(palette::BLACK);
            panel = panel.curve(if index == 0 { line.legend("limit of stability") } else { line });
        }
        for (index, curve) in self.rolling_limit.iter().enumerate() {
            let line = Line::new(curve.iter().copied()).dashed().color(palette::BLACK);
            panel = panel.curve(if index == 0 { line.legend("limit of rolling") } else { line });
        }
        Ok(self.with_friction_boundary(panel))
    }

    /// The limits of every overlay, over where the wheel itself is stable.
    fn limits(&self, mut panel: Panel) -> Result<Panel, FigureError> {
        let grid = Grid::new(self.x.values.clone(), self.y.values.clone())?;
        let cells: Vec<usize> = self.stable.iter().map(|stable| usize::from(*stable != Some(true))).collect();
        let shade = palette::SKY_BLUE.lightened(0.65);
        panel = panel.map(CategoryMap::new(grid, cells, [(self.own_values("stable"), shade)])?);
        // A load changes nothing of the stability: then its limit is that of the wheel, which is drawn once.
        let shares = |overlay: &Overlay| {
            overlay.stability_boundary == self.stability_boundary
                && overlay.value != self.wheel.get(overlay.key)
        };
        if self.overlays.iter().any(shares) {
            for curve in &self.stability_boundary {
                panel = panel.curve(Line::new(curve.iter().copied()).color(palette::BLACK));
            }
        }
        for (index, overlay) in self.overlays.iter().enumerate() {
            let color = color_of(index);
            panel = panel.curves(overlay.lines(color, shares(overlay)));
            if overlay.has_no_limit(shares(overlay)) {
                let name = format!("{}: no limit here", overlay.label());
                panel = panel.legend_entry(LegendEntry::line(name, color, Dash::Solid));
            }
        }
        let any = |curves: fn(&Overlay) -> &Vec<Vec<[f64; 2]>>| {
            self.overlays.iter().any(|overlay| !curves(overlay).is_empty())
        };
        let drawn = [any(|overlay| &overlay.stability_boundary), any(|overlay| &overlay.rolling_limit)];
        let panel = Overlay::legend(drawn[0], drawn[1]).fold(panel, Panel::legend_entry);
        Ok(self.with_friction_boundary(panel))
    }

    /// What holds for the wheel itself, with its own value of each parameter that the overlays change.
    fn own_values(&self, what: &str) -> String {
        let mut keys: Vec<Key> = self.overlays.iter().map(|overlay| overlay.key).collect();
        keys.dedup();
        let own = keys.iter().map(|key| label_of(*key, self.wheel.get(*key)));
        format!("{what} at {}", own.collect::<Vec<_>>().join(", "))
    }

    /// The limit of small motions with dry friction about the king pin besides.
    fn with_friction_boundary(&self, mut panel: Panel) -> Panel {
        for (index, curve) in self.friction_boundary.iter().enumerate() {
            let line = Line::new(curve.iter().copied()).color(palette::VERMILION);
            panel = panel.curve(if index == 0 {
                line.legend("with dry friction small motions die out up to here")
            } else {
                line
            });
        }
        panel
    }

    /// Over which speeds the limit of small motions with dry friction runs.
    fn write_friction_boundary(&self, out: &mut dyn Write) -> io::Result<()> {
        let place = usize::from(self.plane.x().key() != Key::V);
        let speeds = || self.friction_boundary.iter().flatten().map(|point| point[place]);
        let [low, high] =
            [speeds().fold(f64::INFINITY, f64::min), speeds().fold(f64::NEG_INFINITY, f64::max)];
        if low > high {
            return Ok(());
        }
        let [low, high] = [low, high].map(|speed| significant(speed, 4));
        let over = if low == high { format!("at {low} m/s") } else { format!("at {low} to {high} m/s") };
        writeln!(out, "over the chart the limit up to which they die out is {over} (`friction_boundary`)")
    }

    /// How far the limits of every overlay reach.
    fn write_overlays(&self, out: &mut dyn Write) -> io::Result<()> {
        if self.overlays.is_empty() {
            return Ok(());
        }
        let reach = |curves: &[Vec<[f64; 2]>]| {
            let values = || curves.iter().flatten().map(|[x, _]| *x);
            match curves.is_empty() {
                true => "none here".to_owned(),
                false => format!(
                    "{} to {} {}",
                    significant(values().fold(f64::INFINITY, f64::min), 4),
                    significant(values().fold(f64::NEG_INFINITY, f64::max), 4),
                    self.x.unit
                ),
            }
        };
        writeln!(out)?;
        let mut table = Table::new([
            "".to_owned(),
            format!("limit of stability, {}", self.x.key),
            format!("limit of rolling, {}", self.x.key),
        ]);
        for overlay in &self.overlays {
            table.row([
                overlay.name().into(),
                reach(&overlay.stability_boundary).into(),
                reach(&overlay.rolling_limit).into(),
            ]);
        }
        table.write(out)
    }
}
