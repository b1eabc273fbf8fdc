//! Puts labels where they cover least: beside points, or farther away on a leader line where points crowd, along curves, and legends in
//! the emptiest place.
//!
//! Every candidate position has a cost, counted in points of curve covered; the cheapest wins and the first of equals,
//! so the result is the same every time.

use crate::geometry::{Point, Rect, length_inside};
use crate::text::TextLayout;

/// Cost of covering another label, per square point, and of standing out of the panel.
const LABEL_COST: f64 = 3.0;
const OUTSIDE_COST: f64 = 1e6;
/// Cost of a name standing beside its curve, of a steep one, and of covering other curves, per point.
const BESIDE_COST: f64 = 12.0;
const STEEPNESS_COST: f64 = 10.0;
const CROSSING_COST: f64 = 3.0;
/// A legend is tried at this many steps across the panel. Its cost for covering curves, and for standing away from the
/// edges, each per point.
const LEGEND_STEPS: u32 = 12;
const COVERING_COST: f64 = 10.0;
const INLAND_COST: f64 = 0.3;
/// Gap between a label and what it belongs to, in points.
const GAP: f64 = 2.0;
/// Distances of a label from its point that are tried: so many, so far apart in points, and what each costs.
const RINGS: u32 = 9;
const RING: f64 = 4.0;
const RING_COST: f64 = 3.0;
/// Distance of a label from the marker of its point from which on a line leads to it, in points, and what the line costs: as such, for every
/// other one that it crosses, and per point of label or marker and of curve that it covers.
const LEADER_FROM: f64 = 4.5;
const LEADER_COST: f64 = 4.0;
const LEADERS_COST: f64 = 60.0;
const LEADER_ON_LABEL: f64 = 8.0;
const LEADER_ON_CURVE: f64 = 0.3;
/// Gap between a leader line and its label, and how far from a marker it starts.
const LEADER_GAP: f64 = 1.0;

/// What labels should not cover.
#[derive(Debug, Clone, Default)]
pub(crate) struct Obstacles {
    segments: Vec<(Point, Point, usize)>,
    boxes: Vec<Rect>,
    leaders: Vec<(Point, Point)>,
    curves: usize,
}

/// The place of a label of a point.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct PlacedLabel {
    /// Where its baseline starts.
    pub origin: Point,
    /// From the marker to the label, where it stands away from it.
    pub leader: Option<(Point, Point)>,
}

/// The place of a name along its curve.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct PlacedName {
    pub center: Point,
    /// Slope in radians, between -pi/2 and pi/2.
    pub angle: f64,
    /// Whether it stands on the curve, which then leaves a gap for it.
    pub interrupts: bool,
}

impl Obstacles {
    /// Adds the visible pieces of one curve and returns its number.
    pub(crate) fn add_curve(&mut self, pieces: &[Vec<Point>]) -> usize {
        let curve = self.curves;
        self.curves += 1;
        for piece in pieces {
            self.segments.extend(piece.windows(2).map(|pair| (pair[0], pair[1], curve)));
        }
        curve
    }

    pub(crate) fn add_box(&mut self, rect: Rect) {
        self.boxes.push(rect);
    }

    /// Whether the rectangle covers a curve.
    pub(crate) fn covers_curve(&self, rect: &Rect) -> bool {
        self.segments.iter().any(|(a, b, _)| length_inside(*a, *b, rect) > 0.0)
    }

    /// The cost of covering the rectangle, not counting the given curve.
    fn cost(&self, rect: &Rect, own_curve: Option<usize>) -> f64 {
        let curves: f64 = self
            .segments
            .iter()
            .filter(|(_, _, curve)| Some(*curve) != own_curve)
            .map(|(a, b, _)| length_inside(*a, *b, rect))
            .sum();
        let labels: f64 = self.boxes.iter().map(|other| LABEL_COST * other.overlap_area(rect)).sum();
        curves + labels
    }

