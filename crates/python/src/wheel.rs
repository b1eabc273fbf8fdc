//! Wheels: their parameters, and the table of these.

use crate::errors::Failure;
use arclength_analysis::Assignment;
use kingpin::{Key, Tyre, Wheel};
use kingpin_analysis::WheelRequest;
use pyo3::prelude::*;
use pyo3::types::PyDict;
use std::path::PathBuf;

fn wheel(set: Vec<(String, String)>, path: Option<PathBuf>) -> Result<Wheel, Failure> {
    let set = set.into_iter().map(|(key, value)| Assignment { key, value }).collect();
    Ok(WheelRequest { wheel: path, set }.read()?)
}

/// Values of all parameters of the wheel of a file, or the paper's, with those that are set.
#[pyfunction]
pub(crate) fn wheel_parameters(
    py: Python<'_>,
    set: Vec<(String, String)>,
    path: Option<PathBuf>,
) -> PyResult<Bound<'_, PyDict>> {
    let wheel = wheel(set, path)?;
    let values = PyDict::new(py);
    wheel.parameters().try_for_each(|(key, value)| values.set_item(key.name(), value))?;
    values.set_item(Tyre::KEY, wheel.tyre().name())?;
    Ok(values)
}

/// The wheel as the text of a file.
#[pyfunction]
pub(crate) fn wheel_toml(set: Vec<(String, String)>) -> PyResult<String> {
    Ok(wheel(set, None)?.to_toml())
}

/// The table of parameters: key, symbol, unit, meaning, smallest value, largest finite value, whether infinity is allowed, default.
#[pyfunction]
#[allow(clippy::type_complexity)] // one row of a table
pub(crate) fn parameter_table()
-> Vec<(&'static str, &'static str, &'static str, &'static str, f64, f64, bool, f64)> {
    let row = |key: Key| {
        let allowed = key.allowed();
        let ends = (allowed.lowest, allowed.highest, allowed.infinite);
        (key.name(), key.symbol(), key.unit(), key.meaning(), ends.0, ends.1, ends.2, key.default_value())
    };
    Key::ALL.into_iter().map(row).collect()
}
