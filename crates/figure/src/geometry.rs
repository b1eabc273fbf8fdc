//! Points, rectangles, and the clipping and thinning of polylines and polygons.
//!
//! Curves are clipped here rather than by the viewer: files need no clip paths, every back end draws the same, and the
//! automatic placement of labels sees exactly the ink that is drawn.

/// A point, in the units of the data or in points (1/72 inch) on the page.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Point {
    /// Horizontal coordinate.
    pub x: f64,
    /// Vertical coordinate.
    pub y: f64,
}

impl Point {
    /// The point (x, y).
    pub const fn new(x: f64, y: f64) -> Self {
        Self { x, y }
    }

    /// Whether both coordinates are finite.
    pub fn is_finite(self) -> bool {
        self.x.is_finite() && self.y.is_finite()
    }

    pub(crate) fn distance(self, other: Point) -> f64 {
        (self.x - other.x).hypot(self.y - other.y)
    }

    pub(crate) fn lerp(self, other: Point, t: f64) -> Point {
        Point::new(self.x + t * (other.x - self.x), self.y + t * (other.y - self.y))
    }

    pub(crate) fn offset(self, dx: f64, dy: f64) -> Point {
        Point::new(self.x + dx, self.y + dy)
    }
}

impl From<(f64, f64)> for Point {
    fn from((x, y): (f64, f64)) -> Self {
        Point::new(x, y)
    }
}

impl From<(&f64, &f64)> for Point {
    fn from((x, y): (&f64, &f64)) -> Self {
        Point::new(*x, *y)
    }
}

impl From<[f64; 2]> for Point {
    fn from([x, y]: [f64; 2]) -> Self {
        Point::new(x, y)
    }
}

impl From<&(f64, f64)> for Point {
    fn from(&(x, y): &(f64, f64)) -> Self {
        Point::new(x, y)
    }
}

/// An axis-parallel rectangle on the page, y downwards.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(crate) struct Rect {
    pub left: f64,
    pub top: f64,
    pub right: f64,
    pub bottom: f64,
}

impl Rect {
    pub(crate) fn new(left: f64, top: f64, right: f64, bottom: f64) -> Self {
        Self { left, top, right, bottom }
    }

    pub(crate) fn width(&self) -> f64 {
        self.right - self.left
    }

    pub(crate) fn height(&self) -> f64 {
        self.bottom - self.top
    }

    pub(crate) fn center(&self) -> Point {
        Point::new(0.5 * (self.left + self.right), 0.5 * (self.top + self.bottom))
    }

    pub(crate) fn expanded(&self, by: f64) -> Rect {
        Rect::new(self.left - by, self.top - by, self.right + by, self.bottom + by)
    }

    pub(crate) fn contains(&self, p: Point) -> bool {
        p.x >= self.left && p.x <= self.right && p.y >= self.top && p.y <= self.bottom
    }

    pub(crate) fn encloses(&self, other: &Rect) -> bool {
        other.left >= self.left
            && other.right <= self.right
            && other.top >= self.top
            && other.bottom <= self.bottom
    }

    pub(crate) fn overlap_area(&self, other: &Rect) -> f64 {
        let width = self.right.min(other.right) - self.left.max(other.left);
        let height = self.bottom.min(other.bottom) - self.top.max(other.top);
        width.max(0.0) * height.max(0.0)
    }

    pub(crate) fn corners(&self) -> [Point; 4] {
        [
            Point::new(self.left, self.top),
            Point::new(self.right, self.top),
            Point::new(self.right, self.bottom),
            Point::new(self.left, self.bottom),
        ]
    }
}

/// The part of the segment inside the rectangle as parameters in [0, 1] (Liang and Barsky, 1984), `None` when outside.
pub(crate) fn clip_segment(a: Point, b: Point, rect: &Rect) -> Option<(f64, f64)> {
    let (dx, dy) = (b.x - a.x, b.y - a.y);
    let (mut enter, mut leave) = (0.0_f64, 1.0_f64);
    let edges =
        [(-dx, a.x - rect.left), (dx, rect.right - a.x), (-dy, a.y - rect.top), (dy, rect.bottom - a.y)];
    for (slope, distance) in edges {
        if slope == 0.0 {
            if distance < 0.0 {
                return None;
            }
        } else if slope < 0.0 {
            enter = enter.max(distance / slope);
        } else {
            leave = leave.min(distance / slope);
        }
    }
    (enter <= leave).then_some((enter, leave))
}

/// Length of the segment inside the rectangle.
pub(crate) fn length_inside(a: Point, b: Point, rect: &Rect) -> f64 {
    if a.x.max(b.x) < rect.left
        || a.x.min(b.x) > rect.right
        || a.y.max(b.y) < rect.top
        || a.y.min(b.y) > rect.bottom
    {
        return 0.0;
    }
    clip_segment(a, b, rect).map_or(0.0, |(enter, leave)| (leave - enter) * a.distance(b))
}

