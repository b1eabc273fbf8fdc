//! Pictures without axes of ours: outlines, texts and maps at places that somebody else has chosen.

use crate::color::Color;
use crate::geometry::{Point, Rect, clip_polygon, clip_polyline};
use crate::path::Path;
use crate::scene::{Dash, Item, Raster, Scene, Stroke};
use crate::text::TextLayout;

/// A picture of shapes at given places, in points from the upper left corner.
///
/// ```
/// use kingpin_figure::{Drawing, Shape, ShapeStyle, palette};
/// let mut drawing = Drawing::new(90.0, 60.0, "A disk").paper(palette::WHITE);
/// let style = ShapeStyle { fill: Some(palette::BLUE), ..ShapeStyle::default() };
/// drawing.shape(Shape::Circle { center: (45.0, 30.0).into(), radius: 20.0 }, style);
/// assert!(drawing.to_pdf().starts_with(b"%PDF"));
/// ```
#[derive(Debug, Clone)]
pub struct Drawing {
    scene: Scene,
}

/// What is drawn.
#[derive(Debug, Clone, PartialEq)]
pub enum Shape {
    /// Lines through points.
    Lines(Vec<Vec<Point>>),
    /// A polygon; its last corner is joined to the first.
    Polygon(Vec<Point>),
    /// A circle.
    Circle {
        /// Its centre.
        center: Point,
        /// Its radius.
        radius: f64,
    },
}

/// How a shape is drawn; without anything it is not seen.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct ShapeStyle {
    /// The colour inside.
    pub fill: Option<Color>,
    /// Colour, width and style of its line.
    pub stroke: Option<(Color, f64, Dash)>,
    /// The left upper and the right lower corner of the window beyond which it is not seen.
    pub window: Option<[Point; 2]>,
}

/// A text as it stands, without markup.
#[derive(Debug, Clone, PartialEq)]
pub struct PlacedText {
    /// What it says.
    pub text: String,
    /// Where its baseline is.
    pub at: Point,
    /// Size of the font.
    pub size: f64,
    /// Which part of its width lies before that place: 0 where it begins there, 1 where it ends there.
    pub anchor: f64,
    /// How far it is turned, clockwise.
    pub degrees: f64,
    /// The colour.
    pub color: Color,
}

impl Drawing {
    /// An empty picture; the description is the title of its file.
    pub fn new(width: f64, height: f64, description: impl Into<String>) -> Self {
        Self { scene: Scene::new(width, height, description.into()) }
    }

    /// The colour of the paper, white unless given.
    pub fn paper(mut self, color: Color) -> Self {
        self.scene.paper = color;
        self
    }

    /// Draws a shape over what is there.
    pub fn shape(&mut self, shape: Shape, style: ShapeStyle) {
        let window = style.window.map(|[first, last]| Rect::new(first.x, first.y, last.x, last.y));
        let Some(path) = outline(shape, window) else { return };
        if let Some(color) = style.fill {
            self.scene.fill(path.clone(), color);
        }
        if let Some((color, width, dash)) = style.stroke {
            self.scene.stroke(path, Stroke { color, width, dash });
        }
    }

    /// Writes a text over what is there.
    pub fn text(&mut self, placed: &PlacedText) {
        let layout = TextLayout::new(&placed.text.replace('$', "\\$"), placed.size);
        let (sine, cosine) = placed.degrees.to_radians().sin_cos();
        let before = placed.anchor * layout.width;
        let at = placed.at.offset(-before * cosine, -before * sine);
        self.scene.text(layout, at, placed.degrees, placed.color, None);
    }

    /// Lays a map of pixels (red, green, blue, opacity; first row on top) between two corners. What has no whole rows is not drawn.
    pub fn map(&mut self, [first, last]: [Point; 2], columns: usize, pixels: Vec<[u8; 4]>) {
        if columns == 0 || pixels.is_empty() || !pixels.len().is_multiple_of(columns) {
            return;
        }
        let raster = Raster { columns, rows: pixels.len() / columns, pixels, is_scale: false };
        self.scene.items.push(Item::Raster { frame: Rect::new(first.x, first.y, last.x, last.y), raster });
    }

    /// The picture as PDF.
    pub fn to_pdf(&self) -> Vec<u8> {
        crate::pdf::write(&self.scene)
    }
}

/// The part of a shape that is seen in a window.
fn outline(shape: Shape, window: Option<Rect>) -> Option<Path> {
    let mut path = Path::default();
    match (shape, window) {
        (Shape::Lines(lines), None) => lines.iter().for_each(|line| path.add_polyline(line)),
        (Shape::Lines(lines), Some(window)) => {
            let pieces = lines.iter().flat_map(|line| clip_polyline(line, &window));
            pieces.for_each(|piece| path.add_polyline(&piece));
        }
        (Shape::Polygon(corners), None) => path = Path::polygon(&corners),
        (Shape::Polygon(corners), Some(window)) => {
            let corners = clip_polygon(&corners, &window);
            path = if corners.is_empty() { path } else { Path::polygon(&corners) };
        }
        (Shape::Circle { center, .. }, Some(window)) if !window.contains(center) => {}
        (Shape::Circle { center, radius }, _) => path = Path::circle(center, radius),
    }
    (!path.segments.is_empty()).then_some(path)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::color::palette;

    fn drawing() -> Drawing {
        Drawing::new(100.0, 50.0, "")
    }

    fn stroked() -> ShapeStyle {
        ShapeStyle { stroke: Some((palette::BLACK, 1.0, Dash::Solid)), ..ShapeStyle::default() }
    }

    #[test]
    fn what_leaves_the_window_is_cut_off() {
        let style =
            ShapeStyle { window: Some([Point::new(10.0, 10.0), Point::new(20.0, 20.0)]), ..stroked() };
        let mut drawing = drawing();
        drawing.shape(Shape::Lines(vec![vec![Point::new(0.0, 15.0), Point::new(90.0, 15.0)]]), style);
        let Item::Shape { path, .. } = &drawing.scene.items[0] else { panic!() };
        assert_eq!(path, &Path::polyline(&[Point::new(10.0, 15.0), Point::new(20.0, 15.0)]));
        drawing.shape(Shape::Circle { center: Point::new(50.0, 15.0), radius: 2.0 }, style);
        assert_eq!(drawing.scene.items.len(), 1);
    }

    #[test]
    fn a_turned_text_ends_where_it_should() {
        let mut drawing = drawing();
        let text = PlacedText {
            text: "$v_0$".to_owned(),
            at: Point::new(5.0, 5.0),
            size: 10.0,
            anchor: 1.0,
            degrees: 90.0,
            color: palette::BLACK,
        };
        drawing.text(&text);
        let Item::Text { layout, at, .. } = &drawing.scene.items[0] else { panic!() };
        // Dollars are no markup.
        assert_eq!(layout.glyphs.len(), 5);
        assert!((at.y - (5.0 - layout.width)).abs() < 1e-9 && (at.x - 5.0).abs() < 1e-9);
    }

    #[test]
    fn a_map_without_whole_rows_is_not_drawn() {
        let mut drawing = drawing();
        let corners = [Point::new(0.0, 0.0), Point::new(9.0, 9.0)];
        drawing.map(corners, 2, vec![[0; 4]; 3]);
        drawing.map(corners, 0, vec![[0; 4]; 3]);
        assert!(drawing.scene.items.is_empty());
        drawing.map(corners, 2, vec![[0; 4]; 4]);
        assert_eq!(drawing.scene.items.len(), 1);
    }
}
