//! Draws one figure of each kind into a folder, as SVG, PNG and PDF, and prints how long each took:
//! `cargo run --release -p kingpin-figure --example gallery -- FOLDER`. The curves are invented.

use std::path::PathBuf;
use std::time::Instant;

use kingpin_figure::{
    Axis, Branch, CategoryMap, ColorMap, Dash, Figure, FigureError, Grid, HeatMap, Legend, LegendEntry, Line,
    Marker, MarkerShape, Markers, Note, Panel, Panel3d, Point, PointLabel, Projection, Region, Stability,
    Wall, palette,
};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let folder = PathBuf::from(std::env::args().nth(1).unwrap_or_else(|| "gallery".to_owned()));
    std::fs::create_dir_all(&folder)?;
    let figures = [
        ("stacked", stacked()),
        ("chart", stability_chart()),
        ("growth", growth_rate()?),
        ("bifurcation", bifurcation()),
        ("basins", basins()?),
        ("space", space()),
    ];
    for (name, figure) in figures {
        for ending in ["svg", "png", "pdf"] {
            let path = folder.join(name).with_extension(ending);
            let start = Instant::now();
            figure.save(&path)?;
            let size = std::fs::metadata(&path)?.len();
            println!("{:40} {:7.1} ms {:8} bytes", path.display(), 1e3 * start.elapsed().as_secs_f64(), size);
        }
    }
    Ok(())
}

fn curve(from: f64, to: f64, f: impl Fn(f64) -> f64) -> Vec<Point> {
    (0..=400).map(|i| from + (to - from) * f64::from(i) / 400.0).map(|x| Point::new(x, f(x))).collect()
}

/// Three quantities over one shared axis.
fn stacked() -> Figure {
    let speed = || Axis::new("$v$ (m/s)").limits(0.0, 12.0);
    let panel = |tag: &str, x: Axis, label: &str, points: Vec<Point>| {
        Panel::new(x, Axis::new(label)).tag(tag).curve(Line::new(points).color(palette::BLUE))
    };
    Figure::single_column()
        .height_mm(110.0)
        .description("Lateral and longitudinal displacement and caster angle against speed")
        .panel(panel("(a)", speed().without_labels(), "$q_0$ (mm)", curve(0.0, 12.0, |v| 0.35 * v * v)))
        .panel(panel(
            "(b)",
            speed().without_labels(),
            "$u_0$ (m)",
            curve(0.0, 12.0, |v| 1e-7 * (2.0 * v).sin()),
        ))
        .panel(panel("(c)", speed(), "$\\psi_0$ (rad)", curve(0.0, 12.0, |v| 0.08 - 2e-4 * v * v)))
}

fn boundary(r: f64) -> Vec<Point> {
    (0..=300)
        .map(|i| 0.0461 + 0.2539 * f64::from(i) / 300.0)
        .map(|l| Point::new(r * 8.43 * (1.0 - (-(l - 0.046) / 0.012).exp()) * (1.0 - 1.2 * (l - 0.08)), l))
        .collect()
}

/// A stability chart with a shaded domain and curves that carry their names, and a second panel beside it.
fn stability_chart() -> Figure {
    let colors = [palette::VERMILION, palette::BLACK, palette::BLUE, palette::GREEN];
    let radii = [0.5, 1.0, 2.0, 5.0];
    let mut chart =
        Panel::new(Axis::new("$v$ (m/s)").limits(0.0, 16.0), Axis::new("$l$ (m)").limits(0.0, 0.3))
            .tag("(a)")
            .note(Note::new((1.5, 0.2), "stable"))
            .note(Note::new((6.0, 0.02), "unstable"));
    let mut shaded = boundary(1.0);
    shaded.extend([Point::new(0.0, 0.3), Point::new(0.0, 0.0461)]);
    chart =
        chart.region(Region::new(shaded).fill(palette::SKY_BLUE.lightened(0.6)).legend("stable at $r=1$ m"));
    let mut collapse = Panel::new(
        Axis::new("$v/r$ (rad/s)").limits(0.0, 10.0),
        Axis::new("$l$ (m)").limits(0.0, 0.3).without_labels(),
    )
    .tag("(b)");
    for (r, color) in radii.into_iter().zip(colors) {
        let line = boundary(r);
        collapse = collapse.markers(
            Markers::new(
                line.iter().skip((r * 20.0) as usize).step_by(60).map(|p| Point::new(p.x / r, p.y)),
                Marker::new(MarkerShape::Circle).open().color(color),
            )
            .legend(format!("$r={r}$ m")),
        );
        chart = chart.curve(Line::new(line).color(color).name(format!("$r={r}$ m")));
    }
    chart = chart
        .curve(Line::new([(0.0, 0.0461), (16.0, 0.0461)]).dashed().color(palette::GREY).name("$r=\\infty$"));
    collapse = collapse.curve(Line::new(boundary(1.0)).legend("$\\omega_{\\mathrm{crit}}(l)$"));
    Figure::double_column().columns(2).column_weights([1.4, 1.0]).height_mm(75.0).panel(chart).panel(collapse)
}

