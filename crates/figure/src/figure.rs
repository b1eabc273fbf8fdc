//! A figure: panels on a grid, and its files.

use std::path::Path;

use crate::axis::Scale;
use crate::draw::draw_panel;
use crate::draw3d::draw_panel3d;
use crate::error::FigureError;
use crate::frame::{Frame, Margins};
use crate::geometry::Rect;
use crate::panel::Panel;
use crate::panel3d::Panel3d;
use crate::save::{Format, write_atomically};
use crate::scene::Scene;
use crate::svg::{POINTS_PER_MM, SvgOptions};
use crate::theme::Theme;

/// Widths of one and of two columns of a journal, in millimetres.
const SINGLE_COLUMN: f64 = 84.0;
const DOUBLE_COLUMN: f64 = 174.0;
/// Smallest and largest side of a figure, in millimetres.
const SMALLEST_SIDE: f64 = 10.0;
const LARGEST_SIDE: f64 = 2000.0;
/// Height of a panel relative to its width when the figure has no height of its own.
const ASPECT: f64 = 0.68;
/// Gaps between panels and room at the edge of the figure, in points.
const COLUMN_GAP: f64 = 9.0;
const ROW_GAP: f64 = 7.0;
const EDGE: f64 = 2.0;
/// Smallest side of the axes of a panel, in points, where surroundings would leave less.
const SMALLEST_PANEL: f64 = 10.0;
/// Resolution of PNG files written by [`Figure::save`].
const FILE_DPI: f64 = 300.0;

/// One or several panels, drawn together.
///
/// ```
/// use kingpin_figure::{Axis, Figure, Line, Panel};
/// let panel = Panel::new(Axis::new("$t$ (s)"), Axis::new("$q$ (mm)"))
///     .curve(Line::new((0..100).map(|i| (0.01 * f64::from(i), (0.3 * f64::from(i)).sin()))));
/// let svg = Figure::single_column().panel(panel).to_svg()?;
/// assert!(svg.starts_with("<svg"));
/// # Ok::<(), kingpin_figure::FigureError>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct Figure {
    width: f64,
    height: Option<f64>,
    columns: usize,
    column_weights: Vec<f64>,
    row_weights: Vec<f64>,
    description: String,
    panels: Vec<Content>,
    theme: Theme,
}

/// What fills one place of the grid of a figure: a [`Panel`] or a [`Panel3d`].
#[derive(Debug, Clone, PartialEq)]
pub enum Content {
    /// A panel with two axes.
    Plane(Box<Panel>),
    /// A panel in space.
    Space(Box<Panel3d>),
}

/// Where the axes of a panel stand in a picture, and what they span.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Place {
    /// Left edge of the axes.
    pub left: f64,
    /// Upper edge.
    pub top: f64,
    /// Right edge.
    pub right: f64,
    /// Lower edge.
    pub bottom: f64,
    /// What the horizontal axis spans, from left to right.
    pub x: Span,
    /// What the vertical axis spans, from below.
    pub y: Span,
}

/// What an axis spans.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Span {
    /// The value at its beginning.
    pub low: f64,
    /// The value at its end.
    pub high: f64,
    /// Whether equal lengths are equal factors.
    pub logarithmic: bool,
}

impl From<Scale> for Span {
    fn from(Scale { low, high, logarithmic }: Scale) -> Self {
        Self { low, high, logarithmic }
    }
}

impl From<Panel> for Content {
    fn from(panel: Panel) -> Self {
        Content::Plane(Box::new(panel))
    }
}

impl From<Panel3d> for Content {
    fn from(panel: Panel3d) -> Self {
        Content::Space(Box::new(panel))
    }
}

impl Content {
    fn margins(&self, (width, height): (f64, f64)) -> Margins {
        match self {
            Content::Plane(panel) => Frame::new(panel, width, height).margins,
            // Its labels stand inside its place.
            Content::Space(_) => Margins::default(),
        }
    }
}

impl Figure {
    /// A figure of a width in millimetres, kept between 10 and 2000.
    pub fn with_width_mm(width: f64) -> Self {
        Self {
            width: side(width, SINGLE_COLUMN),
            height: None,
            columns: 1,
            column_weights: Vec::new(),
            row_weights: Vec::new(),
            description: String::new(),
            panels: Vec::new(),
            theme: Theme::Light,
        }
    }

    /// A figure for one column of a journal, 84 mm wide.
    pub fn single_column() -> Self {
        Self::with_width_mm(SINGLE_COLUMN)
    }

    /// A figure over two columns of a journal, 174 mm wide.
    pub fn double_column() -> Self {
        Self::with_width_mm(DOUBLE_COLUMN)
    }

