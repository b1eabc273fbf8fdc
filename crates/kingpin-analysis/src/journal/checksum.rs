//! Checksums (CRC-32) of the lines of a journal: any digit that was changed shows, and so does a line of another journal.

use crc32fast::Hasher;
use std::fmt::Write;

/// Hexadecimal digits of a checksum.
const DIGITS: usize = 8;

/// The checksum of what was read so far.
#[derive(Clone, Debug)]
pub(super) struct Checksum(Hasher);

/// What a line is.
#[derive(Debug, PartialEq)]
pub(super) enum Checked<'a> {
    /// It fits its checksum: this is its content.
    Fits(&'a [u8]),
    /// It does not.
    Differs,
    /// It has none.
    Missing,
}

impl Checksum {
    /// That of nothing.
    pub(super) fn of_nothing() -> Self {
        Self(Hasher::new())
    }

    /// That of what was read so far and a content after it.
    pub(super) fn and(&self, content: &[u8]) -> Self {
        let mut hasher = self.0.clone();
        hasher.update(content);
        Self(hasher)
    }

    /// The line that holds a content after its checksum, which this is.
    pub(super) fn line(&self, content: &str) -> String {
        let mut line = String::with_capacity(content.len() + DIGITS + 2);
        // Writing to memory does not fail.
        let _ = writeln!(line, "{:08x} {content}", self.0.clone().finalize());
        line
    }

    /// Compares a line, without its end, with the checksum that it begins with.
    pub(super) fn check<'a>(&self, line: &'a [u8]) -> Checked<'a> {
        let digits = line.get(..DIGITS).filter(|digits| digits.iter().all(u8::is_ascii_hexdigit));
        let (Some(digits), Some(b' ')) = (digits, line.get(DIGITS)) else { return Checked::Missing };
        let content = &line[DIGITS + 1..];
        let own = format!("{:08x}", self.and(content).0.finalize());
        if own.as_bytes() == digits { Checked::Fits(content) } else { Checked::Differs }
    }
}
