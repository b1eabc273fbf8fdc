//! A result in Python: its file, its columns as arrays, its table, its picture.

use crate::analyses::Finished;
use crate::arrow;
use crate::errors::Failure;
use crate::stored::Stored;
use crate::waiting::{GRACE, UNTIL_GONE, unless_interrupted};
use arclength_analysis::ResultFile;
use kingpin_report::{Columns, Entries, Schema};
use numpy::IntoPyArray;
use pyo3::prelude::*;
use pyo3::types::{PyBytes, PyCapsule, PyDict, PyList};
use serde::Deserialize;
use std::path::{Path, PathBuf};
use std::sync::{Arc, OnceLock};

/// Entries of a list that are made between two looks at signals.
const LISTED: usize = 1 << 16;

/// A result of an analysis.
#[pyclass(frozen, module = "arclength._native")]
pub(crate) struct NativeResult {
    stored: Arc<dyn Stored>,
    /// Computed when they are first asked for.
    columns: OnceLock<Columns>,
    /// What is worth knowing of it.
    #[pyo3(get)]
    warnings: Vec<String>,
    /// Whether it was stopped before its end.
    #[pyo3(get)]
    interrupted: bool,
}

impl NativeResult {
    pub(crate) fn new(Finished { result, warnings }: Finished, interrupted: bool) -> Self {
        Self { stored: result.into(), columns: OnceLock::new(), warnings, interrupted }
    }

    fn columns(&self) -> &Columns {
        self.columns.get_or_init(|| self.stored.columns())
    }
}

/// Entries as a list; Ctrl-C stops that.
fn list<'py, T: Clone + IntoPyObject<'py>>(py: Python<'py>, entries: &[T]) -> PyResult<Bound<'py, PyList>> {
    let all = PyList::empty(py);
    for some in entries.chunks(LISTED) {
        py.check_signals()?;
        some.iter().try_for_each(|entry| all.append(entry.clone()))?;
    }
    Ok(all)
}

fn text(bytes: Vec<u8>) -> Result<String, Failure> {
    String::from_utf8(bytes).map_err(|error| Failure::internal(error.to_string()))
}

#[pymethods]
impl NativeResult {
    /// Name of its form in JSON.
    #[getter]
    fn schema(&self) -> String {
        self.stored.schema().name
    }

    /// The text of its file.
    fn json<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyBytes>> {
        let stored = Arc::clone(&self.stored);
        let text = unless_interrupted(py, GRACE, move |stop| stored.json(stop))?;
        Ok(PyBytes::new(py, &text))
    }

    /// Its table for people.
    fn table(&self) -> PyResult<String> {
        Ok(text(self.stored.table().map_err(Failure::from)?)?)
    }

    /// The story of the run, if there is one.
    fn story(&self) -> PyResult<Option<String>> {
        Ok(self.stored.story().map_err(Failure::from)?.map(text).transpose()?)
    }

    /// Its picture as SVG, if it has one.
    fn svg(&self, py: Python<'_>) -> PyResult<Option<String>> {
        let stored = Arc::clone(&self.stored);
        unless_interrupted(py, GRACE, move |_| stored.svg())
    }

    /// Writes it to a file of the format that the ending says.
    fn write(&self, py: Python<'_>, path: PathBuf) -> PyResult<()> {
        let stored = Arc::clone(&self.stored);
        unless_interrupted(py, UNTIL_GONE, move |stop| stored.write(&path, stop))
    }

    /// Names of its columns.
    fn column_names(&self) -> Vec<String> {
        self.columns().iter().map(|column| column.name.clone()).collect()
    }

    /// Units of the columns that have one.
    fn units<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let units = PyDict::new(py);
        self.columns().units().try_for_each(|(name, unit)| units.set_item(name, unit))?;
        Ok(units)
    }

    /// A column: an array of numbers, not a number where there is none; or a list of words, of yes and no, `None` where there is none.
    fn column<'py>(&self, py: Python<'py>, name: &str) -> PyResult<Option<Bound<'py, PyAny>>> {
        let Some(column) = self.columns().iter().find(|column| column.name == name) else { return Ok(None) };
        let entries = match &column.entries {
            Entries::Numbers(entries) => {
                let numbers: Vec<f64> = entries.iter().map(|entry| entry.unwrap_or(f64::NAN)).collect();
                numbers.into_pyarray(py).into_any()
            }
            Entries::Counts(entries) => entries.clone().into_pyarray(py).into_any(),
            Entries::Booleans(entries) => list(py, entries)?.into_any(),
            Entries::Texts(entries) => list(py, entries)?.into_any(),
        };
        Ok(Some(entries))
    }

    /// Its columns as a stream of Arrow's C interface.
    fn stream<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyCapsule>> {
        arrow::stream(py, self.columns())
    }
}

/// A result that was written to a file.
#[pyfunction]
pub(crate) fn read_result(py: Python<'_>, path: PathBuf) -> PyResult<NativeResult> {
    let wrong = |problem: String| Failure::bad_request(format!("{}: {problem}", path.display()));
    let read = || -> Result<Finished, Failure> {
        let result: Box<dyn Stored> = if is_of_a_wheel(&path) {
            use kingpin_analysis::ResultFile;
            match ResultFile::read(&path).map_err(wrong)? {
                ResultFile::Hopf(result) => Box::new(result),
                ResultFile::Cycles(result) => Box::new(result),
                ResultFile::MotionLocus(result) => Box::new(result),
                ResultFile::CycleLocus(result) => Box::new(result),
            }
        } else {
            match ResultFile::read(&path).map_err(wrong)? {
                ResultFile::Equilibria(result) => Box::new(result),
                ResultFile::Cycles(result) => Box::new(result),
                ResultFile::Locus(result) => Box::new(result),
                ResultFile::CycleLocus(result) => Box::new(result),
                ResultFile::History(result) => Box::new(result),
            }
        };
        Ok(Finished { result, warnings: Vec::new() })
    };
    Ok(NativeResult::new(py.detach(read)?, false))
}

/// Whether a file says of itself that it is a result of a wheel.
fn is_of_a_wheel(path: &Path) -> bool {
    #[derive(Deserialize)]
    struct Header {
        schema: Schema,
    }
    let header = std::fs::read(path).ok().and_then(|text| serde_json::from_slice::<Header>(&text).ok());
    header.is_some_and(|header| header.schema.name.starts_with("kingpin."))
}
