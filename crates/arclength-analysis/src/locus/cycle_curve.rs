//! A curve of special cycles in two parameters, of any model.

use super::quantities::Quantities;
use crate::branch::{Origin, pairs, parameters, shortened, tests};
use crate::course;
use crate::end::End;
use crate::labels::{self, is_bifurcation};
use crate::monitor::{monitored, named as named_monitors};
use crate::picture::{self, Curve};
use crate::unlocated::UnlocatedChangeResult;
use crate::varying_parameter::VaryingParameter;
use arclength::branch::{Label, SpecialKind, Unlocated};
use arclength::continuation::Stop;
use arclength::cycle::Orbit;
use arclength::locus::{CycleLocusEnd, CycleLocusPoint};
use kingpin_figure::{Color, Figure, palette};
use kingpin_report::numbers::significant;
use kingpin_report::{Cell, Columns, NamedNumbers, Story, Table};
use serde::{Deserialize, Serialize};
use std::io::{self, Write};

/// Digits of the parameters at labelled points.
const DIGITS: usize = 11;

/// A cycle of the curve in a result.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct CycleCurvePoint {
    /// Values of the two parameters.
    #[serde(with = "kingpin_report::number")]
    pub values: [f64; 2],
    /// Period.
    pub period: f64,
    /// Largest value of every state.
    pub max: NamedNumbers,
    /// Smallest value of every state.
    pub min: NamedNumbers,
    /// Floquet multipliers, the largest modulus first.
    pub multipliers: Vec<[Option<f64>; 2]>,
    /// How far the computed trivial multiplier is from 1.
    pub trivial_multiplier_error: f64,
    /// Error estimate of cycle and eigenfunctions relative to their sizes.
    pub error_estimate: f64,
    /// Mesh intervals.
    pub intervals: usize,
    /// Argument of the multipliers of a torus bifurcation.
    pub argument: Option<f64>,
    /// Coefficient of the normal form.
    pub coefficient: Option<f64>,
    /// Of points of codimension two, of values asked for, of the ends.
    pub label: Option<String>,
    /// Error estimates of the parameters at a point of codimension two.
    pub location_error: Option<[f64; 2]>,
    /// Test functions by the label of the point at which each changes its sign.
    pub tests: NamedNumbers,
    /// What was monitored, where it exists.
    #[serde(default, skip_serializing_if = "NamedNumbers::is_empty")]
    pub monitors: NamedNumbers,
    /// The cycle itself, where a computation can start from it.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub orbit: Option<Orbit>,
}

/// A curve of special cycles in two parameters.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct CycleCurve {
    /// What the curve consists of; nothing where it consists of any cycles.
    pub kind: Option<SpecialKind>,
    /// What keeps its value along the curve, with that value.
    #[serde(default, skip_serializing_if = "NamedNumbers::is_empty")]
    pub held: NamedNumbers,
    /// The parameters that vary.
    #[serde(rename = "in")]
    pub plane: [VaryingParameter; 2],
    /// Where the curve starts.
    pub from: Origin,
    /// Why it ends, at its first and at its last point.
    pub ends: [End; 2],
    /// What was detected but not located.
    #[serde(default)]
    pub unlocated: Vec<UnlocatedChangeResult>,
    /// The points in the order of the curve.
    pub points: Vec<CycleCurvePoint>,
}

