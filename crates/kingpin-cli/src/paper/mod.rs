//! `kingpin paper`: figures 2 to 6 of the paper, and every statement of its text beside what was computed.
//!
//! Each figure has a file here that computes and draws it. The statements are in [`claims`]; what is said of them
//! follows from numbers computed in the same run. [`run`] does everything and writes the files when all are ready.

mod data;
mod files;
mod rolling_limit;
mod stability_chart;
mod uniform_motion;

use data::Data;
use kingpin::chart::Observer;
use kingpin::{Key, KingpinError, Wheel};
use kingpin_figure::{Color, Figure, FigureError, palette};
use rayon::prelude::*;
use serde::Serialize;
use std::path::PathBuf;

/// Turning radii of figures 3 and 6, in m.
const RADII: [f64; 5] = [0.5, 1.0, 2.0, 5.0, f64::INFINITY];
/// Resolution of the PNG files in dots per inch.
const DPI: f64 = 300.0;

/// What `kingpin paper` was asked for.
#[derive(Clone, Debug, PartialEq)]
pub struct PaperOptions {
    /// One figure only, by its number; everything otherwise.
    pub figure: Option<u8>,
    /// The folder for the files; it is created where it is missing.
    pub out: PathBuf,
}

/// What was written.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Report {
    /// The files.
    pub files: Vec<PathBuf>,
}

/// Why there is no report.
#[derive(Debug, thiserror::Error)]
pub enum PaperError {
    /// There is no such figure.
    #[error("--figure {0}: the paper has no such result; allowed: 2, 3, 4, 5 and 6")]
    UnknownFigure(u8),
    /// The wheel has no such motion.
    #[error(transparent)]
    Wheel(#[from] KingpinError),
    /// Eigenvalues did not converge.
    #[error(transparent)]
    Eigenvalues(#[from] arclength::linear::eigenvalues::EigenvalueError),
    /// Something that the paper shows was not found.
    #[error("no {what} was found at {place}")]
    NotFound {
        /// What was looked for.
        what: &'static str,
        /// Where.
        place: String,
    },
    /// A figure could not be drawn.
    #[error(transparent)]
    Figure(#[from] FigureError),
    /// A file could not be written.
    #[error("--out {}: cannot write there: {source}; no file was left behind", path.display())]
    Unwritable {
        /// The file or folder.
        path: PathBuf,
        /// The cause.
        source: std::io::Error,
    },
}

/// A figure with its number, its data, and its caption in HTML.
struct Drawing {
    number: u8,
    figure: Figure,
    data: Data,
    caption: String,
}

/// Computes and draws what is asked for, and writes it.
///
/// # Errors
/// [`PaperError`]; then no file was written.
pub fn run(options: &PaperOptions, _observer: &Observer) -> Result<Report, PaperError> {
    files::prepare(&options.out)?;
    let drawings = vec![
        uniform_motion::UniformMotions::compute()?.drawing(),
        stability_chart::StabilityChart::compute()?.drawing()?,
        rolling_limit::RollingLimits::compute()?.drawing(),
    ];
    let pictures: Vec<[(String, Vec<u8>); 3]> =
        drawings.par_iter().map(Drawing::files).collect::<Result<_, _>>()?;
    let all: Vec<(String, Vec<u8>)> = pictures.into_iter().flatten().collect();
    Ok(Report { files: files::write(&options.out, &all)? })
}

impl Drawing {
    fn files(&self) -> Result<[(String, Vec<u8>); 3], PaperError> {
        let (svg, png) = rayon::join(|| self.figure.to_svg(), || self.figure.to_png(DPI));
        let name = |ending: &str| format!("figure{}.{ending}", self.number);
        Ok([
            (name("svg"), svg?.into_bytes()),
            (name("png"), png?),
            (name("csv"), self.data.to_csv().into_bytes()),
        ])
    }
}

/// The paper's wheel at a speed in m/s, a caster length and a turning radius in m.
fn paper_wheel(speed: f64, caster_length: f64, radius: f64) -> Result<Wheel, KingpinError> {
    Wheel::default().with(Key::V, speed)?.with(Key::L, caster_length)?.with(Key::TurningRadius, radius)
}

/// The colour of a turning radius, the same in all figures.
fn radius_color(radius: f64) -> Color {
    let colors = [palette::VERMILION, palette::BLACK, palette::BLUE, palette::GREEN, palette::PURPLE];
    RADII.iter().position(|candidate| *candidate == radius).map_or(palette::GREY, |index| colors[index])
}

/// The name of a turning radius in the figures.
fn radius_label(radius: f64) -> String {
    if radius.is_infinite() { "$r=\\infty$".to_owned() } else { format!("$r={radius}$ m") }
}
