//! Figure 3: where the uniform motion is linearly stable, for several turning radii, and the collapse of all
//! boundaries on the yaw rate `v/r`.
//!
//! The boundaries are traced as curves in the plane of speed and caster length. The collapse is shown with crossings
//! found independently: eigenvalues, by QR iteration, of the Jacobian, by automatic differentiation.

use super::data::{Cell, Data};
use super::drawing::Drawing;
use super::numbers::number;
use super::wheel::{RADII, paper_wheel, radius_color, radius_label};
use crate::error::Error;
use arclength::linear::eigenvalues::eigenvalues;
use arclength_analysis::Control;
use kingpin::parallel;
use kingpin::{Axis as Interval, Key, Plane, Wheel};
use kingpin_figure::{
    Anchor, Axis, Color, Figure, Line, Marker, MarkerShape, Markers, Note, Panel, Region, palette,
};

/// The chart of figure 3: largest speed in m/s, and caster lengths in m.
const FASTEST: f64 = 20.0;
pub(super) const LENGTHS: [f64; 2] = [0.02, 0.3];
/// The radius in m for which the chart is shaded.
pub(super) const SHADED_RADIUS: f64 = 1.0;
/// Caster lengths in m at which eigenvalues are followed through the imaginary axis.
const CROSSING_LENGTHS: [f64; 11] = [0.047, 0.05, 0.055, 0.06, 0.07, 0.08, 0.1, 0.13, 0.17, 0.22, 0.28];
/// Radii whose curves lie too close to each other to carry their names, and where the names stand.
const LABELS_BESIDE: [(f64, (f64, f64)); 2] = [(5.0, (19.7, 0.057)), (f64::INFINITY, (19.7, 0.037))];
/// Yaw rate in rad/s beyond which no boundary lies.
const LARGEST_YAW_RATE: f64 = 10.0;
/// Yaw rates in rad/s between which the first crossing is looked for, and their number.
const YAW_RATES: (f64, f64, usize) = (0.25, LARGEST_YAW_RATE, 39);
/// Halvings of the interval of a crossing: to rounding.
const HALVINGS: usize = 50;

/// The stability boundary at one radius, in order of the caster length from the critical one on.
pub(super) struct Boundary {
    pub radius: f64,
    /// Speed in m/s and caster length in m.
    pub points: Vec<[f64; 2]>,
}

/// A speed at which an eigenvalue crosses the imaginary axis.
pub(super) struct Crossing {
    pub radius: f64,
    pub caster_length: f64,
    pub speed: f64,
    /// Yaw rate of the crossing over that of the closed form, minus one.
    pub deviation: f64,
}

/// What figure 3 shows.
pub(super) struct StabilityChart {
    pub boundaries: Vec<Boundary>,
    pub crossings: Vec<Crossing>,
    /// Caster length in m above which straight running is stable at any speed.
    pub critical_caster_length: f64,
}

impl StabilityChart {
    pub(super) fn compute() -> Result<Self, Error> {
        let finite: Vec<f64> = RADII.into_iter().filter(|radius| radius.is_finite()).collect();
        let places: Vec<(f64, f64)> =
            finite.iter().flat_map(|&radius| CROSSING_LENGTHS.map(|length| (radius, length))).collect();
        let boundaries = parallel::try_map(&finite, |&radius| boundary(radius))?;
        let crossings = parallel::try_map(&places, |&(radius, length)| crossing(radius, length))?;
        Ok(Self { boundaries, crossings, critical_caster_length: critical_caster_length()? })
    }