/// Cuts a polyline at the rectangle and at its non-finite points; every piece has at least two points.
pub(crate) fn clip_polyline(points: &[Point], rect: &Rect) -> Vec<Vec<Point>> {
    let mut pieces = Vec::new();
    let mut piece: Vec<Point> = Vec::new();
    for pair in points.windows(2) {
        let (a, b) = (pair[0], pair[1]);
        let inside = if a.is_finite() && b.is_finite() { clip_segment(a, b, rect) } else { None };
        let Some((enter, leave)) = inside else {
            flush(&mut piece, &mut pieces);
            continue;
        };
        if enter > 0.0 {
            flush(&mut piece, &mut pieces);
        }
        if piece.is_empty() {
            piece.push(if enter > 0.0 { a.lerp(b, enter) } else { a });
        }
        piece.push(if leave < 1.0 { a.lerp(b, leave) } else { b });
        if leave < 1.0 {
            flush(&mut piece, &mut pieces);
        }
    }
    flush(&mut piece, &mut pieces);
    pieces
}

/// The parts of a polyline outside a rectangle that is turned by an angle in radians about its centre.
pub(crate) fn cut_out(
    points: &[Point],
    center: Point,
    angle: f64,
    width: f64,
    height: f64,
) -> Vec<Vec<Point>> {
    let (sine, cosine) = angle.sin_cos();
    let turned = |p: Point| {
        let (dx, dy) = (p.x - center.x, p.y - center.y);
        Point::new(cosine * dx + sine * dy, cosine * dy - sine * dx)
    };
    let hole = Rect::new(-0.5 * width, -0.5 * height, 0.5 * width, 0.5 * height);
    let mut pieces = Vec::new();
    let mut piece: Vec<Point> = points.first().copied().into_iter().collect();
    for pair in points.windows(2) {
        let (a, b) = (pair[0], pair[1]);
        if let Some((enter, leave)) = clip_segment(turned(a), turned(b), &hole) {
            if enter > 0.0 {
                piece.push(a.lerp(b, enter));
                flush(&mut piece, &mut pieces);
            }
            piece = if leave < 1.0 { vec![a.lerp(b, leave), b] } else { Vec::new() };
        } else {
            if piece.is_empty() {
                piece.push(a);
            }
            piece.push(b);
        }
    }
    flush(&mut piece, &mut pieces);
    pieces
}

fn flush(piece: &mut Vec<Point>, pieces: &mut Vec<Vec<Point>>) {
    if piece.len() > 1 {
        pieces.push(std::mem::take(piece));
    } else {
        piece.clear();
    }
}

/// Clips a polygon to the rectangle (Sutherland and Hodgman, 1974); non-finite corners are left out.
pub(crate) fn clip_polygon(points: &[Point], rect: &Rect) -> Vec<Point> {
    let mut polygon: Vec<Point> = points.iter().copied().filter(|p| p.is_finite()).collect();
    // Signed distance to each edge of the rectangle, positive inside.
    let distances: [&dyn Fn(Point) -> f64; 4] =
        [&|p| p.x - rect.left, &|p| rect.right - p.x, &|p| p.y - rect.top, &|p| rect.bottom - p.y];
    for distance in distances {
        let mut clipped = Vec::with_capacity(polygon.len() + 4);
        for (i, &current) in polygon.iter().enumerate() {
            let previous = polygon[(i + polygon.len() - 1) % polygon.len()];
            let (before, now) = (distance(previous), distance(current));
            if (before >= 0.0) != (now >= 0.0) {
                clipped.push(previous.lerp(current, before / (before - now)));
            }
            if now >= 0.0 {
                clipped.push(current);
            }
        }
        polygon = clipped;
    }
    if polygon.len() < 3 { Vec::new() } else { polygon }
}

/// Leaves out the points of a polyline that lie within `tolerance` of the thinned line (Douglas and Peucker, 1973).
pub(crate) fn thin(points: &[Point], tolerance: f64) -> Vec<Point> {
    if points.len() < 3 {
        return points.to_vec();
    }
    let mut keep = vec![false; points.len()];
    keep[0] = true;
    keep[points.len() - 1] = true;
    let mut spans = vec![(0, points.len() - 1)];
    while let Some((first, last)) = spans.pop() {
        let mut farthest = (0.0, first);
        for (i, &p) in points.iter().enumerate().take(last).skip(first + 1) {
            let distance = distance_to_segment(p, points[first], points[last]);
            if distance > farthest.0 {
                farthest = (distance, i);
            }
        }
        if farthest.0 > tolerance {
            keep[farthest.1] = true;
            spans.push((first, farthest.1));
            spans.push((farthest.1, last));
        }
    }
    points.iter().zip(&keep).filter(|(_, keep)| **keep).map(|(p, _)| *p).collect()
}

