//! Draws markers and hatching.

use crate::color::{Color, palette};
use crate::geometry::Point;
use crate::path::Path;
use crate::scene::{Dash, Item, Scene, Stroke};
use crate::series::{Marker, MarkerShape};

/// Width of the rim of a marker, and of hatching and its spacing, in points.
const RIM: f64 = 0.8;
const HATCH_WIDTH: f64 = 0.4;
const HATCH_SPACING: f64 = 3.0;

pub(crate) fn draw_marker(scene: &mut Scene, marker: Marker, center: Point) {
    let radius = 0.5 * marker.size;
    let polygon = |corners: &[(f64, f64)]| {
        let corners: Vec<Point> =
            corners.iter().map(|(x, y)| center.offset(x * radius, y * radius)).collect();
        Path::polygon(&corners)
    };
    // The corners reach out so that all shapes look equally large.
    let path = match marker.shape {
        MarkerShape::Circle => Path::circle(center, radius),
        MarkerShape::Square => polygon(&[(-0.9, -0.9), (0.9, -0.9), (0.9, 0.9), (-0.9, 0.9)]),
        MarkerShape::Diamond => polygon(&[(0.0, -1.3), (1.3, 0.0), (0.0, 1.3), (-1.3, 0.0)]),
        MarkerShape::Triangle => polygon(&[(0.0, -1.3), (1.15, 0.75), (-1.15, 0.75)]),
    };
    let fill = if marker.open { palette::WHITE } else { marker.color };
    let stroke = Stroke { color: marker.color, width: RIM, dash: Dash::Solid };
    scene.items.push(Item::Shape { path, fill: Some(fill), stroke: Some(stroke) });
}

/// Fills a polygon with parallel lines at an angle in degrees, anticlockwise from the horizontal.
pub(crate) fn draw_hatching(scene: &mut Scene, corners: &[Point], color: Color, degrees: f64) {
    let (sine, cosine) = if degrees.is_finite() { degrees.to_radians().sin_cos() } else { (0.0, 1.0) };
    // In turned coordinates the lines are horizontal (y downwards on the page turns the other way round).
    let turned: Vec<Point> =
        corners.iter().map(|p| Point::new(cosine * p.x - sine * p.y, sine * p.x + cosine * p.y)).collect();
    let back = |x: f64, y: f64| Point::new(cosine * x + sine * y, -sine * x + cosine * y);
    let low = turned.iter().map(|p| p.y).fold(f64::INFINITY, f64::min);
    let high = turned.iter().map(|p| p.y).fold(f64::NEG_INFINITY, f64::max);
    let mut path = Path::default();
    // Multiples of the spacing on the page, so that neighbouring areas match.
    let mut level = (low / HATCH_SPACING).ceil() * HATCH_SPACING;
    while level < high {
        let mut crossings: Vec<f64> = (0..turned.len())
            .filter_map(|i| {
                let (a, b) = (turned[i], turned[(i + 1) % turned.len()]);
                ((a.y <= level) != (b.y <= level)).then(|| a.x + (level - a.y) / (b.y - a.y) * (b.x - a.x))
            })
            .collect();
        crossings.sort_by(f64::total_cmp);
        for pair in crossings.chunks_exact(2) {
            path.add_polyline(&[back(pair[0], level), back(pair[1], level)]);
        }
        level += HATCH_SPACING;
    }
    scene.stroke(path, Stroke { color, width: HATCH_WIDTH, dash: Dash::Solid });
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::Rect;
    use crate::path::Segment;

    #[test]
    fn hatching_stays_inside_at_every_angle() {
        let square = Rect::new(10.0, 20.0, 40.0, 50.0);
        for degrees in [0.0, 30.0, 45.0, 90.0, 135.0, f64::NAN] {
            let mut scene = Scene::new(99.0, 99.0, String::new());
            draw_hatching(&mut scene, &square.corners(), palette::BLACK, degrees);
            let Some(Item::Shape { path, .. }) = scene.items.first() else { panic!("nothing drawn") };
            assert!(path.segments.len() > 16);
            for segment in &path.segments {
                let (Segment::Move(p) | Segment::Line(p)) = segment else { panic!("not a line") };
                assert!(square.expanded(1e-9).contains(*p));
            }
        }
    }
}