    pub(super) fn drawing(&self) -> Result<Drawing, Error> {
        let lengths = || Axis::new("$l$ (m)").limits(0.0, LENGTHS[1]);
        let shade = palette::SKY_BLUE.lightened(0.65);
        let mut chart = Panel::new(Axis::new("$v$ (m/s)").limits(0.0, FASTEST), lengths())
            .tag("(a)")
            .note(Note::new((1.9, 0.12), "stable"))
            .note(Note::new((9.0, 0.022), "unstable"));
        let mut collapse =
            Panel::new(Axis::new("$v/r$ (rad/s)").limits(0.0, LARGEST_YAW_RATE), lengths().without_labels())
                .tag("(b)");
        for boundary in &self.boundaries {
            let color = radius_color(boundary.radius);
            if boundary.radius == SHADED_RADIUS {
                let shaded = Region::new(stable_side(&boundary.points)).fill(shade);
                chart = chart.region(shaded);
            }
            let crossings = self.crossings.iter().filter(|crossing| crossing.radius == boundary.radius);
            collapse = collapse.markers(
                Markers::new(
                    crossings.map(|crossing| (crossing.speed / crossing.radius, crossing.caster_length)),
                    collapse_marker(boundary.radius),
                )
                .legend(radius_label(boundary.radius)),
            );
            let line = Line::new(boundary.points.iter().copied().map(<(f64, f64)>::from)).color(color);
            chart = match LABELS_BESIDE.into_iter().find(|(radius, _)| *radius == boundary.radius) {
                None => chart.curve(line.name(radius_label(boundary.radius))),
                Some((radius, at)) => chart
                    .curve(line)
                    .note(Note::new(at, radius_label(radius)).anchor(Anchor::Right).color(color)),
            };
        }
        let rectilinear = [(0.0, self.critical_caster_length), (FASTEST, self.critical_caster_length)];
        let (radius, at) = LABELS_BESIDE[1];
        chart = chart
            .curve(Line::new(rectilinear).color(radius_color(radius)))
            .note(Note::new(at, radius_label(radius)).anchor(Anchor::Right).color(radius_color(radius)));
        collapse = collapse.curve(Line::new(self.closed_form()?).color(palette::GREY).legend("closed form"));
        let figure = Figure::double_column()
            .columns(2)
            .column_weights([1.35, 1.0])
            .height_mm(78.0)
            .description("Linear stability chart in the plane of towing speed and caster length")
            .panel(chart)
            .panel(collapse);
        let caption = format!(
            "Linear stability of the uniform motion. (a) Boundaries for several turning radii, the stable side on the left, \
             shaded for <i>r</i> = {SHADED_RADIUS} m; straight running (<i>r</i> = ∞) is stable above <i>l</i> = {:.6} m at every speed. \
             (b) The same boundaries against <i>v</i>/<i>r</i>. The line is the closed form; the markers are crossings of \
             eigenvalues of the Jacobian, which deviate from it by at most {} (relative).",
            self.critical_caster_length,
            number(self.largest_deviation(), 2)
        );
        Ok(Drawing { number: 3, figure, data: self.data(), caption })
    }

    /// Largest relative deviation of a crossing from the closed form.
    pub(super) fn largest_deviation(&self) -> f64 {
        self.crossings.iter().map(|crossing| crossing.deviation.abs()).fold(0.0, f64::max)
    }

    /// The closed form of the boundary, as yaw rate against caster length.
    fn closed_form(&self) -> Result<Vec<(f64, f64)>, Error> {
        let mut points = vec![(0.0, self.critical_caster_length)];
        let span = LENGTHS[1] - self.critical_caster_length;
        for index in 1..=400 {
            // Points crowd at the lower end, where the boundary turns.
            let length = self.critical_caster_length + span * (index as f64 / 400.0).powi(2);
            let wheel = paper_wheel(1.0, length, SHADED_RADIUS)?;
            points.extend(wheel.critical_yaw_rate().map(|yaw_rate| (yaw_rate, length)));
        }
        Ok(points)
    }

    fn data(&self) -> Data {
        let mut data = Data::new(&[("curve", ""), ("r", "m"), ("v", "m/s"), ("l", "m"), ("v/r", "rad/s")]);
        for Boundary { radius, points } in &self.boundaries {
            for [speed, length] in points {
                data.push([
                    "boundary".into(),
                    (*radius).into(),
                    (*speed).into(),
                    (*length).into(),
                    (speed / radius).into(),
                ]);
            }
        }
        for speed in [0.0, FASTEST] {
            data.push([
                "boundary".into(),
                f64::INFINITY.into(),
                speed.into(),
                self.critical_caster_length.into(),
                Cell::from(0.0),
            ]);
        }
        for crossing in &self.crossings {
            data.push([
                "eigenvalue crossing".into(),
                crossing.radius.into(),
                crossing.speed.into(),
                crossing.caster_length.into(),
                (crossing.speed / crossing.radius).into(),
            ]);
        }
        data
    }
}

