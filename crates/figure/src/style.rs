//! Sizes shared by all figures, in points; they suit a journal column at print size.

/// Font size of axis labels and tags.
pub(crate) const TEXT_SIZE: f64 = 9.0;
/// Font size of tick labels, legends and labels of curves and points.
pub(crate) const SMALL_SIZE: f64 = 8.0;
/// Width of the frame of a panel and of its ticks.
pub(crate) const FRAME_WIDTH: f64 = 0.6;
/// Lengths of the ticks.
pub(crate) const MAJOR_TICK: f64 = 3.2;
pub(crate) const MINOR_TICK: f64 = 1.8;
/// Gap between an axis and its tick labels, and between those and the axis label.
pub(crate) const LABEL_GAP: f64 = 3.0;
/// How far a curve may be off when points are left out of it.
pub(crate) const THINNING: f64 = 0.02;
/// Reach of the white rim around text on curves.
pub(crate) const HALO_WIDTH: f64 = 1.2;
/// Width of the line from a point to a label that stands away from it.
pub(crate) const LEADER_WIDTH: f64 = 0.4;
