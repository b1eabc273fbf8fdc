//! From bytes to logical lines: character sets, line endings and continuation.
//!
//! Models come from thirty years of editors, so the text may be UTF-8 or Latin-1, with any line
//! ending. A logical line remembers where each of its characters was, through continuation and
//! array expansion, so that errors point at what the author wrote.

use crate::error::{Span, Warning};

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
    ///
    /// XPPAUT looks for names before numbers, so that `2b` is a name; `1e5` and the beginning of `2.5` are numbers.
    pub(crate) fn identifier_end(&self, start: usize) -> usize {
        let first = self.at(start);
        let end = self.find(start, |character| !is_identifier_part(character));
        let is_name = is_identifier_start(first) || first.is_ascii_digit() && self.number_end(start) < end;
        if is_name { end } else { start }
    }

    /// End of the number that starts at `start`: digits, a point, digits, and an exponent if it has digits.
    pub(crate) fn number_end(&self, start: usize) -> usize {
        let digits = |from: usize| self.find(from, |character| !character.is_ascii_digit());
        let mut end = digits(start);
        if self.at(end) == '.' {
            end = digits(end + 1);
        }
        if self.lower_at(end) == 'e' {
            let sign = usize::from(matches!(self.at(end + 1), '+' | '-'));
            let exponent_end = digits(end + 1 + sign);
            if exponent_end > end + 1 + sign {
                return exponent_end;
            }
        }
        end
    }

    /// Whether the line is a remark: empty, or begun by `#`, `"`, or a `%` that begins no block.
    pub(crate) fn is_remark(&self) -> bool {
        let start = self.skip_blanks(0);
        match self.at(start) {
            '#' => !self.is_include(start),
            '%' => self.at(self.skip_blanks(start + 1)) != '[',
            '"' => true,
            _ => start == self.len(),
        }
    }

    /// Whether `#include` stands at `start`.
    pub(crate) fn is_include(&self, start: usize) -> bool {
        let word = self.string(start, start + "#include".len());
        word.eq_ignore_ascii_case("#include")
    }
}

pub(crate) fn is_identifier_start(character: char) -> bool {
    character.is_ascii_alphabetic() || character == '_'
}

pub(crate) fn is_identifier_part(character: char) -> bool {
    character.is_ascii_alphanumeric() || character == '_'
}

/// Lines joined by a backslash, as XPPAUT does: what follows the backslash on its line is dropped. In a remark on the first line
/// the backslash has no meaning; further down it makes the next line a part of the remark, which earns a warning.
pub(crate) fn logical_lines(source: &str, warnings: &mut Vec<Warning>) -> Vec<Text> {
    let mut lines = Vec::new();
    let mut current = Text::default();
    let mut continued = false;
    for (number, line) in physical_lines(source).enumerate() {
        let begins = !std::mem::take(&mut continued);
        for (column, character) in line.chars().enumerate() {
            let place = (number as u32 + 1, column as u32 + 1);
            if character == '\\' {
                let remark = begins && current.is_remark();
                continued = !(remark && number == 0);
                if remark && continued {
                    warnings.push(Warning::new(
                        Span { line: place.0, column: place.1, length: 1 },
                        "the backslash makes the next line a part of this remark, as in XPPAUT",
                    ));
                }
                break;
            }
            current.push(character, place);
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
