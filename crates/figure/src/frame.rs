//! The surroundings of a panel: frame, ticks, labels, tag, colour bar and the place of the legend.

use crate::axis::{Axis, Scale};
use crate::color::palette;
use crate::font::Font;
use crate::geometry::{Point, Rect};
use crate::legend::{Legend, LegendLayout};
use crate::panel::{Map, Panel};
use crate::path::Path;
use crate::scene::{Dash, Item, Raster, Scene, Stroke};
use crate::style::{FRAME_WIDTH, LABEL_GAP, MAJOR_TICK, MINOR_TICK, SMALL_SIZE, TEXT_SIZE};
use crate::text::{Anchor, TextLayout};

/// Width of a colour bar and its gap from the panel.
const BAR_WIDTH: f64 = 7.0;
const BAR_GAP: f64 = 6.0;
/// Room for one tick label along a vertical axis.
const ROW_ROOM: f64 = 22.0;
/// Room between tick labels along a horizontal axis.
const COLUMN_ROOM: f64 = 14.0;
/// How much wider than its panel a legend below it may be.
const BELOW_OVERHANG: f64 = 16.0;
/// Gap between panel and tag, title or a common power of ten.
const ABOVE_GAP: f64 = 3.5;

/// Space around a panel.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(crate) struct Margins {
    pub left: f64,
    pub top: f64,
    pub right: f64,
    pub bottom: f64,
}

/// An axis with its scale and ticks, set for a length on the page.
pub(crate) struct SetAxis {
    pub scale: Scale,
    major: Vec<(f64, TextLayout)>,
    minor: Vec<f64>,
    exponent: Option<TextLayout>,
    label: TextLayout,
}

impl SetAxis {
    fn new(axis: &Axis, scale: Scale, length: f64, horizontal: bool) -> Self {
        let set = |ticks: &[(f64, String)]| -> Vec<(f64, TextLayout)> {
            ticks.iter().map(|(value, label)| (*value, TextLayout::new(label, SMALL_SIZE))).collect()
        };
        let mut target = ((length / if horizontal { 34.0 } else { ROW_ROOM }) as usize).clamp(2, 9);
        let (major, minor, exponent) = if let Some(ticks) = &axis.ticks {
            (set(ticks), Vec::new(), 0)
        } else {
            loop {
                let ticks = scale.ticks(target);
                let major = set(&ticks.major);
                let widest = major.iter().map(|(_, label)| label.width).fold(0.0, f64::max);
                let crowded = horizontal && major.len() as f64 * (widest + COLUMN_ROOM) > length + widest;
                if !crowded || target == 1 {
                    break (major, ticks.minor, ticks.exponent);
                }
                target -= 1;
            }
        };
        let label = if axis.labels_hidden { String::new() } else { axis.label.clone() };
        let exponent = (exponent != 0 && !axis.labels_hidden)
            .then(|| TextLayout::new(&format!("$\\times 10^{{{exponent}}}$"), SMALL_SIZE));
        let inside = |value: f64| (-1e-6..=1.0 + 1e-6).contains(&scale.fraction(value));
        let hide = |(value, layout)| (value, if axis.labels_hidden { TextLayout::default() } else { layout });
        Self {
            scale,
            major: major.into_iter().filter(|(value, _)| inside(*value)).map(hide).collect(),
            minor: minor.into_iter().filter(|value| inside(*value)).collect(),
            exponent,
            label: TextLayout::new(&label, TEXT_SIZE),
        }
    }

    fn widest(&self) -> f64 {
        self.major.iter().map(|(_, label)| label.width).fold(0.0, f64::max)
    }

    fn labelled(&self) -> bool {
        self.major.iter().any(|(_, label)| !label.glyphs.is_empty())
    }
}

struct ColorBar {
    axis: SetAxis,
    raster: Raster,
}

impl ColorBar {
    fn width(&self) -> f64 {
        let label =
            if self.axis.label.glyphs.is_empty() { 0.0 } else { LABEL_GAP + self.axis.label.height() };
        BAR_GAP + BAR_WIDTH + LABEL_GAP + self.axis.widest() + label
    }
}

/// The surroundings of one panel, measured for a size of the panel.
pub(crate) struct Frame {
    pub x: SetAxis,
    pub y: SetAxis,
    tag: TextLayout,
    title: TextLayout,
    bar: Option<ColorBar>,
    legend: Option<LegendLayout>,
    place: Legend,
    outward: bool,
    pub margins: Margins,
}

