//! Files of a folder that several processes write to: each is on the disk before it has its name.

use super::error::ChunkError;
use crate::unfinished::UnfinishedFile;
use std::fs::File;
use std::io::{self, Write};
use std::path::Path;

/// Writes a file in place of what is there.
pub(super) fn publish(path: &Path, content: &[u8]) -> Result<(), ChunkError> {
    let write = || {
        on_the_disk(path, content)?.finish(path)?;
        sync_folder_of(path)
    };
    write().map_err(ChunkError::file(path))
}

/// Writes a file unless there is one already.
pub(super) fn publish_once(path: &Path, content: &[u8]) -> Result<(), ChunkError> {
    let write = || match on_the_disk(path, content)?.finish_once(path) {
        Err(error) if error.kind() == io::ErrorKind::AlreadyExists => Ok(()),
        other => other.and_then(|_| sync_folder_of(path)),
    };
    write().map_err(ChunkError::file(path))
}

fn on_the_disk(path: &Path, content: &[u8]) -> io::Result<UnfinishedFile> {
    let mut file = UnfinishedFile::beside(path)?;
    file.file().write_all(content)?;
    file.file().sync_all()?;
    Ok(file)
}

/// Has the names of a folder on the disk, where the system lets a folder be opened.
fn sync_folder_of(path: &Path) -> io::Result<()> {
    match path.parent().map(File::open) {
        Some(Ok(folder)) if cfg!(unix) => folder.sync_all(),
        _ => Ok(()),
    }
}
