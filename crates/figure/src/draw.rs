//! Draws what a panel shows, inside its frame.

use crate::axis::Scale;
use crate::color::{Color, palette};
use crate::frame::{Frame, Margins};
use crate::geometry::{Point, Rect, clip_polygon, clip_polyline, cut_out, thin};
use crate::markers::{draw_hatching, draw_marker};
use crate::panel::{Map, Panel};
use crate::path::Path;
use crate::placement::Obstacles;
use crate::scene::{Dash, Halo, Item, Scene, Stroke};
use crate::series::{Curve, CurvePiece, Marker, PointLabel};
use crate::smooth::smoothed;
use crate::style::{HALO_WIDTH, LEADER_WIDTH, SMALL_SIZE, THINNING};
use crate::text::TextLayout;

/// Draws the panel into the rectangle of its axes.
pub(crate) fn draw_panel(scene: &mut Scene, panel: &Panel, mut frame: Frame, plot: &Rect, margins: &Margins) {
    let place = Place { x: frame.x.scale, y: frame.y.scale, plot: *plot };
    draw_ground(scene, panel, &place);
    // Everything is placed before anything is drawn, since a name interrupts its curve.
    let mut obstacles = Obstacles::default();
    let curves: Vec<PlacedCurve<'_>> =
        panel.curves.iter().map(|curve| PlacedCurve::new(curve, &place, &mut obstacles)).collect();
    let points: Vec<(Point, &PointLabel)> = panel
        .points
        .iter()
        .map(|label| (place.point(label.at), label))
        .filter(|(at, _)| place.shows(at))
        .collect();
    let markers = placed_markers(panel, &place, &points);
    for (at, marker) in &markers {
        obstacles.add_box(around(*at, 0.5 * marker.size));
    }
    let mut texts = Texts { on_map: panel.map.is_some(), texts: Vec::new() };
    place_notes(panel, &place, &mut obstacles, &mut texts);
    for (index, curve) in curves.iter().enumerate() {
        curve.draw(scene, panel.curve_color(index), &mut obstacles, &mut texts, plot);
    }
    // The frame is drawn over curves that end at it, and under markers that lie on it.
    frame.draw(scene, plot, margins);
    for (at, marker) in markers {
        draw_marker(scene, marker, at);
    }
    if let Some((legend, corner)) = frame.take_legend(plot) {
        let inside = corner.is_none();
        let corner = corner.unwrap_or_else(|| obstacles.emptiest(legend.width, legend.height, plot));
        legend.draw(scene, corner, inside);
    }
    draw_point_labels(scene, &points, &mut obstacles, &mut texts, plot);
    scene.items.extend(texts.texts);
}

/// What lies under everything: the map and the regions.
fn draw_ground(scene: &mut Scene, panel: &Panel, place: &Place) {
    let Place { x, y, plot } = place;
    let raster = match &panel.map {
        Some(Map::Heat(map)) => Some(map.raster(x, y)),
        Some(Map::Category(map)) => Some(map.raster(x, y)),
        None => None,
    };
    scene.items.extend(raster.map(|raster| Item::Raster { frame: *plot, raster }));
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
}

/// The markers that are seen: those of the series, and those of the points that have a label.
fn placed_markers(panel: &Panel, place: &Place, points: &[(Point, &PointLabel)]) -> Vec<(Point, Marker)> {
    let of_series = panel
        .markers
        .iter()
        .flat_map(|series| series.points.iter().map(|p| (place.point(*p), series.marker)));
    let of_points = points.iter().filter_map(|(at, label)| Some((*at, label.marker?)));
    of_series.chain(of_points).filter(|(at, _)| place.shows(at)).collect()
}

/// Places the notes of the panel.
fn place_notes(panel: &Panel, place: &Place, obstacles: &mut Obstacles, texts: &mut Texts) {
    for note in &panel.notes {
        let at = place.point(note.at);
        if at.is_finite() {
            let layout = TextLayout::new(&note.text, SMALL_SIZE);
            let origin = layout.origin(at, note.anchor, SMALL_SIZE);
            let covers = obstacles.covers_curve(&layout.bounds(origin));
            obstacles.add_box(layout.bounds(origin));
            texts.add(layout, origin, 0.0, note.color, covers);
        }
    }
}

/// Draws the labels of points beside them, at a leader line where there is no room.
fn draw_point_labels(
    scene: &mut Scene,
    points: &[(Point, &PointLabel)],
    obstacles: &mut Obstacles,
    texts: &mut Texts,
    plot: &Rect,
) {
    for (at, label) in points {
        let radius = label.marker.map_or(0.0, |marker| 0.5 * marker.size);
        let layout = TextLayout::new(&label.text, SMALL_SIZE);
        let label = obstacles.beside_point(*at, radius, &layout, plot);
        if let Some((from, to)) = label.leader {
            let line = Stroke { color: palette::BLACK, width: LEADER_WIDTH, dash: Dash::Solid };
            scene.stroke(Path::polyline(&[from, to]), line);
        }
        let covers = obstacles.covers_curve(&layout.bounds(label.origin));
        texts.add(layout, label.origin, 0.0, palette::BLACK, covers);
    }
}

