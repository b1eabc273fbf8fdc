//! Which wheel an analysis is asked for: a part of every request.

use crate::error::Error;
use arclength_analysis::Assignment;
use kingpin::Wheel;
use serde::{Deserialize, Serialize};
use std::path::PathBuf;

/// Which wheel: that of a file, or the paper's, with the parameters that are set.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct WheelRequest {
    /// File of `key = value` lines; the paper's wheel where there is none.
    pub wheel: Option<PathBuf>,
    /// Parameters that are set; they win over the file.
    pub set: Vec<Assignment>,
}

impl WheelRequest {
    /// The wheel of the file, or the paper's, with the parameters that are set.
    ///
    /// # Errors
    /// What is wrong with the file or a parameter.
    pub fn read(&self) -> Result<Wheel, Error> {
        let wheel = self.wheel.as_ref().map_or(Ok(Wheel::default()), Wheel::read)?;
        self.change(wheel)
    }

    /// A wheel with the parameters that are set.
    ///
    /// # Errors
    /// What is wrong with a parameter.
    pub fn change(&self, mut wheel: Wheel) -> Result<Wheel, Error> {
        for Assignment { key, value } in &self.set {
            wheel.set(key, value).map_err(|source| Error::Set {
                field: "set",
                given: format!("{key}={value}"),
                source: Box::new(source),
            })?;
        }
        wheel.check()?;
        Ok(wheel)
    }
}
