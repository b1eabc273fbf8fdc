//! Values on a rectangular grid: heat maps, maps of categories, and contour lines.

use crate::axis::{Range, Scale};
use crate::color::{Color, ColorMap};
use crate::error::FigureError;
use crate::geometry::Point;
use crate::scene::Raster;

/// Pixels along one side of a map whose cells do not fit the panel evenly: enough that a cell's edge is off by less than
/// a line's width.
const FEWEST_PIXELS: usize = 600;
const MOST_PIXELS: usize = 1600;
/// How far spacings may differ, relatively, for cells to count as equal.
const EVEN: f64 = 1e-6;

/// The nodes of a grid; every value belongs to the cell around its node.
#[derive(Debug, Clone, PartialEq)]
pub struct Grid {
    x: Vec<f64>,
    y: Vec<f64>,
}

impl Grid {
    /// A grid from the coordinates of its columns and rows.
    ///
    /// # Errors
    /// [`FigureError::GridAxis`] when one of them is empty, not finite, or neither rises nor falls throughout.
    pub fn new(x: impl Into<Vec<f64>>, y: impl Into<Vec<f64>>) -> Result<Self, FigureError> {
        let grid = Self { x: x.into(), y: y.into() };
        for (name, nodes) in [("x", &grid.x), ("y", &grid.y)] {
            let rising = nodes.windows(2).all(|pair| pair[0] < pair[1]);
            let falling = nodes.windows(2).all(|pair| pair[0] > pair[1]);
            if nodes.is_empty() || nodes.iter().any(|node| !node.is_finite()) || !(rising || falling) {
                return Err(FigureError::GridAxis { axis: name });
            }
        }
        Ok(grid)
    }

    fn check(&self, found: usize) -> Result<(), FigureError> {
        let (columns, rows) = (self.x.len(), self.y.len());
        if found == columns * rows { Ok(()) } else { Err(FigureError::GridShape { columns, rows, found }) }
    }

    pub(crate) fn include_in(&self, x: &mut Range, y: &mut Range) {
        self.x.iter().for_each(|value| x.include(*value));
        self.y.iter().for_each(|value| y.include(*value));
    }

    /// Samples the cells over the whole panel, the upper row first.
    fn raster(&self, x: &Scale, y: &Scale, is_scale: bool, color: impl Fn(usize) -> Option<Color>) -> Raster {
        let columns = sample(&self.x, x, false);
        let rows = sample(&self.y, y, true);
        let mut pixels = Vec::with_capacity(columns.len() * rows.len());
        for row in &rows {
            for column in &columns {
                let color = row.zip(*column).and_then(|(row, column)| color(row * self.x.len() + column));
                pixels.push(color.map_or([255, 255, 255, 0], |Color { rgb: [r, g, b], .. }| [r, g, b, 255]));
            }
        }
        Raster { columns: columns.len(), rows: rows.len(), pixels, is_scale }
    }
}

/// The index of the node nearest to the middle of each pixel, `None` beyond the outermost cells.
fn sample(nodes: &[f64], scale: &Scale, downwards: bool) -> Vec<Option<usize>> {
    let last = nodes.len() - 1;
    let span = nodes[last] - nodes[0];
    let even = last > 0
        && !scale.logarithmic
        && nodes.windows(2).all(|pair| ((pair[1] - pair[0]) * last as f64 / span - 1.0).abs() < EVEN);
    let ends = scale.low.min(scale.high) == nodes[0].min(nodes[last])
        && scale.low.max(scale.high) == nodes[0].max(nodes[last]);
    // Half a cell at each end and whole ones between: two pixels a cell are exact.
    let pixels = if even && ends { 2 * last } else { (8 * nodes.len()).clamp(FEWEST_PIXELS, MOST_PIXELS) };
    let first_cell = if last == 0 { 1.0 } else { (nodes[1] - nodes[0]).abs() };
    let last_cell = if last == 0 { 1.0 } else { (nodes[last] - nodes[last - 1]).abs() };
    let rising = span >= 0.0;
    (0..pixels)
        .map(|pixel| {
            let fraction = (pixel as f64 + 0.5) / pixels as f64;
            let value = scale.value(if downwards { 1.0 - fraction } else { fraction });
            let after = nodes.partition_point(|node| if rising { *node <= value } else { *node >= value });
            if after == 0 {
                return ((value - nodes[0]).abs() <= 0.5 * first_cell).then_some(0);
            }
            if after == nodes.len() {
                return ((value - nodes[last]).abs() <= 0.5 * last_cell).then_some(last);
            }
            let nearer = (value - nodes[after - 1]).abs() <= (nodes[after] - value).abs();
            Some(if nearer { after - 1 } else { after })
        })
        .collect()
}