    /// Where the label for `point` stands; it is kept inside `frame` where it fits.
    pub(crate) fn beside_point(
        &mut self,
        point: Point,
        radius: f64,
        layout: &TextLayout,
        frame: &Rect,
    ) -> PlacedLabel {
        let (width, height) = (layout.width, layout.height());
        let mut best = (f64::INFINITY, PlacedLabel { origin: point, leader: None });
        for ring in 0..RINGS {
            let distance = radius + GAP + RING * f64::from(ring);
            for direction in 0..16 {
                let angle = std::f64::consts::FRAC_PI_8 * f64::from(direction) - std::f64::consts::FRAC_PI_4;
                let (sine, cosine) = angle.sin_cos();
                // The label touches a circle about the point with the side that faces the point.
                let center = point.offset(
                    cosine * distance + 0.5 * width * saturated(cosine),
                    sine * distance + 0.5 * height * saturated(sine),
                );
                let rect = Rect::new(
                    center.x - 0.5 * width,
                    center.y - 0.5 * height,
                    center.x + 0.5 * width,
                    center.y + 0.5 * height,
                );
                let outside = if frame.expanded(-1.5).encloses(&rect) {
                    0.0
                } else {
                    OUTSIDE_COST + beyond(&rect, frame)
                };
                let leader = leader(point, radius, &rect);
                let led = leader.map_or(0.0, |(from, to)| self.cost_of_leader(from, to));
                let covered: f64 =
                    self.leaders.iter().map(|(from, to)| LABEL_COST * length_inside(*from, *to, &rect)).sum();
                let cost = outside
                    + self.cost(&rect.expanded(1.5), None)
                    + covered
                    + led
                    + RING_COST * f64::from(ring);
                if cost < best.0 - 1e-9 {
                    let origin = Point::new(rect.left, rect.bottom - layout.descent);
                    best = (cost, PlacedLabel { origin, leader });
                }
            }
        }
        let (_, placed) = best;
        self.add_box(layout.bounds(placed.origin));
        self.leaders.extend(placed.leader);
        placed
    }

    /// The cost of a leader line from a marker to its label.
    fn cost_of_leader(&self, from: Point, to: Point) -> f64 {
        let crossed = self.leaders.iter().filter(|(other, end)| cross(from, to, *other, *end)).count();
        let labels: f64 = self.boxes.iter().map(|label| length_inside(from, to, label)).sum();
        let curves = self.segments.iter().filter(|(a, b, _)| cross(from, to, *a, *b)).count();
        LEADER_COST
            + LEADERS_COST * crossed as f64
            + LEADER_ON_LABEL * labels
            + LEADER_ON_CURVE * curves as f64
    }

    /// Where the name of a curve stands: on the curve, which it interrupts, or close beside it where the curve has too
    /// near a neighbour; `None` when the curve is too short for it.
    pub(crate) fn along_curve(
        &mut self,
        curve: usize,
        pieces: &[Vec<Point>],
        at: Option<f64>,
        layout: &TextLayout,
        frame: &Rect,
    ) -> Option<PlacedName> {
        let (width, height) = (layout.width, layout.height());
        let half = 0.5 * width + GAP;
        let total: f64 = pieces.iter().map(|piece| length(piece)).sum();
        let squares = (width / height).ceil().max(1.0) as usize;
        let mut best: Option<(f64, PlacedName)> = None;
        let mut before = 0.0;
        for piece in pieces {
            let long = length(piece);
            let steps = (long / 4.0).ceil().clamp(1.0, 200.0) as usize;
            for step in 0..=steps {
                let s = long * step as f64 / steps as f64;
                if s < half || s > long - half {
                    continue;
                }
                let (from, middle, to) = (along(piece, s - half), along(piece, s), along(piece, s + half));
                let bend = middle.distance(from.lerp(to, 0.5));
                let mut angle = (to.y - from.y).atan2(to.x - from.x);
                if angle.cos() < 0.0 {
                    angle += std::f64::consts::PI;
                }
                let (sine, cosine) = angle.sin_cos();
                let fraction = (before + s) / total;
                // Between equals the middle of the curve is best.
                let position =
                    at.map_or(4.0 * (fraction - 0.5).abs(), |wanted| 1e3 * (fraction - wanted).abs());
                let shape = 20.0 * bend
                    + 10.0 * (2.0 * half - from.distance(to))
                    + STEEPNESS_COST * sine.abs()
                    + position;
                for side in [0.0, -1.0, 1.0] {
                    let beside = side * (0.5 * height + GAP + bend);
                    let center = middle.offset(-sine * beside, cosine * beside);
                    let own = if side == 0.0 { Some(curve) } else { None };
                    let mut cost = shape + BESIDE_COST * f64::abs(side);
                    for i in 0..squares {
                        let shift = (i as f64 + 0.5) / squares as f64 * width - 0.5 * width;
                        let middle = center.offset(shift * cosine, shift * sine);
                        let square =
                            Rect::new(middle.x, middle.y, middle.x, middle.y).expanded(0.5 * height + 0.5);
                        // Whatever runs close to the curve under a name beside it could be taken for the curve.
                        let foot = middle.offset(sine * beside, -cosine * beside);
                        let strip = Rect::new(foot.x, foot.y, foot.x, foot.y).expanded(GAP);
                        if side != 0.0 {
                            cost += CROSSING_COST * self.cost(&strip, Some(curve));
                        }
                        let outside = if frame.encloses(&square) { 0.0 } else { 100.0 };
                        cost += outside + CROSSING_COST * self.cost(&square, own);
                    }
                    if best.as_ref().is_none_or(|(lowest, _)| cost < lowest - 1e-9) {
                        best = Some((cost, PlacedName { center, angle, interrupts: side == 0.0 }));
                    }
                }
            }
            before += long;
        }
        let (_, name) = best?;
        let (sine, cosine) = (name.angle.sin().abs(), name.angle.cos().abs());
        let reach_x = 0.5 * (width * cosine + height * sine);
        let reach_y = 0.5 * (width * sine + height * cosine);
        let Point { x, y } = name.center;
        self.add_box(Rect::new(x - reach_x, y - reach_y, x + reach_x, y + reach_y));
        Some(name)
    }

