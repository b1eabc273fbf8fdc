//! Legends: which entries they have, how large they are, and how they are drawn.

use crate::color::{Color, palette};
use crate::geometry::{Point, Rect};
use crate::markers::draw_marker;
use crate::path::Path;
use crate::scene::{Dash, Scene, Stroke};
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
    /// Each entry with the place of its swatch: left end, half height, relative to the upper left corner.
    entries: Vec<(TextLayout, Swatch, Point)>,
    pub width: f64,
    pub height: f64,
}

impl LegendLayout {
    /// Arranges the entries in rows that fit a width, or below each other when no width is given.
    pub(crate) fn new(entries: &[LegendEntry], available: Option<f64>) -> Self {
        let mut placed = Vec::with_capacity(entries.len());
        let (mut left, mut row, mut widest) = (0.0, 0, 0.0_f64);
        for (i, entry) in entries.iter().enumerate() {
            let layout = TextLayout::new(&entry.text, SMALL_SIZE);
            let width = SWATCH_WIDTH + SWATCH_GAP + layout.width;
            if i > 0 && available.is_none_or(|available| left + width > available) {
                row += 1;
                left = 0.0;
            }
            let at = Point::new(INSET + left, INSET + (f64::from(row) + 0.5) * ROW_HEIGHT - 0.5);
            placed.push((layout, entry.swatch, at));
            left += width + COLUMN_GAP;
            widest = widest.max(left - COLUMN_GAP);
        }
        let height = f64::from(row + 1) * ROW_HEIGHT + 2.0 * INSET - 1.0;
        Self { entries: placed, width: widest + 2.0 * INSET, height }
    }

    /// Draws the legend with its upper left corner at a point, on a white ground where it lies on the panel.
    pub(crate) fn draw(self, scene: &mut Scene, corner: Point, ground: bool) {
        if ground {
            let rect = Rect::new(corner.x, corner.y, corner.x + self.width, corner.y + self.height);
            scene.fill(Path::rectangle(&rect), palette::WHITE.with_opacity(0.85));
        }
        for (layout, swatch, at) in self.entries {
            let left = corner.offset(at.x, at.y);
            draw_swatch(scene, swatch, left);
            let origin = layout.origin(left.offset(SWATCH_WIDTH + SWATCH_GAP, 0.0), Anchor::Left, SMALL_SIZE);
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
