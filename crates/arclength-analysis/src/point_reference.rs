//! Labelled points of result files, `FILE:LABEL`, from which an analysis can start.

use crate::error::Error;
use arclength::cycle::Orbit;
use serde::{Deserialize, Serialize};
use std::path::PathBuf;
use std::str::FromStr;

/// A labelled point of a result file, as it is written in an option.
///
/// ```
/// use arclength_analysis::PointReference;
/// let reference: PointReference = "runs/cycles.json:LPC1".parse()?;
/// assert_eq!((reference.path.to_str(), reference.label.as_str()), (Some("runs/cycles.json"), "LPC1"));
/// # Ok::<(), String>(())
/// ```
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
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

impl PointReference {
    /// That the orbit that was read is one of a model with so many states.
    ///
    /// # Errors
    /// [`Error::ResultFile`].
    pub fn check(&self, orbit: &Orbit, dimension: usize) -> Result<(), Error> {
        check(orbit, dimension)
            .map_err(|problem| self.failure(format!("the orbit of {}: {problem}", self.label)))
    }

    /// That the label is none of those of the file.
    pub fn no_such_label(&self, labels: &[String]) -> Error {
        let known = if labels.is_empty() { "it has no labels".to_owned() } else { labels.join(", ") };
        self.failure(format!("no point is labelled `{}`; the labels are: {known}", self.label))
    }

    /// What is wrong with the file.
    pub fn failure(&self, problem: String) -> Error {
        Error::ResultFile { path: self.path.clone(), problem }
    }
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
