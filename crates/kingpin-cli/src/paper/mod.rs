//! `kingpin paper`: figures 2 to 6 of the paper, and every statement of its text beside what was computed.
//!
//! Each figure has a file here that computes and draws it. The statements are in [`claims`]; what is said of them
//! follows from numbers computed in the same run. [`run`] does everything and writes the files when all are ready.

mod branches;
pub mod claims;
mod data;
mod diagrams_in_space;
mod files;
mod page;
mod rolling_limit;
mod stability_chart;
#[cfg(test)]
mod tests;
mod turning_radii;
mod uniform_motion;

use branches::Branches;
use claims::{Claim, Computed};
use data::Data;
use kingpin::chart::Observer;
use kingpin::simulation::SimulationError;
use kingpin::{Key, KingpinError, Wheel};
use kingpin_figure::{Color, Figure, FigureError, palette};
use page::PageFigure;
use rayon::prelude::*;
use rolling_limit::RollingLimits;
use serde::Serialize;
use stability_chart::StabilityChart;
use std::ops::ControlFlow;
use std::path::PathBuf;
use std::sync::atomic::{AtomicUsize, Ordering};
use uniform_motion::UniformMotions;

/// The figures of the paper that are computed.
const FIGURES: [u8; 5] = [2, 3, 4, 5, 6];
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
    /// The statements of the paper; none where one figure only was asked for.
    pub claims: Vec<Claim>,
}

/// Why there is no report.
#[derive(Debug, thiserror::Error)]
pub enum PaperError {
    /// There is no such figure.
    #[error("--figure {0}: not a computed figure of the paper; allowed: 2, 3, 4, 5 or 6")]
    UnknownFigure(u8),
    /// The wheel has no such motion.
    #[error(transparent)]
    Wheel(#[from] KingpinError),
    /// A motion could not be simulated.
    #[error(transparent)]
    Simulation(#[from] SimulationError),
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
    /// A branch of cycles could not be followed to the ends of its interval.
    #[error("the branch of cycles at {place} ends early: {reason}")]
    BranchEnds {
        /// Where.
        place: String,
        /// Why.
        reason: String,
    },
    /// The observer asked to stop.
    #[error("cancelled; no file was written")]
    Cancelled,
    /// A figure could not be drawn.
    #[error(transparent)]
    Figure(#[from] FigureError),
    /// A file could not be written.
    #[error("--out: cannot write {}: {source}; give a folder in which files can be made", path.display())]
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

/// Computes and draws what is asked for, and writes it. `observer` is told the part that is done and may cancel.
///
/// # Errors
/// [`PaperError`]; then no file was written.
pub fn run(options: &PaperOptions, observer: &Observer) -> Result<Report, PaperError> {
    if let Some(number) = options.figure.filter(|number| !FIGURES.contains(number)) {
        return Err(PaperError::UnknownFigure(number));
    }
    files::prepare(&options.out)?;
    let (drawings, claims) = match options.figure {
        Some(number) => (vec![one_figure(number, observer)?], Vec::new()),
        None => everything(observer)?,
    };
    let pictures: Vec<Pictures> = drawings.par_iter().map(Drawing::pictures).collect::<Result<_, _>>()?;
    let mut contents = Vec::new();
    if options.figure.is_none() {
        let figures: Vec<PageFigure> = drawings
            .iter()
            .zip(&pictures)
            .map(|(drawing, pictures)| PageFigure {
                number: drawing.number,
                svg: &pictures.svg,
                caption: &drawing.caption,
            })
            .collect();
        let page = page::page(&figures, &claims, &parameters_of_the_wheel());
        contents.push(("report.html".to_owned(), page.into_bytes()));
    }
    for (drawing, Pictures { svg, png }) in drawings.iter().zip(pictures) {
        let name = |ending: &str| format!("figure{}.{ending}", drawing.number);
        contents.push((name("svg"), svg.into_bytes()));
        contents.push((name("png"), png));
        contents.push((name("csv"), drawing.data.to_csv().into_bytes()));
    }
    Ok(Report { files: files::write(&options.out, &contents)?, claims })
}

fn one_figure(number: u8, observer: &Observer) -> Result<Drawing, PaperError> {
    let progress = Progress::new(observer, branches::TASKS);
    match number {
        2 => Ok(UniformMotions::compute()?.drawing()),
        3 => StabilityChart::compute()?.drawing(),
        4 => Ok(RollingLimits::compute()?.drawing()),
        5 => diagrams_in_space::drawing(&Branches::compute(&progress)?),
        _ => turning_radii::drawing(&Branches::compute(&progress)?),
    }
}

/// All figures and statements.
fn everything(observer: &Observer) -> Result<(Vec<Drawing>, Vec<Claim>), PaperError> {
    let progress = Progress::new(observer, branches::TASKS + claims::GROUPS + 1);
    let (branches, rest) = rayon::join(
        || Branches::compute(&progress),
        || {
            let rest = (UniformMotions::compute()?, StabilityChart::compute()?, RollingLimits::compute()?);
            progress.step()?;
            Ok::<_, PaperError>(rest)
        },
    );
    let (branches, (motions, chart, limits)) = (branches?, rest?);
    let computed = Computed { motions: &motions, chart: &chart, limits: &limits, branches: &branches };
    let claims = claims::all(&computed, &progress)?;
    let drawings = vec![
        motions.drawing(),
        chart.drawing()?,
        limits.drawing(),
        diagrams_in_space::drawing(&branches)?,
        turning_radii::drawing(&branches)?,
    ];
    Ok((drawings, claims))
}

/// The wheel of the paper, in HTML.
fn parameters_of_the_wheel() -> String {
    let wheel = Wheel::default();
    let shown = [Key::MW, Key::MC, Key::JWxi, Key::JWzeta, Key::JCz, Key::WheelRadius, Key::LC, Key::K];
    let parameter = |key: Key| {
        let unit = key.unit().replace("^2", "²");
        let value = claims::number(wheel.get(key), 6);
        match key.symbol().split_once('_') {
            Some((letter, index)) => format!("<i>{letter}</i><sub>{index}</sub> = {value} {unit}"),
            None => format!("<i>{}</i> = {value} {unit}", key.symbol()),
        }
    };
    shown.map(parameter).join(", ")
}

/// Counts the tasks that are done and tells the observer.
struct Progress<'a> {
    observer: &'a Observer<'a>,
    done: AtomicUsize,
    total: usize,
}

impl<'a> Progress<'a> {
    fn new(observer: &'a Observer<'a>, total: usize) -> Self {
        Self { observer, done: AtomicUsize::new(0), total }
    }

    fn step(&self) -> Result<(), PaperError> {
        let done = self.done.fetch_add(1, Ordering::Relaxed) + 1;
        match (self.observer)(done as f64 / self.total as f64) {
            ControlFlow::Continue(()) => Ok(()),
            ControlFlow::Break(()) => Err(PaperError::Cancelled),
        }
    }
}

/// A figure in both its formats.
struct Pictures {
    svg: String,
    png: Vec<u8>,
}

impl Drawing {
    fn pictures(&self) -> Result<Pictures, PaperError> {
        let (svg, png) = rayon::join(|| self.figure.to_svg(), || self.figure.to_png(DPI));
        Ok(Pictures { svg: svg?, png: png? })
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
