//! How a picture looks on the page: which part of it is seen, on which paper.

use kingpin_figure::{Figure, Theme};
use serde::Deserialize;

/// How a picture looks; without anything as on the command line.
#[derive(Clone, Copy, Debug, Default, Deserialize)]
pub struct Look {
    /// Ends of the axes of its first panel; an axis without is as wide as what it shows.
    #[serde(default)]
    window: Window,
    /// Whether it stands on dark paper.
    #[serde(default)]
    dark: bool,
    /// Whether the labels of an SVG file are text instead of outlines.
    #[serde(default)]
    pub(crate) text: bool,
}

/// Ends of axes.
#[derive(Clone, Copy, Debug, Default, Deserialize)]
#[serde(deny_unknown_fields)]
struct Window {
    #[serde(default)]
    x: Option<[f64; 2]>,
    #[serde(default)]
    y: Option<[f64; 2]>,
}

impl Look {
    /// A figure that looks so.
    pub fn of(&self, figure: Figure) -> Figure {
        let ends = |ends: Option<[f64; 2]>| ends.map(|[low, high]| (low, high));
        let theme = if self.dark { Theme::Dark } else { Theme::Light };
        figure.window(0, ends(self.window.x), ends(self.window.y)).theme(theme)
    }
}
