//! The programs `arclength` and `kingpin`.

use crate::errors::Failure;
use pyo3::prelude::*;
use std::ffi::OsString;

/// Runs a program with these arguments, of which the first is its name, and gives its exit code.
#[pyfunction]
pub(crate) fn run_program(py: Python<'_>, program: &str, arguments: Vec<OsString>) -> PyResult<u8> {
    let run = match program {
        "arclength" => arclength_cli::run,
        "kingpin" => kingpin_cli::run,
        other => return Err(Failure::bad_request(format!("there is no program `{other}`")).into()),
    };
    Ok(py.detach(|| run(arguments)))
}
