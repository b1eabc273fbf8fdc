//! Limits of stability and of rolling over speed and caster length, for several circles, with the wheel among them.

use super::illustration::Illustration;
use crate::axis_label;
use crate::chart::{COLORS, LimitPoint, Overlay};
use crate::error::Error;
use arclength_analysis::Control;
use kingpin::{Axis as Interval, Key, Plane, Wheel};
use kingpin_figure::{Axis, Dash, Figure, Legend, LegendEntry, Marker, MarkerShape, Markers, Panel, palette};
use kingpin_report::Columns;

/// Radii in m of the circles, beside that of the wheel.
const RADII: [f64; 4] = [1.0, 2.0, 5.0, f64::INFINITY];
/// Traces the limits up to a speed over caster lengths.
///
/// # Errors
/// [`Error::Stopped`].
pub(super) fn illustration(
    wheel: &Wheel,
    fastest: f64,
    lengths: [f64; 2],
    control: &Control<'_>,
) -> Result<Illustration, Error> {
    let plane =
        Plane::new(Interval::new(Key::V, 0.0..=fastest)?, Interval::new(Key::L, lengths[0]..=lengths[1])?)?;
    let own = wheel.get(Key::TurningRadius);
    let mut radii = RADII.to_vec();
    if !radii.contains(&own) {
        radii.push(own);
    }
    let mut overlays = Vec::new();
    let mut panel = Panel::new(
        Axis::new(axis_label::of(Key::V)).limits(0.0, fastest),
        Axis::new(axis_label::of(Key::L)).limits(lengths[0], lengths[1]),
    )
    .legend(Legend::Below);
    for (index, (radius, color)) in radii.iter().copied().zip(COLORS).enumerate() {
        let part = |index: usize| index as f64 / radii.len() as f64;
        let control = control.part(part(index)..part(index + 1));
        let wheel = wheel.with(Key::TurningRadius, radius)?;
        let overlay = Overlay::trace(Key::TurningRadius, radius, &wheel, &plane, &control)?;
        panel = panel.curves(overlay.lines(color, false)).legend_entry(LegendEntry::line(
            overlay.label(),
            color,
            Dash::Solid,
        ));
        overlays.push(overlay);
    }
    let here = (wheel.get(Key::V), wheel.get(Key::L));
    let marker = Marker::new(MarkerShape::Diamond).color(palette::BLACK);
    panel = panel.markers(Markers::new([here], marker).legend("the wheel"));
    let rolling = overlays.iter().any(|overlay| !overlay.rolling_limit.is_empty());
    panel = Overlay::legend(false, rolling).fold(panel, Panel::legend_entry);
    let figure = Figure::single_column()
        .description("Limits of stability and of rolling over speed and caster length for several circles")
        .panel(panel);
    let points: Vec<LimitPoint<'_>> = overlays.iter().flat_map(Overlay::points).collect();
    let numbers = |quantity: fn(&LimitPoint<'_>) -> f64| points.iter().map(quantity);
    let data = Columns::new()
        .texts("limit", points.iter().map(|point| Some(point.limit.to_owned())))
        .numbers("r", numbers(|point| point.overlay.value))
        .unit("m")
        .counts("curve", points.iter().map(|point| point.curve))
        .numbers("v", numbers(|point| point.at[0]))
        .unit("m/s")
        .numbers("l", numbers(|point| point.at[1]))
        .unit("m");
    let limits = if rolling {
        "Limits of stability (solid) and of rolling (dashed) on several circles"
    } else {
        "Limits of stability on several circles, on which the wheel can roll everywhere here"
    };
    let caption = format!(
        "{limits}; a circle without a solid line has no change of stability here. The diamond is the wheel."
    );
    Ok(Illustration { figure, data, caption })
}