fn distance_to_segment(p: Point, a: Point, b: Point) -> f64 {
    let length_squared = (b.x - a.x).powi(2) + (b.y - a.y).powi(2);
    if length_squared == 0.0 {
        return p.distance(a);
    }
    let t = ((p.x - a.x) * (b.x - a.x) + (p.y - a.y) * (b.y - a.y)) / length_squared;
    p.distance(a.lerp(b, t.clamp(0.0, 1.0)))
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    const WINDOW: Rect = Rect { left: 0.0, top: 0.0, right: 10.0, bottom: 5.0 };

    fn points() -> impl Strategy<Value = Vec<Point>> {
        let coordinate = prop_oneof![9 => -20.0..30.0_f64, 1 => Just(f64::NAN), 1 => Just(f64::INFINITY)];
        proptest::collection::vec((coordinate.clone(), coordinate).prop_map(Point::from), 0..40)
    }

    #[test]
    fn a_line_through_the_window_is_cut_at_both_edges() {
        let pieces = clip_polyline(&[Point::new(-5.0, 2.0), Point::new(15.0, 2.0)], &WINDOW);
        assert_eq!(pieces, vec![vec![Point::new(0.0, 2.0), Point::new(10.0, 2.0)]]);
    }

    #[test]
    fn a_gap_splits_a_line() {
        let line = [(1.0, 1.0), (2.0, 1.0), (f64::NAN, 1.0), (3.0, 1.0), (4.0, 1.0)].map(Point::from);
        assert_eq!(clip_polyline(&line, &WINDOW).len(), 2);
    }

    #[test]
    fn a_polygon_around_the_window_becomes_the_window() {
        let around = [(-9.0, -9.0), (99.0, -9.0), (99.0, 99.0), (-9.0, 99.0)].map(Point::from);
        let clipped = clip_polygon(&around, &WINDOW);
        assert_eq!(clipped.len(), 4);
        assert!(WINDOW.corners().iter().all(|corner| clipped.contains(corner)));
    }

    #[test]
    fn a_hole_is_cut_out_of_a_line() {
        let line = [(0.0, 0.0), (3.0, 3.0), (4.0, 4.0), (10.0, 10.0)].map(Point::from);
        let pieces = cut_out(&line, Point::new(4.0, 4.0), std::f64::consts::FRAC_PI_4, 2.0, 1.0);
        let half = std::f64::consts::FRAC_1_SQRT_2;
        assert_eq!(pieces.len(), 2);
        assert!(pieces[0][pieces[0].len() - 1].distance(Point::new(4.0 - half, 4.0 - half)) < 1e-12);
        assert!(pieces[1][0].distance(Point::new(4.0 + half, 4.0 + half)) < 1e-12);
        assert_eq!(cut_out(&line, Point::new(50.0, 0.0), 0.0, 1.0, 1.0), vec![line.to_vec()]);
    }

    #[test]
    fn thinning_a_straight_line_leaves_its_ends() {
        let line: Vec<Point> = (0..1000).map(|i| Point::new(i as f64, 2.0 * i as f64)).collect();
        assert_eq!(thin(&line, 1e-9), vec![line[0], line[999]]);
    }

    proptest! {
        #[test]
        fn clipped_lines_stay_inside_and_keep_the_length_inside(line in points()) {
            let pieces = clip_polyline(&line, &WINDOW);
            let mut length = 0.0;
            for piece in &pieces {
                prop_assert!(piece.len() > 1);
                prop_assert!(piece.iter().all(|p| WINDOW.expanded(1e-9).contains(*p)));
                length += piece.windows(2).map(|pair| pair[0].distance(pair[1])).sum::<f64>();
            }
            let expected: f64 = line
                .windows(2)
                .filter(|pair| pair[0].is_finite() && pair[1].is_finite())
                .map(|pair| length_inside(pair[0], pair[1], &WINDOW))
                .sum();
            prop_assert!((length - expected).abs() < 1e-9 * (1.0 + expected));
        }

        #[test]
        fn clipped_polygons_stay_inside(polygon in points()) {
            let clipped = clip_polygon(&polygon, &WINDOW);
            prop_assert!(clipped.iter().all(|p| WINDOW.expanded(1e-9).contains(*p)));
        }

        #[test]
        fn thinned_lines_stay_within_the_tolerance(line in proptest::collection::vec((0.0..1.0_f64, 0.0..1.0_f64).prop_map(Point::from), 2..60)) {
            let thinned = thin(&line, 0.05);
            for p in &line {
                let nearest = thinned
                    .windows(2)
                    .map(|pair| distance_to_segment(*p, pair[0], pair[1]))
                    .fold(f64::INFINITY, f64::min);
                prop_assert!(nearest <= 0.05 + 1e-12);
            }
        }
    }
}
