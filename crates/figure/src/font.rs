//! The embedded fonts (New Computer Modern, the fonts of LaTeX) and the outlines of their glyphs.
//!
//! Text is drawn as outlines, so a figure looks the same on every machine and needs no font installed.

use std::sync::OnceLock;

use ttf_parser::{Face, GlyphId, OutlineBuilder};

use crate::geometry::Point;
use crate::path::{Path, Segment};

/// Units of the em square; both fonts use it.
pub(crate) const UNITS_PER_EM: f64 = 1000.0;

/// The fonts a figure uses.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub(crate) enum Font {
    /// The mathematics font in its book weight: upright text, digits, symbols and italic letters.
    Text,
    /// Bold text, for the tags of panels.
    Bold,
}

/// One glyph of one font.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub(crate) struct Glyph {
    pub font: Font,
    pub index: u16,
}

impl Font {
    fn postscript_name(self) -> &'static str {
        match self {
            Font::Text => "NewCMMath-Book",
            Font::Bold => "NewCM10-Bold",
        }
    }

    fn face(self) -> &'static Face<'static> {
        static TEXT: OnceLock<Face<'static>> = OnceLock::new();
        static BOLD: OnceLock<Face<'static>> = OnceLock::new();
        let cell = match self {
            Font::Text => &TEXT,
            Font::Bold => &BOLD,
        };
        cell.get_or_init(|| {
            // The fonts are part of the program, so no input can make this fail; a test loads each of them.
            typst_assets::fonts()
                .filter_map(|data| Face::parse(data, 0).ok())
                .find(|face| {
                    face.names().into_iter().any(|name| {
                        name.name_id == ttf_parser::name_id::POST_SCRIPT_NAME
                            && name.to_string().as_deref() == Some(self.postscript_name())
                    })
                })
                .expect("the fonts are embedded in the program")
        })
    }

    /// The glyph of a character: from this font, else from the text font, else the font's sign for a missing glyph.
    pub fn glyph(self, character: char) -> Glyph {
        [self, Font::Text]
            .into_iter()
            .find_map(|font| Some(Glyph { font, index: font.face().glyph_index(character)?.0 }))
            .unwrap_or(Glyph { font: self, index: 0 })
    }
}

impl Glyph {
    /// Advance width in font units.
    pub fn advance(self) -> f64 {
        f64::from(self.font.face().glyph_hor_advance(GlyphId(self.index)).unwrap_or(0))
    }

    /// Outline in font units, y downwards, origin on the baseline.
    pub fn outline(self) -> Path {
        let mut collector = Collector(Path::default());
        // A glyph without an outline, such as a space, leaves the path empty.
        self.font.face().outline_glyph(GlyphId(self.index), &mut collector);
        collector.0
    }
}

struct Collector(Path);

fn flipped(x: f32, y: f32) -> Point {
    Point::new(f64::from(x), -f64::from(y))
}

impl OutlineBuilder for Collector {
    fn move_to(&mut self, x: f32, y: f32) {
        self.0.segments.push(Segment::Move(flipped(x, y)));
    }
    fn line_to(&mut self, x: f32, y: f32) {
        self.0.segments.push(Segment::Line(flipped(x, y)));
    }
    fn quad_to(&mut self, x1: f32, y1: f32, x: f32, y: f32) {
        self.0.segments.push(Segment::Quad(flipped(x1, y1), flipped(x, y)));
    }
    fn curve_to(&mut self, x1: f32, y1: f32, x2: f32, y2: f32, x: f32, y: f32) {
        self.0.segments.push(Segment::Cubic(flipped(x1, y1), flipped(x2, y2), flipped(x, y)));
    }
    fn close(&mut self) {
        self.0.segments.push(Segment::Close);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_font_is_there_with_the_expected_em() {
        for font in [Font::Text, Font::Bold] {
            assert_eq!(f64::from(font.face().units_per_em()), UNITS_PER_EM);
            assert!(!font.glyph('A').outline().segments.is_empty());
        }
    }

    #[test]
    fn letters_with_accents_and_mathematical_letters_have_glyphs() {
        for character in "áčőüß−∞×°≤≥±µψΩ".chars().chain(['\u{1D713}', '\u{1D463}', '\u{210E}'])
        {
            assert_ne!(Font::Text.glyph(character).index, 0, "{character}");
        }
    }
}
