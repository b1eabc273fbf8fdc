//! Where results go: to standard output in one format, and to files whose endings say theirs.

use crate::document;
use crate::failure::Failure;
use crate::parquet;
use crate::report::Report;
use crate::terminal;
use clap::ValueEnum;
use kingpin_figure::Figure;
use std::io::{BufWriter, Write};
use std::path::{Path, PathBuf};

/// Resolution of PNG files in dots per inch.
const PICTURE_RESOLUTION: f64 = 300.0;

/// Formats of standard output.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, ValueEnum)]
pub enum Format {
    /// For people.
    #[default]
    Table,
    /// One object.
    Json,
    /// Rows with a line of names.
    Csv,
}

/// Formats of files.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Ending {
    Json,
    Csv,
    Parquet,
    Svg,
    Png,
    Pdf,
}

impl Ending {
    const DATA: [(&'static str, Self); 3] =
        [("json", Self::Json), ("csv", Self::Csv), ("parquet", Self::Parquet)];
    const PICTURES: [(&'static str, Self); 3] = [("svg", Self::Svg), ("png", Self::Png), ("pdf", Self::Pdf)];

    fn of(path: &Path, pictures: bool) -> Result<Self, Failure> {
        let pictures = Self::PICTURES.into_iter().filter(|_| pictures);
        Self::among(&Self::DATA.into_iter().chain(pictures).collect::<Vec<_>>(), path)
    }

    fn among(allowed: &[(&'static str, Self)], path: &Path) -> Result<Self, Failure> {
        let given = path.extension().and_then(|ending| ending.to_str()).unwrap_or_default();
        let known = allowed.iter().find(|(name, _)| name.eq_ignore_ascii_case(given));
        known.map(|&(_, ending)| ending).ok_or_else(|| {
            let endings: Vec<String> = allowed.iter().map(|(name, _)| format!(".{name}")).collect();
            Failure::Option {
                option: "--out",
                given: path.display().to_string(),
                problem: "the ending names no format of this command".to_owned(),
                allowed: endings.join(", "),
            }
        })
    }
}

/// Where the result of one command goes.
#[derive(Debug)]
pub struct Output {
    format: Format,
    files: Vec<(PathBuf, Ending)>,
    quiet: bool,
}

impl Output {
    /// Checks, before anything is computed, that the endings are known and the folders can be written to.
    ///
    /// # Errors
    /// [`Failure::Option`] and [`Failure::Unwritable`].
    pub fn new(format: Format, paths: &[PathBuf], quiet: bool, pictures: bool) -> Result<Self, Failure> {
        let mut files = Vec::new();
        for path in paths {
            let ending = Ending::of(path, pictures)?;
            let unwritable = |source| Failure::Unwritable { path: path.clone(), source };
            if path.is_dir() {
                return Err(unwritable(std::io::ErrorKind::IsADirectory.into()));
            }
            temporary_beside(path).map_err(unwritable)?;
            files.push((path.clone(), ending));
        }
        Ok(Self { format, files, quiet })
    }

    /// The first of the files.
    pub fn first_file(&self) -> Option<&Path> {
        self.files.first().map(|(path, _)| path.as_path())
    }

    /// Whether progress and warnings are unwanted.
    pub fn is_quiet(&self) -> bool {
        self.quiet
    }

    /// Warns on standard error.
    pub fn warn(&self, message: &str) {
        if !self.quiet {
            terminal::say("warning", message);
        }
    }

    /// Says something worth knowing on standard error.
    pub fn note(&self, message: &str) {
        if !self.quiet {
            terminal::say("note", message);
        }
    }

    /// Writes the files, then standard output; the latter not where there are files and quiet was asked for.
    ///
    /// # Errors
    /// What the writers say.
    pub fn deliver<R: Report>(&self, report: &R) -> Result<(), Failure> {
        for (path, ending) in &self.files {
            write_whole(path, |out| write_file(report, *ending, out))?;
            if !self.quiet {
                terminal::say("wrote", &path.display().to_string());
            }
        }
        if self.quiet && !self.files.is_empty() {
            return Ok(());
        }
        terminal::print(|out| match self.format {
            Format::Table => report.write_table(out).map_err(|e| terminal::output_failure(e, "text")),
            Format::Json => document::write(report, out),
            Format::Csv => report.columns().write_csv(out).map_err(|e| terminal::output_failure(e, "CSV")),
        })
    }
}

fn write_file<R: Report>(report: &R, ending: Ending, out: &mut (dyn Write + Send)) -> Result<(), Failure> {
    let picture = || {
        let none = || Failure::Encoding { format: "a picture", cause: "there is nothing to draw".to_owned() };
        report.figure()?.ok_or_else(none)
    };
    match ending {
        Ending::Json => document::write(report, out),
        Ending::Csv => report.columns().write_csv(out).map_err(|e| terminal::output_failure(e, "CSV")),
        Ending::Parquet => parquet::write(&report.columns(), &metadata(report)?, out),
        Ending::Svg | Ending::Png | Ending::Pdf => write_picture(&picture()?, ending, out),
    }
}

/// Writes a picture to files whose endings say their format.
///
/// # Errors
/// An ending that is none of a picture, [`Failure::Unwritable`], and those of the drawing.
pub fn write_pictures(figure: &Figure, paths: &[PathBuf]) -> Result<(), Failure> {
    for path in paths {
        let ending = Ending::among(&Ending::PICTURES, path)?;
        write_whole(path, |out| write_picture(figure, ending, out))?;
    }
    Ok(())
}

fn write_picture(figure: &Figure, ending: Ending, out: &mut (dyn Write + Send)) -> Result<(), Failure> {
    let picture = match ending {
        Ending::Png => figure.to_png(PICTURE_RESOLUTION)?,
        Ending::Pdf => figure.to_pdf(),
        _ => figure.to_svg()?.into_bytes(),
    };
    out.write_all(&picture).map_err(|error| terminal::output_failure(error, "a picture"))
}

fn metadata<R: Report>(report: &R) -> Result<[(&'static str, String); 2], Failure> {
    let failure =
        |error: serde_json::Error| Failure::Encoding { format: "Parquet", cause: error.to_string() };
    Ok([
        ("schema", serde_json::to_string(&report.schema()).map_err(failure)?),
        ("parameters", serde_json::to_string(&report.parameters()).map_err(failure)?),
    ])
}

/// Writes a file that appears whole or not at all.
///
/// # Errors
/// [`Failure::Unwritable`], and those of the writer; then no file is left behind.
pub fn write_whole(
    path: &Path,
    write: impl FnOnce(&mut (dyn Write + Send)) -> Result<(), Failure>,
) -> Result<(), Failure> {
    let unwritable = |source| Failure::Unwritable { path: path.to_owned(), source };
    let mut file = temporary_beside(path).map_err(unwritable)?;
    let mut out = BufWriter::new(file.as_file_mut());
    write(&mut out)?;
    out.flush().map_err(unwritable)?;
    drop(out);
    file.persist(path).map_err(|error| unwritable(error.error))?;
    Ok(())
}

/// A temporary file in the folder of a file, so that renaming it is one step; it goes when dropped.
fn temporary_beside(path: &Path) -> std::io::Result<tempfile::NamedTempFile> {
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
