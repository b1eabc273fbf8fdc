//! The bifurcation diagram: largest and smallest caster angle of cycles over the parameter, and the uniform motion.

use super::point::CyclePointResult;
use crate::along::drawn_as;
use crate::{axis_label, description};
use arclength_analysis::labels::kind;
use kingpin::branches::Along;
use kingpin::{Key, Wheel};
use kingpin_figure::{
    Axis, Branch, Dash, Figure, Legend, LegendEntry, Marker, MarkerShape, Panel, PointLabel, Stability,
    palette,
};

/// Values of the parameter at which the uniform motion is drawn.
const UNIFORM_MOTIONS: usize = 400;

/// Draws the branches, stable parts solid and the others dashed, with labelled points.
pub(super) fn bifurcation_diagram(wheel: &Wheel, along: &Along, points: &[CyclePointResult]) -> Figure {
    let (key, abscissa) = drawn_as(along);
    let (start, end) = along.ends();
    let ends = [abscissa(start), abscissa(end)];
    let (low, high) = (ends[0].min(ends[1]), ends[0].max(ends[1]));
    let x = Axis::new(axis_label::of(key)).limits(low, high);
    let mut panel = Panel::new(x, Axis::new("$\\psi$ (rad)")).legend(Legend::Below);
    panel = panel.curve(
        uniform_motion(wheel, along, points, key, low, high).color(palette::BLUE).legend("uniform motion"),
    );
    let branches = points.last().map_or(0, |point| point.branch);
    for number in 1..=branches {
        let points: Vec<&CyclePointResult> = points.iter().filter(|point| point.branch == number).collect();
        for (largest, angle) in [(true, largest as fn(&CyclePointResult) -> f64), (false, smallest)] {
            let curve = Branch::new(
                points.iter().map(|point| ((abscissa(point.cycle.value), angle(point)), stability(point))),
            )
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
    let anything_unstable = points.iter().any(|point| point.cycle.stable == Some(false));
    if anything_unstable {
        panel = panel.legend_entry(LegendEntry::line("unstable", palette::BLACK, Dash::Dashed));
    }
    let description = format!(
        "Caster angle of limit cycles and of the uniform motion against {key} at {}",
        description::of(wheel, &[along.key()])
    );
    Figure::single_column().description(description).panel(panel)
}

fn largest(point: &CyclePointResult) -> f64 {
    point.psi_max
}

fn smallest(point: &CyclePointResult) -> f64 {
    point.psi_min
}

/// Nothing is claimed to be stable that is not known to be.
fn stability(point: &CyclePointResult) -> Stability {
    if point.is_bifurcation() {
        Stability::Changes
    } else {
        Stability::from(point.cycle.stable == Some(true))
    }
}

fn marker(label: &str) -> Marker {
    match kind(label) {
        "LPC" => Marker::new(MarkerShape::Square),
        "PD" => Marker::new(MarkerShape::Diamond).open(),
        "NS" => Marker::new(MarkerShape::Triangle).open(),
        "AT" => Marker::default().open(),
        _ => Marker::default(),
    }
}

/// The uniform motion where it exists, its stability changing exactly at the Hopf points.
fn uniform_motion(
    wheel: &Wheel,
    along: &Along,
    points: &[CyclePointResult],
    key: Key,
    low: f64,
    high: f64,
) -> Branch {
    let (_, abscissa) = drawn_as(along);
    let hopf_points = points.iter().filter(|point| point.is_hopf_point());
    let mut points: Vec<((f64, f64), Stability)> =
        hopf_points.map(|point| ((abscissa(point.cycle.value), point.psi_max), Stability::Changes)).collect();
    for index in 0..=UNIFORM_MOTIONS {
        let value = low + (high - low) * index as f64 / UNIFORM_MOTIONS as f64;
        let motion = wheel.with(key, value).and_then(|wheel| wheel.uniform_motion());
        // Outside its range there is nothing to draw.
        if let Ok(motion) = motion {
            points.push(((value, motion.psi()), Stability::from(motion.is_stable() == Some(true))));
        }
    }
    points.sort_by(|a, b| a.0.0.total_cmp(&b.0.0));
    Branch::new(points)
}