impl CycleCurve {
    /// The result of a curve, with why it ends at its first and at its last point; `named` gives a state by name.
    pub fn new<'a>(
        kind: Option<SpecialKind>,
        quantities: impl Into<Quantities<'a>>,
        from: Origin,
        points: Vec<CycleLocusPoint>,
        stops: &[Option<Stop<CycleLocusEnd>>; 2],
        unlocated: &[Unlocated],
        named: impl Fn(&[f64]) -> NamedNumbers,
    ) -> Self {
        let Quantities { plane, monitors, ends } = quantities.into();
        let ends = ends.unwrap_or(monitors);
        let count = points.len();
        let points: Vec<CycleCurvePoint> = (0..)
            .zip(points)
            .map(|(index, point)| {
                let label =
                    point.label.map(|label| label.to_string()).or_else(|| labels::of_end(index, count));
                let monitors = named_monitors(monitors, &point.monitors);
                CycleCurvePoint { monitors, ..CycleCurvePoint::new(point, label, &named) }
            })
            .collect();
        let last = |point: Option<&CycleCurvePoint>| {
            let values = point.map(|point| {
                let values = plane.iter().zip(point.values).map(|(one, value)| (one.key.clone(), value));
                values.chain([("period".to_owned(), point.period)]).collect()
            });
            NamedNumbers(values.unwrap_or_default())
        };
        let ends = [
            End::monitored(stops[0].as_ref(), &plane, ends, last(points.first())),
            End::monitored(stops[1].as_ref(), &plane, ends, last(points.last())),
        ];
        let unlocated = unlocated.iter().map(UnlocatedChangeResult::from).collect();
        Self { kind, held: NamedNumbers::default(), plane, from, ends, unlocated, points }
    }

    /// The same with what keeps its value along it.
    pub fn holding(self, name: &str, value: f64) -> Self {
        Self { held: NamedNumbers(vec![(name.to_owned(), value)]), ..self }
    }

    /// What the curve consists of, in words.
    pub fn name(&self) -> String {
        match self.kind {
            Some(kind) => kind.name().to_owned(),
            None => format!("cycles with {}", parameters(&self.held.0)),
        }
    }

    /// What was detected but not located.
    pub fn warnings(&self) -> Vec<String> {
        shortened(self.unlocated.iter().map(|change| change.text(&self.plane)).collect())
    }

    /// Names of the states.
    fn states(&self) -> Vec<&str> {
        let first = self.points.first();
        first.iter().flat_map(|point| point.max.0.iter().map(|(name, _)| name.as_str())).collect()
    }

    /// What is drawn in the plane of the parameters.
    pub fn drawn(&self) -> Curve {
        self.drawn_with([|value| value; 2])
    }

    /// As it is drawn where the values of both parameters are drawn by these scales.
    pub fn drawn_with(&self, [first, second]: [fn(f64) -> f64; 2]) -> Curve {
        let (name, color): (&'static str, Color) = match self.kind {
            None => ("cycles", palette::VERMILION),
            Some(SpecialKind::FoldOfCycles) => ("folds of cycles", palette::SKY_BLUE),
            Some(SpecialKind::PeriodDoubling) => ("period doublings", palette::ORANGE),
            Some(_) => ("torus bifurcations", palette::PURPLE),
        };
        let points = self.points.iter();
        Curve::of(
            name,
            color,
            &[],
            points.map(|point| {
                ((first(point.values[0]), second(point.values[1])), Some(true), point.label.as_deref())
            }),
        )
    }

    /// Names of the two parameters.
    pub fn keys(&self) -> [&str; 2] {
        [&self.plane[0].key, &self.plane[1].key]
    }

    /// Both parameters with their values.
    fn at(&self, [first, second]: [f64; 2]) -> [String; 2] {
        [self.plane[0].at(first), self.plane[1].at(second)]
    }

    /// Writes the labelled points under a heading.
    ///
    /// # Errors
    /// Those of the writer.
    pub fn write_table(&self, heading: &str, out: &mut dyn Write) -> io::Result<()> {
        writeln!(out, "{heading}")?;
        writeln!(out, "{} points, from {}", self.points.len(), self.from.text())?;
        writeln!(out, "  first: {}\n  last:  {}\n", self.ends[0].text(), self.ends[1].text())?;
        let [one, two] = [&self.plane[0], &self.plane[1]].map(VaryingParameter::heading);
        let period = self.plane[0].heading_beside("period", "s");
        let torus = self.kind == Some(SpecialKind::Torus);
        let argument = ["argument"].into_iter().filter(|_| torus);
        let headings = ["label", &one, &two, &period, "coefficient"].into_iter().chain(argument);
        let monitors: Vec<&str> = monitored(self.points.iter().map(|point| &point.monitors));
        let headings = headings.chain(["error"]).chain(monitors.iter().copied());
        let mut table = Table::new(headings.chain([""]));
        for point in self.points.iter().filter(|point| point.label.is_some()) {
            let mut cells: Vec<Cell> = vec![point.label.clone().into()];
            cells.extend(point.values.map(|value| Cell::Digits(value, DIGITS)));
            cells.extend([Cell::Digits(point.period, DIGITS), point.coefficient.into()]);
            cells.extend(torus.then(|| Cell::from(point.argument)));
            cells.push(Cell::Digits(point.error_estimate, 2));
            cells.extend(monitors.iter().map(|name| Cell::from(point.monitors.named(name))));
            cells.push(point.remark().into());
            table.row(cells);
        }
        table.write(out)
    }

    /// Its points, for CSV and Parquet.
    pub fn columns(&self) -> Columns {
        let points = || self.points.iter();
        let [one, two] = self.keys();
        let mut columns = Columns::new()
            .texts("label", points().map(|point| point.label.clone()))
            .numbers(one, points().map(|point| point.values[0]))
            .unit(self.plane[0].unit.as_deref())
            .numbers(two, points().map(|point| point.values[1]))
            .unit(self.plane[1].unit.as_deref())
            .numbers("period", points().map(|point| point.period))
            .optional_numbers("coefficient", points().map(|point| point.coefficient))
            .optional_numbers("argument", points().map(|point| point.argument))
            .numbers("error_estimate", points().map(|point| point.error_estimate))
            .counts("intervals", points().map(|point| point.intervals as u64));
        for (index, name) in self.states().iter().enumerate() {
            columns = columns
                .optional_numbers(format!("max_{name}"), points().map(|point| point.max.get(index)))
                .optional_numbers(format!("min_{name}"), points().map(|point| point.min.get(index)));
        }
        columns
            .complex_numbers("multiplier", self.states().len(), points().map(|point| &point.multipliers))
            .named_numbers("test", points().map(|point| &point.tests))
            .named_numbers("monitor", points().map(|point| &point.monitors))
    }

    /// Its picture, with the labels of both axes and how values are drawn on them.
    pub fn figure(&self, description: &str, labels: [&str; 2], scales: [fn(f64) -> f64; 2]) -> Figure {
        picture::plane(description, labels, &[self.drawn_with(scales)])
    }

    /// The story of the run.
    pub fn story(&self) -> Story {
        let mut story = Story::new();
        story.tell("start", self.from.text());
        course::tell_ends(&mut story, &self.ends);
        for point in self.points.iter().filter(|point| is_bifurcation(point.label.as_deref())) {
            let [first, second] = self.at(point.values);
            let label = point.label.clone().unwrap_or_default();
            let remark = point.remark();
            story.tell("course", format!("{label} at {first}, {second}: {remark}"));
        }
        let unlocated = self.unlocated.iter().map(|change| change.text(&self.plane));
        unlocated.for_each(|text| story.tell("not located", text));
        story.tell("steps", format!("{} points", self.points.len()));
        let meshes = self.points.iter().map(|point| point.intervals);
        if let (Some(fewest), Some(most)) = (meshes.clone().min(), meshes.max()) {
            story.tell("meshes", format!("{fewest} to {most} intervals"));
        }
        let largest =
            |values: fn(&CycleCurvePoint) -> f64| self.points.iter().map(values).fold(0.0, f64::max);
        story.tell(
            "errors",
            format!(
                "at most {:.1e} of the amplitudes, trivial multiplier at most {:.1e} from 1",
                largest(|point| point.error_estimate),
                largest(|point| point.trivial_multiplier_error)
            ),
        );
        story
    }
}

