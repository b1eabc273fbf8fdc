//! Writes all files of a run, or none of them half.

use kingpin_report::ReportError;
use std::fs;
use std::io::Write;
use std::path::{Path, PathBuf};
use tempfile::NamedTempFile;

/// Creates the folder where it is missing and makes sure that files can be written there.
pub(super) fn prepare(folder: &Path) -> Result<(), ReportError> {
    let failed = |source| ReportError::Unwritable { path: folder.to_owned(), source };
    fs::create_dir_all(folder).map_err(failed)?;
    NamedTempFile::new_in(folder).and_then(NamedTempFile::close).map_err(failed)
}

/// Writes every file under a temporary name first; only when all are complete do they get their names.
pub(super) fn write(folder: &Path, files: &[(String, Vec<u8>)]) -> Result<Vec<PathBuf>, ReportError> {
    let mut complete = Vec::with_capacity(files.len());
    for (name, content) in files {
        let path = folder.join(name);
        let written = NamedTempFile::new_in(folder).and_then(|mut file| {
            file.write_all(content)?;
            readable_by_all(&file)?;
            Ok(file)
        });
        complete
            .push((written.map_err(|source| ReportError::Unwritable { path: path.clone(), source })?, path));
    }
    let named = complete.into_iter().map(|(file, path)| match file.persist(&path) {
        Ok(_) => Ok(path),
        Err(error) => Err(ReportError::Unwritable { path, source: error.error }),
    });
    named.collect()
}

/// Temporary files are private; results are not.
#[cfg(unix)]
fn readable_by_all(file: &NamedTempFile) -> std::io::Result<()> {
    use std::os::unix::fs::PermissionsExt;
    file.as_file().set_permissions(fs::Permissions::from_mode(0o644))
}

#[cfg(not(unix))]
fn readable_by_all(_: &NamedTempFile) -> std::io::Result<()> {
    Ok(())
}
