//! The files of a study.

use super::study::Drawing;
use crate::error::Error;
use kingpin_report::ReportError;
use kingpin_report::files::write_whole;
use std::path::{Path, PathBuf};

/// Resolution of the PNG files in dots per inch.
const DPI: f64 = 300.0;

/// Writes figures, data and pictures into a folder that exists; every file appears whole or not at all.
///
/// # Errors
/// [`Error::Report`].
pub(super) fn write(
    folder: &Path,
    drawings: &[Drawing],
    pictures: &[(&'static str, String)],
) -> Result<Vec<PathBuf>, Error> {
    let mut files = Vec::new();
    let mut keep = |name: String, content: &[u8]| {
        let path = folder.join(name);
        let encoding = |source| ReportError::Encoding { format: "a file", source };
        write_whole(&path, |out| out.write_all(content).map_err(encoding))?;
        files.push(path);
        Ok::<_, Error>(())
    };
    for Drawing { number, figure, data } in drawings {
        let (svg, png) = rayon::join(|| figure.to_svg(), || figure.to_png(DPI));
        let mut csv = Vec::new();
        data.write_csv(&mut csv).map_err(|source| ReportError::Encoding { format: "CSV", source })?;
        keep(format!("figure{number}.svg"), svg?.as_bytes())?;
        keep(format!("figure{number}.png"), &png?)?;
        keep(format!("figure{number}.csv"), &csv)?;
    }
    for (name, content) in pictures {
        keep((*name).to_owned(), content.as_bytes())?;
    }
    Ok(files)
}
