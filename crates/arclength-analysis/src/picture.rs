//! Bifurcation diagrams: a panel for each of the first states over the parameter, or one of two parameters.

use crate::labels::{is_bifurcation, kind};
use kingpin_figure::{
    Axis, Branch, Color, Dash, Figure, Legend, LegendEntry, Marker, MarkerShape, Panel, PointLabel,
    Stability, palette,
};
use std::borrow::Cow;

/// Part of the extent of the picture within which two labelled points are drawn as one.
const SAME_POINT: f64 = 1e-6;
/// Most panels.
const MOST_PANELS: usize = 4;

/// A colour that somebody has chosen for a result among others, with the name by which the legend tells it.
#[derive(Clone, Debug, PartialEq)]
pub struct OwnColor {
    /// The colour.
    pub color: Color,
    /// Name of the result.
    pub name: String,
}

/// A branch as it is drawn: solid where stable, dashed elsewhere, with labelled points.
#[derive(Clone, Debug)]
pub struct Curve {
    name: Cow<'static, str>,
    color: Color,
    points: Vec<((f64, f64), Stability)>,
    /// At which of them it is upright.
    upright: Vec<bool>,
    labels: Vec<((f64, f64), String)>,
}

impl Curve {
    /// A curve through points with their stability and labels. Ends and neutral saddles are not labelled in
    /// pictures. At the special points of the kinds `upright` the horizontal value stands still.
    pub fn of<'a>(
        name: &'static str,
        color: Color,
        upright: &[&str],
        points: impl IntoIterator<Item = ((f64, f64), Option<bool>, Option<&'a str>)>,
    ) -> Self {
        let name = Cow::Borrowed(name);
        let mut curve = Self { name, color, points: Vec::new(), upright: Vec::new(), labels: Vec::new() };
        for (at, stable, label) in points {
            // Nothing is claimed to be stable that is not known to be.
            let stability = match is_bifurcation(label) {
                true => Stability::Changes,
                false => Stability::from(stable == Some(true)),
            };
            curve.points.push((at, stability));
            curve.upright.push(label.is_some_and(|label| upright.contains(&kind(label))));
            if let Some(label) = label.filter(|label| !matches!(kind(label), "EP" | "NSE")) {
                curve.labels.push((at, label.to_owned()));
            }
        }
        curve
    }

    /// The same curve in a colour of its own, if there is one, which has its own entry in the legend.
    pub fn in_color(self, own: Option<&OwnColor>) -> Self {
        match own {
            Some(OwnColor { color, name }) => {
                Self { name: own_name(&self.name, name).into(), color: *color, ..self }
            }
            None => self,
        }
    }

    /// The same curve without labels.
    pub fn without_labels(self) -> Self {
        Self { labels: Vec::new(), ..self }
    }
}

/// A diagram: for every state its name and the curves over the parameter `key`. Only the first states are drawn.
pub fn bifurcation_diagram(
    description: &str,
    key: &str,
    states: impl IntoIterator<Item = (String, Vec<Curve>)>,
) -> Figure {
    let states: Vec<(String, Vec<Curve>)> = states.into_iter().take(MOST_PANELS).collect();
    let figure = if states.len() > 1 { Figure::double_column().columns(2) } else { Figure::single_column() };
    let mut figure = figure.description(description);
    for (index, (state, curves)) in states.into_iter().enumerate() {
        figure = figure.panel(panel([key, &state], &curves, (index == 0).then_some("not stable")));
    }
    figure
}

/// A diagram of curves in the plane of two parameters.
pub fn plane(description: &str, keys: [&str; 2], curves: &[Curve]) -> Figure {
    Figure::single_column().description(description).panel(panel(keys, curves, Some("neutral saddles")))
}

/// A panel with curves, the first of every name in the legend where there is one, with the meaning of dashes.
fn panel([horizontal, vertical]: [&str; 2], curves: &[Curve], legend: Option<&str>) -> Panel {
    let mut panel = Panel::new(Axis::new(horizontal), Axis::new(vertical)).legend(Legend::Below);
    let mut named: Vec<&str> = Vec::new();
    for curve in curves {
        let line = Branch::new(curve.points.iter().copied())
            .smooth(curve.upright.iter().copied())
            .color(curve.color);
        let first = legend.is_some() && !named.contains(&&*curve.name);
        named.push(&curve.name);
        panel = panel.curve(if first { line.legend(&*curve.name) } else { line });
    }
    // Labels of several curves at one point are one.
    let extent = |pick: fn(&(f64, f64)) -> f64| {
        let values = curves.iter().flat_map(|curve| &curve.points).map(|(at, _)| pick(at));
        let (low, high) = values
            .fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), value| (low.min(value), high.max(value)));
        high - low
    };
    let extents = (extent(|at| at.0), extent(|at| at.1));
    let same = |one: (f64, f64), other: (f64, f64)| {
        (one.0 - other.0).abs() <= SAME_POINT * extents.0 && (one.1 - other.1).abs() <= SAME_POINT * extents.1
    };
    let mut labelled: Vec<(&(f64, f64), &str)> = Vec::new();
    for (at, label) in curves.iter().flat_map(|curve| &curve.labels) {
        if !labelled.iter().any(|(other, text)| text == label && same(**other, *at)) {
            labelled.push((at, label));
            panel = panel.point(PointLabel::new(*at, label.as_str()).marker(marker(label)));
        }
    }
    let dashed = curves.iter().flat_map(|curve| &curve.points).any(|(_, s)| *s == Stability::Unstable);
    if let Some(text) = legend.filter(|_| dashed) {
        panel = panel.legend_entry(LegendEntry::line(text, palette::BLACK, Dash::Dashed));
    }
    panel
}

/// What the legend calls curves of a result that has a colour of its own.
pub fn own_name(curves: &str, result: &str) -> String {
    format!("{curves}: {result}")
}

fn marker(label: &str) -> Marker {
    match kind(label) {
        "LP" | "LPC" => Marker::new(MarkerShape::Square),
        "PD" | "BP" | "BPC" => Marker::new(MarkerShape::Diamond).open(),
        "NS" => Marker::new(MarkerShape::Triangle).open(),
        "AT" => Marker::default().open(),
        _ => Marker::default(),
    }
}