/// Values on a grid shown as colours, with a colour bar.
///
/// ```
/// use kingpin_figure::{ColorMap, Grid, HeatMap};
/// let grid = Grid::new([0.0, 1.0, 2.0], [0.0, 1.0])?;
/// let map = HeatMap::new(grid, vec![-1.0, 0.0, 1.0, 0.0, 1.0, 2.0])?
///     .color_map(ColorMap::Diverging)
///     .label("growth rate (1/s)");
/// # Ok::<(), kingpin_figure::FigureError>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct HeatMap {
    pub(crate) grid: Grid,
    values: Vec<f64>,
    pub(crate) map: ColorMap,
    limits: Option<(f64, f64)>,
    pub(crate) label: String,
}

impl HeatMap {
    /// A map of values in rows, the row of the first y first; cells that are not finite stay empty.
    ///
    /// # Errors
    /// [`FigureError::GridShape`] when the number of values is not that of the nodes.
    pub fn new(grid: Grid, values: impl Into<Vec<f64>>) -> Result<Self, FigureError> {
        let values = values.into();
        grid.check(values.len())?;
        Ok(Self { grid, values, map: ColorMap::default(), limits: None, label: String::new() })
    }

    /// The colour map.
    pub fn color_map(self, map: ColorMap) -> Self {
        Self { map, ..self }
    }

    /// The values at the ends of the colour bar; without them they are those of the data, symmetric about zero for
    /// [`ColorMap::Diverging`]. Unusable limits (equal or not finite) are passed over.
    pub fn limits(self, low: f64, high: f64) -> Self {
        Self { limits: Some((low, high)), ..self }
    }

    /// The label of the colour bar, in markup.
    pub fn label(self, text: impl Into<String>) -> Self {
        Self { label: text.into(), ..self }
    }

    /// The curves on which the values, interpolated linearly, have the given level; for [`crate::Line`].
    pub fn contour(&self, level: f64) -> Vec<Vec<Point>> {
        crate::contour::contour_lines(&self.grid.x, &self.grid.y, &self.values, level)
    }

    pub(crate) fn value_scale(&self) -> Scale {
        let mut range = Range::default();
        self.values.iter().for_each(|value| range.include(*value));
        let usable = |(low, high): &(f64, f64)| low.is_finite() && high.is_finite() && low != high;
        let (low, high) = self.limits.filter(usable).unwrap_or_else(|| match (range.all(), self.map) {
            (None, _) => (0.0, 1.0),
            (Some((low, high)), ColorMap::Diverging) if low != 0.0 || high != 0.0 => {
                let largest = low.abs().max(high.abs());
                (-largest, largest)
            }
            (Some((low, high)), _) if low == high => (low - 0.5, high + 0.5),
            (Some(range), _) => range,
        });
        Scale { low, high, logarithmic: false }
    }

    pub(crate) fn raster(&self, x: &Scale, y: &Scale) -> Raster {
        let scale = self.value_scale();
        self.grid.raster(x, y, self.map.has_own_paper(), |index| {
            let value = self.values[index];
            value.is_finite().then(|| self.map.at(scale.fraction(value)))
        })
    }
}

