//! The embedded fonts (New Computer Modern, the fonts of LaTeX) and the outlines of their glyphs.
//!
//! Text is drawn as outlines, so a figure looks the same on every machine and needs no font installed. The outlines are
//! taken from the fonts when this crate is built: `build.rs` says which and how they are stored.

use std::cmp::Ordering;

use crate::geometry::Point;
use crate::path::{Path, Segment};

/// Units of the em square; both fonts use it.
pub(crate) const UNITS_PER_EM: f64 = 1000.0;

/// Bytes before the characters of a table, and of each character.
const HEAD: usize = 4;
const ENTRY: usize = 12;

static TEXT: &[u8] = include_bytes!(concat!(env!("OUT_DIR"), "/text.glyphs"));
static BOLD: &[u8] = include_bytes!(concat!(env!("OUT_DIR"), "/bold.glyphs"));

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
    /// Its number in the font.
    pub index: u16,
    /// Advance width in font units.
    advance: u16,
    /// Where its outline starts in the table of the font.
    start: usize,
}

impl Font {
    fn table(self) -> &'static [u8] {
        match self {
            Font::Text => TEXT,
            Font::Bold => BOLD,
        }
    }

    /// The glyph of a character: from this font, else from the text font, else the font's sign for a missing glyph.
    pub(crate) fn glyph(self, character: char) -> Glyph {
        [self, Font::Text].into_iter().find_map(|font| font.find(character)).unwrap_or_else(|| self.entry(0))
    }

    fn find(self, character: char) -> Option<Glyph> {
        let (mut from, mut to) = (0, self.count());
        while from < to {
            let middle = from.midpoint(to);
            match self.character(middle).cmp(&u32::from(character)) {
                Ordering::Less => from = middle + 1,
                Ordering::Greater => to = middle,
                Ordering::Equal => return Some(self.entry(middle)),
            }
        }
        None
    }

    fn count(self) -> usize {
        u32::from_le_bytes(bytes(self.table(), 0)) as usize
    }

    fn character(self, entry: usize) -> u32 {
        u32::from_le_bytes(bytes(self.table(), HEAD + ENTRY * entry))
    }

    fn entry(self, entry: usize) -> Glyph {
        let (table, at) = (self.table(), HEAD + ENTRY * entry);
        Glyph {
            font: self,
            index: u16::from_le_bytes(bytes(table, at + 4)),
            advance: u16::from_le_bytes(bytes(table, at + 6)),
            start: HEAD + ENTRY * self.count() + u32::from_le_bytes(bytes(table, at + 8)) as usize,
        }
    }
}

impl Glyph {
    /// Advance width in font units.
    pub(crate) fn advance(self) -> f64 {
        f64::from(self.advance)
    }

    /// Outline in font units, y downwards, origin on the baseline.
    pub(crate) fn outline(self) -> Path {
        let table = self.font.table();
        let mut reader = OutlineReader { table, at: self.start + 1, short: table[self.start] == 0 };
        let mut path = Path::default();
        while let Some(segment) = reader.segment() {
            path.segments.push(segment);
        }
        path
    }
}

struct OutlineReader {
    table: &'static [u8],
    at: usize,
    /// Whether coordinates are stored as whole numbers.
    short: bool,
}

impl OutlineReader {
    fn segment(&mut self) -> Option<Segment> {
        let letter = self.table[self.at];
        self.at += 1;
        match letter {
            b'M' => Some(Segment::Move(self.point())),
            b'L' => Some(Segment::Line(self.point())),
            b'Q' => Some(Segment::Quad(self.point(), self.point())),
            b'C' => Some(Segment::Cubic(self.point(), self.point(), self.point())),
            b'Z' => Some(Segment::Close),
            _ => None,
        }
    }

    fn point(&mut self) -> Point {
        let (x, y) = (self.coordinate(), self.coordinate());
        Point::new(x, -y)
    }

    fn coordinate(&mut self) -> f64 {
        let at = self.at;
        if self.short {
            self.at += 2;
            f64::from(i16::from_le_bytes(bytes(self.table, at)))
        } else {
            self.at += 4;
            f64::from(f32::from_le_bytes(bytes(self.table, at)))
        }
    }
}

fn bytes<const N: usize>(table: &[u8], at: usize) -> [u8; N] {
    std::array::from_fn(|i| table[at + i])
}

#[cfg(test)]
mod tests {
    use super::*;
    use ttf_parser::{Face, GlyphId, OutlineBuilder, name_id};

    /// An outline as the face itself gives it.
    #[derive(Default)]
    struct Reference(Vec<Segment>);

    fn flipped(x: f32, y: f32) -> Point {
        Point::new(f64::from(x), -f64::from(y))
    }

    impl OutlineBuilder for Reference {
        fn move_to(&mut self, x: f32, y: f32) {
            self.0.push(Segment::Move(flipped(x, y)));
        }
        fn line_to(&mut self, x: f32, y: f32) {
            self.0.push(Segment::Line(flipped(x, y)));
        }
        fn quad_to(&mut self, x1: f32, y1: f32, x: f32, y: f32) {
            self.0.push(Segment::Quad(flipped(x1, y1), flipped(x, y)));
        }
        fn curve_to(&mut self, x1: f32, y1: f32, x2: f32, y2: f32, x: f32, y: f32) {
            self.0.push(Segment::Cubic(flipped(x1, y1), flipped(x2, y2), flipped(x, y)));
        }
        fn close(&mut self) {
            self.0.push(Segment::Close);
        }
    }

    #[test]
    fn every_glyph_is_that_of_its_face() {
        for (font, name) in [(Font::Text, "NewCMMath-Book"), (Font::Bold, "NewCM10-Bold")] {
            let face = typst_assets::fonts()
                .filter_map(|data| Face::parse(data, 0).ok())
                .find(|face| {
                    face.names().into_iter().any(|entry| {
                        entry.name_id == name_id::POST_SCRIPT_NAME
                            && entry.to_string().as_deref() == Some(name)
                    })
                })
                .unwrap();
            assert_eq!(f64::from(face.units_per_em()), UNITS_PER_EM);
            assert!(font.count() > 1000, "{name} has {} characters", font.count());
            for entry in 0..font.count() {
                let (glyph, character) = (font.entry(entry), char::from_u32(font.character(entry)).unwrap());
                let expected = face.glyph_index(character).unwrap_or(GlyphId(0));
                assert_eq!(font.glyph(character), glyph);
                assert_eq!(glyph.index, expected.0, "{character}");
                assert_eq!(Some(glyph.advance), face.glyph_hor_advance(expected), "{character}");
                let mut reference = Reference::default();
                face.outline_glyph(expected, &mut reference);
                assert_eq!(glyph.outline().segments, reference.0, "{character}");
            }
        }
    }

    #[test]
    fn letters_with_accents_and_mathematical_letters_have_glyphs() {
        for character in "áčőüß−∞×°≤≥±µψΩ".chars().chain(['\u{1D713}', '\u{1D463}', '\u{210E}'])
        {
            assert_ne!(Font::Text.glyph(character).index, 0, "{character}");
        }
    }

    #[test]
    fn a_character_that_no_face_has_is_drawn_as_a_missing_glyph() {
        for font in [Font::Text, Font::Bold] {
            let missing = font.glyph('漢');
            assert_eq!((missing.font, missing.index), (font, 0));
            assert!(missing.advance() > 0.0);
        }
        assert_eq!(Font::Bold.glyph('∮').font, Font::Text);
    }
}
