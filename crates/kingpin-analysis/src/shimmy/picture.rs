//! The diagram of shimmy: largest and smallest caster angle over the parameter, beside the uniform motion.

use super::drawn_point::DrawnPoint;
use super::point::{GRAZING, what};
use crate::along::drawn_as;
use crate::uniform_curve::uniform_motion;
use crate::{axis_label, description};
use arclength_analysis::labels::kind;
use kingpin::branches::Along;
use kingpin::{Tyre, Wheel};
use kingpin_figure::{Axis, Branch, Figure, Legend, Marker, MarkerShape, Panel, PointLabel, palette};

/// Draws the branches, stable parts solid and the others dashed, with labelled points.
pub(super) fn diagram(wheel: &Wheel, along: &Along, points: &[DrawnPoint]) -> Figure {
    let (key, abscissa) = drawn_as(along);
    let (start, end) = along.ends();
    let (start, end) = (abscissa(start), abscissa(end));
    let (low, high) = (start.min(end), start.max(end));
    let x = Axis::new(axis_label::of(key)).limits(low, high);
    let mut panel = Panel::new(x, Axis::new("$\\psi$ (rad)")).legend(Legend::Below);
    let (uniform, dashes) = uniform_motion(wheel, along, Vec::new());
    panel = panel.curve(uniform.color(palette::BLUE).legend("uniform motion"));
    let branches = points.last().map_or(0, |point| point.branch);
    for number in 1..=branches {
        let points: Vec<&DrawnPoint> = points.iter().filter(|point| point.branch == number).collect();
        for largest in [true, false] {
            let angle = |point: &DrawnPoint| if largest { point.psi_max } else { point.psi_min };
            let curve = Branch::new(
                points.iter().map(|point| ((abscissa(point.value), angle(point)), point.stability())),
            )
            .color(palette::VERMILION);
            let first = largest && number == 1;
            panel =
                panel.curve(if first { curve.legend(format!("{}, extremes", what(wheel))) } else { curve });
        }
        for point in points {
            if let Some(label) = &point.label {
                let at = (abscissa(point.value), point.psi_max);
                panel = panel.point(PointLabel::new(at, label.as_str()).marker(marker(label)));
            }
        }
    }
    let dashes = dashes.and(points.iter().any(|point| point.stable == Some(false)), false);
    panel = dashes.legend().fold(panel, Panel::legend_entry);
    let description = format!(
        "Caster angle of {} and of the uniform motion against {key} at {}",
        if wheel.tyre() == Tyre::Rigid { "shimmy with sliding phases" } else { "shimmy" },
        description::of(wheel, &[along.key()])
    );
    Figure::single_column().description(description).panel(panel)
}

fn marker(label: &str) -> Marker {
    match kind(label) {
        "LPC" => Marker::new(MarkerShape::Square),
        "PD" => Marker::new(MarkerShape::Diamond).open(),
        "NS" => Marker::new(MarkerShape::Triangle).open(),
        GRAZING => Marker::new(MarkerShape::Triangle).size(3.0),
        "AT" => Marker::default().open(),
        _ => Marker::default(),
    }
}