impl Frame {
    /// Sets the surroundings for a panel of the given size.
    pub(crate) fn new(panel: &Panel, width: f64, height: f64) -> Self {
        let (x_scale, y_scale) = panel.scales();
        let x = SetAxis::new(&panel.x, x_scale, width, true);
        let y = SetAxis::new(&panel.y, y_scale, height, false);
        let bar = match &panel.map {
            Some(Map::Heat(map)) => {
                let axis = SetAxis::new(&Axis::new(map.label.clone()), map.value_scale(), height, false);
                let pixel = |i: usize| {
                    let [r, g, b] = map.map.at((255 - i) as f64 / 255.0).rgb;
                    [r, g, b, 255]
                };
                Some(ColorBar {
                    axis,
                    raster: Raster {
                        columns: 1,
                        rows: 256,
                        pixels: (0..256).map(pixel).collect(),
                        is_scale: map.map.has_own_paper(),
                    },
                })
            }
            _ => None,
        };
        let entries = panel.entries();
        let legend = (panel.legend != Legend::None && !entries.is_empty()).then(|| {
            LegendLayout::new(&entries, (panel.legend == Legend::Below).then_some(width + BELOW_OVERHANG))
        });
        let mut frame = Self {
            x,
            y,
            tag: TextLayout::with_font(&panel.tag, TEXT_SIZE, Font::Bold),
            title: TextLayout::new(&panel.title, TEXT_SIZE),
            bar,
            legend,
            place: panel.legend,
            outward: panel.map.is_some(),
            margins: Margins::default(),
        };
        frame.margins = frame.measure(width);
        frame
    }

    fn outward_tick(&self) -> f64 {
        if self.outward { MAJOR_TICK } else { 0.0 }
    }

    fn measure(&self, width: f64) -> Margins {
        let tick = self.outward_tick();
        let mut left = tick + if self.y.labelled() { LABEL_GAP + self.y.widest() } else { 0.0 };
        if !self.y.label.glyphs.is_empty() {
            left += LABEL_GAP + self.y.label.height();
        }
        let mut bottom = tick + if self.x.labelled() { LABEL_GAP + SMALL_SIZE } else { 0.0 };
        if !self.x.label.glyphs.is_empty() || self.x.exponent.is_some() {
            bottom += LABEL_GAP + self.x.label.height().max(TEXT_SIZE);
        }
        let above = [Some(&self.tag), Some(&self.title), self.y.exponent.as_ref()];
        let highest = above.iter().flatten().map(|layout| layout.height()).fold(0.0, f64::max);
        // The uppermost tick label reaches half its height over the frame.
        let mut top = if self.y.labelled() { 0.35 * SMALL_SIZE } else { 0.5 };
        if highest > 0.0 {
            top = top.max(ABOVE_GAP + highest);
        }
        // So do the first and the last tick label of the horizontal axis.
        let mut right: f64 = 0.5;
        for (value, label) in &self.x.major {
            let at = self.x.scale.fraction(*value) * width;
            right = right.max(at + 0.5 * label.width - width);
            left = left.max(0.5 * label.width - at);
        }
        if let Some(bar) = &self.bar {
            right = right.max(bar.width());
            if bar.axis.exponent.is_some() {
                top = top.max(ABOVE_GAP + SMALL_SIZE);
            }
        }
        if let Some(legend) = &self.legend {
            match self.place {
                Legend::Right => right += LABEL_GAP + legend.width,
                Legend::Below => bottom += LABEL_GAP + legend.height,
                Legend::Emptiest | Legend::None => {}
            }
        }
        Margins { left, top, right, bottom }
    }

    /// Draws frame, ticks and labels around the panel; `margins` are those common to a row and a column of panels.
    pub(crate) fn draw(&self, scene: &mut Scene, plot: &Rect, margins: &Margins) {
        self.draw_ticks(scene, plot);
        let line = Stroke { color: palette::BLACK, width: FRAME_WIDTH, dash: Dash::Solid };
        scene.stroke(Path::rectangle(plot), line);

        let tick = self.outward_tick();
        for (value, label) in &self.x.major {
            let at = Point::new(plot.left + self.x.scale.fraction(*value) * plot.width(), plot.bottom);
            let origin = Point::new(at.x - 0.5 * label.width, at.y + tick + LABEL_GAP + 0.7 * SMALL_SIZE);
            scene.text(label.clone(), origin, 0.0, palette::BLACK, None);
        }
        for (value, label) in &self.y.major {
            let at = Point::new(
                plot.left - tick - LABEL_GAP,
                plot.bottom - self.y.scale.fraction(*value) * plot.height(),
            );
            let origin = label.origin(at, Anchor::Right, SMALL_SIZE);
            scene.text(label.clone(), origin, 0.0, palette::BLACK, None);
        }

        let labels_below = plot.bottom + tick + LABEL_GAP + SMALL_SIZE;
        let under = labels_below + LABEL_GAP + self.x.label.ascent.max(0.683 * TEXT_SIZE);
        let x_origin = Point::new(plot.center().x - 0.5 * self.x.label.width, under);
        scene.text(self.x.label.clone(), x_origin, 0.0, palette::BLACK, None);
        if let Some(exponent) = &self.x.exponent {
            let origin = Point::new(plot.right - exponent.width, under);
            scene.text(exponent.clone(), origin, 0.0, palette::BLACK, None);
        }

        // Vertical labels read upwards and stand in line with those of the panels above and below.
        let label_left = plot.left - margins.left;
        let y_origin =
            Point::new(label_left + self.y.label.ascent, plot.center().y + 0.5 * self.y.label.width);
        scene.text(self.y.label.clone(), y_origin, -90.0, palette::BLACK, None);

        let over = plot.top - ABOVE_GAP;
        let tag_left = label_left.min(plot.left - self.tag.width - LABEL_GAP).max(label_left);
        scene.text(self.tag.clone(), Point::new(tag_left, over - 0.1 * TEXT_SIZE), 0.0, palette::BLACK, None);
        let mut next = plot.left.max(tag_left + self.tag.width + LABEL_GAP);
        if let Some(exponent) = &self.y.exponent {
            scene.text(
                exponent.clone(),
                Point::new(next, over - 0.1 * SMALL_SIZE),
                0.0,
                palette::BLACK,
                None,
            );
            next += exponent.width + 2.0 * LABEL_GAP;
        }
        let title_left = (plot.center().x - 0.5 * self.title.width).max(next);
        let title = Point::new(title_left, over - 0.1 * TEXT_SIZE);
        scene.text(self.title.clone(), title, 0.0, palette::BLACK, None);

        if let Some(bar) = &self.bar {
            draw_bar(scene, bar, plot);
        }
    }

