//! Pictures that the page has drawn by itself, as PDF files.

use crate::failure::Failure;
use crate::routes::Routes;
use crate::sent_files::parse;
use crate::work::Work;
use axum::body::Bytes;
use axum::extract::State;
use axum::http::StatusCode;
use axum::http::header::CONTENT_TYPE;
use axum::response::{IntoResponse, Response};
use kingpin_figure::{Color, Dash, Drawing, PlacedText, Point, Shape, ShapeStyle};
use serde::Deserialize;

/// Largest side of a drawing, in points.
const LARGEST_SIDE: f64 = 5000.0;

/// Shapes at places in points from the upper left corner.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct DrawingRequest {
    width: f64,
    height: f64,
    /// What it shows.
    title: String,
    paper: Rgba,
    items: Vec<DrawnItem>,
}

/// Red, green and blue from 0 to 255, opacity from 0 to 1.
type Rgba = [f64; 4];
/// Left, top, right, bottom.
type Corners = [f64; 4];

#[derive(Debug, Deserialize)]
#[serde(tag = "kind", rename_all = "lowercase")]
enum DrawnItem {
    Lines {
        lines: Vec<Vec<[f64; 2]>>,
        #[serde(flatten)]
        style: Style,
    },
    Polygon {
        corners: Vec<[f64; 2]>,
        #[serde(flatten)]
        style: Style,
    },
    Circle {
        center: [f64; 2],
        radius: f64,
        #[serde(flatten)]
        style: Style,
    },
    Text {
        text: String,
        at: [f64; 2],
        size: f64,
        anchor: f64,
        degrees: f64,
        color: Rgba,
    },
    Raster {
        frame: Corners,
        columns: usize,
        pixels: Vec<u8>,
    },
}

#[derive(Debug, Deserialize)]
struct Style {
    fill: Option<Rgba>,
    stroke: Option<Line>,
    clip: Option<Corners>,
}

#[derive(Debug, Deserialize)]
struct Line {
    color: Rgba,
    width: f64,
    dashed: bool,
}

fn color([red, green, blue, opacity]: Rgba) -> Color {
    // What is outside the range is cut off.
    Color::rgb(red as u8, green as u8, blue as u8).with_opacity(opacity.clamp(0.0, 1.0))
}

fn corners([left, top, right, bottom]: Corners) -> [Point; 2] {
    [Point::new(left, top), Point::new(right, bottom)]
}

fn points(places: Vec<[f64; 2]>) -> Vec<Point> {
    places.into_iter().map(Point::from).collect()
}

impl Style {
    fn shown(self) -> ShapeStyle {
        let line = |line: Line| {
            (color(line.color), line.width, if line.dashed { Dash::Dashed } else { Dash::Solid })
        };
        ShapeStyle {
            fill: self.fill.map(color),
            stroke: self.stroke.map(line),
            window: self.clip.map(corners),
        }
    }
}

impl DrawingRequest {
    fn pdf(self) -> Result<Vec<u8>, Failure> {
        let fits = |side: f64| side > 0.0 && side <= LARGEST_SIDE;
        if !fits(self.width) || !fits(self.height) {
            let message = format!(
                "width {}, height {}: no size of a picture; allowed: up to {LARGEST_SIDE} points",
                self.width, self.height
            );
            return Err(Failure::new(StatusCode::UNPROCESSABLE_ENTITY, message));
        }
        let mut drawing = Drawing::new(self.width, self.height, self.title).paper(color(self.paper));
        for item in self.items {
            match item {
                DrawnItem::Lines { lines, style } => {
                    drawing.shape(Shape::Lines(lines.into_iter().map(points).collect()), style.shown());
                }
                DrawnItem::Polygon { corners, style } => {
                    drawing.shape(Shape::Polygon(points(corners)), style.shown());
                }
                DrawnItem::Circle { center, radius, style } => {
                    drawing.shape(Shape::Circle { center: center.into(), radius }, style.shown());
                }
                DrawnItem::Text { text, at, size, anchor, degrees, color: ink } => {
                    let at = at.into();
                    drawing.text(&PlacedText { text, at, size, anchor, degrees, color: color(ink) });
                }
                DrawnItem::Raster { frame, columns, pixels } => {
                    let (whole, _) = pixels.as_chunks::<4>();
                    drawing.map(corners(frame), columns, whole.to_vec());
                }
            }
        }
        Ok(drawing.to_pdf())
    }
}

/// The route of drawings.
pub(crate) fn drawing_routes() -> Routes {
    Routes::new().post("/api/drawing", draw)
}

async fn draw(State(work): State<Work>, body: Bytes) -> Result<Response, Failure> {
    let request = parse::<DrawingRequest>(&body)?;
    let pdf = work.answer(move |_| request.pdf()).await?;
    Ok(([(CONTENT_TYPE, "application/pdf")], pdf).into_response())
}