    /// The same figure with another width in millimetres, kept between 10 and 2000.
    pub fn width_mm(self, width: f64) -> Self {
        Self { width: side(width, self.width), ..self }
    }

    /// The height in millimetres, kept between 10 and 2000; without it the panels have a pleasant shape.
    pub fn height_mm(self, height: f64) -> Self {
        Self { height: height.is_finite().then(|| side(height, 0.0)), ..self }
    }

    /// How many panels stand side by side, 1 unless given; panels fill row after row.
    pub fn columns(self, columns: usize) -> Self {
        Self { columns: columns.max(1), ..self }
    }

    /// Relative widths of the columns, 1 where not given.
    pub fn column_weights(self, weights: impl Into<Vec<f64>>) -> Self {
        Self { column_weights: weights.into(), ..self }
    }

    /// Relative heights of the rows, 1 where not given.
    pub fn row_weights(self, weights: impl Into<Vec<f64>>) -> Self {
        Self { row_weights: weights.into(), ..self }
    }

    /// What the figure shows, for readers who cannot see it and as the title of the files.
    pub fn description(self, text: impl Into<String>) -> Self {
        Self { description: text.into(), ..self }
    }

    /// The theme, light unless given.
    pub fn theme(self, theme: Theme) -> Self {
        Self { theme, ..self }
    }

    /// Other limits of the axes of a panel with two axes: a part of it, or more. What there is none of stays as it is; a panel in space
    /// does.
    pub fn window(mut self, panel: usize, x: Option<(f64, f64)>, y: Option<(f64, f64)>) -> Self {
        if let Some(Content::Plane(panel)) = self.panels.get_mut(panel) {
            panel.x.limits = x.or(panel.x.limits);
            panel.y.limits = y.or(panel.y.limits);
        }
        self
    }

    /// Adds a [`Panel`] or a [`Panel3d`].
    pub fn panel(mut self, panel: impl Into<Content>) -> Self {
        self.panels.push(panel.into());
        self
    }

    /// The figure as SVG text, which can also stand inside an HTML page.
    ///
    /// # Errors
    /// [`FigureError::Png`] when the raster of a map cannot be encoded.
    pub fn to_svg(&self) -> Result<String, FigureError> {
        self.to_svg_with(SvgOptions::default())
    }

    /// The same with other options.
    ///
    /// # Errors
    /// Those of [`Figure::to_svg`].
    pub fn to_svg_with(&self, options: SvgOptions) -> Result<String, FigureError> {
        crate::svg::write(&self.scene(), options)
    }

    /// The figure as PNG at a resolution in dots per inch.
    ///
    /// # Errors
    /// [`FigureError::Resolution`] when the resolution is not finite, too low or too high for the size of the figure.
    pub fn to_png(&self, dpi: f64) -> Result<Vec<u8>, FigureError> {
        crate::png::write(&self.scene(), dpi)
    }

    /// The figure as PDF.
    pub fn to_pdf(&self) -> Vec<u8> {
        crate::pdf::write(&self.scene())
    }

    /// Writes the figure in the format that the ending of the path names (.svg, .png at 300 dpi, or .pdf). The file
    /// appears whole or not at all.
    ///
    /// # Errors
    /// [`FigureError::UnknownFormat`] for another ending, [`FigureError::Io`] when the file cannot be written, and those
    /// of [`Figure::to_svg`] and [`Figure::to_png`].
    pub fn save(&self, path: impl AsRef<Path>) -> Result<(), FigureError> {
        let path = path.as_ref();
        let data = match Format::of_path(path)? {
            Format::Svg => self.to_svg()?.into_bytes(),
            Format::Png => self.to_png(FILE_DPI)?,
            Format::Pdf => self.to_pdf(),
        };
        write_atomically(path, &data)
    }

    fn rows(&self) -> usize {
        self.panels.len().div_ceil(self.columns)
    }

    /// Where the axes of every panel stand and what they span, for whoever puts something on top of the picture; nothing for a panel
    /// in space. Lengths are those of the `viewBox` of the SVG text, in points from the upper left corner.
    pub fn places(&self) -> Vec<Option<Place>> {
        let page = self.page();
        let place = |(content, plot): (&Content, &Rect)| match content {
            Content::Plane(panel) => {
                let (x, y) = panel.scales();
                let [left, top, right, bottom] = [plot.left, plot.top, plot.right, plot.bottom];
                Some(Place { left, top, right, bottom, x: x.into(), y: y.into() })
            }
            Content::Space(_) => None,
        };
        self.panels.iter().zip(&page.plots).map(place).collect()
    }

    /// Width and height in points, as in the `viewBox` of the SVG text.
    pub fn size(&self) -> (f64, f64) {
        (self.width * POINTS_PER_MM, self.page().height)
    }