    /// The upper left corner of a box of the given size where it covers least, corners preferred.
    pub(crate) fn emptiest(&mut self, width: f64, height: f64, frame: &Rect) -> Point {
        let inner = frame.expanded(-4.0);
        let (room_x, room_y) = ((inner.width() - width).max(0.0), (inner.height() - height).max(0.0));
        let mut best = (f64::INFINITY, Point::new(inner.left, inner.top));
        for row in 0..=LEGEND_STEPS {
            for column in 0..=LEGEND_STEPS {
                // Top before bottom and right before left.
                let x = 1.0 - f64::from(column) / f64::from(LEGEND_STEPS);
                let y = f64::from(row) / f64::from(LEGEND_STEPS);
                let corner = Point::new(inner.left + x * room_x, inner.top + y * room_y);
                let rect = Rect::new(corner.x, corner.y, corner.x + width, corner.y + height);
                let inland = x.min(1.0 - x) * room_x + y.min(1.0 - y) * room_y;
                let cost = COVERING_COST * self.cost(&rect.expanded(2.0), None) + INLAND_COST * inland;
                if cost < best.0 - 1e-9 {
                    best = (cost, corner);
                }
            }
        }
        self.add_box(Rect::new(best.1.x, best.1.y, best.1.x + width, best.1.y + height));
        best.1
    }
}

/// The line from a marker to a label that stands away from it.
fn leader(point: Point, radius: f64, label: &Rect) -> Option<(Point, Point)> {
    let nearest = Point::new(point.x.clamp(label.left, label.right), point.y.clamp(label.top, label.bottom));
    let distance = point.distance(nearest);
    let [start, end] = [radius + LEADER_GAP, distance - LEADER_GAP];
    (distance - radius > LEADER_FROM)
        .then(|| (point.lerp(nearest, start / distance), point.lerp(nearest, end / distance)))
}

/// Whether two segments cross.
fn cross(a: Point, b: Point, c: Point, d: Point) -> bool {
    let side = |from: Point, to: Point, p: Point| {
        (to.x - from.x) * (p.y - from.y) - (to.y - from.y) * (p.x - from.x)
    };
    side(a, b, c) * side(a, b, d) < 0.0 && side(c, d, a) * side(c, d, b) < 0.0
}

/// -1, 0 or 1 with a linear passage, so that labels straight above a point are centred.
fn saturated(value: f64) -> f64 {
    (1.45 * value).clamp(-1.0, 1.0)
}

fn beyond(rect: &Rect, frame: &Rect) -> f64 {
    (frame.left - rect.left).max(0.0)
        + (rect.right - frame.right).max(0.0)
        + (frame.top - rect.top).max(0.0)
        + (rect.bottom - frame.bottom).max(0.0)
}

fn length(line: &[Point]) -> f64 {
    line.windows(2).map(|pair| pair[0].distance(pair[1])).sum()
}

