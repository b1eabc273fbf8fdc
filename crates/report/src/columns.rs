//! Results as named columns with units, each of one type, for CSV and Parquet.

use crate::named_numbers::NamedNumbers;
use std::io::{self, Write};

/// A named column.
#[derive(Clone, Debug, PartialEq)]
pub struct Column {
    /// Its name.
    pub name: String,
    /// The unit of its numbers, where they have one.
    pub unit: Option<String>,
    /// Its entries.
    pub entries: Entries,
}

/// The entries of a column; `None` where there is no value. Not a number counts as no value.
#[derive(Clone, Debug, PartialEq)]
pub enum Entries {
    /// Numbers in SI units.
    Numbers(Vec<Option<f64>>),
    /// Counts.
    Counts(Vec<u64>),
    /// Yes or no.
    Booleans(Vec<Option<bool>>),
    /// Words.
    Texts(Vec<Option<String>>),
}

impl Entries {
    fn len(&self) -> usize {
        match self {
            Self::Numbers(entries) => entries.len(),
            Self::Counts(entries) => entries.len(),
            Self::Booleans(entries) => entries.len(),
            Self::Texts(entries) => entries.len(),
        }
    }

    /// Adds entries of the same type; whether they were.
    fn append(&mut self, more: Self) -> bool {
        match (self, more) {
            (Self::Numbers(entries), Self::Numbers(more)) => entries.extend(more),
            (Self::Counts(entries), Self::Counts(more)) => entries.extend(more),
            (Self::Booleans(entries), Self::Booleans(more)) => entries.extend(more),
            (Self::Texts(entries), Self::Texts(more)) => entries.extend(more),
            _ => return false,
        }
        true
    }

    fn write_entry(&self, row: usize, out: &mut dyn Write) -> io::Result<()> {
        match self {
            Self::Numbers(entries) => match entries[row] {
                // The shortest text that is read back as the same number.
                Some(number) => write!(out, "{number:?}"),
                None => Ok(()),
            },
            Self::Counts(entries) => write!(out, "{}", entries[row]),
            Self::Booleans(entries) => entries[row].map_or(Ok(()), |value| write!(out, "{value}")),
            Self::Texts(entries) => entries[row].as_ref().map_or(Ok(()), |text| write_quoted(text, out)),
        }
    }
}

/// Named columns of equal length.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Columns {
    columns: Vec<Column>,
}

impl Columns {
    /// No columns.
    pub fn new() -> Self {
        Self::default()
    }

    /// Adds a column of numbers.
    pub fn numbers(self, name: impl Into<String>, entries: impl IntoIterator<Item = f64>) -> Self {
        self.optional_numbers(name, entries.into_iter().map(Some))
    }

    /// Adds a column of numbers of which some are absent.
    pub fn optional_numbers(
        self,
        name: impl Into<String>,
        entries: impl IntoIterator<Item = Option<f64>>,
    ) -> Self {
        let mut entries = entries.into_iter();
        let numbers = collected(&mut || Some(entries.next()?.filter(|number| !number.is_nan())));
        self.add(name.into(), Entries::Numbers(numbers))
    }

