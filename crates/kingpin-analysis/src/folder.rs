//! Writes all files of a run, or none of them half.

use kingpin_report::ReportError;
use kingpin_report::files::{Staged, check_writable};
use std::fs;
use std::path::{Path, PathBuf};

/// Creates the folder where it is missing and makes sure that files can be written there.
pub(crate) fn prepare(folder: &Path) -> Result<(), ReportError> {
    let failed = |source| ReportError::Unwritable { path: folder.to_owned(), source };
    fs::create_dir_all(folder).map_err(failed)?;
    check_writable(&folder.join("report.html"))
}

/// Writes every file under a temporary name first; only when all are complete do they get their names.
pub(crate) fn write(folder: &Path, files: &[(String, Vec<u8>)]) -> Result<Vec<PathBuf>, ReportError> {
    let stage = |(name, content): &(String, Vec<u8>)| {
        let encoding = |source| ReportError::Encoding { format: "a file", source };
        Staged::new(&folder.join(name), |out| out.write_all(content).map_err(encoding))
    };
    let complete = files.iter().map(stage).collect::<Result<Vec<_>, _>>()?;
    let named = complete.into_iter().map(|file| {
        let path = file.path().to_owned();
        file.publish().map(|()| path)
    });
    named.collect()
}
