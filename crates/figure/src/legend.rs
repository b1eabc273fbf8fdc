//! Legends: which entries they have, how large they are, and how they are drawn.

use crate::color::{Color, palette};
use crate::geometry::{Point, Rect};
use crate::markers::draw_marker;
use crate::scene::{Dash, Path, Scene, Stroke};
use crate::series::Marker;
use crate::style::{FRAME_WIDTH, SMALL_SIZE};
use crate::text::{Anchor, TextLayout};

/// Where the legend of a panel stands.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Legend {
    /// Inside the panel where it covers least.
    #[default]
    Emptiest,
    /// Outside, to the right.
    Right,
    /// Outside, below the label of the x axis, in rows.
    Below,
    /// Nowhere.
    None,
}

/// One line of a legend.
#[derive(Debug, Clone, PartialEq)]
pub struct LegendEntry {
    pub(crate) text: String,
    pub(crate) swatch: Swatch,
}

#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Swatch {
    Line(Color, f64, Dash),
    Marker(Marker),
    Patch(Color),
    Hatching(Color),
}

impl LegendEntry {
    /// An entry that shows a line style, for example one that explains what dashes mean.
    pub fn line(text: impl Into<String>, color: Color, dash: Dash) -> Self {
        Self { text: text.into(), swatch: Swatch::Line(color, crate::series::CURVE_WIDTH, dash) }
    }

    /// An entry that shows a marker.
    pub fn marker(text: impl Into<String>, marker: Marker) -> Self {
        Self { text: text.into(), swatch: Swatch::Marker(marker) }
    }

    /// An entry that shows a filled patch.
    pub fn patch(text: impl Into<String>, color: Color) -> Self {
        Self { text: text.into(), swatch: Swatch::Patch(color) }
    }
}

const SWATCH_WIDTH: f64 = 17.0;
const SWATCH_GAP: f64 = 4.0;
const ROW_HEIGHT: f64 = 10.0;
const COLUMN_GAP: f64 = 10.0;
const INSET: f64 = 3.0;

/// A legend with its entries set and arranged.
pub(crate) struct LegendLayout {
    entries: Vec<(TextLayout, Swatch)>,
    columns: usize,
    column_width: f64,
    pub width: f64,
    pub height: f64,
}

impl LegendLayout {
    /// Arranges the entries in as many columns as fit a width; one column when no width is given.
    pub fn new(entries: &[LegendEntry], available: Option<f64>) -> Self {
        let entries: Vec<_> =
            entries.iter().map(|entry| (TextLayout::new(&entry.text, SMALL_SIZE), entry.swatch)).collect();
        let widest = entries.iter().map(|(layout, _)| layout.width).fold(0.0, f64::max);
        let column_width = SWATCH_WIDTH + SWATCH_GAP + widest;
        let fitting =
            available.map_or(1, |width| ((width + COLUMN_GAP) / (column_width + COLUMN_GAP)) as usize);
        let columns = fitting.clamp(1, entries.len().max(1));
        let rows = entries.len().div_ceil(columns);
        let width = columns as f64 * (column_width + COLUMN_GAP) - COLUMN_GAP + 2.0 * INSET;
        let height = rows as f64 * ROW_HEIGHT + 2.0 * INSET - 1.0;
        Self { entries, columns, column_width, width, height }
    }

    /// Draws the legend with its upper left corner at a point, on a white ground where it lies on the panel.
    pub fn draw(self, scene: &mut Scene, corner: Point, ground: bool) {
        if ground {
            let rect = Rect::new(corner.x, corner.y, corner.x + self.width, corner.y + self.height);
            scene.fill(Path::rectangle(&rect), palette::WHITE.with_opacity(0.85));
        }
        for (i, (layout, swatch)) in self.entries.into_iter().enumerate() {
            let (row, column) = (i / self.columns, i % self.columns);
            let left = corner.x + INSET + column as f64 * (self.column_width + COLUMN_GAP);
            let middle = corner.y + INSET + (row as f64 + 0.5) * ROW_HEIGHT - 0.5;
            draw_swatch(scene, swatch, Point::new(left, middle));
            let start = Point::new(left + SWATCH_WIDTH + SWATCH_GAP, middle);
            let origin = layout.origin(start, Anchor::Left, SMALL_SIZE);
            scene.text(layout, origin, 0.0, palette::BLACK, None);
        }
    }
}

fn draw_swatch(scene: &mut Scene, swatch: Swatch, left: Point) {
    let right = left.offset(SWATCH_WIDTH, 0.0);
    let patch = Rect::new(left.x + 2.0, left.y - 3.2, right.x - 2.0, left.y + 3.2);
    let outline = Stroke { color: palette::GREY, width: 0.5 * FRAME_WIDTH, dash: Dash::Solid };
    match swatch {
        Swatch::Line(color, width, dash) => {
            scene.stroke(Path::polyline(&[left, right]), Stroke { color, width, dash });
        }
        Swatch::Marker(marker) => draw_marker(scene, marker, left.lerp(right, 0.5)),
        Swatch::Patch(color) => {
            scene.fill(Path::rectangle(&patch), color);
            scene.stroke(Path::rectangle(&patch), outline);
        }
        Swatch::Hatching(color) => {
            crate::markers::draw_hatching(scene, &patch.corners(), color, 45.0);
            scene.stroke(Path::rectangle(&patch), outline);
        }
    }
}
