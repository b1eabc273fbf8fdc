//! Results and pictures in files whose endings say their format, each written whole or not at all.
//!
//! A file is [staged](Staged) under another name first, in the same folder, and then published in one step; several that belong
//! together are published when all are staged. Symbolic links are followed, permissions of what is replaced are kept, and pipes
//! and devices are written to, never replaced.

use crate::columns::Columns;
use crate::destination::{Destination, open_stream};
use crate::error::ReportError;
use crate::report::Report;
use crate::stoppable::Stoppable;
use crate::unfinished::UnfinishedFile;
use crate::{json, parquet};
use kingpin_figure::Figure;
use std::collections::BTreeMap;
use std::fs::File;
use std::io::{self, BufWriter, Write};
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, Ordering};

/// Resolution of PNG files in dots per inch.
const PICTURE_RESOLUTION: f64 = 300.0;

/// Formats of files.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FileFormat {
    /// One object.
    Json,
    /// Rows under a line of names.
    Csv,
    /// Typed columns.
    Parquet,
    /// A picture.
    Picture(PictureFormat),
}

/// Formats of pictures.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PictureFormat {
    /// Vectors.
    Svg,
    /// Dots, 300 per inch.
    Png,
    /// A page.
    Pdf,
}

impl FileFormat {
    /// Formats of data.
    pub const DATA: &'static [Self] = &[Self::Json, Self::Csv, Self::Parquet];
    /// All formats.
    pub const ALL: &'static [Self] = &[
        Self::Json,
        Self::Csv,
        Self::Parquet,
        Self::Picture(PictureFormat::Svg),
        Self::Picture(PictureFormat::Png),
        Self::Picture(PictureFormat::Pdf),
    ];

    /// The ending of its files, without the dot.
    pub fn ending(self) -> &'static str {
        match self {
            Self::Json => "json",
            Self::Csv => "csv",
            Self::Parquet => "parquet",
            Self::Picture(format) => format.ending(),
        }
    }

    /// The format that the ending of a file names, among those that are allowed.
    ///
    /// # Errors
    /// [`ReportError::UnknownEnding`].
    pub fn of(path: &Path, allowed: &[Self]) -> Result<Self, ReportError> {
        let known = allowed.iter().find(|format| ends_in(path, format.ending()));
        known.copied().ok_or_else(|| unknown(path, allowed.iter().map(|format| format.ending())))
    }
}

impl PictureFormat {
    /// All formats.
    pub const ALL: &'static [Self] = &[Self::Svg, Self::Png, Self::Pdf];

    /// The ending of its files, without the dot.
    pub fn ending(self) -> &'static str {
        match self {
            Self::Svg => "svg",
            Self::Png => "png",
            Self::Pdf => "pdf",
        }
    }

    /// The format that the ending of a file names.
    ///
    /// # Errors
    /// [`ReportError::UnknownEnding`].
    pub fn of(path: &Path) -> Result<Self, ReportError> {
        let known = Self::ALL.iter().find(|format| ends_in(path, format.ending()));
        known.copied().ok_or_else(|| unknown(path, Self::ALL.iter().map(|format| format.ending())))
    }
}

fn ends_in(path: &Path, ending: &str) -> bool {
    path.extension().and_then(|given| given.to_str()).is_some_and(|given| given.eq_ignore_ascii_case(ending))
}

fn unknown<'a>(path: &Path, allowed: impl Iterator<Item = &'a str>) -> ReportError {
    let endings: Vec<String> = allowed.map(|ending| format!(".{ending}")).collect();
    ReportError::UnknownEnding { path: path.to_owned(), allowed: endings.join(", ") }
}

/// Checks that a file can be written where it is wanted; nothing is left there.
///
/// # Errors
/// [`ReportError::Unwritable`].
pub fn check_writable(path: &Path) -> Result<(), ReportError> {
    let check = || match Destination::of(path)? {
        Destination::File { path, .. } => UnfinishedFile::beside(&path).map(drop),
        // Opening a pipe would wait for its reader.
        Destination::Stream(_) | Destination::Output(_) => Ok(()),
    };
    check().map_err(unwritable(path))
}

