//! How the boundary of figure 3 moves with the dampers, and for which damping the uniform motion is stable at any speed.
//!
//! Boundaries are traced in the plane of speed and caster length for several values of each damper; in the plane of speed
//! and damping, at several caster lengths, the tip of the boundary is the damping above which the uniform motion keeps its
//! stability.

use super::study::{Drawing, Finding, Study};
use super::wheel::wheel;
use crate::axis_label;
use crate::error::Error;
use arclength_analysis::Control;
use kingpin::parallel;
use kingpin::{Axis as Interval, Curve, Key, Plane};
use kingpin_figure::{Axis, Color, Figure, Legend, Line, Panel, palette};
use kingpin_report::Columns;

/// Turning radius of the charts in m.
const RADIUS: f64 = 1.0;
/// Speeds in m/s and caster lengths in m of the charts.
const SPEEDS: (f64, f64) = (0.01, 12.0);
const LENGTHS: (f64, f64) = (0.02, 0.2);
/// A damper, its values in the chart, and the largest one in the plane of speed and damping.
type Damper = (Key, [f64; 4], f64);
const DAMPERS: [Damper; 3] = [
    (Key::CQ, [0.0, 0.05, 0.1, 0.2], 2.0),
    (Key::CU, [0.0, 0.05, 0.1, 0.2], 2.0),
    (Key::CPsi, [0.0, 2e-4, 5e-4, 1e-3], 0.02),
];
/// Caster lengths in m in the planes of speed and damping.
const SECTIONS: [f64; 4] = [0.05, 0.06, 0.08, 0.12];
const COLORS: [Color; 4] = [palette::BLACK, palette::BLUE, palette::VERMILION, palette::GREEN];

/// A boundary with the damper and the value that it belongs to: the damping in a chart, the caster length in a section.
struct Boundary {
    damper: Key,
    value: f64,
    curves: Vec<Curve>,
}

pub(super) fn study(control: &Control<'_>) -> Result<Study, Error> {
    let pairs = |values: fn(&Damper) -> [f64; 4]| -> Vec<(Key, f64, f64)> {
        let all = DAMPERS.iter();
        all.flat_map(|damper| values(damper).map(|value| (damper.0, value, damper.2))).collect()
    };
    let charts = parallel::try_map(&pairs(|damper| damper.1), |&(damper, value, _)| {
        chart(damper, value, &control.quiet())
    })?;
    control.done(0.5);
    let sections = parallel::try_map(&pairs(|_| SECTIONS), |&(damper, length, most)| {
        section(damper, length, most, &control.quiet())
    })?;
    control.done(0.9);
    let findings = sections.iter().map(finding).collect();
    Ok(Study {
        findings,
        drawings: vec![drawing(&charts, &sections)],
        pictures: Vec::new(),
        notes: Vec::new(),
    })
}

fn chart(damper: Key, damping: f64, control: &Control<'_>) -> Result<Boundary, Error> {
    let plane = Plane::new(
        Interval::new(Key::V, SPEEDS.0..=SPEEDS.1)?,
        Interval::new(Key::L, LENGTHS.0..=LENGTHS.1)?,
    )?;
    let curves =
        wheel(&[(Key::TurningRadius, RADIUS), (damper, damping)])?.stability_boundary(&plane, control)?;
    Ok(Boundary { damper, value: damping, curves })
}

fn section(damper: Key, length: f64, most: f64, control: &Control<'_>) -> Result<Boundary, Error> {
    let plane = Plane::new(Interval::new(Key::V, SPEEDS.0..=SPEEDS.1)?, Interval::new(damper, 0.0..=most)?)?;
    let curves =
        wheel(&[(Key::TurningRadius, RADIUS), (Key::L, length)])?.stability_boundary(&plane, control)?;
    Ok(Boundary { damper, value: length, curves })
}

/// The largest damping on a boundary, with its speed.
fn tip(boundary: &Boundary) -> Option<[f64; 2]> {
    let points = boundary.curves.iter().flat_map(|curve| &curve.points);
    points.copied().max_by(|a, b| a[1].total_cmp(&b[1]))
}

