//! Limits of stability and of rolling over speed and caster length, for several circles, with the wheel among them.

use super::illustration::Illustration;
use crate::axis_label;
use crate::error::Error;
use arclength_analysis::Control;
use kingpin::{Axis as Interval, Key, Plane, Wheel};
use kingpin_figure::{
    Axis, Color, Dash, Figure, Legend, LegendEntry, Line, Marker, MarkerShape, Markers, Panel, palette,
};
use kingpin_report::Columns;
use kingpin_report::numbers::readable;

/// Radii in m of the circles, beside that of the wheel.
const RADII: [f64; 4] = [1.0, 2.0, 5.0, f64::INFINITY];
const COLORS: [Color; 5] =
    [palette::VERMILION, palette::BLUE, palette::GREEN, palette::PURPLE, palette::ORANGE];

/// A point of a limit.
struct Place {
    limit: &'static str,
    radius: f64,
    curve: u64,
    speed: f64,
    length: f64,
}

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
    let mut places = Vec::new();
    let mut panel = Panel::new(
        Axis::new(axis_label::of(Key::V)).limits(0.0, fastest),
        Axis::new(axis_label::of(Key::L)).limits(lengths[0], lengths[1]),
    )
    .legend(Legend::Below);
    for (index, (radius, color)) in radii.iter().copied().zip(COLORS).enumerate() {
        let part = |index: usize| index as f64 / radii.len() as f64;
        let control = control.part(part(index)..part(index + 1));
        let wheel = wheel.with(Key::TurningRadius, radius)?;
        let limits = [
            ("stability", wheel.stability_boundary(&plane, &control)?),
            ("rolling", wheel.rolling_limit(&plane, &control)?),
        ];
        let name = if radius.is_infinite() {
            "$r=\\infty$".to_owned()
        } else {
            format!("$r={}$ m", readable(radius))
        };
        panel = panel.legend_entry(LegendEntry::line(name, color, Dash::Solid));
        for (limit, curves) in limits {
            for (number, curve) in (1..).zip(curves) {
                let line = Line::new(curve.points.iter().copied()).color(color);
                let line = if limit == "rolling" { line.dashed() } else { line };
                panel = panel.curve(line);
                places.extend(curve.points.iter().map(|[speed, length]| Place {
                    limit,
                    radius,
                    curve: number,
                    speed: *speed,
                    length: *length,
                }));
            }
        }
    }
    let here = (wheel.get(Key::V), wheel.get(Key::L));
    let marker = Marker::new(MarkerShape::Diamond).color(palette::BLACK);
    panel = panel.markers(Markers::new([here], marker).legend("the wheel")).legend_entry(LegendEntry::line(
        "limit of rolling",
        palette::BLACK,
        Dash::Dashed,
    ));
    let figure = Figure::single_column()
        .description("Limits of stability and of rolling over speed and caster length for several circles")
        .panel(panel);
    let numbers = |quantity: fn(&Place) -> f64| places.iter().map(quantity);
    let data = Columns::new()
        .texts("limit", places.iter().map(|place| Some(place.limit.to_owned())))
        .numbers("r", numbers(|place| place.radius))
        .unit("m")
        .counts("curve", places.iter().map(|place| place.curve))
        .numbers("v", numbers(|place| place.speed))
        .unit("m/s")
        .numbers("l", numbers(|place| place.length))
        .unit("m");
    let caption = "Limits of stability (solid) and of rolling (dashed) on several circles; a circle without a solid line has no change of \
                   stability here. The diamond is the wheel.";
    Ok(Illustration { figure, data, caption: caption.to_owned() })
}
