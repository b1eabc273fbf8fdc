//! Pictures and files of results: the same that the command line writes.

use crate::answer::Answer;
use crate::colors::OwnColors;
use crate::failure::Failure;
use crate::look::Look;
use crate::routes::Routes;
use crate::sent_files::{Asked, parse};
use crate::work::Work;
use arclength_analysis::diagram::diagram_of;
use arclength_analysis::{Error, FilesInMemory, ResultFile};
use axum::body::Bytes;
use axum::extract::State;
use axum::http::header::CONTENT_TYPE;
use axum::response::{IntoResponse, Response};
use kingpin_figure::{Figure, Span, SvgOptions};
use kingpin_report::Report;
use serde::{Deserialize, Serialize};
use std::path::PathBuf;

/// Resolution of PNG files in dots per inch, as that of the command line.
const RESOLUTION: f64 = 300.0;

/// Least width of a picture on the page in millimetres, which says how large its text is there.
const PAGE_WIDTH: f64 = 130.0;
const POINTS_PER_MM: f64 = 72.0 / 25.4;

/// Formats in which something is saved.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "lowercase")]
enum SavedFormat {
    /// A picture for the page, with the places of its panels.
    Page,
    Svg,
    Png,
    Pdf,
    Csv,
    /// What is shown in a terminal, with the story of the run.
    Text,
}

/// Asks for a picture of results that belong together.
#[derive(Debug, Deserialize)]
struct DiagramRequest {
    /// The results, by name.
    results: Vec<PathBuf>,
    /// The states that are shown; all of them where none is named.
    #[serde(default)]
    states: Vec<String>,
    format: SavedFormat,
    /// Colours of their own.
    #[serde(default)]
    colors: OwnColors,
    #[serde(flatten)]
    look: Look,
}

/// A picture for the page.
#[derive(Debug, Serialize)]
pub struct PictureAnswer {
    svg: String,
    width: f64,
    height: f64,
    /// Where the axes of every panel stand, and what they span; nothing for a panel in space.
    panels: Vec<Option<PanelPlace>>,
}

#[derive(Debug, Serialize)]
struct PanelPlace {
    left: f64,
    top: f64,
    right: f64,
    bottom: f64,
    x: AxisSpan,
    y: AxisSpan,
}

#[derive(Debug, Serialize)]
struct AxisSpan {
    low: f64,
    high: f64,
    logarithmic: bool,
}

impl From<Span> for AxisSpan {
    fn from(Span { low, high, logarithmic }: Span) -> Self {
        Self { low, high, logarithmic }
    }
}

impl PictureAnswer {
    /// A picture with what its axes span, as wide as suits a page.
    ///
    /// # Errors
    /// It cannot be drawn.
    pub fn of(figure: &Figure) -> Result<Self, Failure> {
        // A page has more room than a column of a journal.
        let is_narrow = figure.size().0 < PAGE_WIDTH * POINTS_PER_MM;
        let figure = if is_narrow { figure.clone().width_mm(PAGE_WIDTH) } else { figure.clone() };
        let (width, height) = figure.size();
        let panel = |place: kingpin_figure::Place| PanelPlace {
            left: place.left,
            top: place.top,
            right: place.right,
            bottom: place.bottom,
            x: place.x.into(),
            y: place.y.into(),
        };
        let panels = figure.places().into_iter().map(|place| place.map(panel)).collect();
        let options = SvgOptions { fluid: true, ..SvgOptions::default() };
        Ok(Self { svg: figure.to_svg_with(options).map_err(drawing)?, width, height, panels })
    }
}

fn drawing(error: kingpin_figure::FigureError) -> Failure {
    Failure::new(axum::http::StatusCode::INTERNAL_SERVER_ERROR, error.to_string())
}

/// Routes of pictures and files of results of any model.
pub(crate) fn picture_routes() -> Routes {
    Routes::new().post("/api/diagram", draw)
}

async fn draw(State(work): State<Work>, body: Bytes) -> Result<Response, Failure> {
    let Asked { request, files } = parse::<Asked<DiagramRequest>>(&body)?;
    work.answer(move |_| request.answer(&files)).await
}

