//! A curve of equilibria in two parameters, of any model: special ones, or those on which a quantity keeps its value.

use super::quantities::Quantities;
use crate::branch::{Origin, certain_digits, pairs, parameters, shortened, tests};
use crate::course;
use crate::end::End;
use crate::labels;
use crate::monitor::{monitored, named as named_monitors};
use crate::normal_form;
use crate::picture::{self, Curve};
use crate::unlocated::UnlocatedChangeResult;
use crate::varying_parameter::VaryingParameter;
use arclength::branch::{SpecialKind, Unlocated};
use arclength::continuation::Stop;
use arclength::locus::{CodimensionTwoPoint, LocusPoint};
use kingpin_figure::{Color, Figure, palette};
use kingpin_report::{Cell, Columns, NamedNumbers, Story, Table};
use serde::{Deserialize, Serialize};
use std::convert::Infallible;
use std::io::{self, Write};

/// States that are shown in a table.
const SHOWN_STATES: usize = 3;
/// Digits of the parameters at labelled points.
const DIGITS: usize = 12;

/// A point of the curve in a result.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct EquilibriumCurvePoint {
    /// Values of the two parameters.
    #[serde(with = "kingpin_report::number")]
    pub values: [f64; 2],
    /// The equilibrium.
    pub state: NamedNumbers,
    /// Eigenvalues by descending real part.
    pub eigenvalues: Vec<[Option<f64>; 2]>,
    /// Angular frequency of a Hopf point; nothing at a neutral saddle.
    pub frequency: Option<f64>,
    /// First Lyapunov coefficient of a Hopf point.
    pub first_lyapunov: Option<f64>,
    /// Of points of codimension two, of values asked for, of the ends.
    pub label: Option<String>,
    /// Test functions by the label of the point at which each changes its sign.
    pub tests: NamedNumbers,
    /// What was monitored, where it exists.
    #[serde(default, skip_serializing_if = "NamedNumbers::is_empty")]
    pub monitors: NamedNumbers,
    /// What is known about a point of codimension two.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub special: Option<CodimensionTwoPoint>,
}

/// A curve of special points in two parameters.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct EquilibriumCurve {
    /// What the curve consists of; nothing where it consists of any equilibria.
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
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub unlocated: Vec<UnlocatedChangeResult>,
    /// The points in the order of the curve.
    pub points: Vec<EquilibriumCurvePoint>,
}

