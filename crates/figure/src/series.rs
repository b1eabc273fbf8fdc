//! What a panel can show besides maps: curves, branches with stability, markers, labelled points, regions and notes.

use crate::color::{Color, palette};
use crate::geometry::Point;
use crate::scene::Dash;
use crate::text::Anchor;

/// Width of a curve unless another is given, in points.
pub(crate) const CURVE_WIDTH: f64 = 1.0;
/// Diameter of a marker unless another is given, in points.
const MARKER_SIZE: f64 = 4.0;

fn collect<P: Into<Point>>(points: impl IntoIterator<Item = P>) -> Vec<Point> {
    points.into_iter().map(Into::into).collect()
}

/// A curve through points; non-finite points are gaps.
///
/// ```
/// use kingpin_figure::{Line, palette};
/// let speeds = [1.0, 2.0, 3.0];
/// let angles = [0.1, 0.3, 0.2];
/// let line = Line::new(speeds.iter().zip(&angles)).color(palette::BLUE).dashed().legend("measured");
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct Line {
    pub(crate) points: Vec<Point>,
    pub(crate) dash: Dash,
    pub(crate) style: CurveStyle,
}

/// What lines and branches have in common.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct CurveStyle {
    pub color: Option<Color>,
    pub width: f64,
    pub legend: String,
    pub name: String,
    pub name_at: Option<f64>,
}

impl Default for CurveStyle {
    fn default() -> Self {
        Self { color: None, width: CURVE_WIDTH, legend: String::new(), name: String::new(), name_at: None }
    }
}

macro_rules! curve_style {
    () => {
        /// The colour; without one the next of [`palette::CYCLE`] is taken.
        pub fn color(mut self, color: Color) -> Self {
            self.style.color = Some(color);
            self
        }

        /// The width in points, 1 unless given.
        pub fn width(mut self, points: f64) -> Self {
            self.style.width = points;
            self
        }

        /// The text of its entry in the legend.
        pub fn legend(mut self, text: impl Into<String>) -> Self {
            self.style.legend = text.into();
            self
        }

        /// A name written on the curve itself, where there is most room.
        pub fn name(mut self, text: impl Into<String>) -> Self {
            self.style.name = text.into();
            self
        }

        /// A name written on the curve at a fraction of its visible length, from 0 to 1.
        pub fn name_at(mut self, fraction: f64, text: impl Into<String>) -> Self {
            self.style.name = text.into();
            self.style.name_at = fraction.is_finite().then(|| fraction.clamp(0.0, 1.0));
            self
        }
    };
}

impl Line {
    /// A solid line through the points.
    pub fn new<P: Into<Point>>(points: impl IntoIterator<Item = P>) -> Self {
        Self { points: collect(points), dash: Dash::Solid, style: CurveStyle::default() }
    }

    /// Sets the line style.
    pub fn dash(self, dash: Dash) -> Self {
        Self { dash, ..self }
    }

    /// Dashed, as unstable solutions are.
    pub fn dashed(self) -> Self {
        self.dash(Dash::Dashed)
    }

    /// Dotted.
    pub fn dotted(self) -> Self {
        self.dash(Dash::Dotted)
    }

    curve_style!();
}

/// Stability at a point of a branch.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Stability {
    /// Stable here.
    Stable,
    /// Unstable here.
    Unstable,
    /// Exactly the point where stability changes (a bifurcation): belongs to both sides.
    Changes,
}

impl From<bool> for Stability {
    /// `true` is stable.
    fn from(stable: bool) -> Self {
        if stable { Stability::Stable } else { Stability::Unstable }
    }
}

/// A branch of solutions, solid where stable and dashed where unstable.
///
/// A segment has the stability of its first point, or of its second where the first is a point of change; so the style
/// switches exactly at the points marked [`Stability::Changes`].
///
/// ```
/// use kingpin_figure::{Branch, Stability};
/// let branch = Branch::new([
///     ((0.0, 0.0), Stability::Stable),
///     ((1.0, 0.0), Stability::Changes),
///     ((2.0, 0.0), Stability::Unstable),
/// ]);
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct Branch {
    points: Vec<(Point, Stability)>,
    /// Which points are dotted; those beyond its end are not.
    dotted: Vec<bool>,
    unstable_color: Option<Color>,
    /// Which points the curve is known to be upright at, where it is smooth.
    smooth: Option<Vec<bool>>,
    pub(crate) style: CurveStyle,
}

impl Branch {
    /// A branch through points with their stability.
    pub fn new<P: Into<Point>, S: Into<Stability>>(points: impl IntoIterator<Item = (P, S)>) -> Self {
        Self {
            points: points.into_iter().map(|(point, stability)| (point.into(), stability.into())).collect(),
            dotted: Vec::new(),
            unstable_color: None,
            smooth: None,
            style: CurveStyle::default(),
        }
    }

