//! Figure 5: bifurcation diagrams standing on the stability chart.

use super::branches::{Branch, Branches, FIGURE_5_RADIUS};
use super::data::{Cell, Data};
use super::drawing::Drawing;
use super::rolling_limit::HEAVIEST;
use super::stability_chart::{Boundary, LENGTHS, boundary, stable_side};
use crate::error::Error;
use kingpin_figure::{
    Axis, Branch as Curve, Color, Dash, Figure, Legend, LegendEntry, Line, Marker, Markers, Panel, Panel3d,
    PointLabel, Projection, Region, Stability, Wall, palette,
};

/// Largest speed of the figure in m/s.
const FASTEST: f64 = 10.0;
/// Largest caster length of the figure in m.
const LONGEST: f64 = 0.2;
/// Largest caster angle of the walls in rad.
const TOP: f64 = 1.0;
/// Speeds at which a uniform motion is drawn.
const SPEEDS: usize = 200;

pub(super) fn drawing(branches: &Branches) -> Result<Drawing, Error> {
    let Boundary { points, .. } = boundary(FIGURE_5_RADIUS)?;
    let shade = palette::SKY_BLUE.lightened(0.6);
    let visible: Vec<[f64; 2]> = points.into_iter().filter(|[_, length]| *length <= LONGEST).collect();
    let mut panel = Panel3d::new(
        Axis::new("$v$ (m/s)").limits(0.0, FASTEST),
        Axis::new("$l$ (m)").limits(LENGTHS[0], LONGEST),
        Axis::new("$\\psi$ (rad)").limits(-TOP, TOP),
    )
    .projection(Projection::axonometric(-24.0, 38.0).perspective(5.0).proportions(1.3, 1.7, 0.36))
    .ground_region(Region::new(stable_side(&visible)).fill(shade))
    .ground_curve(Line::new(visible.iter().copied().map(<(f64, f64)>::from)).color(palette::BLUE))
    .legend_entry(LegendEntry::line("stable", palette::GREEN, Dash::Solid))
    .legend_entry(LegendEntry::line("unstable", palette::VERMILION, Dash::Dashed))
    .legend_entry(LegendEntry::line(beyond_rolling_legend(), palette::VERMILION, Dash::Dotted))
    .legend_entry(LegendEntry::patch("linearly stable at $r=1$ m", shade))
    .tag("(a)");
    let mut plane = Panel::new(
        Axis::new("$v$ (m/s)").limits(0.0, FASTEST),
        Axis::new("extremes of $\\psi$ (rad)").limits(-0.8, 1.0),
    )
    .tag("(b)")
    .legend(Legend::Below)
    .legend_entry(LegendEntry::line("stable", palette::BLACK, Dash::Solid))
    .legend_entry(LegendEntry::line("unstable", palette::BLACK, Dash::Dashed))
    .legend_entry(LegendEntry::line(beyond_rolling_legend(), palette::BLACK, Dash::Dotted));
    let mut data = Data::new(&[
        ("solution", ""),
        ("l", "m"),
        ("v", "m/s"),
        ("psi_max", "rad"),
        ("psi_min", "rad"),
        ("period", "s"),
        ("stability", ""),
        ("friction_max", "N"),
    ]);
    for (branch, color) in branches.of_figure_5().zip(palette::CYCLE) {
        let diagram = Diagram::of(branch, &mut data)?;
        panel = panel.wall(diagram.wall(branch));
        plane = plane.curves(diagram.curves(color, &length_label(branch)));
        let hopf = branch.hopf.iter().map(|hopf| (hopf.value, hopf.state[2]));
        plane = plane.markers(Markers::new(hopf, Marker::default().size(3.0).color(color)));
    }
    for [speed, length] in visible {
        let nothing = || Cell::Empty;
        data.push([
            "stability boundary".into(),
            length.into(),
            speed.into(),
            nothing(),
            nothing(),
            nothing(),
            nothing(),
            nothing(),
        ]);
    }
    let figure = Figure::double_column()
        .row_weights([1.35, 1.0])
        .height_mm(175.0)
        .description("Bifurcation diagrams at several caster lengths, standing on the linear stability chart, and in one plane")
        .panel(panel)
        .panel(plane);
    let caption = format!(
        "Largest and smallest caster angle against the towing speed at <i>r</i> = {FIGURE_5_RADIUS} m for several caster \
         lengths, (a) standing on the stability chart, (b) in one plane. Solid: stable; dashed: unstable; dotted: cycles that ask the \
         ground for more than the static friction under {} N, the largest load of figure 4. The cycles are born at the \
         Hopf points (dots, in (a) above the boundary of the chart) towards lower speeds.",
        HEAVIEST.abs()
    );
    Ok(Drawing { number: 5, figure, data, caption })
}

