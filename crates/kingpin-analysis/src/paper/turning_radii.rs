//! Figure 6: the limit cycles at several turning radii, straight running among them.

use super::branches::{Branch, Branches, FASTEST, FIGURE_6_LENGTH};
use super::data::{Cell, Data};
use super::diagrams_in_space::{beyond_rolling_legend, stability_word};
use super::drawing::Drawing;
use super::rolling_limit::HEAVIEST;
use super::wheel::{radius_color, radius_label};
use crate::error::Error;
use arclength::branch::{Labelled, SpecialKind};
use arclength::cycle::CyclePoint;
use kingpin_figure::{
    Axis, Branch as Curve, Color, Dash, Figure, Legend, LegendEntry, Line, Marker, MarkerShape, Markers,
    Panel, Stability, palette,
};

pub(super) fn drawing(branches: &Branches) -> Result<Drawing, Error> {
    let mut panel = Panel::new(
        Axis::new("$v$ (m/s)").limits(0.0, FASTEST),
        Axis::new("extremes of $\\psi-\\psi_0$ (rad)").limits(-0.8, 0.8),
    )
    .legend(Legend::Below)
    .curve(Line::new([(0.0, 0.0), (FASTEST, 0.0)]).color(palette::GREY).width(0.6));
    let mut data = Data::new(&[
        ("solution", ""),
        ("r", "m"),
        ("v", "m/s"),
        ("psi_max - psi0", "rad"),
        ("psi_min - psi0", "rad"),
        ("psi0", "rad"),
        ("period", "s"),
        ("stability", ""),
        ("friction_max", "N"),
    ]);
    for branch in branches.of_figure_6() {
        let radius = branch.radius;
        let color = radius_color(radius);
        let [upper, lower] = extremes(branch)?;
        panel = panel
            .curve(diagram(branch, upper)?.color(color))
            .curve(diagram(branch, lower)?.color(color))
            .legend_entry(LegendEntry::line(radius_label(radius), color, Dash::Dashed));
        let tori = branch.cycles.iter().filter(|cycle| is_torus(cycle));
        let deviations = tori
            .map(|cycle| {
                let uniform = branch.uniform_angle(cycle.value)?;
                Ok([(cycle.value, cycle.max[2] - uniform), (cycle.value, cycle.min[2] - uniform)])
            })
            .collect::<Result<Vec<_>, Error>>()?;
        panel = panel.markers(Markers::new(deviations.into_iter().flatten(), torus_marker(color)));
        if let Some(hopf) = &branch.hopf {
            let marker = Marker::new(MarkerShape::Circle).size(3.6).color(color);
            panel = panel.markers(Markers::new([(hopf.value, 0.0)], marker));
            data.push([
                "Hopf point".into(),
                radius.into(),
                hopf.value.into(),
                0.0.into(),
                0.0.into(),
                hopf.state[2].into(),
                (std::f64::consts::TAU / hopf.frequency).into(),
                Cell::Empty,
                hopf.wheel.uniform_motion()?.contact_force().friction().into(),
            ]);
        }
        for cycle in &branch.cycles {
            let uniform = branch.uniform_angle(cycle.value)?;
            data.push([
                "limit cycle".into(),
                radius.into(),
                cycle.value.into(),
                (cycle.max[2] - uniform).into(),
                (cycle.min[2] - uniform).into(),
                uniform.into(),
                cycle.period.into(),
                if is_torus(cycle) { "torus bifurcation" } else { stability_word(cycle.stable) }.into(),
                branch.forces(cycle)?.friction_max.into(),
            ]);
        }
    }
    let hopf = Marker::new(MarkerShape::Circle).size(3.6);
    panel = panel.legend_entry(LegendEntry::marker("Hopf point", hopf));
    panel = panel.legend_entry(LegendEntry::marker("torus bifurcation", torus_marker(palette::BLACK)));
    panel = panel.legend_entry(LegendEntry::line(beyond_rolling_legend(), palette::BLACK, Dash::Dotted));
    let figure = Figure::single_column()
        .height_mm(84.0)
        .description("Extremes of the caster angle of the limit cycles against the towing speed for several turning radii")
        .panel(panel);
    let caption = format!(
        "Limit cycles at <i>l</i> = {FIGURE_6_LENGTH} m for several turning radii: largest and smallest deviation of the caster angle \
         from that of the uniform motion. The branch of straight running (<i>r</i> = ∞), which has no Hopf point, was reached by \
         following a cycle in 1/<i>r</i> to zero. Dashed: unstable; dotted: cycles that ask the ground for more than the static friction under {} N, the largest load of \
         figure 4. At a torus bifurcation a pair of multipliers \
         crosses the unit circle.",
        HEAVIEST.abs()
    );
    Ok(Drawing { number: 6, figure, data, caption })
}

fn is_torus(cycle: &CyclePoint) -> bool {
    cycle.special_kind() == Some(SpecialKind::Torus)
}

fn torus_marker(color: Color) -> Marker {
    Marker::new(MarkerShape::Diamond).open().size(3.2).color(color)
}

/// Largest and smallest deviation from the uniform motion against the speed.
fn extremes(branch: &Branch) -> Result<[Vec<(f64, f64)>; 2], Error> {
    let (mut upper, mut lower) = (Vec::new(), Vec::new());
    for (speed, max, min) in branch.extremes() {
        let uniform = branch.uniform_angle(speed)?;
        upper.push((speed, max - uniform));
        lower.push((speed, min - uniform));
    }
    Ok([upper, lower])
}

fn diagram(branch: &Branch, points: Vec<(f64, f64)>) -> Result<Curve, Error> {
    let start = std::iter::repeat_n(Stability::Changes, usize::from(branch.hopf.is_some()));
    let cycles = branch.cycles.iter().map(|cycle| Stability::from(cycle.stable == Some(true)));
    Ok(Curve::new(points.into_iter().zip(start.chain(cycles))).dotted(branch.beyond_rolling()?))
}