fn finding(section: &Boundary) -> Finding {
    let place = format!("l = {} m, r = {RADIUS} m, up to v = {} m/s", section.value, SPEEDS.1);
    let name = section.damper.name();
    let most =
        DAMPERS.iter().find(|damper| damper.0 == section.damper).map_or(f64::INFINITY, |damper| damper.2);
    let unit = section.damper.unit();
    match tip(section) {
        Some([_, damping]) if damping > most * (1.0 - 1e-6) => {
            Finding::new(format!("{place}: shimmy remains at {name} ="), most, unit)
        }
        Some([_, damping]) => {
            Finding::new(format!("{place}: no shimmy of small amplitude above {name} ="), damping, unit)
        }
        None => Finding::new(format!("{place}: no boundary at any {name} from"), 0.0, unit),
    }
}

fn drawing(charts: &[Boundary], sections: &[Boundary]) -> Drawing {
    let mut figure = Figure::double_column().columns(3).height_mm(128.0).description(
        "Stability boundaries for several dampers, in speed and caster length and in speed and damping",
    );
    let tags = ["(a)", "(b)", "(c)", "(d)", "(e)", "(f)"];
    let mut tags = tags.into_iter();
    for (index, (damper, values, _)) in DAMPERS.into_iter().enumerate() {
        let lengths = Axis::new(axis_label::of(Key::L)).limits(0.0, LENGTHS.1);
        let mut panel = Panel::new(
            Axis::new(axis_label::of(Key::V)).limits(0.0, SPEEDS.1),
            if index == 0 { lengths } else { lengths.without_labels() },
        )
        .tag(tags.next().unwrap_or_default())
        .legend(Legend::Below);
        let label = axis_label::of(damper);
        let (symbol, unit) = label.split_once(" (").unwrap_or((&label, ""));
        for (value, color) in values.into_iter().zip(COLORS) {
            let boundary = charts.iter().filter(|chart| chart.damper == damper && chart.value == value);
            let text = format!("{symbol} = {value} {}", unit.trim_end_matches(')'));
            panel = add(panel, boundary, color, &text);
        }
        figure = figure.panel(panel);
    }
    for (damper, _, most) in DAMPERS {
        let tips = sections.iter().filter(|section| section.damper == damper).filter_map(tip);
        let highest = tips.map(|[_, damping]| damping).fold(0.0, f64::max);
        let top = if highest > 0.0 { 1.15 * highest } else { most };
        let mut panel = Panel::new(
            Axis::new(axis_label::of(Key::V)).limits(0.0, SPEEDS.1),
            Axis::new(axis_label::of(damper)).limits(0.0, top.min(most)),
        )
        .tag(tags.next().unwrap_or_default())
        .legend(Legend::Below);
        for (length, color) in SECTIONS.into_iter().zip(COLORS) {
            let boundary =
                sections.iter().filter(|section| section.damper == damper && section.value == length);
            panel = add(panel, boundary, color, &format!("$l = {length}$ m"));
        }
        figure = figure.panel(panel);
    }
    Drawing { number: 9, figure, data: data(charts, sections) }
}

/// Adds all curves of a boundary, of which the first is in the legend.
fn add<'a>(
    mut panel: Panel,
    boundary: impl Iterator<Item = &'a Boundary>,
    color: Color,
    text: &str,
) -> Panel {
    for (index, curve) in boundary.flat_map(|boundary| &boundary.curves).enumerate() {
        let line = Line::new(curve.points.iter().map(|&[x, y]| (x, y))).color(color);
        panel = panel.curve(if index == 0 { line.legend(text) } else { line });
    }
    panel
}

fn data(charts: &[Boundary], sections: &[Boundary]) -> Columns {
    let mut rows = Vec::new();
    for chart in charts {
        for &[speed, length] in chart.curves.iter().flat_map(|curve| &curve.points) {
            rows.push(("chart", chart.damper, [speed, length, chart.value]));
        }
    }
    for section in sections {
        for &[speed, damping] in section.curves.iter().flat_map(|curve| &curve.points) {
            rows.push(("section", section.damper, [speed, section.value, damping]));
        }
    }
    let number = |index: usize| rows.iter().map(move |row| row.2[index]);
    Columns::new()
        .texts("curve", rows.iter().map(|row| Some(row.0.to_owned())))
        .texts("damper", rows.iter().map(|row| Some(row.1.name().to_owned())))
        .numbers("v [m/s]", number(0))
        .numbers("l [m]", number(1))
        .numbers("damping [SI]", number(2))
}
