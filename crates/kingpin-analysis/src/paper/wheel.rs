//! The paper's wheel and its turning radii, as all figures show them.

use kingpin::{Key, KingpinError, Wheel};
use kingpin_figure::{Color, palette};

/// Turning radii of figures 3 and 6, in m.
pub(super) const RADII: [f64; 5] = [0.5, 1.0, 2.0, 5.0, f64::INFINITY];

/// The paper's wheel at a speed in m/s, a caster length and a turning radius in m.
pub(super) fn paper_wheel(speed: f64, caster_length: f64, radius: f64) -> Result<Wheel, KingpinError> {
    Wheel::default().with(Key::V, speed)?.with(Key::L, caster_length)?.with(Key::TurningRadius, radius)
}

/// The colour of a turning radius, the same in all figures.
pub(super) fn radius_color(radius: f64) -> Color {
    let colors = [palette::VERMILION, palette::BLACK, palette::BLUE, palette::GREEN, palette::PURPLE];
    RADII.iter().position(|candidate| *candidate == radius).map_or(palette::GREY, |index| colors[index])
}

/// The name of a turning radius in the figures.
pub(super) fn radius_label(radius: f64) -> String {
    if radius.is_infinite() { "$r=\\infty$".to_owned() } else { format!("$r={radius}$ m") }
}