/// A heat map about zero with its zero contour.
fn growth_rate() -> Result<Figure, FigureError> {
    let x: Vec<f64> = (0..600).map(|i| 12.0 * f64::from(i) / 599.0).collect();
    let y: Vec<f64> = (0..400).map(|i| 0.01 + 0.29 * f64::from(i) / 399.0).collect();
    let mut values = Vec::with_capacity(x.len() * y.len());
    for l in &y {
        values.extend(x.iter().map(|v| {
            let critical = 8.43 * (1.0 - (-(l - 0.02) / 0.03).exp()) * (1.0 - 1.2 * (l - 0.08));
            if *l < 0.03 && *v > 10.0 { f64::NAN } else { 2.0 * (v - critical) / (1.0 + 10.0 * l) }
        }));
    }
    let map = HeatMap::new(Grid::new(x, y)?, values)?
        .color_map(ColorMap::Diverging)
        .label("largest growth rate (1/s)");
    let zero = map.contour(0.0);
    let panel = Panel::new(Axis::new("$v$ (m/s)"), Axis::new("$l$ (m)"))
        .map(map)
        .curves(zero.into_iter().map(|line| Line::new(line).color(palette::BLACK).name("0")));
    Ok(Figure::single_column().panel(panel))
}

/// Branches of cycles with stable and unstable parts and labelled points.
fn bifurcation() -> Figure {
    let fold = 2.0;
    let amplitude = |s: f64| (8.43 - 6.43 * (1.0 - (1.0 - s).powi(2)), 0.35 * s.sqrt() * (1.0 + 0.8 * s));
    let cycles = |sign: f64| {
        let mut points: Vec<(Point, Stability)> = (0..=200)
            .map(|i| amplitude(f64::from(i) / 200.0))
            .map(|(v, a)| (Point::new(v, sign * a), Stability::Unstable))
            .collect();
        points[200].1 = Stability::Changes;
        points.extend((1..=150).map(|i| {
            let s = f64::from(i) / 150.0;
            (Point::new(fold + 9.0 * s * s, sign * (0.63 + 0.5 * s)), Stability::Stable)
        }));
        Branch::new(points).color(palette::VERMILION)
    };
    let uniform = Branch::new((0..=120).map(|i| {
        let v = 0.1 * f64::from(i);
        let stability = match i {
            84 => Stability::Changes,
            _ => Stability::from(i < 84),
        };
        (Point::new(v, 0.0), stability)
    }));
    let panel = Panel::new(Axis::new("$v$ (m/s)").limits(0.0, 12.0), Axis::new("$\\psi-\\psi_0$ (rad)"))
        .curve(uniform.color(palette::BLUE).legend("uniform motion"))
        .curve(cycles(1.0).legend("limit cycle"))
        .curve(cycles(-1.0))
        .legend_entry(LegendEntry::line("unstable", palette::BLACK, Dash::Dashed))
        .point(PointLabel::new((8.4, 0.0), "HB1"))
        .point(PointLabel::new((2.0, 0.63), "LPC1").marker(Marker::new(MarkerShape::Square)))
        .point(PointLabel::new((2.0, -0.63), "LPC1").marker(Marker::new(MarkerShape::Square)))
        .point(PointLabel::new((6.0, 0.9633), "PD1").marker(Marker::new(MarkerShape::Diamond).open()))
        .point(PointLabel::new((7.0, 1.0027), "NS1").marker(Marker::new(MarkerShape::Triangle).open()));
    Figure::single_column().panel(panel)
}

