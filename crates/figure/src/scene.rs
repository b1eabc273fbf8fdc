//! What is to be drawn, in points (1/72 inch) on a page with y downwards: the common ground of the SVG, PNG and PDF
//! writers. It holds only filled and stroked outlines, rasters and placed glyphs.

use crate::color::Color;
use crate::geometry::{Point, Rect};
use crate::path::Path;
use crate::text::TextLayout;

/// A picture ready for a writer.
#[derive(Debug, Clone)]
pub(crate) struct Scene {
    pub width: f64,
    pub height: f64,
    pub description: String,
    /// What is to be seen, in sentences.
    pub detail: String,
    /// The colour of the paper.
    pub paper: Color,
    pub items: Vec<Item>,
}

#[derive(Debug, Clone)]
pub(crate) enum Item {
    Shape { path: Path, fill: Option<Color>, stroke: Option<Stroke> },
    Raster { frame: Rect, raster: Raster },
    Text { layout: TextLayout, at: Point, degrees: f64, color: Color, halo: Option<Halo> },
}

#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Stroke {
    pub color: Color,
    pub width: f64,
    pub dash: Dash,
}

/// The line style of a curve.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Dash {
    /// A continuous line: stable solutions.
    #[default]
    Solid,
    /// Dashes: unstable solutions.
    Dashed,
    /// Dots.
    Dotted,
    /// Dashes and dots in turn.
    DashDotted,
}

impl Dash {
    /// Lengths of dashes and gaps in turn for a line of the given width, in points.
    pub(crate) fn pattern(self, width: f64) -> &'static [f64] {
        // Two sizes keep thin and thick lines readable; a pattern scaled with the width would leave hairlines grey.
        match (self, width < 0.8) {
            (Dash::Solid, _) => &[],
            (Dash::Dashed, true) => &[3.0, 1.8],
            (Dash::Dashed, false) => &[4.0, 2.2],
            (Dash::Dotted, true) => &[0.8, 1.4],
            (Dash::Dotted, false) => &[1.1, 1.7],
            (Dash::DashDotted, true) => &[4.0, 1.4, 0.8, 1.4],
            (Dash::DashDotted, false) => &[5.0, 1.7, 1.1, 1.7],
        }
    }
}

/// A rim around text that keeps it readable on curves.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Halo {
    pub color: Color,
    /// How far the rim reaches beyond the glyphs.
    pub width: f64,
}

/// A grid of opaque or transparent pixels, first row on top.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Raster {
    pub columns: usize,
    pub rows: usize,
    /// Red, green, blue and opacity of each pixel, row by row.
    pub pixels: Vec<[u8; 4]>,
    /// Whether its colours are the same on any paper.
    pub is_scale: bool,
}

impl Scene {
    /// An empty picture on white paper.
    pub(crate) fn new(width: f64, height: f64, description: String) -> Self {
        let (detail, paper) = (String::new(), crate::color::palette::WHITE);
        Self { width, height, description, detail, paper, items: Vec::new() }
    }

    pub(crate) fn stroke(&mut self, path: Path, stroke: Stroke) {
        if !path.segments.is_empty() {
            self.items.push(Item::Shape { path, fill: None, stroke: Some(stroke) });
        }
    }

    pub(crate) fn fill(&mut self, path: Path, color: Color) {
        if !path.segments.is_empty() {
            self.items.push(Item::Shape { path, fill: Some(color), stroke: None });
        }
    }

    pub(crate) fn text(
        &mut self,
        layout: TextLayout,
        at: Point,
        degrees: f64,
        color: Color,
        halo: Option<Halo>,
    ) {
        if !layout.glyphs.is_empty() {
            self.items.push(Item::Text { layout, at, degrees, color, halo });
        }
    }
}
