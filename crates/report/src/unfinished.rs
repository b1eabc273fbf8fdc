//! Files under temporary names, in the folder where they are to appear, that are gone when the program ends before they are
//! complete, by a signal too.
//!
//! A value that is dropped removes its file. A program that ends at once drops nothing: it calls [`abandon_unfinished`] before.

use std::collections::BTreeSet;
use std::fs::{File, Permissions};
use std::io;
use std::path::{Path, PathBuf};
use std::sync::{Mutex, MutexGuard, PoisonError};
use tempfile::NamedTempFile;

/// The temporary files that there are now.
static UNFINISHED: Mutex<BTreeSet<PathBuf>> = Mutex::new(BTreeSet::new());

fn unfinished() -> MutexGuard<'static, BTreeSet<PathBuf>> {
    UNFINISHED.lock().unwrap_or_else(PoisonError::into_inner)
}

/// A file under a temporary name. It is removed when dropped.
#[derive(Debug)]
pub struct UnfinishedFile {
    file: NamedTempFile,
    _known: Known,
}

/// That a temporary file is known as long as this lives.
#[derive(Debug)]
struct Known(PathBuf);

impl Drop for Known {
    fn drop(&mut self) {
        unfinished().remove(&self.0);
    }
}

impl UnfinishedFile {
    /// Creates a file in the folder of another, so that giving it that name is one step, with the permissions of any new
    /// file.
    ///
    /// # Errors
    /// Those of the file system.
    pub fn beside(path: &Path) -> io::Result<Self> {
        let folder = path.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."));
        let mut builder = tempfile::Builder::new();
        builder.prefix(".unfinished-");
        #[cfg(unix)]
        {
            // As any other new file, not for the owner alone; the mask of the user applies.
            use std::os::unix::fs::PermissionsExt;
            builder.permissions(Permissions::from_mode(0o666));
        }
        // Under the lock, so that there is no moment in which the file exists and is not known.
        let mut unfinished = unfinished();
        let file = builder.tempfile_in(folder)?;
        let path = file.path().to_owned();
        unfinished.insert(path.clone());
        Ok(Self { file, _known: Known(path) })
    }

    /// The file, to be written.
    pub fn file(&mut self) -> &mut File {
        self.file.as_file_mut()
    }

    /// Gives the file permissions.
    ///
    /// # Errors
    /// Those of the file system.
    pub fn set_permissions(&self, permissions: Permissions) -> io::Result<()> {
        self.file.as_file().set_permissions(permissions)
    }

    /// Gives the file its name, in place of what is there.
    ///
    /// # Errors
    /// Those of the file system; then the file is removed.
    pub fn finish(self, path: &Path) -> io::Result<File> {
        self.file.persist(path).map_err(|error| error.error)
    }

    /// Gives the file its name, unless something has that name.
    ///
    /// # Errors
    /// Those of the file system, [`AlreadyExists`](io::ErrorKind::AlreadyExists) among them; then the file is removed.
    pub(crate) fn finish_once(self, path: &Path) -> io::Result<File> {
        self.file.persist_noclobber(path).map_err(|error| error.error)
    }
}

/// That nothing unfinished is left, nor begun as long as this lives.
#[derive(Debug)]
pub struct Abandoned {
    _begin_nothing: MutexGuard<'static, BTreeSet<PathBuf>>,
}

/// Removes every unfinished file, for a program that is about to end. Whoever begins another one waits until the value that
/// is returned is dropped.
pub fn abandon_unfinished() -> Abandoned {
    let mut unfinished = unfinished();
    for path in std::mem::take(&mut *unfinished) {
        // What has got its name meanwhile is finished and not there any more.
        let _ = std::fs::remove_file(path);
    }
    Abandoned { _begin_nothing: unfinished }
}
