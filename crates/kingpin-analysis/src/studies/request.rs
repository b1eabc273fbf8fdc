//! Which studies are asked for.

use super::files::write;
use super::name::StudyName;
use super::result::StudyResult;
use super::study::Study;
use crate::error::Error;
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
    /// Folder for the figures and their data; it is created where it is missing.
    pub out: PathBuf,
}

impl Default for StudyRequest {
    fn default() -> Self {
        Self { studies: StudyName::ALL.to_vec(), out: "studies".into() }
    }
}

impl StudyRequest {
    /// Computes and draws the studies. The files of each are written as soon as it is finished.
    ///
    /// # Errors
    /// What could not be computed or written; where the control stops it [`Error::Stopped`], or [`Error::Interrupted`] after the
    /// first study.
    pub fn run(&self, control: &Control<'_>) -> Result<StudyResult, Error> {
        std::fs::create_dir_all(&self.out)
            .map_err(|source| ReportError::Unwritable { path: self.out.clone(), source })?;
        let mut result = StudyResult::default();
        for (done, &name) in self.studies.iter().enumerate() {
            control.at(name.as_str());
            let Study { findings, drawings, pictures } =
                name.compute(control).map_err(|error| match error {
                    Error::Stopped if done > 0 => Error::Interrupted {
                        done,
                        parts: self.studies.len(),
                        kept: format!("their files are in {}", self.out.display()),
                    },
                    error => error,
                })?;
            result.files.extend(write(&self.out, &drawings, &pictures)?);
            result.findings.extend(findings.into_iter().map(|finding| (name, finding)));
        }
        Ok(result)
    }
}