    /// Where everything stands.
    fn page(&self) -> Page {
        let columns = self.columns.min(self.panels.len().max(1));
        let rows = self.rows().max(1);
        let width = self.width * POINTS_PER_MM;
        let across = shares(&self.column_weights, columns);
        let down = shares(&self.row_weights, rows);

        // The surroundings depend on the size of the panels and the other way round: twice is enough, since only the
        // number of ticks depends on the size.
        let guess = 0.75 * width / columns as f64;
        let mut sizes: Vec<(f64, f64)> = vec![(guess, ASPECT * guess); self.panels.len()];
        let mut page = Page::default();
        for _ in 0..2 {
            page = self.arrange(&sizes, width, &across, &down);
            sizes = page.plots.iter().map(|plot| (plot.width(), plot.height())).collect();
        }
        page
    }

    fn scene(&self) -> Scene {
        let page = self.page();
        let width = self.width * POINTS_PER_MM;
        let mut scene = Scene::new(width, page.height, self.description.clone());
        scene.paper = self.theme.paper();
        let told = self.panels.iter().filter_map(|content| match content {
            Content::Plane(panel) => Some(panel.told()),
            Content::Space(_) => None,
        });
        scene.detail = told.collect::<Vec<_>>().join(" ");
        for ((panel, plot), margins) in self.panels.iter().zip(&page.plots).zip(&page.margins) {
            match panel {
                Content::Plane(panel) => {
                    let frame = Frame::new(panel, plot.width(), plot.height());
                    draw_panel(&mut scene, panel, frame, plot, margins);
                }
                Content::Space(panel) => draw_panel3d(&mut scene, panel, plot),
            }
        }
        self.theme.apply(&mut scene);
        scene
    }

    /// Places the axes of all panels, given the sizes from which the surroundings are measured.
    fn arrange(&self, sizes: &[(f64, f64)], width: f64, across: &[f64], down: &[f64]) -> Page {
        let mut left = vec![0.0_f64; across.len()];
        let mut right = left.clone();
        let mut top = vec![0.0_f64; down.len()];
        let mut bottom = top.clone();
        for (i, (panel, size)) in self.panels.iter().zip(sizes).enumerate() {
            let margins = panel.margins(*size);
            let (row, column) = (i / across.len(), i % across.len());
            left[column] = left[column].max(margins.left);
            right[column] = right[column].max(margins.right);
            top[row] = top[row].max(margins.top);
            bottom[row] = bottom[row].max(margins.bottom);
        }
        let sum = |values: &[f64]| values.iter().sum::<f64>();
        let taken = sum(&left) + sum(&right) + COLUMN_GAP * (across.len() - 1) as f64 + 2.0 * EDGE;
        let panel_width = (width - taken).max(SMALLEST_PANEL * across.len() as f64);
        let taken = sum(&top) + sum(&bottom) + ROW_GAP * (down.len() - 1) as f64 + 2.0 * EDGE;
        let height = match self.height {
            Some(height) => height * POINTS_PER_MM,
            None => taken + ASPECT * panel_width / across.len() as f64 * down.len() as f64,
        };
        let panel_height = (height - taken).max(SMALLEST_PANEL * down.len() as f64);

        let mut page = Page { height, ..Page::default() };
        let mut y = EDGE;
        for row in 0..down.len() {
            let mut x = EDGE;
            y += top[row];
            for column in 0..across.len() {
                x += left[column];
                if row * across.len() + column < self.panels.len() {
                    let (w, h) = (across[column] * panel_width, down[row] * panel_height);
                    page.plots.push(Rect::new(x, y, x + w, y + h));
                    page.margins.push(Margins {
                        left: left[column],
                        top: top[row],
                        right: right[column],
                        bottom: bottom[row],
                    });
                }
                x += across[column] * panel_width + right[column] + COLUMN_GAP;
            }
            y += down[row] * panel_height + bottom[row] + ROW_GAP;
        }
        page
    }
}

/// Where everything stands on the page.
#[derive(Default)]
struct Page {
    height: f64,
    plots: Vec<Rect>,
    margins: Vec<Margins>,
}

fn side(length: f64, otherwise: f64) -> f64 {
    if length.is_finite() { length.clamp(SMALLEST_SIDE, LARGEST_SIDE) } else { otherwise }
}

/// Weights as shares of 1; missing, non-finite and non-positive ones count as 1.
fn shares(weights: &[f64], count: usize) -> Vec<f64> {
    let usable = |i: usize| weights.get(i).copied().filter(|w| w.is_finite() && *w > 0.0).unwrap_or(1.0);
    let total: f64 = (0..count).map(usable).sum();
    (0..count).map(|i| usable(i) / total).collect()
}
