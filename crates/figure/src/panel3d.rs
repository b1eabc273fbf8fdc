//! A panel in space: a chart on the ground with upright walls on it that carry diagrams.

use crate::axis::{Axis, Range, Scale};
use crate::legend::LegendEntry;
use crate::projection::Projection;
use crate::series::{Curve, PointLabel, Region};

/// A chart in the plane of x and y on the ground, and walls at several y that carry diagrams of z against x.
///
/// ```
/// use kingpin_figure::{Axis, Figure, Line, Panel3d, Wall};
/// let wall = Wall::at(0.08).curve(Line::new([(0.0, 0.5), (8.0, 0.1)]).dashed());
/// let panel = Panel3d::new(Axis::new("$v$ (m/s)"), Axis::new("$l$ (m)"), Axis::new("$\\psi$ (rad)"))
///     .ground_curve(Line::new([(6.0, 0.05), (8.0, 0.08), (7.0, 0.2)]))
///     .wall(wall);
/// let svg = Figure::double_column().panel(panel).to_svg()?;
/// # assert!(svg.contains("<path"));
/// # Ok::<(), kingpin_figure::FigureError>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct Panel3d {
    pub(crate) axes: [Axis; 3],
    pub(crate) projection: Projection,
    pub(crate) tag: String,
    pub(crate) regions: Vec<Region>,
    pub(crate) ground: Vec<Curve>,
    pub(crate) walls: Vec<Wall>,
    pub(crate) entries: Vec<LegendEntry>,
}

/// An upright plane at one y.
#[derive(Debug, Clone, PartialEq)]
pub struct Wall {
    pub(crate) y: f64,
    pub(crate) curves: Vec<Curve>,
    pub(crate) points: Vec<PointLabel>,
    pub(crate) plumb: Vec<(f64, f64)>,
}

impl Wall {
    /// A wall at a value of y.
    pub fn at(y: f64) -> Self {
        Self { y, curves: Vec::new(), points: Vec::new(), plumb: Vec::new() }
    }

    /// A curve of points (x, z): a [`crate::Line`] or a [`crate::Branch`].
    pub fn curve(mut self, curve: impl Into<Curve>) -> Self {
        self.curves.push(curve.into());
        self
    }

    /// Several curves.
    pub fn curves<C: Into<Curve>>(mut self, curves: impl IntoIterator<Item = C>) -> Self {
        self.curves.extend(curves.into_iter().map(Into::into));
        self
    }

    /// A marked point (x, z) with a label, which may be empty.
    pub fn point(mut self, point: PointLabel) -> Self {
        self.points.push(point);
        self
    }

    /// A thin vertical line from (x, z) down to the ground, to show which point of the chart belongs to it.
    pub fn plumb_line(mut self, x: f64, z: f64) -> Self {
        self.plumb.push((x, z));
        self
    }
}

impl Panel3d {
    /// An empty panel with axes to the right, into the depth, and upwards.
    pub fn new(x: Axis, y: Axis, z: Axis) -> Self {
        Self {
            axes: [x, y, z],
            projection: Projection::default(),
            tag: String::new(),
            regions: Vec::new(),
            ground: Vec::new(),
            walls: Vec::new(),
            entries: Vec::new(),
        }
    }

    /// From where it is seen.
    pub fn projection(self, projection: Projection) -> Self {
        Self { projection, ..self }
    }

    /// The tag by which the text speaks of the panel, such as `(a)`.
    pub fn tag(self, tag: impl Into<String>) -> Self {
        Self { tag: tag.into(), ..self }
    }

    /// A filled area (x, y) on the ground; hatching is not drawn in space.
    pub fn ground_region(mut self, region: Region) -> Self {
        self.regions.push(region);
        self
    }

    /// A curve (x, y) on the ground.
    pub fn ground_curve(mut self, curve: impl Into<Curve>) -> Self {
        self.ground.push(curve.into());
        self
    }

    /// Adds a wall.
    pub fn wall(mut self, wall: Wall) -> Self {
        self.walls.push(wall);
        self
    }

    /// A line of the legend, which stands where it covers least.
    pub fn legend_entry(mut self, entry: LegendEntry) -> Self {
        self.entries.push(entry);
        self
    }

    /// The scales of the three axes, from their limits or the data.
    pub(crate) fn scales(&self) -> [Scale; 3] {
        let mut ranges = [Range::default(); 3];
        let corners = self.regions.iter().flat_map(|region| &region.corners);
        let curves = self.ground.iter().flat_map(|curve| &curve.pieces).flat_map(|piece| &piece.points);
        for point in corners.chain(curves).filter(|point| point.is_finite()) {
            ranges[0].include(point.x);
            ranges[1].include(point.y);
        }
        for wall in &self.walls {
            ranges[1].include(wall.y);
            let curves = wall.curves.iter().flat_map(|curve| &curve.pieces).flat_map(|piece| &piece.points);
            for point in curves.chain(wall.points.iter().map(|point| &point.at)).filter(|p| p.is_finite()) {
                ranges[0].include(point.x);
                ranges[2].include(point.y);
            }
        }
        let [x, y, z] = &self.axes;
        [x.scale(ranges[0]), y.scale(ranges[1]), z.scale(ranges[2])]
    }
}
