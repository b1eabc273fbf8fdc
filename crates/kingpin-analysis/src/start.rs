//! Points of earlier results of `hopf` and `cycles`, from which cycles can start.

use crate::error::Error;
use arclength::cycle::{Branching, Orbit};
use arclength_analysis::PointReference;
use kingpin_report::{NamedNumbers, Number, Schema};
use serde::Deserialize;
use std::path::Path;

/// What is read of a result file.
#[derive(Debug, Deserialize)]
struct ResultFile {
    schema: Schema,
    parameters: NamedNumbers,
    along: StoredParameter,
    points: Vec<StoredPoint>,
}

#[derive(Debug, Deserialize)]
struct StoredParameter {
    key: String,
}

#[derive(Debug, Deserialize)]
struct StoredPoint {
    value: Number,
    label: Option<String>,
    orbit: Option<Orbit>,
    branching: Option<Branching>,
}

/// A labelled point: all parameters, and the cycle where it is one.
#[derive(Clone, Debug, PartialEq)]
pub struct LabelledPoint {
    /// Every parameter of the model there.
    pub parameters: Vec<(String, f64)>,
    /// The cycle, where it is one.
    pub orbit: Option<Orbit>,
    /// The branch that leaves there, and the parameter along which it was found.
    pub branching: Option<(Branching, String)>,
}

impl LabelledPoint {
    /// Reads the point from its file.
    ///
    /// # Errors
    /// [`Error::Start`]: no such file, not a result of one of the commands, no such label.
    pub fn read(reference: &PointReference, schemas: &[&str]) -> Result<Self, Error> {
        let mut file = read_file(&reference.path, schemas).map_err(|problem| reference.failure(problem))?;
        let labels: Vec<String> = file.points.iter().filter_map(|point| point.label.clone()).collect();
        let place = file.points.iter().position(|point| point.label.as_ref() == Some(&reference.label));
        let Some(place) = place else {
            return Err(reference.no_such_label(&labels).into());
        };
        let point = file.points.swap_remove(place);
        let mut parameters = file.parameters.0;
        let branching = point.branching.map(|branching| (branching, file.along.key.clone()));
        parameters.push((file.along.key, point.value.0));
        Ok(Self { parameters, orbit: point.orbit, branching })
    }
}

fn read_file(path: &Path, schemas: &[&str]) -> Result<ResultFile, String> {
    let text = std::fs::read(path).map_err(|error| format!("cannot be read: {error}"))?;
    let allowed = format!("allowed: a file that --out FILE.json of {} wrote", schemas.join(" or "));
    let file: ResultFile = serde_json::from_slice(&text)
        .map_err(|error| format!("not such a result file: {error}; {allowed}"))?;
    if file.schema.version != 1 || !schemas.contains(&file.schema.name.as_str()) {
        return Err(format!("it is a {} of version {}; {allowed}", file.schema.name, file.schema.version));
    }
    Ok(file)
}
