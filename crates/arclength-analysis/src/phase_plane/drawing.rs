//! The phase plane as a panel of a figure.

use super::plane_field::ARROWS;
use super::{Direction, EquilibriumKind, PhasePlane};
use kingpin_figure::{Axis, Color, Legend, Line, Marker, MarkerShape, Markers, Panel, palette};

/// Length of an arrow in parts of the distance to the next.
const ARROW: f64 = 0.55;
/// Length and half the width of its head in parts of its length.
const HEAD: [f64; 2] = [0.36, 0.18];
/// Grey of the arrows.
const FAINT: Color = Color::rgb(185, 185, 185);

impl PhasePlane {
    /// The panel, with a motion.
    pub(crate) fn panel(&self, motion: &[[f64; 2]]) -> Panel {
        let [[left, right], [bottom, top]] = self.window;
        let x = Axis::new(self.x.as_str()).limits(left, right);
        let y = Axis::new(self.y.as_str()).limits(bottom, top);
        let mut panel =
            Panel::new(x, y).legend(Legend::Below).curve(Line::new(self.arrows()).color(FAINT).width(0.5));
        let nullclines = [
            (&self.x, &self.x_nullclines, palette::VERMILION),
            (&self.y, &self.y_nullclines, palette::GREEN),
        ];
        for (name, curves, color) in nullclines {
            if !curves.is_empty() {
                let legend = format!("{name}\u{2032} = 0");
                panel = panel.curve(Line::new(joined(curves)).color(color).width(1.0).legend(legend));
            }
        }
        for (stable, legend) in [(true, "stable manifold"), (false, "unstable manifold")] {
            let curves: Vec<Vec<[f64; 2]>> = self
                .manifolds
                .iter()
                .filter(|curve| curve.stable == stable)
                .map(|curve| curve.points.clone())
                .collect();
            if !curves.is_empty() {
                let line = Line::new(joined(&curves)).color(palette::PURPLE).width(0.9).legend(legend);
                panel = panel.curve(if stable { line.dashed() } else { line });
            }
        }
        panel = panel.curve(
            Line::new(motion.iter().map(|[x, y]| (*x, *y))).color(palette::BLUE).width(1.4).legend("motion"),
        );
        let start = motion.first().map(|[x, y]| (*x, *y));
        let start_marker = Marker::new(MarkerShape::Triangle).color(palette::BLUE).size(4.5);
        panel = panel.markers(Markers::new(start, start_marker).legend("start"));
        for (legend, marker, kinds) in [
            ("stable", Marker::default(), STABLE),
            ("unstable", Marker::default().open(), UNSTABLE),
            ("saddle", Marker::new(MarkerShape::Diamond).open(), SADDLE),
            ("stability undecided", Marker::new(MarkerShape::Square).open(), UNDECIDED),
        ] {
            let points: Vec<(f64, f64)> = self
                .equilibria
                .iter()
                .flatten()
                .filter(|found| kinds.contains(&found.kind))
                .map(|found| (found.x, found.y))
                .collect();
            if !points.is_empty() {
                panel = panel.markers(Markers::new(points, marker.size(5.0)).legend(legend));
            }
        }
        panel
    }

    /// All arrows of the direction field as one line with gaps.
    fn arrows(&self) -> Vec<(f64, f64)> {
        let [[left, right], [bottom, top]] = self.window;
        let [across, up] = ARROWS.map(|count| ARROW / count as f64);
        let mut line = Vec::new();
        for Direction { at: [x, y], velocity } in &self.directions {
            let place = [(x - left) / (right - left), (y - bottom) / (top - bottom)];
            // In units of the length of an arrow, so that its shape on the page does not depend on its direction.
            let (dx, dy) = (velocity[0] / ((right - left) * across), velocity[1] / ((top - bottom) * up));
            let speed = dx.hypot(dy);
            if !(speed > 0.0 && speed.is_finite()) {
                continue;
            }
            let (dx, dy) = (dx / speed, dy / speed);
            let at = |along: f64, aside: f64| {
                let (u, v) = (along * dx - aside * dy, along * dy + aside * dx);
                let (u, v) = (place[0] + across * u, place[1] + up * v);
                (left + u * (right - left), bottom + v * (top - bottom))
            };
            let gap = (f64::NAN, f64::NAN);
            let [length, width] = HEAD;
            line.extend([at(-0.5, 0.0), at(0.5, 0.0), gap]);
            line.extend([at(0.5 - length, width), at(0.5, 0.0), at(0.5 - length, -width), gap]);
        }
        line
    }
}

const STABLE: &[EquilibriumKind] = &[EquilibriumKind::StableNode, EquilibriumKind::StableFocus];
const UNSTABLE: &[EquilibriumKind] = &[EquilibriumKind::UnstableNode, EquilibriumKind::UnstableFocus];
const SADDLE: &[EquilibriumKind] = &[EquilibriumKind::Saddle];
const UNDECIDED: &[EquilibriumKind] = &[EquilibriumKind::Centre, EquilibriumKind::Degenerate];

/// Several curves as one with gaps.
fn joined(curves: &[Vec<[f64; 2]>]) -> Vec<(f64, f64)> {
    let gap = [(f64::NAN, f64::NAN)];
    curves.iter().flat_map(|curve| curve.iter().map(|[x, y]| (*x, *y)).chain(gap)).collect()
}
