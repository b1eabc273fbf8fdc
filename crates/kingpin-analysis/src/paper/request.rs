//! What of the paper is asked for, and how it is computed and written.

use super::branches::{self, Branches};
use super::claims::{self, Claim, Computed};
use super::drawing::{Drawing, Pictures};
use super::numbers::number;
use super::page::page;
use super::result::PaperResult;
use super::rolling_limit::RollingLimits;
use super::stability_chart::StabilityChart;
use super::tasks::Tasks;
use super::uniform_motion::UniformMotions;
use super::{diagrams_in_space, turning_radii};
use crate::error::Error;
use crate::folder;
use crate::page::PageFigure;
use arclength_analysis::Control;
use kingpin::parallel;
use kingpin::{Key, Wheel};
use serde::{Deserialize, Serialize};
use std::path::PathBuf;

/// The figures of the paper that are computed.
const FIGURES: [u8; 5] = [2, 3, 4, 5, 6];

/// Figures 2 to 6 of the paper with their data, and a report on what the paper says.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct PaperRequest {
    /// One figure only, by its number; everything otherwise.
    pub figure: Option<u8>,
    /// The folder for the files; it is created where it is missing.
    pub out: PathBuf,
}

impl Default for PaperRequest {
    fn default() -> Self {
        Self { figure: None, out: "paper".into() }
    }
}

impl PaperRequest {
    /// Computes and draws what is asked for, and writes it when all is ready.
    ///
    /// # Errors
    /// What could not be computed or written; then no file was written.
    pub fn run(&self, control: &Control<'_>) -> Result<PaperResult, Error> {
        if let Some(number) = self.figure.filter(|number| !FIGURES.contains(number)) {
            let allowed = "2, 3, 4, 5 or 6";
            return Err(Error::invalid(
                &["figure"],
                number.to_string(),
                "not a computed figure of the paper",
                allowed,
            ));
        }
        folder::prepare(&self.out)?;
        let (drawings, claims) = match self.figure {
            Some(number) => (vec![one_figure(number, control)?], Vec::new()),
            None => everything(control)?,
        };
        let pictures: Vec<Pictures> = parallel::try_map(&drawings, Drawing::pictures)?;
        let mut contents = Vec::new();
        if self.figure.is_none() {
            let figures: Vec<PageFigure> = drawings
                .iter()
                .zip(&pictures)
                .map(|(drawing, pictures)| PageFigure {
                    number: drawing.number,
                    svg: &pictures.svg,
                    caption: &drawing.caption,
                })
                .collect();
            let page = page(&figures, &claims, &parameters_of_the_wheel());
            contents.push(("report.html".to_owned(), page.into_bytes()));
        }
        for (drawing, Pictures { svg, png, pdf }) in drawings.iter().zip(pictures) {
            let name = |ending: &str| format!("figure{}.{ending}", drawing.number);
            contents.push((name("svg"), svg.into_bytes()));
            contents.push((name("png"), png));
            contents.push((name("pdf"), pdf));
            contents.push((name("csv"), drawing.data.to_csv().into_bytes()));
        }
        Ok(PaperResult { files: folder::write(&self.out, &contents)?, claims })
    }
}

fn one_figure(number: u8, control: &Control<'_>) -> Result<Drawing, Error> {
    let tasks = Tasks::new(control, branches::TASKS);
    match number {
        2 => Ok(UniformMotions::compute()?.drawing()),
        3 => StabilityChart::compute()?.drawing(),
        4 => Ok(RollingLimits::compute()?.drawing()),
        5 => diagrams_in_space::drawing(&Branches::compute(&tasks)?),
        _ => turning_radii::drawing(&Branches::compute(&tasks)?),
    }
}

/// All figures and statements.
fn everything(control: &Control<'_>) -> Result<(Vec<Drawing>, Vec<Claim>), Error> {
    let tasks = Tasks::new(control, branches::TASKS + claims::GROUPS + 1);
    let (branches, rest) = rayon::join(
        || Branches::compute(&tasks),
        || {
            let rest = (UniformMotions::compute()?, StabilityChart::compute()?, RollingLimits::compute()?);
            tasks.step()?;
            Ok::<_, Error>(rest)
        },
    );
    let (branches, (motions, chart, limits)) = (branches?, rest?);
    let computed = Computed { motions: &motions, chart: &chart, limits: &limits, branches: &branches };
    let claims = claims::all(&computed, &tasks)?;
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
        let value = number(wheel.get(key), 6);
        match key.symbol().split_once('_') {
            Some((letter, index)) => format!("<i>{letter}</i><sub>{index}</sub> = {value} {unit}"),
            None => format!("<i>{}</i> = {value} {unit}", key.symbol()),
        }
    };
    shown.map(parameter).join(", ")
}
