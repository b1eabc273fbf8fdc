//! What stands where a file is wanted: a file that can be replaced as a whole, perhaps through symbolic links, or a pipe, a terminal
//! or another device, which can only be written to.

use std::fs::{self, File, Metadata, OpenOptions, Permissions};
use std::io;
use std::path::{Path, PathBuf};

/// Most symbolic links that are followed, as by the operating system.
const MOST_LINKS: usize = 40;

/// Where what is written to a path goes.
#[derive(Debug)]
pub(crate) enum Destination {
    /// A file, or a place where there is none, that is replaced as a whole.
    File {
        /// The file itself, behind all links.
        path: PathBuf,
        /// Those of the file that is there.
        permissions: Option<Permissions>,
    },
    /// A pipe, a terminal or another device: what is written goes through it.
    Stream(PathBuf),
    /// A file that this program writes its output to already: what is written follows that.
    Output(File),
}

impl Destination {
    /// What a path leads to.
    ///
    /// # Errors
    /// A folder, more links than are followed, and what the file system says.
    pub(crate) fn of(path: &Path) -> io::Result<Self> {
        let path = behind_links(path)?;
        match fs::metadata(&path) {
            Ok(found) if found.is_dir() => Err(io::ErrorKind::IsADirectory.into()),
            Ok(found) if !found.is_file() => Ok(Self::Stream(path)),
            Ok(found) => Ok(match output_into(&found)? {
                Some(file) => Self::Output(file),
                None => Self::File { path, permissions: Some(found.permissions()) },
            }),
            Err(error) if error.kind() == io::ErrorKind::NotFound => {
                Ok(Self::File { path, permissions: None })
            }
            Err(error) => Err(error),
        }
    }
}

/// Opens a pipe, a terminal or another device for writing; a pipe waits for its reader.
pub(crate) fn open_stream(path: &Path) -> io::Result<File> {
    OpenOptions::new().write(true).open(path)
}

/// The path behind symbolic links, also where nothing is there.
fn behind_links(path: &Path) -> io::Result<PathBuf> {
    let mut path = path.to_owned();
    for _ in 0..MOST_LINKS {
        match fs::symlink_metadata(&path) {
            Ok(found) if found.is_symlink() => {
                let target = fs::read_link(&path)?;
                let linked = match path.parent() {
                    Some(folder) => folder.join(&target),
                    None => target,
                };
                // The links of the system to open pipes and sockets lead to no path: they are opened themselves.
                if fs::symlink_metadata(&linked).is_err() && fs::metadata(&path).is_ok() {
                    return Ok(path);
                }
                path = linked;
            }
            _ => return Ok(path),
        }
    }
    Err(io::Error::other("too many levels of symbolic links"))
}

/// The standard output or error of this program, where it goes into this very file: replacing the file would lose it.
#[cfg(unix)]
fn output_into(found: &Metadata) -> io::Result<Option<File>> {
    use std::os::fd::AsFd;
    use std::os::unix::fs::MetadataExt;
    for output in [io::stdout().as_fd(), io::stderr().as_fd()] {
        let file = File::from(output.try_clone_to_owned()?);
        let own = file.metadata()?;
        if (own.dev(), own.ino()) == (found.dev(), found.ino()) {
            return Ok(Some(file));
        }
    }
    Ok(None)
}

#[cfg(not(unix))]
fn output_into(_: &Metadata) -> io::Result<Option<File>> {
    Ok(None)
}