/// A curve on the page, with its place among the obstacles.
struct PlacedCurve<'a> {
    curve: &'a Curve,
    /// What is seen of each of its pieces.
    pieces: Vec<(Vec<Vec<Point>>, &'a CurvePiece)>,
    /// What is seen of all of them.
    all: Vec<Vec<Point>>,
    number: usize,
}

impl<'a> PlacedCurve<'a> {
    fn new(curve: &'a Curve, place: &Place, obstacles: &mut Obstacles) -> Self {
        let pieces: Vec<_> = place.pieces(curve).into_iter().zip(&curve.pieces).collect();
        let all: Vec<Vec<Point>> = pieces.iter().flat_map(|(points, _)| points).cloned().collect();
        let number = obstacles.add_curve(&all);
        Self { curve, pieces, all, number }
    }

    /// Draws the curve; its name, if it has one, interrupts it.
    fn draw(
        &self,
        scene: &mut Scene,
        color: Color,
        obstacles: &mut Obstacles,
        texts: &mut Texts,
        plot: &Rect,
    ) {
        let style = &self.curve.style;
        let mut hole = None;
        if !style.name.is_empty() {
            let layout = TextLayout::new(&style.name, SMALL_SIZE);
            if let Some(name) = obstacles.along_curve(self.number, &self.all, style.name_at, &layout, plot) {
                let (sine, cosine) = name.angle.sin_cos();
                // From the centre of the text to the start of its baseline, turned with the text.
                let (dx, dy) =
                    (-0.5 * layout.width, 0.5 * (layout.ascent - layout.descent) - 0.06 * SMALL_SIZE);
                let origin = name.center.offset(cosine * dx - sine * dy, sine * dx + cosine * dy);
                if name.interrupts {
                    hole = Some((name.center, name.angle, layout.width + 4.0, layout.height()));
                }
                texts.add(layout, origin, name.angle.to_degrees(), color, false);
            }
        }
        for (visible, piece) in &self.pieces {
            let mut path = Path::default();
            for points in visible {
                match hole {
                    Some((center, angle, width, height)) => cut_out(points, center, angle, width, height)
                        .iter()
                        .for_each(|part| path.add_polyline(part)),
                    None => path.add_polyline(points),
                }
            }
            let (color, width) = (piece.color.unwrap_or(color), style.width);
            scene.stroke(path, Stroke { color, width, dash: piece.dash });
        }
    }
}

/// Texts to be drawn last, with a rim where they lie on something.
struct Texts {
    on_map: bool,
    texts: Vec<Item>,
}

impl Texts {
    fn add(&mut self, layout: TextLayout, at: Point, degrees: f64, color: Color, covers: bool) {
        let rim = Halo { color: palette::WHITE, width: HALO_WIDTH };
        let halo = (covers || self.on_map).then_some(rim);
        self.texts.push(Item::Text { layout, at, degrees, color, halo });
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
    /// Whether something at a point of the page is seen.
    fn shows(&self, at: &Point) -> bool {
        at.is_finite() && self.plot.expanded(0.01).contains(*at)
    }

    fn point(&self, p: Point) -> Point {
        Point::new(
            self.plot.left + self.x.fraction(p.x) * self.plot.width(),
            self.plot.bottom - self.y.fraction(p.y) * self.plot.height(),
        )
    }

    /// The visible parts of every piece of a curve, without points that make no difference.
    fn pieces(&self, curve: &Curve) -> Vec<Vec<Vec<Point>>> {
        let on_page = |piece: &CurvePiece| piece.points.iter().map(|p| self.point(*p)).collect();
        let mut pieces: Vec<Vec<Point>> = curve.pieces.iter().map(on_page).collect();
        if let Some(upright) = &curve.smooth {
            // The direction where two pieces meet is that of the whole curve.
            let mut whole: Vec<Point> = pieces.first().map(|piece| piece[..1].to_vec()).unwrap_or_default();
            whole.extend(pieces.iter().flat_map(|piece| &piece[1..]));
            let mut smooth = smoothed(&whole, upright).into_iter();
            for piece in &mut pieces {
                *piece = smooth.by_ref().take(piece.len() - 1).flatten().collect();
            }
        }
        let visible = |points: &Vec<Point>| {
            clip_polyline(points, &self.plot).iter().map(|piece| thin(piece, THINNING)).collect()
        };
        pieces.iter().map(visible).collect()
    }
}