/// Basins of attraction, and a logarithmic axis.
fn basins() -> Result<Figure, FigureError> {
    let nodes: Vec<f64> = (0..120).map(|i| -1.5 + 3.0 * f64::from(i) / 119.0).collect();
    let mut cells = Vec::new();
    for y in &nodes {
        cells.extend(nodes.iter().map(|x| {
            let spiral = (3.0 * x.hypot(*y) + y.atan2(*x)).sin();
            if x.hypot(*y) < 0.5 {
                0
            } else if spiral > 0.2 {
                1
            } else {
                2
            }
        }));
    }
    let entries = [
        ("uniform motion", palette::BLUE.lightened(0.4)),
        ("tumbling", palette::ORANGE.lightened(0.3)),
        ("escape", palette::LIGHT_GREY),
    ];
    let basins = Panel::new(Axis::new("$\\psi$ (rad)"), Axis::new("$\\Omega$ (rad/s)"))
        .tag("(a)")
        .map(CategoryMap::new(Grid::new(nodes.clone(), nodes)?, cells, entries)?)
        .legend(Legend::Below);
    let convergence = Panel::new(
        Axis::new("mesh intervals").logarithmic(),
        Axis::new("relative error").logarithmic().limits(1e-12, 1e-1),
    )
    .tag("(b)")
    .title("convergence")
    .markers(
        Markers::new(
            [(5.0, 2e-2), (10.0, 1e-4), (20.0, 4e-7), (40.0, 1.6e-9), (80.0, 6e-12)],
            Marker::new(MarkerShape::Diamond).color(palette::BLUE),
        )
        .legend("computed"),
    )
    .curve(Line::new(curve(4.0, 100.0, |n| 1e4 * n.powi(-8))).dotted().legend("order 8"))
    .region(
        Region::new([(4.0, 1e-12), (100.0, 1e-12), (100.0, 1e-11), (4.0, 1e-11)])
            .hatched(palette::GREY, 45.0),
    );
    Ok(Figure::double_column().columns(2).panel(basins).panel(convergence))
}

/// A stability chart on the ground with bifurcation diagrams standing on it.
fn space() -> Figure {
    let mut shaded = boundary(1.0);
    shaded.extend([Point::new(0.0, 0.3), Point::new(0.0, 0.0461)]);
    let mut panel = Panel3d::new(
        Axis::new("$v$ (m/s)").limits(0.0, 10.0),
        Axis::new("$l$ (m)").limits(0.0, 0.3),
        Axis::new("$\\psi$ (rad)").limits(-1.0, 1.0),
    )
    .projection(Projection::axonometric(-24.0, 34.0).perspective(5.0).proportions(1.3, 1.5, 0.42))
    .ground_region(Region::new(shaded).fill(palette::SKY_BLUE.lightened(0.6)))
    .ground_curve(Line::new(boundary(1.0)).color(palette::BLUE))
    .legend_entry(LegendEntry::line("stable", palette::GREEN, Dash::Solid))
    .legend_entry(LegendEntry::line("unstable", palette::VERMILION, Dash::Dashed))
    .legend_entry(LegendEntry::patch("linearly stable at $r=1$ m", palette::SKY_BLUE.lightened(0.6)));
    for l in [0.06, 0.1, 0.15, 0.2, 0.25] {
        let line = boundary(1.0);
        let hopf = line.iter().find(|p| p.y >= l).map_or(8.0, |p| p.x);
        let steady = |v: f64| 0.3 * l + 0.001 * v * v;
        let uniform = Branch::new(curve(0.0, 10.0, steady).into_iter().map(|p| (p, p.x <= hopf)))
            .color(palette::GREEN)
            .unstable_color(palette::VERMILION);
        let cycle = |sign: f64| {
            Line::new(curve(0.3, hopf, |v| steady(v) + sign * 0.8 * (1.0 - v / hopf).sqrt()))
                .dashed()
                .color(palette::VERMILION)
        };
        let hopf_point = (hopf, steady(hopf));
        panel = panel.wall(
            Wall::at(l)
                .curve(uniform)
                .curve(cycle(1.0))
                .curve(cycle(-1.0))
                .point(PointLabel::new(hopf_point, "").marker(Marker::default().size(3.0)))
                .plumb_line(hopf_point.0, hopf_point.1),
        );
    }
    Figure::double_column().height_mm(105.0).panel(panel)
}
