//! Limits of wheels that differ in a third parameter, such as the radius or the load, drawn over one chart.

use crate::axis_label;
use crate::error::Error;
use arclength_analysis::{Assignment, Control};
use kingpin::{Curve, Key, KingpinError, Plane, Wheel};
use kingpin_figure::{Color, Dash, LegendEntry, Line, palette};
use kingpin_report::numbers::readable;
use serde::Serialize;

/// Most values that are drawn over one chart.
const MOST: usize = 24;
/// The colours of the values, in their order.
pub(crate) const COLORS: [Color; 6] =
    [palette::VERMILION, palette::BLUE, palette::GREEN, palette::PURPLE, palette::ORANGE, palette::SKY_BLUE];

/// The part by which colours are lighter each time that they come again.
const LIGHTER: f64 = 0.35;

/// The colour of the value with this index: where there are more values than colours these come again, lighter.
pub(super) fn color_of(index: usize) -> Color {
    let (round, index) = (index / COLORS.len(), index % COLORS.len());
    (0..round).fold(COLORS[index], |color, _| color.lightened(LIGHTER))
}

/// A parameter and its value as a figure has them.
pub(super) fn label_of(key: Key, value: f64) -> String {
    let symbol = axis_label::symbol(key);
    let unit = if key.unit() == "1" { String::new() } else { key.unit().replace("^2", "$^2$") };
    match value {
        value if value.is_infinite() => format!("{symbol}$=\\infty$"),
        value => format!("{symbol}$={}$ {unit}", readable(value)).trim_end().to_owned(),
    }
}

/// The limits of stability and of rolling of the wheel with another value of a third parameter.
#[derive(Clone, Debug, Serialize)]
pub struct Overlay {
    /// The parameter.
    #[serde(serialize_with = "name_of")]
    pub key: Key,
    /// Its value.
    #[serde(with = "kingpin_report::number")]
    pub value: f64,
    /// The limit of stability, as curves of points `[x, y]`.
    pub stability_boundary: Vec<Vec<[f64; 2]>>,
    /// The limit of rolling, as curves of points.
    pub rolling_limit: Vec<Vec<[f64; 2]>>,
}

fn name_of<S: serde::Serializer>(key: &Key, serializer: S) -> Result<S::Ok, S::Error> {
    serializer.serialize_str(key.name())
}

/// The points of curves.
pub(super) fn points_of(curves: Vec<Curve>) -> Vec<Vec<[f64; 2]>> {
    curves.into_iter().map(|curve| curve.points).collect()
}

/// The wheels of `KEY=A,B,C`, each with its value of the key.
///
/// # Errors
/// [`Error::Set`] with a key or a value that cannot be taken; [`Error::Invalid`] where the key is one of the axes, has no effect on
/// uniform motions, or there are too many values.
pub(super) fn wheels(
    given: &[Assignment],
    wheel: &Wheel,
    plane: &Plane,
) -> Result<Vec<(Key, f64, Wheel)>, Error> {
    let mut wheels = Vec::new();
    for Assignment { key, value } in given {
        let text = format!("{key}={value}");
        let wrong = |source: KingpinError| Error::Set {
            field: "overlay",
            given: text.clone(),
            source: Box::new(source),
        };
        let key: Key = key.parse().map_err(wrong)?;
        for axis in [plane.x(), plane.y()] {
            if key.sets().iter().any(|stored| axis.key().sets().contains(stored)) {
                let problem = format!("`{key}` varies with the axis `{}`", axis.key());
                return Err(Error::invalid(&["overlay"], text, problem, "a parameter that is no axis"));
            }
        }
        if key == Key::MF {
            return Err(wrong(KingpinError::DryFrictionVaries));
        }
        for part in value.split(',') {
            let mut other = *wheel;
            other.set(key.name(), part).and_then(|()| other.check()).map_err(wrong)?;
            wheels.push((key, other.get(key), other));
        }
    }
    if wheels.len() > MOST {
        let allowed = format!("at most {MOST} values");
        return Err(Error::invalid(&["overlay"], format!("{} values", wheels.len()), "too many", allowed));
    }
    Ok(wheels)
}

/// A point of a limit.
pub(crate) struct LimitPoint<'a> {
    /// Of stability, or of rolling.
    pub limit: &'static str,
    /// Whose limit it is.
    pub overlay: &'a Overlay,
    /// Number of the curve, from 1.
    pub curve: u64,
    /// Where it is.
    pub at: [f64; 2],
}

impl Overlay {
    /// Traces the limits of a wheel in a plane.
    ///
    /// # Errors
    /// [`Error::Stopped`].
    pub(crate) fn trace(
        key: Key,
        value: f64,
        wheel: &Wheel,
        plane: &Plane,
        control: &Control<'_>,
    ) -> Result<Self, Error> {
        Ok(Self {
            key,
            value,
            stability_boundary: points_of(wheel.stability_boundary(plane, &control.part(0.0..0.5))?),
            rolling_limit: points_of(wheel.rolling_limit(plane, &control.part(0.5..1.0))?),
        })
    }

    /// What it is called in text, `r = 2 m`.
    pub(crate) fn name(&self) -> String {
        crate::description::quantity(self.key, self.value)
    }

    /// What it is called in a figure.
    pub(crate) fn label(&self) -> String {
        label_of(self.key, self.value)
    }

    /// Whether nothing of it is drawn: it has no limit of rolling, and none of stability or one that is that of the wheel.
    pub(super) fn has_no_limit(&self, stability_is_shared: bool) -> bool {
        self.rolling_limit.is_empty() && (stability_is_shared || self.stability_boundary.is_empty())
    }

    /// Its limits as lines: solid that of stability, dashed that of rolling. The longest one carries the name: of stability, if that
    /// limit is its own.
    pub(crate) fn lines(&self, color: Color, stability_is_shared: bool) -> Vec<Line> {
        let longest = |curves: &[Vec<[f64; 2]>]| {
            (0..curves.len()).max_by_key(|&index| (curves[index].len(), std::cmp::Reverse(index)))
        };
        let stability: &[_] = if stability_is_shared { &[] } else { &self.stability_boundary };
        let solid = longest(stability);
        let dashed = if solid.is_some() { None } else { longest(&self.rolling_limit) };
        let mut lines = Vec::new();
        for (curves, named, is_dashed) in [(stability, solid, false), (&self.rolling_limit[..], dashed, true)]
        {
            for (index, curve) in curves.iter().enumerate() {
                let line = Line::new(curve.iter().copied()).color(color);
                let line = if is_dashed { line.dashed() } else { line };
                lines.push(if named == Some(index) { line.name(self.label()) } else { line });
            }
        }
        lines
    }

    /// What the dashes of the limits mean, for those that are drawn.
    pub(crate) fn legend(stability: bool, rolling: bool) -> impl Iterator<Item = LegendEntry> {
        let entries =
            [(stability, "limit of stability", Dash::Solid), (rolling, "limit of rolling", Dash::Dashed)];
        let drawn = entries.into_iter().filter(|(is_drawn, ..)| *is_drawn);
        drawn.map(|(_, name, dash)| LegendEntry::line(name, palette::BLACK, dash))
    }

    /// The points of its limits, curve by curve.
    pub(crate) fn points(&self) -> impl Iterator<Item = LimitPoint<'_>> {
        let limits = [("stability", &self.stability_boundary), ("rolling", &self.rolling_limit)];
        limits.into_iter().flat_map(move |(limit, curves)| {
            (1..).zip(curves).flat_map(move |(curve, places)| {
                places.iter().map(move |&at| LimitPoint { limit, overlay: self, curve, at })
            })
        })
    }
}
