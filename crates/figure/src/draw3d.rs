//! Draws a panel in space, from back to front: the ground, then the walls from the farthest to the nearest. Walls are
//! parallel and the view is from above, so this order hides exactly what is behind.

use crate::axis::{Axis, Scale};
use crate::color::{Color, palette};
use crate::font::Font;
use crate::geometry::{Point, Rect, clip_polygon, clip_polyline, thin};
use crate::legend::LegendLayout;
use crate::markers::draw_marker;
use crate::panel3d::{Panel3d, Wall};
use crate::path::Path;
use crate::placement::Obstacles;
use crate::projection::View;
use crate::scene::{Dash, Halo, Item, Scene, Stroke};
use crate::series::Curve;
use crate::style::{
    FRAME_WIDTH, HALO_WIDTH, LABEL_GAP, LEADER_WIDTH, MAJOR_TICK, SMALL_SIZE, TEXT_SIZE, THINNING,
};
use crate::text::TextLayout;

/// How much of what is behind shows through a wall.
const WALL_OPACITY: f64 = 0.6;
const WALL_EDGE: Color = Color::rgb(150, 150, 150);
const GROUND_GRID: Color = Color::rgb(225, 225, 225);
const PLUMB_LINE: Color = Color::rgb(90, 90, 90);
/// Room for one tick label along an edge, in points.
const TICK_ROOM: f64 = 26.0;
/// Rounds of fitting the box and its labels into the panel; each removes most of what is left over.
const FITTING_ROUNDS: usize = 6;
const UNIT: Rect = Rect { left: 0.0, top: 0.0, right: 1.0, bottom: 1.0 };

/// Draws the panel with its labels into a rectangle.
pub(crate) fn draw_panel3d(scene: &mut Scene, panel: &Panel3d, target: &Rect) {
    let scales = panel.scales();
    let mut inner = *target;
    let mut view = panel.projection.fitted(&inner);
    let mut labels = Labels::default();
    for _ in 0..FITTING_ROUNDS {
        labels = set_labels(panel, &scales, &view);
        let bounds = labels.bounds;
        inner.left += target.left - bounds.left;
        inner.top += target.top - bounds.top;
        inner.right += target.right - bounds.right;
        inner.bottom += target.bottom - bounds.bottom;
        if inner.width() < 10.0 || inner.height() < 10.0 {
            inner = *target;
        }
        view = panel.projection.fitted(&inner);
    }

    let space = Space { view, scales };
    let line = |color: Color, width: f64| Stroke { color, width, dash: Dash::Solid };
    let ground = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]].map(|[x, y]| view.point([x, y, 0.0]));
    for region in &panel.regions {
        let corners: Vec<Point> = region.corners.iter().map(|p| space.fractions(0, 1, *p)).collect();
        let corners: Vec<Point> =
            clip_polygon(&corners, &UNIT).iter().map(|p| view.point([p.x, p.y, 0.0])).collect();
        if let (Some(color), false) = (region.fill, corners.is_empty()) {
            scene.fill(Path::polygon(&corners), color);
        }
    }
    scene.stroke(labels.grid, line(GROUND_GRID, 0.4));
    let mut obstacles = Obstacles::default();
    for curve in &panel.ground {
        space.draw_curve(scene, &mut obstacles, curve, (0, 1), |p| [p.x, p.y, 0.0]);
    }
    scene.stroke(Path::polygon(&ground), line(palette::BLACK, FRAME_WIDTH));

    let mut walls: Vec<(f64, &Wall)> =
        panel.walls.iter().map(|wall| (scales[1].fraction(wall.y), wall)).collect();
    walls.retain(|(y, _)| (-1e-9..=1.0 + 1e-9).contains(y));
    walls.sort_by(|a, b| b.0.total_cmp(&a.0));
    let mut point_labels = Vec::new();
    for (y, wall) in walls {
        draw_wall(scene, &space, &mut obstacles, y, wall, &mut point_labels);
    }

    scene.stroke(labels.ticks, line(palette::BLACK, FRAME_WIDTH));
    scene.items.extend(labels.texts);
    for (at, text) in point_labels {
        let layout = TextLayout::new(&text, SMALL_SIZE);
        let label = obstacles.beside_point(at, 2.0, &layout, target);
        if let Some((from, to)) = label.leader {
            let line = Stroke { color: palette::BLACK, width: LEADER_WIDTH, dash: Dash::Solid };
            scene.stroke(Path::polyline(&[from, to]), line);
        }
        let halo = Halo { color: palette::WHITE, width: HALO_WIDTH };
        scene.text(layout, label.origin, 0.0, palette::BLACK, Some(halo));
    }
    let tag = TextLayout::with_font(&panel.tag, TEXT_SIZE, Font::Bold);
    scene.text(tag, Point::new(target.left, target.top + TEXT_SIZE), 0.0, palette::BLACK, None);
    if !panel.entries.is_empty() {
        let legend = LegendLayout::new(&panel.entries, None);
        let corner = obstacles.emptiest(legend.width, legend.height, &target.expanded(4.0));
        legend.draw(scene, corner, false);
    }
}

