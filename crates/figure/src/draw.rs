//! Draws what a panel shows, inside its frame.

use crate::axis::Scale;
use crate::color::palette;
use crate::frame::{Frame, Margins};
use crate::geometry::{Point, Rect, clip_polygon, clip_polyline, thin};
use crate::markers::{draw_hatching, draw_marker};
use crate::panel::{Map, Panel};
use crate::placement::Obstacles;
use crate::scene::{Halo, Item, Path, Scene, Stroke};
use crate::series::CurvePiece;
use crate::style::{HALO_WIDTH, SMALL_SIZE, THINNING};
use crate::text::TextLayout;

/// Draws the panel into the rectangle of its axes.
pub(crate) fn draw_panel(scene: &mut Scene, panel: &Panel, mut frame: Frame, plot: &Rect, margins: &Margins) {
    let (x, y) = (frame.x.scale, frame.y.scale);
    let place = Place { x, y, plot: *plot };
    match &panel.map {
        Some(Map::Heat(map)) => {
            scene.items.push(Item::Raster { frame: *plot, raster: map.raster(&x, &y) });
        }
        Some(Map::Category(map)) => {
            scene.items.push(Item::Raster { frame: *plot, raster: map.raster(&x, &y) });
        }
        None => {}
    }
    for region in &panel.regions {
        let corners: Vec<Point> = region.corners.iter().map(|p| place.point(*p)).collect();
        let corners = clip_polygon(&corners, plot);
        if corners.is_empty() {
            continue;
        }
        if let Some(color) = region.fill {
            let mut closed = corners.clone();
            closed.push(corners[0]);
            let mut thinned = thin(&closed, THINNING);
            thinned.pop();
            scene.fill(Path::polygon(&thinned), color);
        }
        if let Some((color, degrees)) = region.hatching {
            draw_hatching(scene, &corners, color, degrees);
        }
    }

    let mut obstacles = Obstacles::default();
    let mut visible = Vec::with_capacity(panel.curves.len());
    for (index, curve) in panel.curves.iter().enumerate() {
        let color = panel.curve_color(index);
        let mut all = Vec::new();
        for piece in &curve.pieces {
            let pieces = place.pieces(piece);
            let mut path = Path::default();
            pieces.iter().for_each(|points| path.add_polyline(points));
            let stroke =
                Stroke { color: piece.color.unwrap_or(color), width: curve.style.width, dash: piece.dash };
            scene.stroke(path, stroke);
            all.extend(pieces);
        }
        let number = obstacles.add_curve(&all);
        visible.push((number, all));
    }
    // The frame is drawn over curves that end at it, and under markers that lie on it.
    frame.draw(scene, plot, margins);

    let shown = |p: Point| p.is_finite() && plot.expanded(0.01).contains(p);
    for markers in &panel.markers {
        for at in markers.points.iter().map(|p| place.point(*p)).filter(|p| shown(*p)) {
            draw_marker(scene, markers.marker, at);
            obstacles.add_box(around(at, 0.5 * markers.marker.size));
        }
    }
    let points: Vec<_> = panel
        .points
        .iter()
        .map(|label| (place.point(label.at), label))
        .filter(|(at, _)| shown(*at))
        .collect();
    for (at, label) in &points {
        if let Some(marker) = label.marker {
            draw_marker(scene, marker, *at);
            obstacles.add_box(around(*at, 0.5 * marker.size));
        }
    }

    let halo = Some(Halo { color: palette::WHITE, width: HALO_WIDTH });
    for note in &panel.notes {
        let at = place.point(note.at);
        if at.is_finite() {
            let layout = TextLayout::new(&note.text, SMALL_SIZE);
            let origin = layout.origin(at, note.anchor, SMALL_SIZE);
            obstacles.add_box(layout.bounds(origin));
            scene.text(layout, origin, 0.0, note.color, halo);
        }
    }
    for (index, (curve, (number, pieces))) in panel.curves.iter().zip(&visible).enumerate() {
        let style = &curve.style;
        if style.name.is_empty() || pieces.is_empty() {
            continue;
        }
        let layout = TextLayout::new(&style.name, SMALL_SIZE);
        if let Some((center, degrees)) = obstacles.along_curve(*number, pieces, style.name_at, &layout, plot)
        {
            let (sine, cosine) = degrees.to_radians().sin_cos();
            // From the centre of the text to the start of its baseline, turned with the text.
            let (dx, dy) = (-0.5 * layout.width, 0.5 * (layout.ascent - layout.descent) - 0.08 * SMALL_SIZE);
            let origin = center.offset(cosine * dx - sine * dy, sine * dx + cosine * dy);
            scene.text(layout, origin, degrees, panel.curve_color(index), halo);
        }
    }
    let legend = frame.take_legend(plot);
    let mut inside = None;
    if let Some((legend, corner)) = legend {
        match corner {
            Some(corner) => legend.draw(scene, corner, false),
            None => {
                let corner = obstacles.emptiest(legend.width, legend.height, plot);
                inside = Some((legend, corner));
            }
        }
    }
    if let Some((legend, corner)) = inside {
        legend.draw(scene, corner, true);
    }
    for (at, label) in points {
        let radius = label.marker.map_or(0.0, |marker| 0.5 * marker.size);
        let layout = TextLayout::new(&label.text, SMALL_SIZE);
        let origin = obstacles.beside_point(at, radius, &layout, plot);
        scene.text(layout, origin, 0.0, palette::BLACK, halo);
    }
}

fn around(center: Point, radius: f64) -> Rect {
    Rect::new(center.x, center.y, center.x, center.y).expanded(radius)
}

/// The mapping from data to the page.
struct Place {
    x: Scale,
    y: Scale,
    plot: Rect,
}

impl Place {
    fn point(&self, p: Point) -> Point {
        Point::new(
            self.plot.left + self.x.fraction(p.x) * self.plot.width(),
            self.plot.bottom - self.y.fraction(p.y) * self.plot.height(),
        )
    }

    /// The visible parts of a curve, without points that make no difference.
    fn pieces(&self, piece: &CurvePiece) -> Vec<Vec<Point>> {
        let points: Vec<Point> = piece.points.iter().map(|p| self.point(*p)).collect();
        clip_polyline(&points, &self.plot).iter().map(|piece| thin(piece, THINNING)).collect()
    }
}
