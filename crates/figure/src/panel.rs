//! A panel with two axes and what is drawn in it.

use crate::axis::{Axis, Range, Scale};
use crate::color::{Color, palette};
use crate::grid::{CategoryMap, HeatMap};
use crate::legend::{Legend, LegendEntry, Swatch};
use crate::scene::Dash;
use crate::series::{Curve, Markers, Note, PointLabel, Region};
use crate::text::TextLayout;

/// One diagram of a figure: axes, and what they show.
///
/// Maps lie at the bottom, then regions, curves, markers and labels, each in the order in which they were added.
///
/// ```
/// use kingpin_figure::{Axis, Line, Panel, PointLabel};
/// let panel = Panel::new(Axis::new("$v$ (m/s)"), Axis::new("$\\psi$ (rad)"))
///     .tag("(a)")
///     .curve(Line::new([(0.0, 0.0), (4.0, 0.1), (8.0, 0.3)]))
///     .point(PointLabel::new((8.0, 0.3), "HB1"));
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct Panel {
    pub(crate) x: Axis,
    pub(crate) y: Axis,
    pub(crate) tag: String,
    pub(crate) title: String,
    pub(crate) map: Option<Map>,
    pub(crate) regions: Vec<Region>,
    pub(crate) curves: Vec<Curve>,
    pub(crate) markers: Vec<Markers>,
    pub(crate) points: Vec<PointLabel>,
    pub(crate) notes: Vec<Note>,
    pub(crate) legend: Legend,
    pub(crate) extra_entries: Vec<LegendEntry>,
}

/// What lies under everything else in a panel.
#[derive(Debug, Clone, PartialEq)]
pub enum Map {
    /// Values as colours.
    Heat(HeatMap),
    /// Categories as colours.
    Category(CategoryMap),
}

impl From<HeatMap> for Map {
    fn from(map: HeatMap) -> Self {
        Map::Heat(map)
    }
}

impl From<CategoryMap> for Map {
    fn from(map: CategoryMap) -> Self {
        Map::Category(map)
    }
}

impl Panel {
    /// An empty panel with a horizontal and a vertical axis.
    pub fn new(x: Axis, y: Axis) -> Self {
        Self {
            x,
            y,
            tag: String::new(),
            title: String::new(),
            map: None,
            regions: Vec::new(),
            curves: Vec::new(),
            markers: Vec::new(),
            points: Vec::new(),
            notes: Vec::new(),
            legend: Legend::default(),
            extra_entries: Vec::new(),
        }
    }

    /// The tag by which the text speaks of the panel, such as `(a)`.
    pub fn tag(self, tag: impl Into<String>) -> Self {
        Self { tag: tag.into(), ..self }
    }

    /// A title above the panel, in markup.
    pub fn title(self, title: impl Into<String>) -> Self {
        Self { title: title.into(), ..self }
    }

    /// A curve: a [`crate::Line`] or a [`crate::Branch`].
    pub fn curve(mut self, curve: impl Into<Curve>) -> Self {
        self.curves.push(curve.into());
        self
    }

    /// Several curves.
    pub fn curves<C: Into<Curve>>(mut self, curves: impl IntoIterator<Item = C>) -> Self {
        self.curves.extend(curves.into_iter().map(Into::into));
        self
    }

    /// A shaded or hatched area.
    pub fn region(mut self, region: Region) -> Self {
        self.regions.push(region);
        self
    }

    /// Marked points.
    pub fn markers(mut self, markers: Markers) -> Self {
        self.markers.push(markers);
        self
    }

    /// A labelled point.
    pub fn point(mut self, point: PointLabel) -> Self {
        self.points.push(point);
        self
    }

    /// Several labelled points.
    pub fn points(mut self, points: impl IntoIterator<Item = PointLabel>) -> Self {
        self.points.extend(points);
        self
    }

    /// A text at a point.
    pub fn note(mut self, note: Note) -> Self {
        self.notes.push(note);
        self
    }

    /// A map under everything else: a [`HeatMap`] or a [`CategoryMap`].
    pub fn map(self, map: impl Into<Map>) -> Self {
        Self { map: Some(map.into()), ..self }
    }

    /// Where the legend stands; it shows whatever has a text for it.
    pub fn legend(self, legend: Legend) -> Self {
        Self { legend, ..self }
    }

    /// A line of the legend that belongs to no single series.
    pub fn legend_entry(mut self, entry: LegendEntry) -> Self {
        self.extra_entries.push(entry);
        self
    }

