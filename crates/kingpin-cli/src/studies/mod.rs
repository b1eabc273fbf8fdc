//! `kingpin study`: what the paper leaves open, computed and drawn.
//!
//! Each study has a file here that computes, draws and tells its findings; figures are numbered from 7 on, after those of
//! the paper. A study returns plain data; [`write()`] turns them into files.

mod animation;
mod basin;
mod damping;
mod isola;
mod sliding;
mod step_steer;

use crate::error::Error;
use kingpin::basin::Fate;
use kingpin::{Key, KingpinError, Wheel};
use kingpin_figure::{Color, Figure, palette};
use kingpin_report::Cell;
use kingpin_report::Columns;
use kingpin_report::ReportError;
use kingpin_report::files::write_whole;
use std::path::{Path, PathBuf};

/// Resolution of the PNG files in dots per inch.
const DPI: f64 = 300.0;

/// Significant digits of findings.
const DIGITS: usize = 9;

/// The studies.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Name {
    /// Damping and the boundary of stability.
    Damping,
    /// Branches of cycles that are detached from the uniform motion.
    Isola,
    /// Large shimmy with sliding phases.
    Sliding,
    /// Where kicked wheels end.
    Basin,
    /// From straight towing to a curve at once.
    StepSteer,
}

impl Name {
    /// All studies in the order of their figures.
    pub const ALL: [Self; 5] = [Self::Isola, Self::Sliding, Self::Damping, Self::Basin, Self::StepSteer];

    /// The name as it is given to the command.
    pub const fn as_str(self) -> &'static str {
        match self {
            Self::Damping => "damping",
            Self::Isola => "isola",
            Self::Sliding => "sliding",
            Self::Basin => "basin",
            Self::StepSteer => "step-steer",
        }
    }

    /// What it is about.
    pub const fn subject(self) -> &'static str {
        match self {
            Self::Damping => "the stability boundary with dampers",
            Self::Isola => "large motions detached from straight running",
            Self::Sliding => "large stable shimmy with sliding phases",
            Self::Basin => "where kicked wheels end",
            Self::StepSteer => "driving straight, then suddenly round a curve",
        }
    }

    /// Computes and draws the study; `progress` is told the part that is done.
    ///
    /// # Errors
    /// What could not be computed.
    pub fn compute(self, progress: &(dyn Fn(f64) + Sync)) -> Result<Study, Error> {
        match self {
            Self::Isola => isola::study(progress),
            Self::Sliding => sliding::study(progress),
            Self::Damping => damping::study(progress),
            Self::Basin => basin::study(progress),
            Self::StepSteer => step_steer::study(progress),
        }
    }
}

/// What a study gives.
#[derive(Debug)]
pub struct Study {
    /// The numbers that matter, in the order in which they are told.
    pub findings: Vec<Finding>,
    /// Its figures.
    pub drawings: Vec<Drawing>,
    /// Names and contents of further pictures.
    pub pictures: Vec<(&'static str, String)>,
}

/// A number with what it is.
#[derive(Clone, Debug, PartialEq)]
pub struct Finding {
    /// What it is, with the parameters at which it was found.
    pub quantity: String,
    /// The value in SI units.
    pub value: f64,
    /// The unit; empty where there is none.
    pub unit: &'static str,
}

impl Finding {
    fn new(quantity: impl Into<String>, value: f64, unit: &'static str) -> Self {
        Self { quantity: quantity.into(), value, unit }
    }

    /// The value as it is shown in tables.
    pub fn cell(&self) -> Cell {
        Cell::Digits(self.value, DIGITS)
    }
}

/// A figure with its number and its data.
#[derive(Debug)]
pub struct Drawing {
    /// Its number; those up to 6 are the paper's.
    pub number: u8,
    /// The figure.
    pub figure: Figure,
    /// The data; columns are named with units in brackets.
    pub data: Columns,
}

/// Writes figures, data and pictures into a folder that exists; every file appears whole or not at all.
///
/// # Errors
/// [`Error::Unwritable`] and those of the drawing.
pub fn write(
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

fn not_found(what: &str, place: &str) -> Error {
    Error::NothingFound(format!("no {what} was found at {place}"))
}

/// The colour of a fate, the same in all figures.
fn fate_color(fate: Fate) -> Color {
    match fate {
        Fate::UniformMotion => palette::SKY_BLUE.lightened(0.55),
        Fate::Shimmy => palette::VERMILION,
        Fate::Tumbling => palette::ORANGE.lightened(0.35),
        Fate::Escape => palette::GREY,
        Fate::Undecided => palette::LIGHT_GREY,
    }
}

/// The paper's wheel with other values of some keys.
fn wheel(values: &[(Key, f64)]) -> Result<Wheel, KingpinError> {
    values.iter().try_fold(Wheel::default(), |wheel, &(key, value)| wheel.with(key, value))
}
