//! Which studies are asked for.

use super::files::write;
use super::name::StudyName;
use super::result::StudyResult;
use super::study::Study;
use super::wheel::given;
use crate::error::Error;
use crate::wheel_request::WheelRequest;
use arclength_analysis::Control;
use kingpin_report::ReportError;
use serde::{Deserialize, Serialize};
use std::path::PathBuf;

/// Studies beyond the paper.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct StudyRequest {
    /// Which.
    pub studies: Vec<StudyName>,
    /// The wheel of the studies of isolas and of sliding; where none is given they take the paper's, as the others always do.
    #[serde(flatten)]
    pub wheel: WheelRequest,
    /// Folder for the figures and their data; it is created where it is missing.
    pub out: PathBuf,
}

impl Default for StudyRequest {
    fn default() -> Self {
        Self { studies: StudyName::ALL.to_vec(), wheel: WheelRequest::default(), out: "studies".into() }
    }
}

impl StudyRequest {
    /// Computes and draws the studies. The files of each are written as soon as it is finished.
    ///
    /// # Errors
    /// What could not be computed or written; where the control stops it [`Error::Stopped`], or [`Error::Interrupted`] after the
    /// first study.
    pub fn run(&self, control: &Control<'_>) -> Result<StudyResult, Error> {
        let wheel = given(&self.wheel)?;
        if wheel.is_some()
            && let Some(other) = self.studies.iter().find(|study| !study.takes_a_wheel())
        {
            return Err(Error::invalid(
                &["wheel", "set"],
                format!("with the study `{}`", other.as_str()),
                "this study is about the paper's wheel",
                "a wheel with `isola` or `sliding`",
            ));
        }
        std::fs::create_dir_all(&self.out)
            .map_err(|source| ReportError::Unwritable { path: self.out.clone(), source })?;
        let mut result = StudyResult { wheel, ..StudyResult::default() };
        for (done, &name) in self.studies.iter().enumerate() {
            control.at(name.as_str());
            let Study { findings, drawings, pictures, notes } =
                name.compute(wheel.as_ref(), control).map_err(|error| match error {
                    Error::Stopped if done > 0 => Error::Interrupted {
                        done,
                        parts: self.studies.len(),
                        kept: format!("their files are in {}", self.out.display()),
                    },
                    error => error,
                })?;
            result.files.extend(write(&self.out, &drawings, &pictures)?);
            result.findings.extend(findings.into_iter().map(|finding| (name, finding)));
            result.notes.extend(notes.into_iter().map(|note| (name, note)));
        }
        Ok(result)
    }
}
