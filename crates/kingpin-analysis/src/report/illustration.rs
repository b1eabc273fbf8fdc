//! A figure of the report with its data and its caption.

use crate::error::Error;
use kingpin_figure::Figure;
use kingpin_report::{Columns, Report, ReportError};

/// Resolution of the PNG files in dots per inch.
const DPI: f64 = 300.0;

/// A figure with its data, and its caption in HTML.
pub(super) struct Illustration {
    pub figure: Figure,
    pub data: Columns,
    pub caption: String,
}

/// A figure in all its formats.
pub(super) struct Pictures {
    pub svg: String,
    pub png: Vec<u8>,
    pub pdf: Vec<u8>,
    pub csv: Vec<u8>,
}

impl Illustration {
    /// The picture of a result, if it has one.
    pub(super) fn of(result: &impl Report, caption: String) -> Result<Option<Self>, Error> {
        let figure = result.figure()?;
        Ok(figure.map(|figure| Self { figure, data: result.columns(), caption }))
    }

    pub(super) fn pictures(&self) -> Result<Pictures, Error> {
        let vectors = || (self.figure.to_svg(), self.figure.to_pdf());
        let ((svg, pdf), png) = rayon::join(vectors, || self.figure.to_png(DPI));
        let mut csv = Vec::new();
        self.data.write_csv(&mut csv).map_err(|source| ReportError::Encoding { format: "CSV", source })?;
        Ok(Pictures { svg: svg?, png: png?, pdf, csv })
    }
}
