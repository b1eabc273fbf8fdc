//! Draws scientific figures at journal standard and writes them as SVG, PNG and PDF.
//!
//! A [`Figure`] holds [`Panel`]s; a panel has two [`Axis`] and shows curves ([`Line`], [`Branch`]), [`Markers`],
//! labelled points ([`PointLabel`]), [`Region`]s, [`Note`]s and maps ([`HeatMap`], [`CategoryMap`]). A [`Panel3d`] shows a
//! chart on the ground with diagrams on upright [`Wall`]s; a [`Drawing`] has no axes, but shapes and texts where they are put. Text is drawn as outlines of embedded fonts, so files look the same everywhere. The same figure gives the same bytes.
//!
//! ```
//! use kingpin_figure::{Axis, Branch, Figure, Panel, PointLabel, Stability};
//!
//! let motion = Branch::new((0..=100).map(|i| {
//!     let speed = 0.12 * f64::from(i);
//!     let stability = match i {
//!         70 => Stability::Changes,
//!         _ => Stability::from(i < 70),
//!     };
//!     ((speed, 0.08 + 0.001 * speed * speed), stability)
//! }));
//! let panel = Panel::new(Axis::new("$v$ (m/s)"), Axis::new("$\\psi_0$ (rad)"))
//!     .curve(motion.legend("uniform motion"))
//!     .point(PointLabel::new((8.4, 0.08 + 0.001 * 8.4 * 8.4), "HB1"));
//! let figure = Figure::single_column().panel(panel);
//!
//! let svg = figure.to_svg()?; // for a page
//! let png = figure.to_png(200.0)?;
//! let folder = std::env::temp_dir();
//! figure.save(folder.join(format!("uniform-motion-{}.pdf", std::process::id())))?;
//! # std::fs::remove_file(folder.join(format!("uniform-motion-{}.pdf", std::process::id()))).unwrap();
//! # assert!(svg.len() > 1000 && png.len() > 1000);
//! # Ok::<(), kingpin_figure::FigureError>(())
//! ```
//!
//! Labels are plain text with mathematics between dollar signs: `$\psi_0$ (rad)`, `$v_{\mathrm{crit}}$`, `$10^{-3}$`.

#![warn(unreachable_pub)]

mod axis;
mod color;
mod contour;
mod draw;
mod draw3d;
mod drawing;
mod error;
mod figure;
mod font;
mod frame;
mod geometry;
mod grid;
mod legend;
mod markers;
mod markup;
mod panel;
mod panel3d;
mod path;
mod pdf;
mod placement;
mod png;
mod projection;
mod save;
mod scene;
mod series;
mod smooth;
mod style;
mod svg;
mod text;
mod theme;
mod ticks;

pub use axis::Axis;
pub use color::{Color, ColorMap, palette};
pub use contour::contour_lines;
pub use drawing::{Drawing, PlacedText, Shape, ShapeStyle};
pub use error::FigureError;
pub use figure::{Content, Figure, Place, Span};
pub use geometry::Point;
pub use grid::{CategoryMap, Grid, HeatMap};
pub use legend::{Legend, LegendEntry};
pub use panel::{Map, Panel};
pub use panel3d::{Panel3d, Wall};
pub use projection::Projection;
pub use save::Format;
pub use scene::Dash;
pub use series::{Branch, Curve, Line, Marker, MarkerShape, Markers, Note, PointLabel, Region, Stability};
pub use svg::SvgOptions;
pub use text::Anchor;
pub use theme::Theme;

/// The code of the README, which is tested.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;