/// What is complete and waits to be published where it is wanted; dropped, it leaves nothing.
#[derive(Debug)]
pub struct Staged {
    /// The path as it was asked for.
    path: PathBuf,
    content: Content,
}

/// What was staged.
#[derive(Debug)]
enum Content {
    /// A file under another name, and its own.
    File(UnfinishedFile, PathBuf),
    /// What is to go through a pipe or a device.
    Stream(Vec<u8>, PathBuf),
    /// What is to follow the output of this program.
    Output(Vec<u8>, File),
}

impl Staged {
    /// Stages what a writer writes.
    ///
    /// # Errors
    /// [`ReportError::Unwritable`], and those of the writer.
    pub fn new(
        path: &Path,
        write: impl FnOnce(&mut (dyn Write + Send)) -> Result<(), ReportError>,
    ) -> Result<Self, ReportError> {
        let unwritable = || unwritable(path);
        let content = match Destination::of(path).map_err(unwritable())? {
            Destination::File { path, permissions } => {
                let mut file = UnfinishedFile::beside(&path).map_err(unwritable())?;
                if let Some(permissions) = permissions {
                    file.set_permissions(permissions).map_err(unwritable())?;
                }
                let mut out = BufWriter::new(file.file());
                write(&mut out)?;
                out.flush().map_err(unwritable())?;
                drop(out);
                Content::File(file, path)
            }
            Destination::Stream(to) => Content::Stream(in_memory(write)?, to),
            Destination::Output(to) => Content::Output(in_memory(write)?, to),
        };
        Ok(Self { path: path.to_owned(), content })
    }

    /// Stages a result.
    ///
    /// # Errors
    /// [`ReportError::Unwritable`], those of the format and of the drawing.
    pub fn result<R: Report>(result: &R, path: &Path, format: FileFormat) -> Result<Self, ReportError> {
        Self::result_unless(&AtomicBool::new(false), result, path, format)
    }

    /// Stages a result unless the flag is set before it is complete.
    ///
    /// # Errors
    /// [`ReportError::Stopped`], and those of [`result`](Self::result).
    pub fn result_unless<R: Report>(
        stop: &AtomicBool,
        result: &R,
        path: &Path,
        format: FileFormat,
    ) -> Result<Self, ReportError> {
        // What takes long without writing comes before the file is begun.
        let staged = |write: &mut dyn FnMut(&mut (dyn Write + Send)) -> Result<(), ReportError>| {
            if stop.load(Ordering::Relaxed) {
                return Err(ReportError::Stopped);
            }
            Self::new(path, |out| write(&mut Stoppable::new(out, stop)))
        };
        let outcome = match format {
            FileFormat::Json => staged(&mut |out| json::write(result, out)),
            FileFormat::Csv => {
                let columns = result.columns();
                staged(&mut |out| columns.write_csv(out).map_err(ReportError::encoding("CSV")))
            }
            FileFormat::Parquet => {
                let columns = result.columns();
                let metadata = metadata(result, &columns)?;
                staged(&mut |out| parquet::write(&columns, &metadata, out))
            }
            FileFormat::Picture(format) => {
                let picture = encoded(&result.figure()?.ok_or(ReportError::NothingToDraw)?, format)?;
                staged(&mut |out| out.write_all(&picture).map_err(ReportError::encoding("a picture")))
            }
        };
        if stop.load(Ordering::Relaxed) { Err(ReportError::Stopped) } else { outcome }
    }

    /// Stages a picture.
    ///
    /// # Errors
    /// As [`result`](Self::result).
    pub fn picture(figure: &Figure, path: &Path, format: PictureFormat) -> Result<Self, ReportError> {
        let picture = encoded(figure, format)?;
        Self::new(path, |out| out.write_all(&picture).map_err(ReportError::encoding("a picture")))
    }

    /// The path as it was asked for.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Puts it where it is wanted.
    ///
    /// # Errors
    /// [`ReportError::Unwritable`].
    pub fn publish(self) -> Result<(), ReportError> {
        let published = match self.content {
            Content::File(file, path) => file.finish(&path).map(drop),
            Content::Stream(bytes, path) => {
                open_stream(&path).and_then(|mut stream| stream.write_all(&bytes))
            }
            Content::Output(bytes, mut file) => file.write_all(&bytes),
        };
        published.map_err(unwritable(&self.path))
    }
}