/// The point at a length along the line, its end when the line is shorter.
fn along(line: &[Point], mut s: f64) -> Point {
    for pair in line.windows(2) {
        let step = pair[0].distance(pair[1]);
        if s <= step && step > 0.0 {
            return pair[0].lerp(pair[1], s / step);
        }
        s -= step;
    }
    line[line.len() - 1]
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    const FRAME: Rect = Rect { left: 0.0, top: 0.0, right: 200.0, bottom: 120.0 };

    #[test]
    fn a_label_avoids_the_curve_through_its_point() {
        let mut obstacles = Obstacles::default();
        let line = vec![Point::new(0.0, 120.0), Point::new(200.0, 0.0)];
        obstacles.add_curve(std::slice::from_ref(&line));
        let layout = TextLayout::new("HB1", 8.0);
        let placed = obstacles.beside_point(Point::new(100.0, 60.0), 2.0, &layout, &FRAME);
        assert_eq!(length_inside(line[0], line[1], &layout.bounds(placed.origin)), 0.0);
        assert_eq!(placed.leader, None);
    }

    #[test]
    fn labels_of_one_place_are_led_to_it_without_crossings() {
        let mut obstacles = Obstacles::default();
        let layout = TextLayout::new("LPC1", 8.0);
        let points: Vec<Point> =
            (0..6).map(|index| Point::new(100.0, 58.0 + 0.8 * f64::from(index))).collect();
        points
            .iter()
            .for_each(|point| obstacles.add_box(Rect::new(point.x, point.y, point.x, point.y).expanded(2.0)));
        let placed: Vec<PlacedLabel> =
            points.iter().map(|point| obstacles.beside_point(*point, 2.0, &layout, &FRAME)).collect();
        let leaders: Vec<(Point, Point)> = placed.iter().filter_map(|placed| placed.leader).collect();
        assert!(!leaders.is_empty());
        for (index, placed) in placed.iter().enumerate() {
            let bounds = layout.bounds(placed.origin);
            // A label without a line touches its marker.
            let nearest = Point::new(
                points[index].x.clamp(bounds.left, bounds.right),
                points[index].y.clamp(bounds.top, bounds.bottom),
            );
            assert!(placed.leader.is_some() || points[index].distance(nearest) <= 2.0 + LEADER_FROM + 1e-9);
            assert!(leaders.iter().all(|(from, to)| length_inside(*from, *to, &bounds) < 0.5));
        }
        for (index, (from, to)) in leaders.iter().enumerate() {
            assert!(leaders[..index].iter().all(|(other, end)| !cross(*from, *to, *other, *end)));
        }
    }

    #[test]
    fn a_name_stands_on_a_lonely_curve_and_beside_a_crowded_one() {
        let line = |y: f64| vec![Point::new(0.0, y), Point::new(200.0, y)];
        let layout = TextLayout::new("$r=1$ m", 8.0);
        let mut alone = Obstacles::default();
        let curve = alone.add_curve(&[line(60.0)]);
        let name = alone.along_curve(curve, &[line(60.0)], None, &layout, &FRAME).unwrap();
        assert!(name.interrupts && name.center == Point::new(100.0, 60.0));
        let mut crowded = Obstacles::default();
        let curve = crowded.add_curve(&[line(60.0)]);
        crowded.add_curve(&[line(57.0)]);
        let name = crowded.along_curve(curve, &[line(60.0)], None, &layout, &FRAME).unwrap();
        assert!(!name.interrupts && name.center.y > 62.0);
        assert!(
            alone
                .along_curve(0, &[vec![Point::new(0.0, 0.0), Point::new(9.0, 0.0)]], None, &layout, &FRAME)
                .is_none()
        );
    }

    #[test]
    fn a_legend_goes_to_the_empty_corner() {
        let mut obstacles = Obstacles::default();
        // Curves in every corner but the lower left one.
        for (x, y) in [(180.0, 10.0), (180.0, 110.0), (20.0, 10.0)] {
            let scribble: Vec<Point> = (0..20)
                .map(|i| Point::new(x + f64::from(i % 2) * 30.0 - 15.0, y + f64::from(i) - 10.0))
                .collect();
            obstacles.add_curve(&[scribble]);
        }
        let corner = obstacles.emptiest(40.0, 20.0, &FRAME);
        assert!(corner.x < 10.0 && corner.y > 90.0, "{corner:?}");
    }

    proptest! {
        #[test]
        fn labels_of_crowded_points_neither_overlap_nor_leave_the_panel(
            points in proptest::collection::vec((5.0..195.0_f64, 5.0..115.0_f64), 1..8),
        ) {
            let mut obstacles = Obstacles::default();
            let layout = TextLayout::new("LPC1", 8.0);
            let mut placed: Vec<Rect> = Vec::new();
            for point in points {
                let placed_label = obstacles.beside_point(point.into(), 2.0, &layout, &FRAME);
                let bounds = layout.bounds(placed_label.origin);
                prop_assert!(FRAME.encloses(&bounds));
                prop_assert!(placed.iter().all(|other| other.overlap_area(&bounds) < 20.0));
                placed.push(bounds);
            }
        }
    }
}