    /// Draws it smoothly through its points, with their corners where it has kinks; `upright` says in the order of the points where it is
    /// known to be upright: where a branch turns, and where cycles are born.
    ///
    /// ```
    /// use kingpin_figure::Branch;
    /// let amplitudes = [0.0, 0.1, 0.2, 0.4].map(|amplitude: f64| ((1.0 - amplitude.powi(2), amplitude), true));
    /// let branch = Branch::new(amplitudes).smooth([true]);
    /// ```
    pub fn smooth(self, upright: impl IntoIterator<Item = bool>) -> Self {
        Self { smooth: Some(upright.into_iter().collect()), ..self }
    }

    /// Draws dotted, whatever its stability, what touches one of the points that are so marked, in their order: solutions outside
    /// the range of the model.
    pub fn dotted(self, dotted: impl IntoIterator<Item = bool>) -> Self {
        Self { dotted: dotted.into_iter().collect(), ..self }
    }

    /// Another colour for the unstable parts.
    pub fn unstable_color(self, color: Color) -> Self {
        Self { unstable_color: Some(color), ..self }
    }

    curve_style!();

    /// The runs of equal stability, and equally dotted, each with both its ends.
    fn runs(&self) -> Vec<Run> {
        let is_dotted = |index: usize| self.dotted.get(index) == Some(&true);
        let mut runs: Vec<Run> = Vec::new();
        for (index, pair) in self.points.windows(2).enumerate() {
            let stable = match (pair[0].1, pair[1].1) {
                (Stability::Stable, _) | (Stability::Changes, Stability::Stable) => true,
                (Stability::Unstable, _) | (Stability::Changes, Stability::Unstable) => false,
                (Stability::Changes, Stability::Changes) => runs.last().is_none_or(|run| run.stable),
            };
            let dotted = is_dotted(index) || is_dotted(index + 1);
            match runs.last_mut() {
                Some(run) if run.stable == stable && run.dotted == dotted => run.points.push(pair[1].0),
                _ => runs.push(Run { points: vec![pair[0].0, pair[1].0], stable, dotted }),
            }
        }
        runs
    }
}

/// A part of a branch that is drawn in one style.
struct Run {
    points: Vec<Point>,
    stable: bool,
    dotted: bool,
}

/// Anything a panel draws as a curve: made from a [`Line`] or a [`Branch`].
#[derive(Debug, Clone, PartialEq)]
pub struct Curve {
    pub(crate) pieces: Vec<CurvePiece>,
    /// Which of the points of all pieces, where two meet once, it is upright at, where it is smooth.
    pub(crate) smooth: Option<Vec<bool>>,
    pub(crate) style: CurveStyle,
}

#[derive(Debug, Clone, PartialEq)]
pub(crate) struct CurvePiece {
    pub points: Vec<Point>,
    pub dash: Dash,
    /// In place of the colour of the curve.
    pub color: Option<Color>,
}

impl From<Line> for Curve {
    fn from(line: Line) -> Self {
        let piece = CurvePiece { points: line.points, dash: line.dash, color: None };
        Curve { pieces: vec![piece], smooth: None, style: line.style }
    }
}

impl From<Branch> for Curve {
    fn from(branch: Branch) -> Self {
        let piece = |run: Run| CurvePiece {
            points: run.points,
            dash: match run {
                Run { dotted: true, .. } => Dash::Dotted,
                Run { stable: true, .. } => Dash::Solid,
                _ => Dash::Dashed,
            },
            color: if run.stable { None } else { branch.unstable_color },
        };
        Curve {
            pieces: branch.runs().into_iter().map(piece).collect(),
            smooth: branch.smooth,
            style: branch.style,
        }
    }
}

/// The shape of a marker.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum MarkerShape {
    /// A circle.
    #[default]
    Circle,
    /// A square.
    Square,
    /// A square standing on a corner.
    Diamond,
    /// A triangle pointing up.
    Triangle,
}

/// How a point is marked.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Marker {
    pub(crate) shape: MarkerShape,
    pub(crate) open: bool,
    pub(crate) size: f64,
    pub(crate) color: Color,
}

impl Default for Marker {
    /// A filled black circle.
    fn default() -> Self {
        Self::new(MarkerShape::Circle)
    }
}

impl Marker {
    /// A filled black marker.
    pub fn new(shape: MarkerShape) -> Self {
        Self { shape, open: false, size: MARKER_SIZE, color: palette::BLACK }
    }

    /// Filled with white instead.
    pub fn open(self) -> Self {
        Self { open: true, ..self }
    }

    /// The colour.
    pub fn color(self, color: Color) -> Self {
        Self { color, ..self }
    }

    /// The diameter in points, 4 unless given.
    pub fn size(self, points: f64) -> Self {
        Self { size: points, ..self }
    }
}

/// Separate points, each drawn with the same marker.
#[derive(Debug, Clone, PartialEq)]
pub struct Markers {
    pub(crate) points: Vec<Point>,
    pub(crate) marker: Marker,
    pub(crate) legend: String,
}