/// One of a few categories in every cell of a grid, such as the attractor that a start leads to.
#[derive(Debug, Clone, PartialEq)]
pub struct CategoryMap {
    pub(crate) grid: Grid,
    categories: Vec<usize>,
    pub(crate) entries: Vec<(String, Color)>,
}

impl CategoryMap {
    /// A map of indices into `entries` (name in the legend and colour), in rows, the row of the first y first; cells with
    /// an index beyond the entries stay empty.
    ///
    /// # Errors
    /// [`FigureError::GridShape`] when the number of cells is not that of the nodes.
    pub fn new<T: Into<String>>(
        grid: Grid,
        categories: impl Into<Vec<usize>>,
        entries: impl IntoIterator<Item = (T, Color)>,
    ) -> Result<Self, FigureError> {
        let categories = categories.into();
        grid.check(categories.len())?;
        let entries = entries.into_iter().map(|(name, color)| (name.into(), color)).collect();
        Ok(Self { grid, categories, entries })
    }

    pub(crate) fn raster(&self, x: &Scale, y: &Scale) -> Raster {
        self.grid
            .raster(x, y, false, |index| self.entries.get(self.categories[index]).map(|(_, color)| *color))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn wrong_shapes_and_axes_are_refused() {
        let grid = Grid::new([0.0, 1.0], [0.0, 1.0, 2.0]).unwrap();
        let message = HeatMap::new(grid, vec![0.0; 5]).unwrap_err().to_string();
        assert!(message.contains("2 columns and 3 rows") && message.contains('6') && message.contains('5'));
        for nodes in [vec![], vec![0.0, 0.0], vec![0.0, f64::NAN], vec![0.0, 2.0, 1.0]] {
            assert!(matches!(Grid::new(nodes, [0.0]), Err(FigureError::GridAxis { axis: "x" })));
        }
    }

    #[test]
    fn cells_at_the_ends_are_halved() {
        let grid = Grid::new([0.0, 1.0, 2.0], [0.0, 1.0]).unwrap();
        let map = HeatMap::new(grid, vec![0.0, 1.0, f64::NAN, 3.0, 4.0, 5.0]).unwrap();
        let scale = |high| Scale { low: 0.0, high, logarithmic: false };
        let raster = map.raster(&scale(2.0), &scale(1.0));
        assert_eq!((raster.columns, raster.rows), (4, 2));
        // The lower row is the first row of values, and its last cell is empty.
        assert_eq!(raster.pixels[4][..3], ColorMap::Viridis.at(0.0).rgb);
        assert_eq!(raster.pixels[7][3], 0);
        assert_eq!(raster.pixels[3][..3], ColorMap::Viridis.at(1.0).rgb);
    }

    #[test]
    fn a_falling_axis_shows_the_same_picture() {
        let rising = HeatMap::new(Grid::new([0.0, 1.0, 2.0], [0.0]).unwrap(), vec![0.0, 1.0, 2.0]).unwrap();
        let falling = HeatMap::new(Grid::new([2.0, 1.0, 0.0], [0.0]).unwrap(), vec![2.0, 1.0, 0.0]).unwrap();
        let (x, y) = (
            Scale { low: -1.0, high: 3.0, logarithmic: false },
            Scale { low: -0.5, high: 0.5, logarithmic: false },
        );
        assert_eq!(rising.raster(&x, &y), falling.raster(&x, &y));
    }

    #[test]
    fn the_diverging_scale_is_symmetric() {
        let map = HeatMap::new(Grid::new([0.0, 1.0], [0.0]).unwrap(), vec![-1.0, 5.0]).unwrap();
        let scale = map.color_map(ColorMap::Diverging).value_scale();
        assert_eq!((scale.low, scale.high), (-5.0, 5.0));
    }
}
