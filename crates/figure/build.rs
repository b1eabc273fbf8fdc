//! Takes from the fonts what figures need: the outlines of the characters that occur in labels, from two faces.
//!
//! All fonts of `typst-assets` together are 10 MB; what is written here for `src/font.rs` to read is an eighth of that.
//! A character that is not in the list, or that the face does not have, is drawn as the face draws missing characters.
//!
//! A table is little-endian: the number of characters (`u32`); for each, in ascending order, the character (`u32`), the
//! index of its glyph in the face (`u16`), its advance width (`u16`) and where its outline starts among the outlines
//! (`u32`); then the outlines. An outline is a byte that says how its coordinates are stored (0: `i16`, 1: `f32`),
//! then segments, each a letter (`M`, `L`, `Q`, `C`, `Z` as in SVG) with its coordinates, then a zero byte.

use std::collections::BTreeMap;
use std::error::Error;
use std::ops::RangeInclusive;
use std::path::PathBuf;
use std::{env, fs};

use ttf_parser::{Face, GlyphId, OutlineBuilder, name_id};

/// The faces, by the names of the tables that `src/font.rs` includes.
const FACES: [(&str, &str); 2] = [("text.glyphs", "NewCMMath-Book"), ("bold.glyphs", "NewCM10-Bold")];
/// Units of the em square that `src/font.rs` expects.
const UNITS_PER_EM: u16 = 1000;

/// The characters of labels, as far as a face has them.
const CHARACTERS: [RangeInclusive<char>; 9] = [
    // Latin with Latin-1, Extended-A and Extended-B.
    ' '..='\u{24F}',
    // Combining marks, Greek.
    '\u{300}'..='\u{3FF}',
    // Latin with more accents, Greek with breathings.
    '\u{1E00}'..='\u{1FFF}',
    // Punctuation, superscripts and subscripts, currencies, letter-like symbols, fractions, arrows, mathematical
    // operators, technical signs.
    '\u{2000}'..='\u{23FF}',
    // Geometric shapes.
    '\u{25A0}'..='\u{25FF}',
    // More mathematical symbols and arrows.
    '\u{27C0}'..='\u{27FF}',
    '\u{2980}'..='\u{2AFF}',
    // Ligatures.
    '\u{FB00}'..='\u{FB06}',
    // Mathematical letters and digits: italic, bold, script, ..
    '\u{1D400}'..='\u{1D7FF}',
];

fn main() -> Result<(), Box<dyn Error>> {
    println!("cargo::rerun-if-changed=build.rs");
    let folder = PathBuf::from(env::var("OUT_DIR")?);
    for (file, name) in FACES {
        let face = typst_assets::fonts()
            .filter_map(|data| Face::parse(data, 0).ok())
            .find(|face| is_named(face, name))
            .ok_or_else(|| format!("typst-assets has no face {name}"))?;
        if face.units_per_em() != UNITS_PER_EM {
            return Err(format!("{name} has {} units per em, not {UNITS_PER_EM}", face.units_per_em()).into());
        }
        fs::write(folder.join(file), table(&face))?;
    }
    Ok(())
}

fn is_named(face: &Face, name: &str) -> bool {
    face.names()
        .into_iter()
        .any(|entry| entry.name_id == name_id::POST_SCRIPT_NAME && entry.to_string().as_deref() == Some(name))
}

fn table(face: &Face) -> Vec<u8> {
    // The sign for a missing glyph stands for the character zero, which no face has.
    let missing = std::iter::once(('\0', GlyphId(0)));
    let characters = CHARACTERS.into_iter().flatten();
    let present = characters.filter_map(|character| Some((character, face.glyph_index(character)?)));
    let glyphs: Vec<(char, GlyphId)> = missing.chain(present).collect();

    let mut table = u32::to_le_bytes(glyphs.len() as u32).to_vec();
    let mut outlines = Vec::new();
    // Characters that share a glyph share its outline.
    let mut starts = BTreeMap::new();
    for (character, glyph) in glyphs {
        let start = *starts.entry(glyph).or_insert_with(|| {
            let start = outlines.len() as u32;
            outlines.extend(outline(face, glyph));
            start
        });
        table.extend((character as u32).to_le_bytes());
        table.extend(glyph.0.to_le_bytes());
        table.extend(face.glyph_hor_advance(glyph).unwrap_or(0).to_le_bytes());
        table.extend(start.to_le_bytes());
    }
    table.extend(outlines);
    table
}

fn outline(face: &Face, glyph: GlyphId) -> Vec<u8> {
    let mut segments = Segments(Vec::new());
    // A glyph without an outline, such as a space, has no segments.
    face.outline_glyph(glyph, &mut segments);
    let fits = |&x: &f32| x == f32::from(x as i16);
    let short = segments.0.iter().flat_map(|(_, coordinates)| coordinates).all(fits);
    let mut bytes = vec![u8::from(!short)];
    for (letter, coordinates) in segments.0 {
        bytes.push(letter);
        for x in coordinates {
            if short {
                bytes.extend((x as i16).to_le_bytes());
            } else {
                bytes.extend(x.to_le_bytes());
            }
        }
    }
    bytes.push(0);
    bytes
}

/// Segments of an outline: a letter each, with coordinates in font units.
struct Segments(Vec<(u8, Vec<f32>)>);

impl OutlineBuilder for Segments {
    fn move_to(&mut self, x: f32, y: f32) {
        self.0.push((b'M', vec![x, y]));
    }
    fn line_to(&mut self, x: f32, y: f32) {
        self.0.push((b'L', vec![x, y]));
    }
    fn quad_to(&mut self, x1: f32, y1: f32, x: f32, y: f32) {
        self.0.push((b'Q', vec![x1, y1, x, y]));
    }
    fn curve_to(&mut self, x1: f32, y1: f32, x2: f32, y2: f32, x: f32, y: f32) {
        self.0.push((b'C', vec![x1, y1, x2, y2, x, y]));
    }
    fn close(&mut self) {
        self.0.push((b'Z', Vec::new()));
    }
}