impl CycleCurvePoint {
    fn new(point: CycleLocusPoint, label: Option<String>, named: impl Fn(&[f64]) -> NamedNumbers) -> Self {
        Self {
            values: point.values,
            period: point.period,
            max: named(&point.max),
            min: named(&point.min),
            multipliers: pairs(&point.multipliers),
            trivial_multiplier_error: point.trivial_multiplier_error,
            error_estimate: point.error_estimate,
            intervals: point.orbit.mesh.len().saturating_sub(1),
            argument: point.argument,
            coefficient: point.coefficient,
            location_error: point.location_error,
            tests: tests(point.tests.iter().map(|(name, value)| (name.as_ref(), *value))),
            monitors: NamedNumbers::default(),
            orbit: label.as_ref().map(|_| point.orbit),
            label,
        }
    }

    /// What a point of codimension two is.
    fn remark(&self) -> String {
        let label = self.label.as_deref().and_then(|label| label.parse::<Label>().ok());
        let name = label.filter(|label| label.kind != SpecialKind::Requested).map(|label| label.kind.name());
        let name = name.unwrap_or_default();
        match self.location_error.filter(|errors| errors.iter().all(|error| error.is_finite())) {
            Some([one, two]) => format!("{name}, located to {}", significant(one.max(two), 2)),
            None => name.to_owned(),
        }
    }
}
