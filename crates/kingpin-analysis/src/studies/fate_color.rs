//! Colours of fates in the figures of the studies.

use kingpin::basin::Fate;
use kingpin_figure::{Color, palette};

/// The colour of a fate, the same in all figures.
pub(super) fn fate_color(fate: Fate) -> Color {
    match fate {
        Fate::UniformMotion => palette::SKY_BLUE.lightened(0.55),
        Fate::Shimmy => palette::VERMILION,
        Fate::SteadySliding => palette::GREEN,
        Fate::Tumbling => palette::ORANGE.lightened(0.35),
        Fate::Escape => palette::GREY,
        Fate::Irregular => palette::VERMILION.lightened(0.5),
        Fate::ModelEnds => palette::BLACK,
        Fate::Undecided => palette::LIGHT_GREY,
    }
}