/// What the dotted parts of figures 5 and 6 are.
pub(super) fn beyond_rolling_legend() -> String {
    format!("cannot roll under {} N", HEAVIEST.abs())
}

/// The diagram at one caster length: the uniform motion, and the extremes of the cycles.
struct Diagram {
    uniform: Vec<((f64, f64), Stability)>,
    extremes: [Vec<((f64, f64), Stability)>; 2],
    /// Which of the cycles, after the Hopf point, cannot roll under any load of figure 4.
    beyond_rolling: Vec<bool>,
}

impl Diagram {
    fn of(branch: &Branch, data: &mut Data) -> Result<Self, Error> {
        let hopf = branch.hopf.iter().map(|hopf| hopf.value);
        let mut speeds: Vec<f64> = (1..=SPEEDS).map(|index| FASTEST * index as f64 / SPEEDS as f64).collect();
        speeds.extend(hopf.clone());
        speeds.sort_by(f64::total_cmp);
        let mut uniform = Vec::with_capacity(speeds.len());
        for speed in speeds {
            let motion = branch.wheel(speed)?.uniform_motion()?;
            let changes = hopf.clone().any(|critical| critical == speed);
            let stability =
                if changes { Stability::Changes } else { Stability::from(motion.is_stable() == Some(true)) };
            uniform.push(((speed, motion.psi()), stability));
            data.push([
                "uniform motion".into(),
                branch.caster_length.into(),
                speed.into(),
                motion.psi().into(),
                motion.psi().into(),
                Cell::Empty,
                if changes { "Hopf point" } else { stability_word(motion.is_stable()) }.into(),
                motion.contact_force().friction().into(),
            ]);
        }
        let stability: Vec<Stability> =
            std::iter::repeat_n(Stability::Changes, usize::from(branch.hopf.is_some()))
                .chain(branch.cycles.iter().map(|cycle| Stability::from(cycle.stable == Some(true))))
                .collect();
        let extremes = [true, false].map(|largest| {
            let points = branch.extremes().zip(&stability);
            let point = |((speed, max, min), stability): ((f64, f64, f64), &Stability)| {
                ((speed, if largest { max } else { min }), *stability)
            };
            points.map(point).collect()
        });
        for (cycle, forces) in branch.cycles_with_forces() {
            data.push([
                "limit cycle".into(),
                branch.caster_length.into(),
                cycle.value.into(),
                cycle.max[2].into(),
                cycle.min[2].into(),
                cycle.period.into(),
                stability_word(cycle.stable).into(),
                forces.friction_max.into(),
            ]);
        }
        Ok(Self { uniform, extremes, beyond_rolling: branch.beyond_rolling.clone() })
    }

    /// Upright on the chart.
    fn wall(&self, branch: &Branch) -> Wall {
        let mut wall = Wall::at(branch.caster_length);
        for curve in self.branches() {
            wall = wall.curve(curve.color(palette::GREEN).unstable_color(palette::VERMILION));
        }
        let name = PointLabel::new((0.0, TOP), length_label(branch)).without_marker();
        wall = wall.point(name);
        if let Some(hopf) = &branch.hopf {
            let at = (hopf.value, hopf.state[2]);
            let marker = Marker::default().size(3.0);
            wall = wall.point(PointLabel::new(at, "").marker(marker)).plumb_line(at.0, at.1);
        }
        wall
    }

    /// The uniform motion, the largest and the smallest angle of the cycles.
    fn branches(&self) -> [Curve; 3] {
        let [upper, lower] = &self.extremes;
        let cycles = |points: &[((f64, f64), Stability)]| {
            Curve::new(points.iter().copied()).dotted(self.beyond_rolling.iter().copied())
        };
        [Curve::new(self.uniform.iter().copied()), cycles(upper), cycles(lower)]
    }

    /// In one plane with others.
    fn curves(&self, color: Color, name: &str) -> [Curve; 3] {
        let [uniform, upper, lower] = self.branches().map(|curve| curve.color(color));
        [uniform, upper.legend(name), lower]
    }
}

/// The caster length of a diagram as the figure tells it.
fn length_label(branch: &Branch) -> String {
    format!("$l={}$ m", branch.caster_length)
}

/// Stability as it stands in the data.
pub(super) fn stability_word(stable: Option<bool>) -> &'static str {
    match stable {
        Some(true) => "stable",
        Some(false) => "unstable",
        None => "undecided",
    }
}
