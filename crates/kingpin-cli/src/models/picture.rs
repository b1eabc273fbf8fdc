//! Bifurcation diagrams of models: one panel for each of the first states.

use super::branch::VaryingParameter;
use super::model::ChosenModel;
use crate::labels::{is_bifurcation, kind};
use kingpin_figure::{
    Axis, Branch, Dash, Figure, Legend, LegendEntry, Marker, MarkerShape, Panel, PointLabel, Stability,
    palette,
};

/// Most panels.
const MOST_PANELS: usize = 4;

/// A branch as it is drawn.
pub struct Curve<'a> {
    /// Name in the legend.
    pub name: &'static str,
    /// Value of the parameter, stability and label of every point.
    pub points: Vec<(f64, Option<bool>, Option<&'a str>)>,
    /// For every state one or two lists of what is drawn over the points: the state, or its largest and smallest value.
    pub extremes: Vec<Vec<Vec<Option<f64>>>>,
}

/// Draws stable parts solid and all others dashed, with labelled points.
pub fn bifurcation_diagram(chosen: &ChosenModel, along: &VaryingParameter, curve: &Curve) -> Figure {
    let states = chosen.model.states();
    let panels = states.len().min(MOST_PANELS);
    let figure = if panels > 1 { Figure::double_column().columns(2) } else { Figure::single_column() };
    let mut figure =
        figure.description(format!("{} of {} along {}", curve.name, chosen.stored.name, along.key));
    for (index, (state, lists)) in states.iter().zip(&curve.extremes).take(panels).enumerate() {
        let mut panel = Panel::new(Axis::new(&along.key), Axis::new(state)).legend(Legend::Below);
        for (number, list) in lists.iter().enumerate() {
            let points = curve.points.iter().zip(list).filter_map(|((value, stable, label), height)| {
                let stability = match is_bifurcation(*label) {
                    true => Stability::Changes,
                    false => Stability::from(*stable == Some(true)),
                };
                height.map(|height| ((*value, height), stability))
            });
            let line = Branch::new(points).color(palette::BLUE);
            panel = panel.curve(if number == 0 && index == 0 { line.legend(curve.name) } else { line });
        }
        let labelled = curve.points.iter().zip(lists.first().into_iter().flatten());
        for ((value, _, label), height) in labelled {
            if let (Some(label), Some(height)) = (label, height) {
                panel = panel.point(PointLabel::new((*value, *height), *label).marker(marker(label)));
            }
        }
        if index == 0 {
            panel = panel.legend_entry(LegendEntry::line("not stable", palette::BLACK, Dash::Dashed));
        }
        figure = figure.panel(panel);
    }
    figure
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
