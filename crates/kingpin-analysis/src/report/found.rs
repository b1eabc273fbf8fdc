//! What a report has found so far: findings with their figures.

use super::finding::Finding;
use super::illustration::Illustration;
use crate::error::Error;

/// What was found so far.
#[derive(Default)]
pub(super) struct Found {
    pub findings: Vec<Finding>,
    pub illustrations: Vec<Illustration>,
}

impl Found {
    /// One finding with its figures.
    pub(super) fn new(finding: Finding, illustrations: impl IntoIterator<Item = Illustration>) -> Self {
        Self { findings: vec![finding], illustrations: illustrations.into_iter().collect() }
    }

    /// Takes what was found on a subject, or why nothing was; a stop goes on as an error.
    pub(super) fn take(&mut self, subject: &str, found: Result<Self, Error>) -> Result<(), Error> {
        match found {
            Ok(found) => {
                self.findings.extend(found.findings);
                self.illustrations.extend(found.illustrations);
            }
            Err(Error::Stopped) => return Err(Error::Stopped),
            Err(error) => self.findings.push(Finding::not_computed(subject, &error)),
        }
        Ok(())
    }
}
