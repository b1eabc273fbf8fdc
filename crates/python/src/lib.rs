//! The native module of the Python package `arclength`.
//!
//! It does four things: runs an analysis whose request comes as JSON (`run`), shows a result as JSON, columns, tables, pictures and files
//! (`result`), tells what models and wheels are (`model`, `wheel`), and is the two programs (`programs`). What Python people see of that
//! is in `python/arclength`. Requests and results are those of the analyses, so that names, defaults and numbers are those of the
//! programs.

mod analyses;
mod arrow;
mod errors;
mod model;
mod pool;
mod programs;
mod result;
mod run;
mod stored;
mod waiting;
mod wheel;

use pyo3::prelude::*;

/// What the package is made of; not for use from outside of it.
#[pymodule]
mod _native {
    #[pymodule_export]
    use super::analyses::complete_request;
    #[pymodule_export]
    use super::model::{NativeModel, build_model};
    #[pymodule_export]
    use super::programs::run_program;
    #[pymodule_export]
    use super::result::{NativeResult, read_result};
    #[pymodule_export]
    use super::run::run_analysis;
    #[pymodule_export]
    use super::wheel::{parameter_table, stability_at, wheel_parameters, wheel_toml};
    use pyo3::prelude::*;

    #[pymodule_init]
    fn init(module: &Bound<'_, PyModule>) -> PyResult<()> {
        module.add("__version__", env!("CARGO_PKG_VERSION"))
    }
}
