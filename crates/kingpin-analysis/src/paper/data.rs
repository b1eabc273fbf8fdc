//! The data behind a figure, written as CSV.

/// A table whose columns have a name and a unit.
pub(super) struct Data {
    columns: Vec<(&'static str, &'static str)>,
    rows: Vec<Vec<Cell>>,
}

/// An entry of a table.
pub(super) enum Cell {
    /// A number; infinity is written `inf`.
    Number(f64),
    /// A word.
    Word(&'static str),
    /// Nothing to be said.
    Empty,
}

impl From<f64> for Cell {
    fn from(number: f64) -> Self {
        Self::Number(number)
    }
}

impl From<&'static str> for Cell {
    fn from(word: &'static str) -> Self {
        Self::Word(word)
    }
}

impl<T: Into<Cell>> From<Option<T>> for Cell {
    fn from(entry: Option<T>) -> Self {
        entry.map_or(Self::Empty, Into::into)
    }
}

impl Data {
    /// A table of columns `(name, unit)` without rows; an empty unit stands for a column of words.
    pub(super) fn new(columns: &[(&'static str, &'static str)]) -> Self {
        Self { columns: columns.to_vec(), rows: Vec::new() }
    }

    pub(super) fn push<const COLUMNS: usize>(&mut self, row: [Cell; COLUMNS]) {
        debug_assert_eq!(COLUMNS, self.columns.len());
        self.rows.push(row.into());
    }

    /// One line with names and units, then a line for each row. Numbers keep all their digits.
    pub(super) fn to_csv(&self) -> String {
        let heading = self.columns.iter().map(|(name, unit)| match *unit {
            "" => (*name).to_owned(),
            unit => format!("{name} [{unit}]"),
        });
        let mut text = heading.collect::<Vec<_>>().join(",");
        text.push('\n');
        for row in &self.rows {
            let cells: Vec<String> = row.iter().map(Cell::to_text).collect();
            text.push_str(&cells.join(","));
            text.push('\n');
        }
        text
    }
}

impl Cell {
    fn to_text(&self) -> String {
        match *self {
            Self::Number(number) if number == 0.0 || (1e-4..1e15).contains(&number.abs()) => {
                number.to_string()
            }
            Self::Number(number) if number.is_infinite() => number.to_string(),
            Self::Number(number) => format!("{number:e}"),
            Self::Word(word) => word.to_owned(),
            Self::Empty => String::new(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_keep_their_digits_and_columns_their_units() {
        let mut data = Data::new(&[("r", "m"), ("u0", "m"), ("stability", "")]);
        data.push([f64::INFINITY.into(), 3e-17.into(), "stable".into()]);
        data.push([(0.1 + 0.2).into(), 0.0.into(), Cell::Empty]);
        assert_eq!(data.to_csv(), "r [m],u0 [m],stability\ninf,3e-17,stable\n0.30000000000000004,0,\n");
    }
}
