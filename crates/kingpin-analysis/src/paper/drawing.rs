//! A figure of the paper as it is drawn and written.

use super::data::Data;
use crate::error::Error;
use kingpin_figure::Figure;

/// Resolution of the PNG files in dots per inch.
const DPI: f64 = 300.0;

/// A figure with its number, its data, and its caption in HTML.
pub(super) struct Drawing {
    pub number: u8,
    pub figure: Figure,
    pub data: Data,
    pub caption: String,
}

/// A figure in all its formats.
pub(super) struct Pictures {
    pub svg: String,
    pub png: Vec<u8>,
    pub pdf: Vec<u8>,
}

impl Drawing {
    pub(super) fn pictures(&self) -> Result<Pictures, Error> {
        let vectors = || (self.figure.to_svg(), self.figure.to_pdf());
        let ((svg, pdf), png) = rayon::join(vectors, || self.figure.to_png(DPI));
        Ok(Pictures { svg: svg?, png: png?, pdf })
    }
}