impl Markers {
    /// Marks each of the points.
    pub fn new<P: Into<Point>>(points: impl IntoIterator<Item = P>, marker: Marker) -> Self {
        Self { points: collect(points), marker, legend: String::new() }
    }

    /// The text of its entry in the legend.
    pub fn legend(self, text: impl Into<String>) -> Self {
        Self { legend: text.into(), ..self }
    }
}

/// A marked point with a label beside it, such as a bifurcation; the label is put where it covers least.
#[derive(Debug, Clone, PartialEq)]
pub struct PointLabel {
    pub(crate) at: Point,
    pub(crate) text: String,
    pub(crate) marker: Option<Marker>,
}

impl PointLabel {
    /// A label for a point, marked with a filled circle.
    pub fn new(at: impl Into<Point>, text: impl Into<String>) -> Self {
        Self { at: at.into(), text: text.into(), marker: Some(Marker::default()) }
    }

    /// Another marker.
    pub fn marker(self, marker: Marker) -> Self {
        Self { marker: Some(marker), ..self }
    }

    /// No marker.
    pub fn without_marker(self) -> Self {
        Self { marker: None, ..self }
    }
}

/// A filled area bounded by a polygon.
#[derive(Debug, Clone, PartialEq)]
pub struct Region {
    pub(crate) corners: Vec<Point>,
    pub(crate) fill: Option<Color>,
    pub(crate) hatching: Option<(Color, f64)>,
    pub(crate) legend: String,
}

impl Region {
    /// The area inside the polygon, shaded light grey; the last corner is joined to the first.
    pub fn new<P: Into<Point>>(corners: impl IntoIterator<Item = P>) -> Self {
        Self {
            corners: collect(corners),
            fill: Some(palette::LIGHT_GREY),
            hatching: None,
            legend: String::new(),
        }
    }

    /// The area between two curves over the same abscissae (such as minimum and maximum of a solution).
    pub fn between<P: Into<Point>>(
        lower: impl IntoIterator<Item = P>,
        upper: impl IntoIterator<Item = P>,
    ) -> Self {
        let mut corners = collect(lower);
        corners.extend(collect(upper).into_iter().rev());
        Self::new(corners)
    }

    /// The colour it is filled with.
    pub fn fill(self, color: Color) -> Self {
        Self { fill: Some(color), ..self }
    }

    /// Parallel lines at an angle in degrees (0 is horizontal, anticlockwise) instead of the shading.
    pub fn hatched(self, color: Color, degrees: f64) -> Self {
        Self { fill: None, hatching: Some((color, degrees)), ..self }
    }

    /// The text of its entry in the legend.
    pub fn legend(self, text: impl Into<String>) -> Self {
        Self { legend: text.into(), ..self }
    }
}

/// A text at a point of a panel.
#[derive(Debug, Clone, PartialEq)]
pub struct Note {
    pub(crate) at: Point,
    pub(crate) text: String,
    pub(crate) anchor: Anchor,
    pub(crate) color: Color,
}

impl Note {
    /// A text in markup centred at a point.
    pub fn new(at: impl Into<Point>, text: impl Into<String>) -> Self {
        Self { at: at.into(), text: text.into(), anchor: Anchor::Center, color: palette::BLACK }
    }

    /// Which part of the text lies at the point.
    pub fn anchor(self, anchor: Anchor) -> Self {
        Self { anchor, ..self }
    }

    /// The colour.
    pub fn color(self, color: Color) -> Self {
        Self { color, ..self }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_style_of_a_branch_switches_at_the_point_of_change() {
        use Stability::{Changes, Stable, Unstable};
        let stability = [Stable, Stable, Changes, Unstable, Unstable, Changes, Stable];
        let branch = Branch::new(stability.iter().enumerate().map(|(i, s)| ((i as f64, 0.0), *s)));
        let ends: Vec<(f64, f64, bool)> = branch
            .runs()
            .iter()
            .map(|run| (run.points[0].x, run.points[run.points.len() - 1].x, run.stable))
            .collect();
        assert_eq!(ends, [(0.0, 2.0, true), (2.0, 5.0, false), (5.0, 6.0, true)]);
    }

    #[test]
    fn what_touches_a_dotted_point_is_dotted() {
        let branch = Branch::new((0..5).map(|i| ((f64::from(i), 0.0), i < 2)))
            .dotted([false, false, false, true, true]);
        let styles: Vec<(f64, bool, bool)> =
            branch.runs().iter().map(|run| (run.points[0].x, run.stable, run.dotted)).collect();
        assert_eq!(styles, [(0.0, true, false), (2.0, false, true)]);
        let Curve { pieces, .. } = branch.into();
        assert_eq!(pieces.iter().map(|piece| piece.dash).collect::<Vec<_>>(), [Dash::Solid, Dash::Dotted]);
    }

    #[test]
    fn short_branches_draw_nothing() {
        assert!(Branch::new(Vec::<((f64, f64), bool)>::new()).runs().is_empty());
        assert!(Branch::new([((1.0, 1.0), true)]).runs().is_empty());
    }
}
