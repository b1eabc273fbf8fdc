//! Outlines made of lines and Bezier curves: those of shapes and those of glyphs.

use crate::geometry::{Point, Rect};

/// An outline of any number of pieces.
#[derive(Debug, Clone, Default, PartialEq)]
pub(crate) struct Path {
    pub segments: Vec<Segment>,
}

#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Segment {
    Move(Point),
    Line(Point),
    Quad(Point, Point),
    Cubic(Point, Point, Point),
    Close,
}

impl Path {
    pub(crate) fn polyline(points: &[Point]) -> Self {
        let mut path = Path::default();
        path.add_polyline(points);
        path
    }

    pub(crate) fn polygon(points: &[Point]) -> Self {
        let mut path = Path::polyline(points);
        path.segments.push(Segment::Close);
        path
    }

    pub(crate) fn rectangle(rect: &Rect) -> Self {
        Path::polygon(&rect.corners())
    }

    pub(crate) fn circle(center: Point, radius: f64) -> Self {
        // Control points at this distance make a cubic deviate from a quarter circle by at most 0.03 %.
        let k = 0.552_284_749_8 * radius;
        let (c, r) = (center, radius);
        Path {
            segments: vec![
                Segment::Move(c.offset(r, 0.0)),
                Segment::Cubic(c.offset(r, k), c.offset(k, r), c.offset(0.0, r)),
                Segment::Cubic(c.offset(-k, r), c.offset(-r, k), c.offset(-r, 0.0)),
                Segment::Cubic(c.offset(-r, -k), c.offset(-k, -r), c.offset(0.0, -r)),
                Segment::Cubic(c.offset(k, -r), c.offset(r, -k), c.offset(r, 0.0)),
                Segment::Close,
            ],
        }
    }

    pub(crate) fn add_polyline(&mut self, points: &[Point]) {
        for (i, &p) in points.iter().enumerate() {
            self.segments.push(if i == 0 { Segment::Move(p) } else { Segment::Line(p) });
        }
    }
}
