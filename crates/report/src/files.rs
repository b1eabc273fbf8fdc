//! Results and pictures in files whose endings say their format, each written whole or not at all.

use crate::columns::Columns;
use crate::error::ReportError;
use crate::report::Report;
use crate::{json, parquet};
use kingpin_figure::Figure;
use std::collections::BTreeMap;
use std::io::{self, BufWriter, Write};
use std::path::Path;

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
    let unwritable = |source| ReportError::Unwritable { path: path.to_owned(), source };
    if path.is_dir() {
        return Err(unwritable(io::ErrorKind::IsADirectory.into()));
    }
    temporary_beside(path).map(drop).map_err(unwritable)
}

/// Writes a result into a file.
///
/// # Errors
/// [`ReportError::Unwritable`], those of the format and of the drawing; then no file is left behind.
pub fn write_result<R: Report>(result: &R, path: &Path, format: FileFormat) -> Result<(), ReportError> {
    let picture = || result.figure()?.ok_or(ReportError::NothingToDraw);
    write_whole(path, |out| match format {
        FileFormat::Json => json::write(result, out),
        FileFormat::Csv => result.columns().write_csv(out).map_err(ReportError::encoding("CSV")),
        FileFormat::Parquet => {
            let columns = result.columns();
            parquet::write(&columns, &metadata(result, &columns)?, out)
        }
        FileFormat::Picture(format) => encode_picture(&picture()?, format, out),
    })
}

/// Writes a picture into a file.
///
/// # Errors
/// As [`write_result`].
pub fn write_picture(figure: &Figure, path: &Path, format: PictureFormat) -> Result<(), ReportError> {
    write_whole(path, |out| encode_picture(figure, format, out))
}

/// Writes a file that appears whole or not at all: under another name first, in the same folder.
///
/// # Errors
/// [`ReportError::Unwritable`], and those of the writer; then no file is left behind.
pub fn write_whole(
    path: &Path,
    write: impl FnOnce(&mut (dyn Write + Send)) -> Result<(), ReportError>,
) -> Result<(), ReportError> {
    let unwritable = |source| ReportError::Unwritable { path: path.to_owned(), source };
    let mut file = temporary_beside(path).map_err(unwritable)?;
    let mut out = BufWriter::new(file.as_file_mut());
    write(&mut out)?;
    out.flush().map_err(unwritable)?;
    drop(out);
    file.persist(path).map_err(|error| unwritable(error.error))?;
    Ok(())
}

fn encode_picture(
    figure: &Figure,
    format: PictureFormat,
    out: &mut (dyn Write + Send),
) -> Result<(), ReportError> {
    let picture = match format {
        PictureFormat::Svg => figure.to_svg()?.into_bytes(),
        PictureFormat::Png => figure.to_png(PICTURE_RESOLUTION)?,
        PictureFormat::Pdf => figure.to_pdf(),
    };
    out.write_all(&picture).map_err(ReportError::encoding("a picture"))
}

fn metadata<R: Report>(result: &R, columns: &Columns) -> Result<[(&'static str, String); 3], ReportError> {
    let failure = |error: serde_json::Error| ReportError::encoding("Parquet")(error.into());
    Ok([
        ("schema", serde_json::to_string(&result.schema()).map_err(failure)?),
        ("parameters", serde_json::to_string(&result.parameters()).map_err(failure)?),
        ("units", serde_json::to_string(&columns.units().collect::<BTreeMap<_, _>>()).map_err(failure)?),
    ])
}

/// A temporary file in the folder of a file, so that renaming it is one step; it goes when dropped.
fn temporary_beside(path: &Path) -> io::Result<tempfile::NamedTempFile> {
    let folder = path.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."));
    let mut builder = tempfile::Builder::new();
    builder.prefix(".unfinished-");
    #[cfg(unix)]
    {
        // As any other new file, not for the owner alone; the mask of the user applies.
        use std::os::unix::fs::PermissionsExt;
        builder.permissions(std::fs::Permissions::from_mode(0o666));
    }
    builder.tempfile_in(folder)
}
