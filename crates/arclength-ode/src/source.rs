//! From bytes to logical lines: character sets, line endings and continuation.
//!
//! Models come from thirty years of editors, so the text may be UTF-8 or Latin-1, with any line
//! ending. A logical line remembers where each of its characters was, through continuation and
//! array expansion, so that errors point at what the author wrote.

use crate::error::Span;

/// Text of the model, whatever its encoding: UTF-8, or else Latin-1.
pub(crate) fn decode(bytes: &[u8]) -> String {
    match std::str::from_utf8(bytes) {
        Ok(text) => text.strip_prefix('\u{feff}').unwrap_or(text).to_owned(),
        Err(_) => bytes.iter().map(|&byte| char::from(byte)).collect(),
    }
}

/// The lines of the file, ended by LF, CR LF or CR.
pub(crate) fn physical_lines(source: &str) -> impl Iterator<Item = &str> {
    source.split('\n').flat_map(|line| line.strip_suffix('\r').unwrap_or(line).split('\r'))
}

/// Characters with the places they came from.
#[derive(Clone, Debug, Default)]
pub(crate) struct Text {
    characters: Vec<char>,
    places: Vec<(u32, u32)>,
}

impl Text {
    pub(crate) fn push(&mut self, character: char, place: (u32, u32)) {
        self.characters.push(character);
        self.places.push(place);
    }

    pub(crate) fn len(&self) -> usize {
        self.characters.len()
    }

    /// The character at `index`; NUL past the end.
    pub(crate) fn at(&self, index: usize) -> char {
        self.characters.get(index).copied().unwrap_or('\0')
    }

    /// The character at `index` in lower case; NUL past the end.
    pub(crate) fn lower_at(&self, index: usize) -> char {
        self.at(index).to_ascii_lowercase()
    }

    pub(crate) fn place(&self, index: usize) -> (u32, u32) {
        match self.places.get(index) {
            Some(&place) => place,
            // Past the end: one column after the last character.
            None => self.places.last().map_or((1, 1), |&(line, column)| (line, column + 1)),
        }
    }

    /// Span of the characters `start..end`, as far as they lie on one line of the source.
    pub(crate) fn span(&self, start: usize, end: usize) -> Span {
        let (line, column) = self.place(start);
        let last = self.place(end.max(start + 1) - 1);
        let length = if last.0 == line && last.1 >= column { last.1 - column + 1 } else { 1 };
        Span { line, column, length }
    }

    pub(crate) fn string(&self, start: usize, end: usize) -> String {
        self.characters
            .get(start..end.min(self.len()))
            .map(|slice| slice.iter().collect())
            .unwrap_or_default()
    }

    /// First index from `start` that holds no white space; the length if there is none.
    pub(crate) fn skip_blanks(&self, start: usize) -> usize {
        (start..self.len()).find(|&index| !self.at(index).is_whitespace()).unwrap_or(self.len())
    }

    /// First index from `start` whose character satisfies `stop`; the length if there is none.
    pub(crate) fn find(&self, start: usize, stop: impl Fn(char) -> bool) -> usize {
        (start..self.len()).find(|&index| stop(self.at(index))).unwrap_or(self.len())
    }

    /// End of the identifier that starts at `start`; `start` itself when there is none.
    pub(crate) fn identifier_end(&self, start: usize) -> usize {
        if !is_identifier_start(self.at(start)) {
            return start;
        }
        self.find(start, |character| !is_identifier_part(character))
    }
}

pub(crate) fn is_identifier_start(character: char) -> bool {
    character.is_ascii_alphabetic() || character == '_'
}

pub(crate) fn is_identifier_part(character: char) -> bool {
    character.is_ascii_alphanumeric() || character == '_'
}

/// Lines joined by a backslash, as XPPAUT does: what follows the backslash on its line is dropped.
pub(crate) fn logical_lines(source: &str) -> Vec<Text> {
    let mut lines = Vec::new();
    let mut current = Text::default();
    let mut continued = false;
    for (number, line) in physical_lines(source).enumerate() {
        continued = false;
        for (column, character) in line.chars().enumerate() {
            if character == '\\' {
                continued = true;
                break;
            }
            current.push(character, (number as u32 + 1, column as u32 + 1));
        }
        if !continued {
            lines.push(std::mem::take(&mut current));
        }
    }
    if continued {
        lines.push(current);
    }
    lines
}