    /// Where the legend stands, if it is not inside the panel: its upper left corner.
    pub(crate) fn take_legend(&mut self, plot: &Rect) -> Option<(LegendLayout, Option<Point>)> {
        let legend = self.legend.take()?;
        let bar = self.bar.as_ref().map_or(0.0, ColorBar::width);
        let corner = match self.place {
            Legend::Right => Some(Point::new(plot.right + bar + LABEL_GAP, plot.top - 2.0)),
            // Below the middle, unless it would leave the picture.
            Legend::Below => Some(Point::new(
                (plot.center().x - 0.5 * legend.width)
                    .min(plot.right + self.margins.right - legend.width)
                    .max(plot.left - self.margins.left),
                plot.bottom + self.margins.bottom - legend.height,
            )),
            Legend::Emptiest | Legend::None => None,
        };
        Some((legend, corner))
    }

    fn draw_ticks(&self, scene: &mut Scene, plot: &Rect) {
        let mut path = Path::default();
        let sign = if self.outward { -1.0 } else { 1.0 };
        let major =
            |axis: &SetAxis| axis.major.iter().map(|(value, _)| (*value, MAJOR_TICK)).collect::<Vec<_>>();
        let minor = |axis: &SetAxis| axis.minor.iter().map(|value| (*value, MINOR_TICK)).collect::<Vec<_>>();
        for (value, length) in [major(&self.x), minor(&self.x)].concat() {
            let x = plot.left + self.x.scale.fraction(value) * plot.width();
            path.add_polyline(&[Point::new(x, plot.bottom), Point::new(x, plot.bottom - sign * length)]);
            if !self.outward {
                path.add_polyline(&[Point::new(x, plot.top), Point::new(x, plot.top + length)]);
            }
        }
        for (value, length) in [major(&self.y), minor(&self.y)].concat() {
            let y = plot.bottom - self.y.scale.fraction(value) * plot.height();
            path.add_polyline(&[Point::new(plot.left, y), Point::new(plot.left + sign * length, y)]);
            if !self.outward {
                path.add_polyline(&[Point::new(plot.right, y), Point::new(plot.right - length, y)]);
            }
        }
        scene.stroke(path, Stroke { color: palette::BLACK, width: FRAME_WIDTH, dash: Dash::Solid });
    }
}

fn draw_bar(scene: &mut Scene, bar: &ColorBar, plot: &Rect) {
    let left = plot.right + BAR_GAP;
    let rect = Rect::new(left, plot.top, left + BAR_WIDTH, plot.bottom);
    scene.items.push(Item::Raster { frame: rect, raster: bar.raster.clone() });
    let line = Stroke { color: palette::BLACK, width: FRAME_WIDTH, dash: Dash::Solid };
    scene.stroke(Path::rectangle(&rect), line);
    let mut ticks = Path::default();
    for (value, label) in &bar.axis.major {
        let y = plot.bottom - bar.axis.scale.fraction(*value) * plot.height();
        ticks.add_polyline(&[Point::new(rect.right - MINOR_TICK, y), Point::new(rect.right, y)]);
        let origin = label.origin(Point::new(rect.right + LABEL_GAP, y), Anchor::Left, SMALL_SIZE);
        scene.text(label.clone(), origin, 0.0, palette::BLACK, None);
    }
    scene.stroke(ticks, line);
    if let Some(exponent) = &bar.axis.exponent {
        scene.text(exponent.clone(), Point::new(left, plot.top - ABOVE_GAP), 0.0, palette::BLACK, None);
    }
    let label = &bar.axis.label;
    let baseline = rect.right + LABEL_GAP + bar.axis.widest() + LABEL_GAP + label.ascent;
    let origin = Point::new(baseline, plot.center().y + 0.5 * label.width);
    scene.text(label.clone(), origin, -90.0, palette::BLACK, None);
}
