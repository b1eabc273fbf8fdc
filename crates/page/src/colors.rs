//! Colours that the page has for curves of its diagrams, which are told apart with any colour vision.

use arclength_analysis::picture::OwnColor;
use kingpin_figure::{Color, palette};
use serde::Deserialize;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

/// Results with a colour of their own, by their names.
#[derive(Clone, Debug, Default, Deserialize)]
#[serde(transparent)]
pub struct OwnColors(BTreeMap<PathBuf, ColorName>);

#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "lowercase")]
enum ColorName {
    Blue,
    Vermilion,
    Green,
    Purple,
    Orange,
    Sky,
    Black,
}

impl From<ColorName> for Color {
    fn from(name: ColorName) -> Self {
        match name {
            ColorName::Blue => palette::BLUE,
            ColorName::Vermilion => palette::VERMILION,
            ColorName::Green => palette::GREEN,
            ColorName::Purple => palette::PURPLE,
            ColorName::Orange => palette::ORANGE,
            ColorName::Sky => palette::SKY_BLUE,
            ColorName::Black => palette::BLACK,
        }
    }
}

impl OwnColors {
    /// Those of results, in their order, with their names.
    pub fn of(&self, results: &[PathBuf]) -> Vec<Option<OwnColor>> {
        let own = |path: &PathBuf| {
            let name = Path::new(path).file_stem().unwrap_or_default().to_string_lossy().into_owned();
            self.0.get(path).map(|color| OwnColor { color: (*color).into(), name })
        };
        results.iter().map(own).collect()
    }

    /// Whether none of them has one.
    pub fn is_empty(&self) -> bool {
        self.0.is_empty()
    }
}