    /// Adds two columns for each of the first `count` complex numbers of every row, `NAME_1_real` and `NAME_1_imaginary` onwards.
    pub fn complex_numbers<'a>(
        mut self,
        name: &str,
        count: usize,
        rows: impl Iterator<Item = &'a Vec<[Option<f64>; 2]>> + Clone,
    ) -> Self {
        for index in 0..count {
            for (part, suffix) in ["real", "imaginary"].into_iter().enumerate() {
                let entries = rows.clone().map(|row| row.get(index).and_then(|pair| pair[part]));
                self = self.optional_numbers(format!("{name}_{}_{suffix}", index + 1), entries);
            }
        }
        self
    }

    /// Adds a column `PREFIX_NAME` for every name that any of the rows has, in their order.
    pub fn named_numbers<'a>(
        mut self,
        prefix: &str,
        rows: impl Iterator<Item = &'a NamedNumbers> + Clone,
    ) -> Self {
        let mut names: Vec<&str> = Vec::new();
        for (name, _) in rows.clone().flat_map(|row| &row.0) {
            if !names.contains(&name.as_str()) {
                names.push(name);
            }
        }
        for name in names {
            self = self.optional_numbers(format!("{prefix}_{name}"), rows.clone().map(|row| row.named(name)));
        }
        self
    }

    /// Adds a column of counts.
    pub fn counts(self, name: impl Into<String>, entries: impl IntoIterator<Item = u64>) -> Self {
        let mut entries = entries.into_iter();
        self.add(name.into(), Entries::Counts(collected(&mut || entries.next())))
    }

    /// Adds a column of yes and no; `None` where neither can be said.
    pub fn booleans<B: Into<Option<bool>>>(
        self,
        name: impl Into<String>,
        entries: impl IntoIterator<Item = B>,
    ) -> Self {
        let mut entries = entries.into_iter();
        self.add(name.into(), Entries::Booleans(collected(&mut || entries.next().map(Into::into))))
    }

    /// Adds a column of words.
    pub fn texts(self, name: impl Into<String>, entries: impl IntoIterator<Item = Option<String>>) -> Self {
        let mut entries = entries.into_iter();
        self.add(name.into(), Entries::Texts(collected(&mut || entries.next())))
    }

    /// Adds a column.
    pub(crate) fn add(mut self, name: String, entries: Entries) -> Self {
        self.columns.push(Column { name, unit: None, entries });
        self
    }

    /// Gives the column that was added last its unit, where there is one other than `1`.
    pub fn unit<'a>(mut self, unit: impl Into<Option<&'a str>>) -> Self {
        if let Some(last) = self.columns.last_mut() {
            last.unit = unit.into().filter(|unit| *unit != "1").map(str::to_owned);
        }
        self
    }

    /// The entries of the column with this name.
    pub fn named(&self, name: &str) -> Option<&Entries> {
        self.iter().find(|column| column.name == name).map(|column| &column.entries)
    }

    /// Adds rows with the same columns; whether they were the same.
    pub(crate) fn append(&mut self, rows: Self) -> bool {
        self.columns.len() == rows.columns.len()
            && self
                .columns
                .iter_mut()
                .zip(rows.columns)
                .all(|(column, rows)| column.name == rows.name && column.entries.append(rows.entries))
    }

    /// The columns.
    pub fn iter(&self) -> impl Iterator<Item = &Column> {
        self.columns.iter()
    }

    /// The units of the columns that have one, by name.
    pub fn units(&self) -> impl Iterator<Item = (&str, &str)> {
        self.iter().filter_map(|column| Some((column.name.as_str(), column.unit.as_deref()?)))
    }

    /// Number of rows: that of the shortest column.
    pub fn rows(&self) -> usize {
        self.iter().map(|column| column.entries.len()).min().unwrap_or(0)
    }

    /// Writes the columns as CSV with a line of names (RFC 4180, but with line feeds).
    ///
    /// # Errors
    /// Those of the writer.
    pub fn write_csv(&self, out: &mut dyn Write) -> io::Result<()> {
        for (index, column) in self.iter().enumerate() {
            write_separator(index, out)?;
            write_quoted(&column.name, out)?;
        }
        writeln!(out)?;
        for row in 0..self.rows() {
            for (index, column) in self.iter().enumerate() {
                write_separator(index, out)?;
                column.entries.write_entry(row, out)?;
            }
            writeln!(out)?;
        }
        Ok(())
    }
}

/// All entries of a column. They come through a pointer: there are hundreds of columns, each with an iterator of its own type, and
/// to collect it would be compiled anew for each of them.
fn collected<T>(next: &mut dyn FnMut() -> Option<T>) -> Vec<T> {
    std::iter::from_fn(next).collect()
}

fn write_separator(index: usize, out: &mut dyn Write) -> io::Result<()> {
    if index > 0 { out.write_all(b",") } else { Ok(()) }
}

fn write_quoted(text: &str, out: &mut dyn Write) -> io::Result<()> {
    if text.contains([',', '"', '\n', '\r']) {
        write!(out, "\"{}\"", text.replace('"', "\"\""))
    } else {
        out.write_all(text.as_bytes())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn csv_of_every_type() {
        let columns = Columns::new()
            .numbers("x", [0.1, f64::NAN])
            .unit("m/s")
            .booleans("stable", [Some(true), None])
            .counts("branch", [1, 2])
            .texts("label", [Some("a,\"b\"".to_owned()), None]);
        let mut text = Vec::new();
        columns.write_csv(&mut text).unwrap();
        assert_eq!(
            String::from_utf8(text).unwrap(),
            "x,stable,branch,label\n0.1,true,1,\"a,\"\"b\"\"\"\n,,2,\n"
        );
        assert_eq!(columns.units().collect::<Vec<_>>(), [("x", "m/s")]);
    }
}
