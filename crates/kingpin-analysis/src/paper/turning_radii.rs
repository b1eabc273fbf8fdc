//! Figure 6: the limit cycles at several turning radii, straight running among them.

use super::branches::{Branch, Branches, FASTEST, FIGURE_6_LENGTH};
use super::data::{Cell, Data};
use super::diagrams_in_space::{beyond_rolling_legend, stability_word};
use super::drawing::Drawing;
use super::rolling_limit::HEAVIEST;
use super::wheel::{RADII, radius_color, radius_label};
use crate::error::Error;
use arclength::branch::{Labelled, SpecialKind};
use arclength::cycle::CyclePoint;
use kingpin_figure::{
    Axis, Branch as Curve, Color, Dash, Figure, Legend, LegendEntry, Line, Marker, MarkerShape, Markers,
    Panel, Stability, palette,
};

/// Speeds at which the uniform motion is computed.
const SPEEDS: usize = 36;

pub(super) fn drawing(branches: &Branches) -> Result<Drawing, Error> {
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
    let motions = motions_panel(branches, &mut data)?;
    let cycles = cycles_panel(branches, &mut data)?;
    let figure = Figure::single_column()
        .row_weights([1.0, 3.0])
        .height_mm(112.0)
        .description("Extremes of the caster angle of the limit cycles against the towing speed for several turning radii")
        .panel(motions)
        .panel(cycles);
    let caption = format!(
        "Turning radii at <i>l</i> = {FIGURE_6_LENGTH} m: (a) the uniform motion, (b) its limit cycles, largest and smallest deviation of the caster angle \
         from that of the uniform motion. The branch of straight running (<i>r</i> = ∞), which has no Hopf point, was reached by \
         following a cycle in 1/<i>r</i> to zero. Dashed: unstable; dotted: cycles that ask the ground for more than the static friction under {} N, the largest load of \
         figure 4. At a torus bifurcation a pair of multipliers \
         crosses the unit circle.",
        HEAVIEST.abs()
    );
    Ok(Drawing { number: 6, figure, data, caption })
}

/// The uniform motion at every radius, one above the other, by its stability.
fn motions_panel(branches: &Branches, data: &mut Data) -> Result<Panel, Error> {
    let radii = (0..).zip(RADII).map(|(place, radius): (u8, f64)| (f64::from(place), radius_label(radius)));
    let mut panel = Panel::new(
        Axis::new("$v$ (m/s)").limits(0.0, FASTEST).without_labels(),
        Axis::new("").limits(-0.6, RADII.len() as f64 - 0.4).ticks(radii),
    )
    .tag("(a)")
    .title("uniform motion");
    for (place, branch) in branches.of_figure_6().enumerate() {
        let (place, color) = (place as f64, radius_color(branch.radius));
        let along = uniform_motions(branch)?;
        for &Uniform { speed, angle, friction, stability } in &along {
            data.push([
                "uniform motion".into(),
                branch.radius.into(),
                speed.into(),
                0.0.into(),
                0.0.into(),
                angle.into(),
                Cell::Empty,
                match stability {
                    Stability::Stable => "stable",
                    Stability::Unstable => "unstable",
                    Stability::Changes => "Hopf point",
                }
                .into(),
                friction.into(),
            ]);
        }
        let line = along.iter().map(|motion| ((motion.speed, place), motion.stability));
        let hopf = branch.hopf.iter().map(|hopf| (hopf.value, place));
        let marker = Marker::new(MarkerShape::Circle).size(3.6).color(color);
        panel = panel.curve(Curve::new(line).color(color)).markers(Markers::new(hopf, marker));
    }
    Ok(panel)
}

/// The limit cycles at every radius by their extremes.
fn cycles_panel(branches: &Branches, data: &mut Data) -> Result<Panel, Error> {
    let mut panel = Panel::new(
        Axis::new("$v$ (m/s)").limits(0.0, FASTEST),
        Axis::new("extremes of $\\psi-\\psi_0$ (rad)").limits(-0.8, 0.8),
    )
    .tag("(b)")
    .title("limit cycles")
    .legend(Legend::Below)
    .curve(Line::new([(0.0, 0.0), (FASTEST, 0.0)]).color(palette::GREY).width(0.6));
    for branch in branches.of_figure_6() {
        let color = radius_color(branch.radius);
        let [upper, lower] = extremes(branch)?;
        panel = panel
            .curve(diagram(branch, upper).color(color))
            .curve(diagram(branch, lower).color(color))
            .legend_entry(LegendEntry::line(radius_label(branch.radius), color, Dash::Dashed));
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
        }
        push_cycles(branch, data)?;
    }
    let hopf = Marker::new(MarkerShape::Circle).size(3.6);
    Ok(panel
        .legend_entry(LegendEntry::marker("Hopf point", hopf))
        .legend_entry(LegendEntry::marker("torus bifurcation", torus_marker(palette::BLACK)))
        .legend_entry(LegendEntry::line(beyond_rolling_legend(), palette::BLACK, Dash::Dotted)))
}

/// The Hopf point and the cycles of a branch, as data.
fn push_cycles(branch: &Branch, data: &mut Data) -> Result<(), Error> {
    if let Some(hopf) = &branch.hopf {
        data.push([
            "Hopf point".into(),
            branch.radius.into(),
            hopf.value.into(),
            0.0.into(),
            0.0.into(),
            hopf.state[2].into(),
            (std::f64::consts::TAU / hopf.frequency).into(),
            Cell::Empty,
            hopf.wheel.uniform_motion()?.contact_force().friction().into(),
        ]);
    }
    for (cycle, forces) in branch.cycles_with_forces() {
        let uniform = branch.uniform_angle(cycle.value)?;
        data.push([
            "limit cycle".into(),
            branch.radius.into(),
            cycle.value.into(),
            (cycle.max[2] - uniform).into(),
            (cycle.min[2] - uniform).into(),
            uniform.into(),
            cycle.period.into(),
            if is_torus(cycle) { "torus bifurcation" } else { stability_word(cycle.stable) }.into(),
            forces.friction_max.into(),
        ]);
    }
    Ok(())
}

/// A uniform motion; where the stability changes it is the Hopf point.
struct Uniform {
    speed: f64,
    angle: f64,
    friction: f64,
    stability: Stability,
}

/// The uniform motions along the figure.
fn uniform_motions(branch: &Branch) -> Result<Vec<Uniform>, Error> {
    let hopf = branch.hopf.as_ref().map(|hopf| hopf.value).filter(|speed| *speed < FASTEST);
    let mut speeds: Vec<f64> = (1..=SPEEDS).map(|index| FASTEST * index as f64 / SPEEDS as f64).collect();
    speeds.extend(hopf);
    speeds.sort_by(f64::total_cmp);
    let motion = |speed: f64| {
        let motion = branch.wheel(speed)?.uniform_motion()?;
        let changes = hopf == Some(speed);
        let stability =
            if changes { Stability::Changes } else { Stability::from(motion.is_stable() == Some(true)) };
        Ok(Uniform { speed, angle: motion.psi(), friction: motion.contact_force().friction(), stability })
    };
    speeds.into_iter().map(motion).collect()
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

fn diagram(branch: &Branch, points: Vec<(f64, f64)>) -> Curve {
    let start = std::iter::repeat_n(Stability::Changes, usize::from(branch.hopf.is_some()));
    let cycles = branch.cycles.iter().map(|cycle| Stability::from(cycle.stable == Some(true)));
    Curve::new(points.into_iter().zip(start.chain(cycles))).dotted(branch.beyond_rolling.iter().copied())
}