/// The shaded side of a boundary: between it and the axis of the caster length.
pub(super) fn stable_side(boundary: &[[f64; 2]]) -> Vec<(f64, f64)> {
    let mut corners: Vec<(f64, f64)> = boundary.iter().copied().map(<(f64, f64)>::from).collect();
    corners.extend(boundary.last().map(|[_, length]| (0.0, *length)));
    corners
}

fn collapse_marker(radius: f64) -> Marker {
    // Nested sizes, since the markers of all radii lie on top of each other.
    let (shape, size) = match radius {
        r if r < 1.0 => (MarkerShape::Circle, 7.6),
        r if r < 2.0 => (MarkerShape::Square, 5.4),
        r if r < 5.0 => (MarkerShape::Diamond, 3.4),
        _ => (MarkerShape::Circle, 1.6),
    };
    let color: Color = radius_color(radius);
    Marker::new(shape).open().size(size).color(color)
}

/// Turns a curve of speeds and caster lengths so that it starts at the shorter caster.
pub(super) fn upwards(points: &mut [[f64; 2]]) {
    if let [first, .., last] = *points
        && first[1] > last[1]
    {
        points.reverse();
    }
}

/// Caster length in m above which straight running is stable at any speed.
pub(super) fn critical_caster_length() -> Result<f64, Error> {
    paper_wheel(1.0, 0.08, f64::INFINITY)?
        .critical_caster_length()
        .ok_or_else(|| Error::not_found("critical caster length", "straight running"))
}

/// The boundary at one radius, traced over all its speeds.
pub(super) fn boundary(radius: f64) -> Result<Boundary, Error> {
    let fastest = LARGEST_YAW_RATE * radius;
    let plane =
        Plane::new(Interval::new(Key::V, 0.0..=fastest)?, Interval::new(Key::L, LENGTHS[0]..=LENGTHS[1])?)?;
    let wheel = paper_wheel(fastest, LENGTHS[1], radius)?;
    let curves = wheel.stability_boundary(&plane, &Control::none())?;
    let lowest = |points: &[[f64; 2]]| points.iter().map(|[_, l]| *l).fold(f64::INFINITY, f64::min);
    let mut points = curves
        .into_iter()
        .map(|curve| curve.points)
        .min_by(|a, b| lowest(a).total_cmp(&lowest(b)))
        .ok_or_else(|| Error::not_found("stability boundary", &format!("r = {radius} m")))?;
    upwards(&mut points);
    points.insert(0, [0.0, critical_caster_length()?]);
    Ok(Boundary { radius, points })
}

/// The first speed at which an eigenvalue of the Jacobian gets a positive real part.
fn crossing(radius: f64, caster_length: f64) -> Result<Crossing, Error> {
    let not_found =
        || Error::not_found("crossing of eigenvalues", &format!("l = {caster_length} m, r = {radius} m"));
    let unstable = |yaw_rate: f64| -> Result<bool, Error> {
        Ok(growth_rate(&paper_wheel(yaw_rate * radius, caster_length, radius)?)? > 0.0)
    };
    let (start, end, count) = YAW_RATES;
    let step = (end - start) / count as f64;
    let mut low = start;
    let mut high = start;
    while !unstable(high)? {
        low = high;
        high += step;
        if high > end {
            return Err(not_found());
        }
    }
    for _ in 0..HALVINGS {
        let middle = 0.5 * (low + high);
        if unstable(middle)? { high = middle } else { low = middle }
    }
    let speed = 0.5 * (low + high) * radius;
    let closed_form = paper_wheel(speed, caster_length, radius)?.critical_yaw_rate().ok_or_else(not_found)?;
    Ok(Crossing { radius, caster_length, speed, deviation: speed / radius / closed_form - 1.0 })
}

/// Largest real part of the eigenvalues in 1/s, by QR iteration on the Jacobian.
pub(super) fn growth_rate(wheel: &Wheel) -> Result<f64, Error> {
    let jacobian = wheel.uniform_motion()?.jacobian();
    let columns: Vec<f64> = (0..5).flat_map(|column| jacobian.iter().map(move |row| row[column])).collect();
    let eigenvalues = eigenvalues(&columns, 5)?;
    Ok(eigenvalues.iter().map(|eigenvalue| eigenvalue.re).fold(f64::NEG_INFINITY, f64::max))
}