/// Writes a file that appears whole or not at all.
///
/// # Errors
/// [`ReportError::Unwritable`], and those of the writer; then no file is left behind.
pub fn write_whole(
    path: &Path,
    write: impl FnOnce(&mut (dyn Write + Send)) -> Result<(), ReportError>,
) -> Result<(), ReportError> {
    Staged::new(path, write)?.publish()
}

fn unwritable(path: &Path) -> impl FnOnce(io::Error) -> ReportError {
    move |source| ReportError::Unwritable { path: path.to_owned(), source }
}

fn in_memory(
    write: impl FnOnce(&mut (dyn Write + Send)) -> Result<(), ReportError>,
) -> Result<Vec<u8>, ReportError> {
    let mut bytes = Vec::new();
    write(&mut bytes)?;
    Ok(bytes)
}

fn encoded(figure: &Figure, format: PictureFormat) -> Result<Vec<u8>, ReportError> {
    Ok(match format {
        PictureFormat::Svg => figure.to_svg()?.into_bytes(),
        PictureFormat::Png => figure.to_png(PICTURE_RESOLUTION)?,
        PictureFormat::Pdf => figure.to_pdf(),
    })
}

fn metadata<R: Report>(result: &R, columns: &Columns) -> Result<[(&'static str, String); 3], ReportError> {
    let failure = |error: serde_json::Error| ReportError::encoding("Parquet")(error.into());
    Ok([
        ("schema", serde_json::to_string(&result.schema()).map_err(failure)?),
        ("parameters", serde_json::to_string(&result.parameters()).map_err(failure)?),
        ("units", serde_json::to_string(&columns.units().collect::<BTreeMap<_, _>>()).map_err(failure)?),
    ])
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Parameters, Schema};
    use serde::Serialize;

    /// A result of many rows whose writing stops itself at one of them.
    struct Long(Vec<Row>);

    struct Row(usize, &'static AtomicBool);

    impl Serialize for Row {
        fn serialize<S: serde::Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
            WRITTEN.fetch_max(self.0, Ordering::Relaxed);
            if self.0 == 1000 {
                self.1.store(true, Ordering::Relaxed);
            }
            serializer.serialize_u64(self.0 as u64)
        }
    }

    impl Serialize for Long {
        fn serialize<S: serde::Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
            use serde::ser::SerializeStruct;
            let mut fields = serializer.serialize_struct("Long", 1)?;
            fields.serialize_field("rows", &self.0)?;
            fields.end()
        }
    }

    impl Report for Long {
        fn schema(&self) -> Schema {
            Schema::first("long")
        }

        fn parameters(&self) -> Parameters {
            Parameters::default()
        }

        fn write_table(&self, _: &mut dyn Write) -> io::Result<()> {
            Ok(())
        }

        fn columns(&self) -> Columns {
            Columns::new().counts("row", self.0.iter().map(|row| row.0 as u64))
        }
    }

    static STOP: AtomicBool = AtomicBool::new(false);
    static WRITTEN: std::sync::atomic::AtomicUsize = std::sync::atomic::AtomicUsize::new(0);

    #[test]
    fn writing_stops_where_it_is_asked_to_and_leaves_nothing() {
        let folder = tempfile::tempdir().unwrap();
        let long = Long((0..100_000).map(|row| Row(row, &STOP)).collect());
        for ending in ["json", "csv", "parquet"] {
            let path = folder.path().join("long").with_extension(ending);
            let format = FileFormat::of(&path, FileFormat::ALL).unwrap();
            // JSON is stopped under way, the others before they begin.
            let outcome = Staged::result_unless(&STOP, &long, &path, format);
            assert!(matches!(outcome, Err(ReportError::Stopped)), "{ending}");
            assert_eq!(fs_entries(folder.path()), 0, "{ending}");
        }
        assert!(WRITTEN.load(Ordering::Relaxed) < 1010, "{WRITTEN:?}");
    }

    fn fs_entries(folder: &Path) -> usize {
        std::fs::read_dir(folder).unwrap().count()
    }
}
