//! The bifurcation diagram: largest and smallest caster angle of cycles over the parameter, and the uniform motion.

use super::point::{CyclePointResult, ROLLING_LIMIT};
use crate::along::drawn_as;
use crate::uniform_curve::{UniformPoint, uniform_motion};
use crate::{axis_label, description};
use arclength_analysis::labels::kind;
use kingpin::Wheel;
use kingpin::branches::Along;
use kingpin_figure::{
    Axis, Branch, Figure, Legend, Marker, MarkerShape, Panel, PointLabel, Stability, palette,
};

/// Draws the branches, stable parts solid and the others dashed, with labelled points.
pub(crate) fn bifurcation_diagram(wheel: &Wheel, along: &Along, points: &[CyclePointResult]) -> Figure {
    let (key, abscissa) = drawn_as(along);
    let (start, end) = along.ends();
    let ends = [abscissa(start), abscissa(end)];
    let (low, high) = (ends[0].min(ends[1]), ends[0].max(ends[1]));
    let x = Axis::new(axis_label::of(key)).limits(low, high);
    let mut panel = Panel::new(x, Axis::new("$\\psi$ (rad)")).legend(Legend::Below);
    let (uniform, dashes) = uniform_motion(wheel, along, hopf_points(points, abscissa));
    panel = panel.curve(uniform.color(palette::BLUE).legend("uniform motion"));
    let branches = points.last().map_or(0, |point| point.branch);
    for number in 1..=branches {
        let points: Vec<&CyclePointResult> = points.iter().filter(|point| point.branch == number).collect();
        for (largest, angle) in [(true, largest as fn(&CyclePointResult) -> f64), (false, smallest)] {
            let curve = Branch::new(
                points.iter().map(|point| ((abscissa(point.cycle.value), angle(point)), stability(point))),
            )
            .smooth(points.iter().map(|point| is_upright(point)))
            .dotted(points.iter().map(|point| needs_more_friction(point)))
            .color(palette::VERMILION);
            let first = largest && number == 1;
            panel = panel.curve(if first { curve.legend("limit cycle, extremes") } else { curve });
        }
        for point in points {
            if let Some(label) = &point.cycle.label {
                let at = (abscissa(point.cycle.value), point.psi_max);
                panel = panel.point(PointLabel::new(at, label.as_str()).marker(marker(label)));
            }
        }
    }
    let unstable = |point: &CyclePointResult| {
        point.cycle.stable == Some(false) && !point.is_hopf_point() && !needs_more_friction(point)
    };
    let dashes = dashes.and(points.iter().any(unstable), points.iter().any(needs_more_friction));
    panel = dashes.legend().fold(panel, Panel::legend_entry);
    let description = format!(
        "Caster angle of limit cycles and of the uniform motion against {key} at {}",
        description::of(wheel, &[along.key()])
    );
    Figure::single_column().description(description).panel(panel)
}

/// The Hopf points as changes of stability of the uniform motion.
fn hopf_points(points: &[CyclePointResult], abscissa: fn(f64) -> f64) -> Vec<UniformPoint> {
    let at_hopf = |point: &CyclePointResult| {
        let place = (abscissa(point.cycle.value), point.psi_max);
        (place, Stability::Changes, needs_more_friction(point))
    };
    points.iter().filter(|point| point.is_hopf_point()).map(at_hopf).collect()
}

fn largest(point: &CyclePointResult) -> f64 {
    point.psi_max
}

fn smallest(point: &CyclePointResult) -> f64 {
    point.psi_min
}

/// Nothing is claimed to be stable that is not known to be.
pub(crate) fn stability(point: &CyclePointResult) -> Stability {
    if point.is_bifurcation() {
        Stability::Changes
    } else {
        Stability::from(point.cycle.stable == Some(true))
    }
}

/// Whether the parameter stands still along the branch: where cycles are born and where they turn.
fn is_upright(point: &CyclePointResult) -> bool {
    point.cycle.label.as_deref().is_some_and(|label| matches!(kind(label), "HB" | "LPC"))
}

/// Whether the wheel cannot roll like this.
pub(crate) fn needs_more_friction(point: &CyclePointResult) -> bool {
    point.forces.rolls == Some(false) && !point.is_rolling_limit()
}

fn marker(label: &str) -> Marker {
    match kind(label) {
        ROLLING_LIMIT => Marker::new(MarkerShape::Square).open(),
        "LPC" => Marker::new(MarkerShape::Square),
        "PD" => Marker::new(MarkerShape::Diamond).open(),
        "NS" => Marker::new(MarkerShape::Triangle).open(),
        "AT" => Marker::default().open(),
        _ => Marker::default(),
    }
}
