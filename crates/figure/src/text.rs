//! Sets a label: from markup to glyphs with positions, widths and heights.

use crate::font::{Font, Glyph, UNITS_PER_EM};
use crate::geometry::{Point, Rect};
use crate::markup::{Piece, parse};

/// Size of scripts relative to their base, and how far they are lowered and raised, in em of the base
/// (close to the parameters of Computer Modern).
const SCRIPT_SCALE: f64 = 0.7;
const SUBSCRIPT_DROP: f64 = 0.17;
const SUPERSCRIPT_RISE: f64 = 0.38;
/// Gap between a base and its superscript, which italic letters lean into.
const SUPERSCRIPT_GAP: f64 = 0.05;
/// Height of capitals and depth of descenders, in em.
const CAPITAL_HEIGHT: f64 = 0.683;
const DESCENDER_DEPTH: f64 = 0.2;

/// A glyph with the position of its origin relative to the start of the baseline and its size, all in points.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct PlacedGlyph {
    pub glyph: Glyph,
    /// What it shows.
    pub character: char,
    pub at: Point,
    pub size: f64,
}

/// A label set in one line.
#[derive(Debug, Clone, PartialEq, Default)]
pub(crate) struct TextLayout {
    pub glyphs: Vec<PlacedGlyph>,
    /// Advance width.
    pub width: f64,
    /// Height above and depth below the baseline.
    pub ascent: f64,
    pub descent: f64,
}

/// Which part of a label lies at the given point.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Anchor {
    /// The left end, at half the height of a capital.
    #[default]
    Left,
    /// The middle.
    Center,
    /// The right end, at half the height of a capital.
    Right,
    /// The middle of the upper edge: the label hangs below the point.
    Top,
    /// The middle of the lower edge: the label stands above the point.
    Bottom,
}

impl TextLayout {
    /// Sets a label with markup at a font size in points.
    pub(crate) fn new(source: &str, size: f64) -> Self {
        Self::with_font(source, size, Font::Text)
    }

    pub(crate) fn with_font(source: &str, size: f64, font: Font) -> Self {
        let mut layout = TextLayout::default();
        let width = set(&parse(source), size, Point::new(0.0, 0.0), font, &mut layout);
        layout.width = width;
        layout
    }

    /// What it says, without its form.
    pub(crate) fn plain(source: &str) -> String {
        fn add(pieces: &[Piece], text: &mut String) {
            for piece in pieces {
                match piece {
                    Piece::Character(character) => text.push(upright(*character)),
                    Piece::Space(_) => {}
                    Piece::Scripts { lower, upper } => [lower, upper].iter().for_each(|part| add(part, text)),
                }
            }
        }
        let mut text = String::new();
        add(&parse(source), &mut text);
        text
    }

    pub(crate) fn height(&self) -> f64 {
        self.ascent + self.descent
    }

    /// Where the baseline starts when the anchor of the label is at `point`.
    pub(crate) fn origin(&self, point: Point, anchor: Anchor, size: f64) -> Point {
        let middle = point.y + 0.5 * CAPITAL_HEIGHT * size;
        match anchor {
            Anchor::Left => Point::new(point.x, middle),
            Anchor::Center => Point::new(point.x - 0.5 * self.width, middle),
            Anchor::Right => Point::new(point.x - self.width, middle),
            Anchor::Top => Point::new(point.x - 0.5 * self.width, point.y + self.ascent),
            Anchor::Bottom => Point::new(point.x - 0.5 * self.width, point.y - self.descent),
        }
    }

    /// The rectangle the label covers when its baseline starts at `origin`.
    pub(crate) fn bounds(&self, origin: Point) -> Rect {
        Rect::new(origin.x, origin.y - self.ascent, origin.x + self.width, origin.y + self.descent)
    }
}

/// The letter that an italic letter of mathematics is, as it is searched and read aloud.
pub(crate) fn upright(character: char) -> char {
    let code = u32::from(character);
    let letter = match code {
        0x1D434..=0x1D44D => code - 0x1D434 + u32::from('A'),
        0x1D44E..=0x1D467 => code - 0x1D44E + u32::from('a'),
        0x210E => u32::from('h'),
        0x1D6E2..=0x1D6FA => code - 0x1D6E2 + u32::from('Α'),
        0x1D6FC..=0x1D714 => code - 0x1D6FC + u32::from('α'),
        _ => code,
    };
    char::from_u32(letter).unwrap_or(character)
}

/// Sets pieces from `start` on and returns the horizontal position after them.
fn set(pieces: &[Piece], size: f64, start: Point, font: Font, layout: &mut TextLayout) -> f64 {
    let scale = size / UNITS_PER_EM;
    let mut x = start.x;
    for piece in pieces {
        match piece {
            Piece::Character(character) => {
                let glyph = font.glyph(*character);
                layout.glyphs.push(PlacedGlyph {
                    glyph,
                    character: *character,
                    at: Point::new(x, start.y),
                    size,
                });
                x += glyph.advance() * scale;
                layout.ascent = layout.ascent.max(CAPITAL_HEIGHT * size - start.y);
                // Digits and capitals have no descender; a label of those alone is centred better without one.
                if !character.is_ascii_digit() && !character.is_ascii_uppercase() && *character != '−' {
                    layout.descent = layout.descent.max(DESCENDER_DEPTH * size + start.y);
                }
            }
            Piece::Space(em) => x += em * size,
            Piece::Scripts { lower, upper } => {
                let below = Point::new(x, start.y + SUBSCRIPT_DROP * size);
                let above = Point::new(x + SUPERSCRIPT_GAP * size, start.y - SUPERSCRIPT_RISE * size);
                let after_lower = set(lower, size * SCRIPT_SCALE, below, font, layout);
                let after_upper =
                    if upper.is_empty() { x } else { set(upper, size * SCRIPT_SCALE, above, font, layout) };
                x = after_lower.max(after_upper) + 0.02 * size;
            }
        }
    }
    x
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_label_is_as_wide_as_its_letters_and_grows_with_its_size() {
        let narrow = TextLayout::new("v", 10.0);
        let wide = TextLayout::new("velocity", 10.0);
        assert!(wide.width > 3.0 * narrow.width);
        assert!((TextLayout::new("velocity", 20.0).width - 2.0 * wide.width).abs() < 1e-9);
    }

    #[test]
    fn what_a_label_says_is_plain() {
        assert_eq!(TextLayout::plain("$v$ (m/s)"), "v (m/s)");
        assert_eq!(TextLayout::plain("$\\psi_0$"), "ψ0");
        assert_eq!(TextLayout::plain("$\\Omega h$"), "Ωh");
    }

    #[test]
    fn a_subscript_is_lower_and_smaller_than_its_base() {
        let layout = TextLayout::new("$q_0$", 10.0);
        assert_eq!(layout.glyphs.len(), 2);
        assert!(layout.glyphs[1].at.y > 0.0 && layout.glyphs[1].size < layout.glyphs[0].size);
    }

    #[test]
    fn an_anchored_label_lies_where_it_should() {
        let layout = TextLayout::new("label", 8.0);
        let at = Point::new(50.0, 50.0);
        let right = layout.bounds(layout.origin(at, Anchor::Right, 8.0));
        let above = layout.bounds(layout.origin(at, Anchor::Bottom, 8.0));
        assert!((right.right - 50.0).abs() < 1e-9);
        assert!((above.bottom - 50.0).abs() < 1e-9 && (above.center().x - 50.0).abs() < 1e-9);
    }
}
