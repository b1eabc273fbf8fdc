//! Writes files whole or not at all.

use std::fs::{self, OpenOptions};
use std::io::{self, Write};
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicU64, Ordering};

use crate::error::FigureError;

/// A picture format, chosen by the ending of a file.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Format {
    /// Scalable vector graphics.
    Svg,
    /// Pixels.
    Png,
    /// Portable document format, vectors.
    Pdf,
}

impl Format {
    /// The format that the ending of a path names, in small or capital letters.
    ///
    /// # Errors
    /// [`FigureError::UnknownFormat`] when it names none.
    pub fn of_path(path: impl AsRef<Path>) -> Result<Format, FigureError> {
        let path = path.as_ref();
        let ending = path.extension().and_then(|ending| ending.to_str()).map(str::to_ascii_lowercase);
        match ending.as_deref() {
            Some("svg") => Ok(Format::Svg),
            Some("png") => Ok(Format::Png),
            Some("pdf") => Ok(Format::Pdf),
            _ => Err(FigureError::UnknownFormat { path: path.to_owned() }),
        }
    }
}

/// Writes the data into a temporary file in the same folder and renames it, so that nobody sees half a file; on failure
/// nothing is left behind.
pub(crate) fn write_atomically(path: &Path, data: &[u8]) -> Result<(), FigureError> {
    let failed = |source| FigureError::Io { path: path.to_owned(), source };
    let temporary = temporary_beside(path).map_err(failed)?;
    let written = write_new(&temporary, data).and_then(|()| fs::rename(&temporary, path));
    written.map_err(|source| {
        // The first failure is the one to report; a file that was never created cannot be removed either.
        let _ = fs::remove_file(&temporary);
        failed(source)
    })
}

fn write_new(path: &Path, data: &[u8]) -> io::Result<()> {
    let mut file = OpenOptions::new().write(true).create_new(true).open(path)?;
    file.write_all(data)?;
    file.sync_all()
}

fn temporary_beside(path: &Path) -> io::Result<PathBuf> {
    let name = path
        .file_name()
        .ok_or_else(|| io::Error::new(io::ErrorKind::InvalidInput, "the path names no file"))?
        .to_string_lossy();
    // The process and a count make the name unique among everybody who writes now.
    static COUNT: AtomicU64 = AtomicU64::new(0);
    let count = COUNT.fetch_add(1, Ordering::Relaxed);
    Ok(path.with_file_name(format!(".{name}.{}-{count}", std::process::id())))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn empty_folder(name: &str) -> PathBuf {
        let folder = std::env::temp_dir().join(format!("kingpin-figure-{}-{name}", std::process::id()));
        fs::create_dir_all(&folder).unwrap();
        folder
    }

    #[test]
    fn a_failed_write_leaves_nothing() {
        let folder = empty_folder("failed");
        // A folder cannot be replaced by a file, so the rename fails after the data were written.
        let target = folder.join("taken.svg");
        fs::create_dir(&target).unwrap();
        fs::write(target.join("inside"), "x").unwrap();
        let error = write_atomically(&target, b"data").unwrap_err();
        assert!(error.to_string().contains("taken.svg"));
        assert_eq!(fs::read_dir(&folder).unwrap().count(), 1);
        fs::remove_dir_all(&folder).unwrap();
    }

    #[test]
    fn a_missing_folder_is_named() {
        let error = write_atomically(Path::new("/no/such/folder/figure.svg"), b"data").unwrap_err();
        assert!(matches!(error, FigureError::Io { .. }));
        assert!(error.to_string().contains("/no/such/folder/figure.svg"));
    }

    #[test]
    fn a_file_is_replaced_whole() {
        let folder = empty_folder("replaced");
        let target = folder.join("figure.svg");
        write_atomically(&target, b"a long first version").unwrap();
        write_atomically(&target, b"second").unwrap();
        assert_eq!(fs::read(&target).unwrap(), b"second");
        assert_eq!(fs::read_dir(&folder).unwrap().count(), 1);
        fs::remove_dir_all(&folder).unwrap();
    }

    #[test]
    fn the_ending_picks_the_format() {
        assert_eq!(Format::of_path("a/b.SVG").unwrap(), Format::Svg);
        let message = Format::of_path("a/b.jpeg").unwrap_err().to_string();
        assert!(message.contains("b.jpeg") && message.contains(".svg, .png or .pdf"));
        assert!(Format::of_path("svg").is_err());
    }
}
