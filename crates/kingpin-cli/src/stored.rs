//! Points of earlier results from which a computation can start, `FILE:LABEL`.

use crate::document::{NamedNumbers, Number, Schema};
use crate::failure::Failure;
use arclength::cycle::{Branching, Orbit};
use serde::Deserialize;
use std::path::{Path, PathBuf};
use std::str::FromStr;

/// A labelled point of a result file, as it is written in an option.
///
/// ```
/// use kingpin_cli::stored::PointReference;
/// let reference: PointReference = "runs/cycles.json:LPC1".parse()?;
/// assert_eq!((reference.path.to_str(), reference.label.as_str()), (Some("runs/cycles.json"), "LPC1"));
/// # Ok::<(), String>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct PointReference {
    /// The file.
    pub path: PathBuf,
    /// The label.
    pub label: String,
}

impl FromStr for PointReference {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        match text.rsplit_once(':') {
            Some((path, label)) if !path.is_empty() && !label.is_empty() => {
                Ok(Self { path: path.into(), label: label.to_owned() })
            }
            _ => Err("it must have the form FILE:LABEL, such as hopf.json:HB1".to_owned()),
        }
    }
}

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

impl PointReference {
    /// Reads the point from its file.
    ///
    /// # Errors
    /// [`Failure::ResultFile`]: no such file, not a result of one of the commands, no such label.
    pub fn read(&self, schemas: &[&str]) -> Result<LabelledPoint, Failure> {
        let mut file = read_file(&self.path, schemas).map_err(|problem| self.failure(problem))?;
        let labels: Vec<String> = file.points.iter().filter_map(|point| point.label.clone()).collect();
        let place = file.points.iter().position(|point| point.label.as_ref() == Some(&self.label));
        let Some(place) = place else {
            return Err(self.no_such_label(&labels));
        };
        let point = file.points.swap_remove(place);
        let mut parameters = file.parameters.0;
        let branching = point.branching.map(|branching| (branching, file.along.key.clone()));
        parameters.push((file.along.key, point.value.0));
        Ok(LabelledPoint { parameters, orbit: point.orbit, branching })
    }

    /// That the orbit that was read is one of a model with so many states.
    ///
    /// # Errors
    /// [`Failure::ResultFile`].
    pub fn check(&self, orbit: &Orbit, dimension: usize) -> Result<(), Failure> {
        check(orbit, dimension)
            .map_err(|problem| self.failure(format!("the orbit of {}: {problem}", self.label)))
    }

    /// That the label is none of those of the file.
    pub fn no_such_label(&self, labels: &[String]) -> Failure {
        let known = if labels.is_empty() { "it has no labels".to_owned() } else { labels.join(", ") };
        self.failure(format!("no point is labelled `{}`; the labels are: {known}", self.label))
    }

    /// What is wrong with the file.
    pub fn failure(&self, problem: String) -> Failure {
        Failure::ResultFile { path: self.path.clone(), problem }
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

/// That an orbit that was read is one.
fn check(orbit: &Orbit, dimension: usize) -> Result<(), String> {
    if orbit.dimension != dimension {
        return Err(format!("{} states; allowed: {dimension}", orbit.dimension));
    }
    if !(2..=16).contains(&orbit.degree) {
        return Err(format!("degree {}; allowed: 2 to 16", orbit.degree));
    }
    let rises = orbit.mesh.windows(2).all(|ends| ends[0] < ends[1]);
    if orbit.mesh.len() < 2 || orbit.mesh.first() != Some(&0.0) || orbit.mesh.last() != Some(&1.0) || !rises {
        return Err("the mesh must rise from 0 to 1".to_owned());
    }
    let expected = (orbit.mesh.len() - 1) * (orbit.degree + 1) * dimension;
    if orbit.states.len() != expected || !orbit.states.iter().all(|value| value.is_finite()) {
        return Err(format!("{} states; allowed: {expected} finite numbers", orbit.states.len()));
    }
    if !(orbit.period > 0.0 && orbit.period.is_finite()) {
        return Err(format!("period {}; allowed: positive and finite", orbit.period));
    }
    Ok(())
}