    /// The colour of a curve: its own, or the next of the cycle.
    pub(crate) fn curve_color(&self, index: usize) -> Color {
        let automatic = self.curves[..index].iter().filter(|curve| curve.style.color.is_none()).count();
        self.curves[index].style.color.unwrap_or(palette::CYCLE[automatic % palette::CYCLE.len()])
    }

    pub(crate) fn entries(&self) -> Vec<LegendEntry> {
        let mut entries = Vec::new();
        let mut add = |text: &str, swatch: Swatch| {
            if !text.is_empty() {
                entries.push(LegendEntry { text: text.to_owned(), swatch });
            }
        };
        for (index, curve) in self.curves.iter().enumerate() {
            let color = self.curve_color(index);
            let first = curve.pieces.iter().find(|piece| piece.dash == Dash::Solid).or(curve.pieces.first());
            let (color, dash) =
                first.map_or((color, Dash::Solid), |piece| (piece.color.unwrap_or(color), piece.dash));
            add(&curve.style.legend, Swatch::Line(color, curve.style.width, dash));
        }
        for markers in &self.markers {
            add(&markers.legend, Swatch::Marker(markers.marker));
        }
        for region in &self.regions {
            let hatching = region.hatching.map(|(color, _)| Swatch::Hatching(color));
            if let Some(swatch) = region.fill.map(Swatch::Patch).or(hatching) {
                add(&region.legend, swatch);
            }
        }
        if let Some(Map::Category(map)) = &self.map {
            for (name, color) in &map.entries {
                add(name, Swatch::Patch(*color));
            }
        }
        entries.extend(self.extra_entries.iter().cloned());
        entries
    }

    /// What it shows, in sentences.
    pub(crate) fn told(&self) -> String {
        let (x, y) = self.scales();
        let axis = |name: &str, axis: &Axis, scale: Scale| {
            let label = if axis.label.is_empty() {
                String::new()
            } else {
                format!("{}, ", TextLayout::plain(&axis.label))
            };
            format!("{name}: {label}from {} to {}. ", rounded(scale.low), rounded(scale.high))
        };
        let title = if self.title.is_empty() {
            String::new()
        } else {
            format!("{}. ", TextLayout::plain(&self.title))
        };
        let mut text = title + &axis("Horizontal axis", &self.x, x) + &axis("Vertical axis", &self.y, y);
        let list = |name: &str, texts: Vec<String>| {
            if texts.is_empty() { String::new() } else { format!("{name}: {}. ", texts.join(", ")) }
        };
        let entries = self.entries().iter().map(|entry| TextLayout::plain(&entry.text)).collect();
        let labels = self.points.iter().filter(|point| !point.text.is_empty() && point.at.is_finite());
        let labels = labels.map(|point| {
            let place = format!("({}, {})", rounded(point.at.x), rounded(point.at.y));
            format!("{} at {place}", TextLayout::plain(&point.text))
        });
        text += &list("Legend", entries);
        text += &list("Labelled points", labels.collect());
        text.trim_end().to_owned()
    }

    /// The scales of both axes, from their limits or the data.
    pub(crate) fn scales(&self) -> (Scale, Scale) {
        let (mut x, mut y) = (Range::default(), Range::default());
        match &self.map {
            Some(Map::Heat(map)) => map.grid.include_in(&mut x, &mut y),
            Some(Map::Category(map)) => map.grid.include_in(&mut x, &mut y),
            None => {}
        }
        let curves = self.curves.iter().flat_map(|curve| &curve.pieces).flat_map(|piece| &piece.points);
        let others = self.markers.iter().flat_map(|markers| &markers.points);
        let corners = self.regions.iter().flat_map(|region| &region.corners);
        let labels = self.points.iter().map(|point| &point.at).chain(self.notes.iter().map(|note| &note.at));
        for point in curves.chain(others).chain(corners).chain(labels).filter(|point| point.is_finite()) {
            x.include(point.x);
            y.include(point.y);
        }
        // A map fills its panel to the edge.
        let exact = |axis: &Axis| if self.map.is_some() { axis.clone().tight() } else { axis.clone() };
        (exact(&self.x).scale(x), exact(&self.y).scale(y))
    }
}

/// A number with four digits.
fn rounded(value: f64) -> f64 {
    format!("{value:.3e}").parse().unwrap_or(value)
}
