//! A periodic orbit from a file of samples, such as a time history that was cut to one period.

use crate::error::Error;
use crate::files::{Disk, Files};
use arclength::cycle::Orbit;
use csv::{ReaderBuilder, StringRecord, Trim};
use kingpin_report::numbers::readable;
use std::path::Path;

/// Name of the column of the times.
const TIME: &str = "t";
/// Most periods that a file is searched for.
const MOST_PERIODS: usize = 6;
/// Agreement of two states, relative to the size of the orbit, from which on they are the same.
const SAME_STATE: f64 = 1e-4;

/// Reads an orbit of a field with these states from comma-separated values.
///
/// The first line has the names of the columns, in any order and without regard to case: `t` and all states; others are ignored. The
/// rows are samples over exactly one period, the last one the first again.
///
/// # Errors
/// [`Error::Unreadable`]; [`Error::OrbitFile`] for a column that is missing, what is no finite number, times that do not grow, fewer
/// than [`Orbit::FEWEST_SAMPLES`] rows, states that do not change, an orbit that does not close, or more than one period.
pub fn read_orbit(path: &Path, states: &[impl AsRef<str>]) -> Result<Orbit, Error> {
    read_orbit_among(&Disk, path, states)
}

/// The same from other files than those of this machine.
pub(crate) fn read_orbit_among(
    files: &dyn Files,
    path: &Path,
    states: &[impl AsRef<str>],
) -> Result<Orbit, Error> {
    let bytes = files.read(path).map_err(|source| Error::Unreadable { path: path.to_owned(), source })?;
    let names = std::iter::once(TIME).chain(states.iter().map(AsRef::as_ref)).collect();
    let file = File { path, names };
    file.orbit(&file.rows(&bytes)?)
}

/// A file with the names of the columns that are needed of it: the time and the states.
struct File<'a> {
    path: &'a Path,
    names: Vec<&'a str>,
}

/// The rows of a file.
struct Rows {
    times: Vec<f64>,
    samples: Vec<Vec<f64>>,
    /// Line of the last one.
    last: u64,
}

impl File<'_> {
    fn failure(&self, line: u64, column: Option<&str>, problem: String) -> Error {
        Error::OrbitFile { path: self.path.to_owned(), line, column: column.map(str::to_owned), problem }
    }

    fn rows(&self, bytes: &[u8]) -> Result<Rows, Error> {
        let unreadable = |error: csv::Error| {
            let line = error.position().map_or(1, csv::Position::line);
            self.failure(line, None, format!("these are no comma-separated values: {error}"))
        };
        let mut reader = ReaderBuilder::new().trim(Trim::All).flexible(true).from_reader(bytes);
        let places = self.columns(reader.headers().map_err(unreadable)?)?;
        let mut rows = Rows { times: Vec::new(), samples: Vec::new(), last: 1 };
        for record in reader.records() {
            let record = record.map_err(unreadable)?;
            let line = record.position().map_or(rows.last + 1, csv::Position::line);
            let number = |(name, place): (&&str, &usize)| {
                let text = record.get(*place).unwrap_or_default();
                let number = text.parse().ok().filter(|number: &f64| number.is_finite());
                number.ok_or_else(|| self.failure(line, Some(name), format!("`{text}` is no finite number")))
            };
            let mut row: Vec<f64> = self.names.iter().zip(&places).map(number).collect::<Result<_, _>>()?;
            let time = row.remove(0);
            if let Some(before) = rows.times.last().filter(|before| time <= **before) {
                let problem = format!("{} does not come after {}", readable(time), readable(*before));
                return Err(self.failure(line, Some(TIME), problem));
            }
            rows.times.push(time);
            rows.samples.push(row);
            rows.last = line;
        }
        Ok(rows)
    }

    /// The places of the columns that are needed.
    fn columns(&self, header: &StringRecord) -> Result<Vec<usize>, Error> {
        let place = |name: &&str| {
            column(header, name).ok_or_else(|| {
                let known: Vec<&str> = header.iter().collect();
                let problem = format!(
                    "there is no such column; the columns are: {}; needed are: {}",
                    known.join(", "),
                    self.names.join(", ")
                );
                self.failure(1, Some(name), problem)
            })
        };
        self.names.iter().map(place).collect()
    }

    fn orbit(&self, Rows { times, samples, last }: &Rows) -> Result<Orbit, Error> {
        if samples.len() < Orbit::FEWEST_SAMPLES {
            let (count, fewest) = (samples.len(), Orbit::FEWEST_SAMPLES);
            let problem = format!("the file ends after {count} rows; allowed: at least {fewest}");
            return Err(self.failure(*last, None, problem));
        }
        let sizes = sizes(samples);
        if sizes.iter().all(|size| *size == 0.0) {
            let problem = "the states are the same in all rows: this is an equilibrium, no cycle".to_owned();
            return Err(self.failure(*last, None, problem));
        }
        let orbit = Orbit::from_samples(times, samples).map_err(|error| {
            let [first, end] = [&samples[0], &samples[samples.len() - 1]];
            let gap = |state: usize| (end[state] - first[state]).abs() / sizes[state];
            let open = (0..sizes.len()).filter(|state| gap(*state) > 0.0);
            match open.max_by(|one, other| gap(*one).total_cmp(&gap(*other))) {
                Some(state) => {
                    let (end, first) = (readable(end[state]), readable(first[state]));
                    let problem = format!(
                        "the orbit does not close: {end} in the last row, {first} in the first one; try: cut the file to \
                         exactly one period, so that the last row repeats the first"
                    );
                    self.failure(*last, Some(self.names[state + 1]), problem)
                }
                None => error.into(),
            }
        })?;
        match (2..=MOST_PERIODS).rev().find(|periods| orbit.repeats(*periods, SAME_STATE)) {
            Some(periods) => {
                let problem =
                    format!("the rows reach over {periods} periods; try: cut the file to exactly one period");
                Err(self.failure(*last, None, problem))
            }
            None => Ok(orbit),
        }
    }
}

/// The place of a column: the one with that very name, or else the one that differs from it in case.
fn column(header: &StringRecord, name: &str) -> Option<usize> {
    let place = header.iter().position(|known| known == name);
    place.or_else(|| header.iter().position(|known| known.eq_ignore_ascii_case(name)))
}

/// How far every state reaches.
fn sizes(samples: &[Vec<f64>]) -> Vec<f64> {
    let size = |state: usize| {
        let values = samples.iter().map(|sample| sample[state]);
        let (low, high) = values
            .fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), value| (low.min(value), high.max(value)));
        high - low
    };
    (0..samples[0].len()).map(size).collect()
}