impl DiagramRequest {
    fn answer(&self, files: &FilesInMemory) -> Result<Response, Failure> {
        if self.results.is_empty() {
            return Err(Failure::bad_request("results: none is named; allowed: names of one result or more"));
        }
        let failure = |index: usize, problem: String| {
            Failure::from(Error::ResultFile { path: self.results[index].clone(), problem })
        };
        let read = |(index, path): (usize, &PathBuf)| {
            ResultFile::read_among(files, path).map_err(|problem| failure(index, problem))
        };
        let results: Vec<ResultFile> = self.results.iter().enumerate().map(read).collect::<Result<_, _>>()?;
        // A single result is saved as the command that computed it does, and a motion has no place in a diagram.
        let is_table = matches!(self.format, SavedFormat::Csv | SavedFormat::Text);
        let is_diagram = |result: &ResultFile| match result {
            ResultFile::History(_) => false,
            _ => self.format == SavedFormat::Page || !self.colors.is_empty() && !is_table,
        };
        if let [one] = &results[..]
            && self.states.is_empty()
            && !is_diagram(one)
        {
            return match one {
                ResultFile::Equilibria(result) => saved_in(self.format, self.look, result),
                ResultFile::Cycles(result) => saved_in(self.format, self.look, result),
                ResultFile::Locus(result) => saved_in(self.format, self.look, result),
                ResultFile::CycleLocus(result) => saved_in(self.format, self.look, result),
                ResultFile::History(result) => saved_in(self.format, self.look, result),
            };
        }
        let figure = diagram_of(&results, &self.states, &self.colors.of(&self.results));
        picture(self.format, self.look, figure.map_err(|(index, problem)| failure(index, problem))?)
    }
}

fn picture(format: SavedFormat, look: Look, figure: Figure) -> Result<Response, Failure> {
    let figure = look.of(figure);
    Ok(match format {
        SavedFormat::Page => Answer(PictureAnswer::of(&figure)?).into_response(),
        SavedFormat::Svg => {
            let options = SvgOptions { text: look.text, ..SvgOptions::default() };
            let text = figure.to_svg_with(options).map_err(drawing)?;
            ([(CONTENT_TYPE, "image/svg+xml")], text).into_response()
        }
        SavedFormat::Png => {
            ([(CONTENT_TYPE, "image/png")], figure.to_png(RESOLUTION).map_err(drawing)?).into_response()
        }
        SavedFormat::Pdf => ([(CONTENT_TYPE, "application/pdf")], figure.to_pdf()).into_response(),
        SavedFormat::Csv | SavedFormat::Text => {
            return Err(Failure::bad_request("several results have no table; allowed: page, svg, png, pdf"));
        }
    })
}

fn saved_in<R: Report>(format: SavedFormat, look: Look, result: &R) -> Result<Response, Failure> {
    let broken = |error: std::io::Error| {
        Failure::new(axum::http::StatusCode::INTERNAL_SERVER_ERROR, error.to_string())
    };
    let mut text = Vec::new();
    match format {
        SavedFormat::Csv => {
            result.columns().write_csv(&mut text).map_err(broken)?;
            Ok(([(CONTENT_TYPE, "text/csv; charset=utf-8")], text).into_response())
        }
        SavedFormat::Text => {
            result.write_table(&mut text).map_err(broken)?;
            if let Some(story) = result.story() {
                story.write(&mut text).map_err(broken)?;
            }
            Ok(([(CONTENT_TYPE, "text/plain; charset=utf-8")], text).into_response())
        }
        _ => match result.figure().map_err(drawing)? {
            Some(figure) => picture(format, look, figure),
            None => Err(Failure::bad_request("this result has no picture; allowed: csv, text")),
        },
    }
}

/// Answers with a result in one of the formats in which results are saved: `page`, `svg`, `png`, `pdf`, `csv` or `text`.
///
/// # Errors
/// Another format; a picture that cannot be drawn or that the result does not have.
pub fn saved<R: Report>(format: &str, look: Look, result: &R) -> Result<Response, Failure> {
    saved_in(format_named(format)?, look, result)
}

/// Answers with a picture in one of the formats of pictures: `page`, `svg`, `png` or `pdf`.
///
/// # Errors
/// Another format; a picture that cannot be drawn.
pub fn drawn(format: &str, look: Look, figure: Figure) -> Result<Response, Failure> {
    picture(format_named(format)?, look, figure)
}

fn format_named(format: &str) -> Result<SavedFormat, Failure> {
    SavedFormat::deserialize(serde::de::value::StrDeserializer::<serde::de::value::Error>::new(format))
        .map_err(|error| Failure::bad_request(format!("format: {error}")))
}