fn draw_wall(
    scene: &mut Scene,
    space: &Space,
    obstacles: &mut Obstacles,
    y: f64,
    wall: &Wall,
    labels: &mut Vec<(Point, String)>,
) {
    let corners = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]].map(|[x, z]| space.view.point([x, y, z]));
    scene.fill(Path::polygon(&corners), palette::WHITE.with_opacity(WALL_OPACITY));
    let edge = Stroke { color: WALL_EDGE, width: 0.5, dash: Dash::Solid };
    scene.stroke(Path::polygon(&corners), edge);
    obstacles.add_curve(&[corners.to_vec()]);
    let zero = space.scales[2].fraction(0.0);
    if zero > 0.0 && zero < 1.0 {
        let line = Path::polyline(&[space.view.point([0.0, y, zero]), space.view.point([1.0, y, zero])]);
        scene.stroke(line, Stroke { width: 0.4, ..edge });
    }
    for &(x, z) in &wall.plumb {
        let top = space.fractions(0, 2, Point::new(x, z));
        if UNIT.contains(top) {
            let line = [space.view.point([top.x, y, top.y]), space.view.point([top.x, y, 0.0])];
            scene.stroke(Path::polyline(&line), Stroke { color: PLUMB_LINE, width: 0.5, dash: Dash::Dotted });
            scene.fill(Path::circle(line[1], 1.3), PLUMB_LINE);
        }
    }
    for curve in &wall.curves {
        space.draw_curve(scene, obstacles, curve, (0, 2), |p| [p.x, y, p.y]);
    }
    for point in &wall.points {
        let at = space.fractions(0, 2, point.at);
        if at.is_finite() && UNIT.expanded(1e-9).contains(at) {
            let at = space.view.point([at.x, y, at.y]);
            if let Some(marker) = point.marker {
                draw_marker(scene, marker, at);
                obstacles.add_box(Rect::new(at.x, at.y, at.x, at.y).expanded(0.5 * marker.size));
            }
            labels.push((at, point.text.clone()));
        }
    }
}

/// From data to the page.
struct Space {
    view: View,
    scales: [Scale; 3],
}

impl Space {
    /// A point of two of the axes as fractions of them.
    fn fractions(&self, first: usize, second: usize, p: Point) -> Point {
        Point::new(self.scales[first].fraction(p.x), self.scales[second].fraction(p.y))
    }

    fn draw_curve(
        &self,
        scene: &mut Scene,
        obstacles: &mut Obstacles,
        curve: &Curve,
        (first, second): (usize, usize),
        lift: impl Fn(Point) -> [f64; 3],
    ) {
        for piece in &curve.pieces {
            let points: Vec<Point> = piece.points.iter().map(|p| self.fractions(first, second, *p)).collect();
            let visible: Vec<Vec<Point>> = clip_polyline(&points, &UNIT)
                .iter()
                .map(|part| part.iter().map(|p| self.view.point(lift(*p))).collect::<Vec<_>>())
                .map(|part| thin(&part, THINNING))
                .collect();
            let mut path = Path::default();
            visible.iter().for_each(|part| path.add_polyline(part));
            let color = piece.color.or(curve.style.color).unwrap_or(palette::BLACK);
            scene.stroke(path, Stroke { color, width: curve.style.width, dash: piece.dash });
            obstacles.add_curve(&visible);
        }
    }
}

/// Ticks and labels of the three axes, and the rectangle that box and labels take.
#[derive(Default)]
struct Labels {
    texts: Vec<Item>,
    ticks: Path,
    grid: Path,
    boxes: Vec<Rect>,
    bounds: Rect,
}

fn set_labels(panel: &Panel3d, scales: &[Scale; 3], view: &View) -> Labels {
    let corners = (0..8).map(|corner| {
        let bit = |i: u32| f64::from(corner >> i & 1);
        view.point([bit(0), bit(1), bit(2)])
    });
    let mut labels = Labels { bounds: EMPTY, ..Labels::default() };
    corners.for_each(|p| labels.include(Rect::new(p.x, p.y, p.x, p.y)));
    // The depth axis is labelled on the side where its edge lies in front, the upward axis on the other.
    let (near, far) = if panel.projection.recedes_right() { (1.0, 0.0) } else { (0.0, 1.0) };
    let center = view.point([0.5, 0.5, 0.5]);
    let x = |t: f64| view.point([t, 0.0, 0.0]);
    let y = |t: f64| view.point([near, t, 0.0]);
    let z = |t: f64| view.point([far, 0.0, t]);
    let edges: [&dyn Fn(f64) -> Point; 3] = [&x, &y, &z];
    for (axis, (scale, edge)) in panel.axes.iter().zip(scales.iter().zip(edges)) {
        labels.add_axis(axis, scale, edge, center);
    }
    for (value, _) in &scales[0].ticks(5).major {
        let t = scales[0].fraction(*value);
        labels.grid.add_polyline(&[view.point([t, 0.0, 0.0]), view.point([t, 1.0, 0.0])]);
    }
    for (value, _) in &scales[1].ticks(5).major {
        let t = scales[1].fraction(*value);
        labels.grid.add_polyline(&[view.point([0.0, t, 0.0]), view.point([1.0, t, 0.0])]);
    }
    labels
}