impl EquilibriumCurve {
    /// The result of a curve, with why it ends at its first and at its last point; `named` gives a state by name.
    pub fn new<'a>(
        kind: Option<SpecialKind>,
        quantities: impl Into<Quantities<'a>>,
        from: Origin,
        points: &[LocusPoint],
        stops: &[Option<Stop<Infallible>>; 2],
        unlocated: &[Unlocated],
        named: impl Fn(&[f64]) -> NamedNumbers,
    ) -> Self {
        let Quantities { plane, monitors, ends } = quantities.into();
        let ends = ends.unwrap_or(monitors);
        let count = points.len();
        let point = |(index, point): (usize, &LocusPoint)| EquilibriumCurvePoint {
            values: point.values,
            state: named(&point.state),
            eigenvalues: pairs(&point.eigenvalues),
            frequency: point.frequency,
            first_lyapunov: point.first_lyapunov,
            label: point.label.map(|label| label.to_string()).or_else(|| labels::of_end(index, count)),
            tests: tests(point.tests.iter().map(|(name, value)| (name.as_ref(), *value))),
            monitors: named_monitors(monitors, &point.monitors),
            special: point.special.as_deref().cloned(),
        };
        let points: Vec<EquilibriumCurvePoint> = points.iter().enumerate().map(point).collect();
        let last = |point: Option<&EquilibriumCurvePoint>| {
            let values = point.map(|point| {
                let values = plane.iter().zip(point.values).map(|(one, value)| (one.key.clone(), value));
                values.chain(point.state.0.iter().cloned()).collect()
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
            Some(kind) => format!("{}s", kind.name()),
            None => format!("equilibria with {}", parameters(&self.held.0)),
        }
    }

    /// What was detected but not located.
    pub fn warnings(&self) -> Vec<String> {
        shortened(self.unlocated.iter().map(|change| change.text(&self.plane)).collect())
    }

    /// Names of the states.
    fn states(&self) -> Vec<&str> {
        let first = self.points.first();
        first.iter().flat_map(|point| point.state.0.iter().map(|(name, _)| name.as_str())).collect()
    }

    /// What is drawn in the plane of the parameters: neutral saddles on a curve of Hopf points are dashed.
    pub fn drawn(&self) -> Curve {
        self.drawn_with([|value| value; 2])
    }

    /// As it is drawn where the values of both parameters are drawn by these scales.
    pub fn drawn_with(&self, [first, second]: [fn(f64) -> f64; 2]) -> Curve {
        let (name, color): (&'static str, Color) = match self.kind {
            Some(SpecialKind::Fold) => ("folds", palette::BLUE),
            Some(SpecialKind::Hopf) => ("Hopf points", palette::VERMILION),
            Some(SpecialKind::BranchPoint) => ("branch points", palette::GREEN),
            Some(_) => ("special points", palette::PURPLE),
            None => ("equilibria", palette::SKY_BLUE),
        };
        Curve::of(
            name,
            color,
            &[],
            self.points.iter().map(|point| {
                let real = self.kind != Some(SpecialKind::Hopf) || point.frequency.is_some();
                ((first(point.values[0]), second(point.values[1])), Some(real), point.label.as_deref())
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
        let hopf = self.kind == Some(SpecialKind::Hopf);
        let frequency = self.plane[0].heading_beside("frequency", "rad/s");
        let of_hopf = [frequency.as_str(), "l1"].into_iter().filter(|_| hopf);
        let states = self.states().into_iter().take(SHOWN_STATES);
        let monitors: Vec<&str> = monitored(self.points.iter().map(|point| &point.monitors));
        let headings = ["label", &one, &two].into_iter().chain(states).chain(of_hopf);
        let mut table = Table::new(headings.chain(monitors.iter().copied()).chain([""]));
        for point in self.points.iter().filter(|point| point.label.is_some()) {
            let mut cells: Vec<Cell> = vec![point.label.clone().into()];
            let errors = point.special.as_ref().map_or([0.0; 2], |special| special.location_error);
            let values = point.values.into_iter().zip(errors);
            cells.extend(
                values.map(|(value, error)| Cell::Digits(value, certain_digits(value, error).min(DIGITS))),
            );
            cells.extend(point.state.0.iter().take(SHOWN_STATES).map(|(_, value)| Cell::from(*value)));
            if hopf {
                cells.extend([point.frequency, point.first_lyapunov].map(Cell::from));
            }
            cells.extend(monitors.iter().map(|name| Cell::from(point.monitors.named(name))));
            cells
                .push(point.special.as_ref().map(normal_form::of_codimension_two).unwrap_or_default().into());
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
            .optional_numbers("frequency", points().map(|point| point.frequency))
            .optional_numbers("first_lyapunov", points().map(|point| point.first_lyapunov));
        let states = self.states();
        for (index, name) in states.iter().enumerate() {
            columns = columns.optional_numbers(*name, points().map(|point| point.state.get(index)));
        }
        columns
            .complex_numbers("eigenvalue", states.len(), points().map(|point| &point.eigenvalues))
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
        for point in &self.points {
            if let Some(special) = &point.special {
                let [first, second] = self.at(point.values);
                let label = point.label.clone().unwrap_or_default();
                story.tell(
                    "course",
                    format!("{label} at {first}, {second}: {}", normal_form::of_codimension_two(special)),
                );
            }
        }
        story.tell("steps", format!("{} points", self.points.len()));
        let errors = self.points.iter().filter_map(|point| Some(point.special.as_ref()?.location_error));
        let largest = errors.flatten().filter(|error| error.is_finite()).fold(0.0, f64::max);
        if largest > 0.0 {
            story.tell("errors", format!("points of codimension two: at most {largest:.1e}"));
        }
        story
    }
}
