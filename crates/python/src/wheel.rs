//! Wheels: their parameters, and the table of these.

use crate::errors::Failure;
use crate::pool;
use arclength_analysis::Assignment;
use kingpin::{Key, KingpinError, Tyre, Wheel};
use kingpin_analysis::WheelRequest;
use numpy::{IntoPyArray, PyArray1, PyReadonlyArray1};
use pyo3::prelude::*;
use pyo3::types::PyDict;
use rayon::prelude::*;
use std::path::PathBuf;

/// Points that a thread takes at a time, at least.
const POINTS_PER_TASK: usize = 1024;

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

/// What a chart says at many points at once: each column has the values of the parameter with that key. The answer is the growth rate
/// (not a number without uniform motion), whether it is stable (not a number where rounding could decide), and whether it rolls.
#[pyfunction]
#[allow(clippy::type_complexity)] // three columns
pub(crate) fn stability_at<'py>(
    py: Python<'py>,
    set: Vec<(String, String)>,
    keys: Vec<String>,
    columns: Vec<PyReadonlyArray1<'py, f64>>,
    threads: usize,
) -> PyResult<(Bound<'py, PyArray1<f64>>, Bound<'py, PyArray1<f64>>, Bound<'py, PyArray1<f64>>)> {
    let wheel = wheel(set, None)?;
    let keys =
        keys.iter().map(|key| key.parse::<Key>()).collect::<Result<Vec<_>, _>>().map_err(Failure::from)?;
    let columns: Vec<&[f64]> = columns.iter().map(|column| column.as_slice()).collect::<Result<_, _>>()?;
    let pool = pool::of(threads)?;
    let rows = columns.first().map_or(0, |column| column.len());
    let evaluated: Result<Vec<[f64; 3]>, KingpinError> = py.detach(|| {
        let row = |row: usize| {
            let at = keys
                .iter()
                .zip(&columns)
                .try_fold(wheel, |wheel, (key, column)| wheel.with(*key, column[row]))?;
            match at.uniform_motion() {
                Ok(motion) => {
                    let stable = motion.is_stable().map_or(f64::NAN, f64::from);
                    Ok([motion.growth_rate(), stable, f64::from(motion.rolls())])
                }
                Err(KingpinError::NoUniformMotion { .. }) => Ok([f64::NAN, 0.0, 0.0]),
                Err(error) => Err(error),
            }
        };
        pool.install(|| (0..rows).into_par_iter().with_min_len(POINTS_PER_TASK).map(row).collect())
    });
    let evaluated = evaluated.map_err(Failure::from)?;
    let column = |index: usize| evaluated.iter().map(|row| row[index]).collect::<Vec<_>>().into_pyarray(py);
    Ok((column(0), column(1), column(2)))
}