const EMPTY: Rect =
    Rect { left: f64::INFINITY, top: f64::INFINITY, right: f64::NEG_INFINITY, bottom: f64::NEG_INFINITY };

impl Labels {
    fn include(&mut self, rect: Rect) {
        let bounds = &mut self.bounds;
        *bounds = Rect::new(
            bounds.left.min(rect.left),
            bounds.top.min(rect.top),
            bounds.right.max(rect.right),
            bounds.bottom.max(rect.bottom),
        );
    }

    fn add_axis(&mut self, axis: &Axis, scale: &Scale, edge: &dyn Fn(f64) -> Point, center: Point) {
        let (start, end) = (edge(0.0), edge(1.0));
        let length = start.distance(end).max(1e-9);
        let along = Point::new((end.x - start.x) / length, (end.y - start.y) / length);
        // Perpendicular to the edge, away from the middle of the box.
        let middle = start.lerp(end, 0.5);
        let side = ((middle.x - center.x) * along.y - (middle.y - center.y) * along.x).signum();
        let out = Point::new(side * along.y, -side * along.x);

        let automatic = scale.ticks(((length / TICK_ROOM) as usize).clamp(2, 6));
        let exponent = if axis.ticks.is_some() { 0 } else { automatic.exponent };
        let major = axis.ticks.clone().unwrap_or(automatic.major);
        self.ticks.add_polyline(&[start, end]);
        let mut farthest = 0.0_f64;
        for (value, label) in major {
            let t = scale.fraction(value);
            if !(-1e-6..=1.0 + 1e-6).contains(&t) {
                continue;
            }
            let at = edge(t);
            self.ticks.add_polyline(&[at, at.offset(out.x * MAJOR_TICK, out.y * MAJOR_TICK)]);
            if axis.labels_hidden {
                continue;
            }
            let layout = TextLayout::new(&label, SMALL_SIZE);
            let reach = 0.5 * (layout.width * out.x.abs() + 0.7 * SMALL_SIZE * out.y.abs());
            let distance = MAJOR_TICK + LABEL_GAP + reach;
            farthest = farthest.max(distance + reach);
            // At a corner of the box labels of two axes may meet; the later one moves along its edge.
            let origin = (0..8)
                .map(|step| 3.0 * f64::from(step))
                .map(|shift| {
                    at.offset(out.x * distance + along.x * shift, out.y * distance + along.y * shift)
                })
                .map(|place| Point::new(place.x - 0.5 * layout.width, place.y + 0.34 * SMALL_SIZE))
                .find(|origin| {
                    let bounds = layout.bounds(*origin).expanded(2.0);
                    self.boxes.iter().all(|other| other.overlap_area(&bounds) == 0.0)
                });
            let Some(origin) = origin else { continue };
            self.boxes.push(layout.bounds(origin));
            self.include(layout.bounds(origin));
            self.texts.push(plain_text(layout, origin, 0.0));
        }
        if axis.label.is_empty() || axis.labels_hidden {
            return;
        }
        let source = if exponent == 0 {
            axis.label.clone()
        } else {
            format!("{} $\\times 10^{{{exponent}}}$", axis.label)
        };
        let layout = TextLayout::new(&source, TEXT_SIZE);
        let mut angle = along.y.atan2(along.x);
        // Nearly upright labels read upwards, all others from left to right.
        let turned_round = if angle.sin().abs() > 0.95 { angle.sin() > 0.0 } else { angle.cos() < 0.0 };
        if turned_round {
            angle += std::f64::consts::PI;
        }
        let distance = farthest + LABEL_GAP + 0.5 * layout.height();
        let place = middle.offset(out.x * distance, out.y * distance);
        let (sine, cosine) = angle.sin_cos();
        let (dx, dy) = (-0.5 * layout.width, 0.5 * (layout.ascent - layout.descent));
        let origin = place.offset(cosine * dx - sine * dy, sine * dx + cosine * dy);
        let reach_x = 0.5 * (layout.width * cosine.abs() + layout.height() * sine.abs());
        let reach_y = 0.5 * (layout.width * sine.abs() + layout.height() * cosine.abs());
        self.include(Rect::new(place.x - reach_x, place.y - reach_y, place.x + reach_x, place.y + reach_y));
        self.texts.push(plain_text(layout, origin, angle.to_degrees()));
    }
}

fn plain_text(layout: TextLayout, at: Point, degrees: f64) -> Item {
    Item::Text { layout, at, degrees, color: palette::BLACK, halo: None }
}
