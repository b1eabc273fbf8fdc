//! Tables of text for people: columns aligned, numbers to the right.

use crate::numbers::{readable, significant};
use std::io::{self, Write};

/// Space between columns.
const GAP: usize = 2;

/// A cell of a table.
#[derive(Clone, Debug, PartialEq)]
pub enum Cell {
    /// A number, shown with eight significant digits.
    Number(f64),
    /// A number with as many significant digits as given.
    Digits(f64, usize),
    /// Words.
    Text(String),
    /// Nothing: a dash.
    Nothing,
}

impl From<f64> for Cell {
    fn from(number: f64) -> Self {
        if number.is_nan() { Self::Nothing } else { Self::Number(number) }
    }
}

impl From<&str> for Cell {
    fn from(text: &str) -> Self {
        Self::Text(text.to_owned())
    }
}

impl From<String> for Cell {
    fn from(text: String) -> Self {
        Self::Text(text)
    }
}

impl<T: Into<Cell>> From<Option<T>> for Cell {
    fn from(entry: Option<T>) -> Self {
        entry.map_or(Self::Nothing, Into::into)
    }
}

impl Cell {
    fn text(&self) -> String {
        match self {
            Self::Number(number) => readable(*number),
            Self::Digits(number, digits) => significant(*number, *digits),
            Self::Text(text) => text.clone(),
            Self::Nothing => "-".to_owned(),
        }
    }
}

/// Rows of cells under a line of headings; a heading may be empty.
#[derive(Clone, Debug, PartialEq)]
pub struct Table {
    headings: Vec<String>,
    rows: Vec<Vec<Cell>>,
}

impl Table {
    /// A table without rows.
    pub fn new<T: Into<String>>(headings: impl IntoIterator<Item = T>) -> Self {
        Self { headings: headings.into_iter().map(Into::into).collect(), rows: Vec::new() }
    }

    /// Adds a row.
    pub fn row(&mut self, cells: impl IntoIterator<Item = Cell>) {
        self.rows.push(cells.into_iter().collect());
    }

    /// Writes the table; the line of headings is left out where all are empty.
    ///
    /// # Errors
    /// Those of the writer.
    pub fn write(&self, out: &mut dyn Write) -> io::Result<()> {
        let texts: Vec<Vec<String>> =
            self.rows.iter().map(|row| row.iter().map(Cell::text).collect()).collect();
        let columns = self.headings.len();
        let width = |column: usize| {
            let cells = texts.iter().filter_map(|row| row.get(column));
            cells.chain(self.headings.get(column)).map(|text| text.chars().count()).max().unwrap_or(0)
        };
        let widths: Vec<usize> = (0..columns).map(width).collect();
        // A column of words starts at the left, a column in which there is a number ends at the right.
        let to_the_right: Vec<bool> = (0..columns)
            .map(|column| {
                self.rows
                    .iter()
                    .any(|row| matches!(row.get(column), Some(Cell::Number(_) | Cell::Digits(..))))
            })
            .collect();
        let mut line = |cells: &[String]| {
            let mut text = String::new();
            for (column, cell) in cells.iter().take(columns).enumerate() {
                let padding = " ".repeat(widths[column].saturating_sub(cell.chars().count()));
                let gap = if column > 0 { " ".repeat(GAP) } else { String::new() };
                text += &gap;
                if to_the_right[column] {
                    text = text + &padding + cell;
                } else {
                    text = text + cell + &padding;
                }
            }
            writeln!(out, "{}", text.trim_end())
        };
        if self.headings.iter().any(|heading| !heading.is_empty()) {
            line(&self.headings)?;
        }
        texts.iter().try_for_each(|row| line(row))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_to_the_right_words_to_the_left() {
        let mut table = Table::new(["label", "v (m/s)", ""]);
        table.row(["HB1".into(), 8.25.into(), "subcritical".into()]);
        table.row([Cell::Nothing, 10.0.into(), Cell::Nothing]);
        let mut text = Vec::new();
        table.write(&mut text).unwrap();
        assert_eq!(
            String::from_utf8(text).unwrap(),
            "label  v (m/s)\nHB1       8.25  subcritical\n-           10  -\n"
        );
    }
}
