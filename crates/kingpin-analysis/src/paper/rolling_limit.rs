//! Figure 4: the speed up to which the ground can hold the wheel in its uniform motion, for several vertical loads.

use super::data::Data;
use super::drawing::Drawing;
use super::stability_chart::{Boundary, LENGTHS, SHADED_RADIUS, boundary, stable_side, upwards};
use super::wheel::paper_wheel;
use crate::error::Error;
use arclength_analysis::Control;
use kingpin::parallel;
use kingpin::{Axis as Interval, Key, Plane};
use kingpin_figure::{Axis, Figure, Legend, LegendEntry, Line, Panel, Region, palette};

/// Largest speed of the figure in m/s.
const FASTEST: f64 = 13.0;
/// Shortest caster of the figure in m.
const SHORTEST: f64 = 0.005;
/// Vertical forces on the king pin in N; negative ones press down.
const LOADS: [f64; 4] = [0.0, -10.0, -20.0, HEAVIEST];
/// The largest of them, under which figures 5 and 6 are looked at.
pub(super) const HEAVIEST: f64 = -50.0;
/// Where the curves carry their names, as part of their length from below.
const NAMES_AT: [f64; 4] = [0.45, 0.45, 0.83, 0.45];

/// The rolling limit under one vertical load.
pub(super) struct RollingLimit {
    pub load: f64,
    /// Curves of speed in m/s and caster length in m.
    pub curves: Vec<Vec<[f64; 2]>>,
}

impl RollingLimit {
    /// The speed of the limit at a caster length, between the two points of the curve next to it.
    pub(super) fn speed_at(&self, caster_length: f64) -> Option<f64> {
        let segments = self.curves.iter().flat_map(|curve| curve.windows(2));
        segments
            .map(|ends| (ends[0], ends[1]))
            .find(|([_, from], [_, to])| (from - caster_length) * (to - caster_length) <= 0.0 && from != to)
            .map(|([speed, from], [next, to])| speed + (next - speed) * (caster_length - from) / (to - from))
    }
}

/// What figure 4 shows.
pub(super) struct RollingLimits {
    pub limits: Vec<RollingLimit>,
    pub boundary: Boundary,
}

impl RollingLimits {
    pub(super) fn compute() -> Result<Self, Error> {
        let plane =
            Plane::new(Interval::new(Key::V, 0.0..=FASTEST)?, Interval::new(Key::L, SHORTEST..=LENGTHS[1])?)?;
        let limit = |&load: &f64| {
            let wheel = paper_wheel(FASTEST, LENGTHS[1], SHADED_RADIUS)?.with(Key::FAz, load)?;
            let mut curves: Vec<Vec<[f64; 2]>> = wheel
                .rolling_limit(&plane, &Control::none())?
                .into_iter()
                .map(|curve| curve.points)
                .collect();
            curves.iter_mut().for_each(|points| upwards(points));
            Ok::<_, Error>(RollingLimit { load, curves })
        };
        Ok(Self { limits: parallel::try_map(&LOADS, limit)?, boundary: boundary(SHADED_RADIUS)? })
    }

    pub(super) fn drawing(&self) -> Drawing {
        let shade = palette::SKY_BLUE.lightened(0.65);
        let colors = [palette::BLUE, palette::GREEN, palette::ORANGE, palette::VERMILION];
        let stability: Vec<(f64, f64)> =
            self.boundary.points.iter().copied().map(<(f64, f64)>::from).collect();
        let mut panel = Panel::new(
            Axis::new("$v$ (m/s)").limits(0.0, FASTEST),
            Axis::new("$l$ (m)").limits(0.0, LENGTHS[1]),
        )
        .region(Region::new(stable_side(&self.boundary.points)).fill(shade))
        .curve(Line::new(stability).color(palette::BLACK).width(1.4).legend("stability boundary"))
        .legend_entry(LegendEntry::patch("linearly stable", shade))
        .legend(Legend::Below);
        for ((RollingLimit { load, curves }, color), name_at) in self.limits.iter().zip(colors).zip(NAMES_AT)
        {
            for curve in curves {
                let line = Line::new(curve.iter().copied().map(<(f64, f64)>::from)).color(color).width(0.8);
                panel = panel.curve(line.name_at(name_at, format!("$F_{{\\mathrm{{A}}z}}={load}$ N")));
            }
        }
        let figure = Figure::single_column()
            .height_mm(82.0)
            .description("Rolling limits for several vertical loads in the linear stability chart")
            .panel(panel);
        let mut data = Data::new(&[("curve", ""), ("F_Az", "N"), ("v", "m/s"), ("l", "m")]);
        for RollingLimit { load, curves } in &self.limits {
            for [speed, length] in curves.iter().flatten() {
                data.push(["rolling limit".into(), (*load).into(), (*speed).into(), (*length).into()]);
            }
        }
        for [speed, length] in &self.boundary.points {
            data.push(["stability boundary".into(), None::<f64>.into(), (*speed).into(), (*length).into()]);
        }
        let caption = format!(
            "Rolling limits of the uniform motion at <i>r</i> = {SHADED_RADIUS} m and <i>μ</i><sub>s</sub> = 1, for four vertical \
             forces <i>F</i><sub>A<i>z</i></sub> on the king pin: to the left of its line the wheel rolls, to the right it must slide."
        );
        Drawing { number: 4, figure, data, caption }
    }
}
