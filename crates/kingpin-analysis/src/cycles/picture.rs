//! The bifurcation diagram: largest and smallest caster angle of cycles over the parameter, and the uniform motion.

use super::point::{CyclePointResult, ROLLING_LIMIT};
use crate::along::drawn_as;
use crate::uniform_curve::{UniformPoint, uniform_motion};
use crate::{axis_label, description};
use arclength_analysis::labels::kind;
use arclength_analysis::picture::{OwnColor, own_name};
use kingpin::Wheel;
use kingpin::branches::Along;
use kingpin_figure::{
    Axis, Branch, Figure, Legend, Marker, MarkerShape, Panel, PointLabel, Stability, palette,
};

/// Part of the picture within which two points of one kind are labelled once: branches that lie on each other agree to their errors.
const SAME_POINT: f64 = 1e-4;
/// What the legend calls cycles.
const CYCLES: &str = "limit cycle, extremes";

/// Draws the branches, stable parts solid and the others dashed, with labelled points. Branches up to each of
/// the numbers may have a colour of their own.
pub(crate) fn bifurcation_diagram(
    wheel: &Wheel,
    along: &Along,
    points: &[CyclePointResult],
    colors: &[(u64, Option<&OwnColor>)],
) -> Figure {
    let (key, abscissa) = drawn_as(along);
    let (start, end) = along.ends();
    let ends = [abscissa(start), abscissa(end)];
    let (low, high) = (ends[0].min(ends[1]), ends[0].max(ends[1]));
    let x = Axis::new(axis_label::of(key)).limits(low, high);
    let mut panel = Panel::new(x, Axis::new("$\\psi$ (rad)")).legend(Legend::Below);
    let (uniform, dashes) = uniform_motion(wheel, along, hopf_points(points, abscissa));
    panel = panel.curve(uniform.color(palette::BLUE).legend("uniform motion"));
    let mut branches: Vec<u64> = points.iter().map(|point| point.branch).collect();
    branches.dedup();
    let mut named: Vec<String> = Vec::new();
    for number in branches {
        let points: Vec<&CyclePointResult> = points.iter().filter(|point| point.branch == number).collect();
        let own = colors.iter().find(|(last, _)| number <= *last).and_then(|(_, own)| *own);
        let name = own.map_or_else(|| CYCLES.to_owned(), |own| own_name(CYCLES, &own.name));
        let is_first = !named.contains(&name);
        for (largest, angle) in [(true, largest as fn(&CyclePointResult) -> f64), (false, smallest)] {
            let curve = Branch::new(
                points.iter().map(|point| ((abscissa(point.cycle.value), angle(point)), stability(point))),
            )
            .smooth(points.iter().map(|point| is_upright(point)))
            .dotted(points.iter().map(|point| needs_more_friction(point)))
            .color(own.map_or(palette::VERMILION, |own| own.color));
            panel = panel.curve(if largest && is_first { curve.legend(&name) } else { curve });
        }
        named.push(name);
    }
    for (at, label) in labelled(points, high - low, abscissa) {
        panel = panel.point(PointLabel::new(at, label).marker(marker(label)));
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

/// The labels, each where it stands: of branches that lie on each other those of the first one.
fn labelled(points: &[CyclePointResult], width: f64, abscissa: fn(f64) -> f64) -> Vec<((f64, f64), &str)> {
    let height = points.iter().map(|point| point.psi_max).fold(0.0, f64::max)
        - points.iter().map(|point| point.psi_min).fold(0.0, f64::min);
    let mut all: Vec<((f64, f64), &str)> = Vec::new();
    for point in points {
        let Some(label) = &point.cycle.label else { continue };
        let at = (abscissa(point.cycle.value), point.psi_max);
        let is_same = |((x, y), other): &((f64, f64), &str)| {
            kind(other) == kind(label)
                && (x - at.0).abs() <= SAME_POINT * width
                && (y - at.1).abs() <= SAME_POINT * height
        };
        if !all.iter().any(is_same) {
            all.push((at, label));
        }
    }
    all
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
