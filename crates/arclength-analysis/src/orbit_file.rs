//! A periodic orbit from a file of samples, such as a time history that was cut to one period.

use crate::error::Error;
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
/// Samples of the orbit that are compared.
const COMPARED: usize = 100;

/// Reads an orbit of a field with these states from comma-separated values.
///
/// The first line has the names of the columns, in any order and without regard to case: `t` and all states; others are ignored. The
/// rows are samples over exactly one period, the last one the first again.
///
/// # Errors
/// [`Error::Unreadable`]; [`Error::OrbitFile`] for a column that is missing, what is no finite number, times that do not grow, fewer
/// than [`Orbit::FEWEST_SAMPLES`] rows, states that do not change, an orbit that does not close, or more than one period.
pub fn read_orbit(path: &Path, states: &[impl AsRef<str>]) -> Result<Orbit, Error> {
    let bytes = std::fs::read(path).map_err(|source| Error::Unreadable { path: path.to_owned(), source })?;
    let failure = |line: u64, column: Option<&str>, problem: String| Error::OrbitFile {
        path: path.to_owned(),
        line,
        column: column.map(str::to_owned),
        problem,
    };
    let unreadable = |error: csv::Error| {
        let line = error.position().map_or(1, csv::Position::line);
        failure(line, None, format!("these are no comma-separated values: {error}"))
    };
    let mut reader = ReaderBuilder::new().trim(Trim::All).flexible(true).from_reader(bytes.as_slice());
    let header = reader.headers().map_err(unreadable)?.clone();
    let names: Vec<&str> = std::iter::once(TIME).chain(states.iter().map(AsRef::as_ref)).collect();
    let places = names.iter().map(|name| {
        column(&header, name).ok_or_else(|| {
            let known: Vec<&str> = header.iter().collect();
            let problem = format!(
                "there is no such column; the columns are: {}; needed are: {}",
                known.join(", "),
                names.join(", ")
            );
            failure(1, Some(name), problem)
        })
    });
    let places: Vec<usize> = places.collect::<Result<_, _>>()?;

    let (mut times, mut samples, mut last) = (Vec::new(), Vec::new(), 1);
    for record in reader.records() {
        let record = record.map_err(unreadable)?;
        last = record.position().map_or(last + 1, csv::Position::line);
        let number = |(name, place): (&&str, &usize)| {
            let text = record.get(*place).unwrap_or_default();
            let number = text.parse().ok().filter(|number: &f64| number.is_finite());
            number.ok_or_else(|| failure(last, Some(name), format!("`{text}` is no finite number")))
        };
        let row: Vec<f64> = names.iter().zip(&places).map(number).collect::<Result<_, _>>()?;
        if let Some(before) = times.last().filter(|before| row[0] <= **before) {
            let (time, before) = (readable(row[0]), readable(*before));
            return Err(failure(last, Some(TIME), format!("{time} does not come after {before}")));
        }
        times.push(row[0]);
        samples.push(row[1..].to_vec());
    }
    if samples.len() < Orbit::FEWEST_SAMPLES {
        let problem = format!(
            "the file ends after {} rows; allowed: at least {}",
            samples.len(),
            Orbit::FEWEST_SAMPLES
        );
        return Err(failure(last, None, problem));
    }
    let sizes = sizes(&samples);
    if sizes.iter().all(|size| *size == 0.0) {
        let problem = "the states are the same in all rows: this is an equilibrium, no cycle".to_owned();
        return Err(failure(last, None, problem));
    }
    let orbit = Orbit::from_samples(&times, &samples).map_err(|error| {
        let [first, end] = [&samples[0], &samples[samples.len() - 1]];
        let gap = |state: usize| (end[state] - first[state]).abs() / sizes[state];
        match (0..sizes.len()).filter(|state| gap(*state) > 0.0).max_by(|a, b| gap(*a).total_cmp(&gap(*b))) {
            Some(state) => {
                let (end, first) = (readable(end[state]), readable(first[state]));
                let problem = format!(
                    "the orbit does not close: {end} in the last row, {first} in the first one; try: cut the file to exactly one \
                     period, so that the last row repeats the first"
                );
                failure(last, Some(names[state + 1]), problem)
            }
            None => error.into(),
        }
    })?;
    match (2..=MOST_PERIODS).rev().find(|periods| repeats(&orbit, *periods, &sizes)) {
        Some(periods) => Err(failure(
            last,
            None,
            format!("the rows reach over {periods} periods; try: cut the file to exactly one period"),
        )),
        None => Ok(orbit),
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

/// Whether an orbit is a shorter one, passed several times.
fn repeats(orbit: &Orbit, periods: usize, sizes: &[f64]) -> bool {
    let shift = orbit.period / periods as f64;
    orbit.sample(COMPARED).into_iter().all(|(time, state)| {
        let later = orbit.state_at(time + shift);
        state
            .iter()
            .zip(&later)
            .zip(sizes)
            .all(|((one, other), size)| (one - other).abs() <= SAME_STATE * size)
    })
}
