//! Where the files are read that a request names: on the disk, or in the memory of a face that touches no disk.

use std::io;
use std::path::{Path, PathBuf};

/// Reads the files that a request names: models, earlier results, samples of orbits.
pub trait Files {
    /// The contents of a file.
    ///
    /// # Errors
    /// It cannot be read.
    fn read(&self, path: &Path) -> io::Result<Vec<u8>>;
}

/// The files of this machine.
#[derive(Clone, Copy, Debug)]
pub struct Disk;

impl Files for Disk {
    fn read(&self, path: &Path) -> io::Result<Vec<u8>> {
        std::fs::read(path)
    }
}

/// Files in memory by name. There are no others, whatever a request names.
///
/// ```
/// use arclength_analysis::{Files, FilesInMemory};
/// use std::path::Path;
/// let files = FilesInMemory::from_iter([("a.json".to_owned(), b"{}".to_vec())]);
/// assert_eq!(files.read(Path::new("a.json"))?, b"{}");
/// assert!(files.read(Path::new("/etc/passwd")).is_err());
/// # Ok::<(), std::io::Error>(())
/// ```
#[derive(Clone, Debug, Default)]
pub struct FilesInMemory(Vec<(PathBuf, Vec<u8>)>);

impl FromIterator<(String, Vec<u8>)> for FilesInMemory {
    fn from_iter<T: IntoIterator<Item = (String, Vec<u8>)>>(files: T) -> Self {
        Self(files.into_iter().map(|(name, contents)| (name.into(), contents)).collect())
    }
}

impl Files for FilesInMemory {
    fn read(&self, path: &Path) -> io::Result<Vec<u8>> {
        let found = self.0.iter().find(|(name, _)| name == path);
        found.map(|(_, contents)| contents.clone()).ok_or_else(|| io::ErrorKind::NotFound.into())
    }
}
