//! The story of a run: what it started from, what it met, why it ended, how exact it is, line by line.

use crate::table::Table;
use std::io::{self, Write};

/// The story of a run in lines. Neighbouring lines about one subject stand under one heading.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Story {
    lines: Vec<(&'static str, String)>,
}

impl Story {
    /// A story without lines.
    pub fn new() -> Self {
        Self::default()
    }

    /// Adds a line about a subject.
    pub fn tell(&mut self, subject: &'static str, text: impl Into<String>) {
        self.lines.push((subject, text.into()));
    }

    /// Writes the story as it stands under a table.
    ///
    /// # Errors
    /// Those of the writer.
    pub fn write(&self, out: &mut dyn Write) -> io::Result<()> {
        writeln!(out, "\nstory of the run")?;
        let mut table = Table::new(["", ""]);
        let mut before = "";
        for (subject, text) in &self.lines {
            let heading = if *subject == before { "" } else { subject };
            before = subject;
            table.row([format!("  {heading}").into(), text.as_str().into()]);
        }
        table.write(out)
    }
}
