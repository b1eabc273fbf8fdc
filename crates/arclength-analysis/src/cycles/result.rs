//! A branch of limit cycles as a result.

use crate::branch::{Origin, pairs, parameters, shortened, stability, tests};
use crate::course::{self, Place};
use crate::end::End;
use crate::interval::Interval;
use crate::labels::{self, is_bifurcation};
use crate::model::ChosenModel;
use crate::normal_form;
use crate::picture::{self, Curve};
use crate::stored_model::StoredModel;
use crate::unlocated::UnlocatedResult;
use crate::varying_parameter::VaryingParameter;
use arclength::cycle::{Branching, CycleBranch, CyclePoint, Orbit};
use kingpin_figure::{Figure, FigureError, palette};
use kingpin_report::{Cell, Columns, NamedNumbers, Report, Schema, Story, Table};
use serde::{Deserialize, Serialize};
use std::io::{self, Write};

/// Digits of parameter and period at labelled points.
const DIGITS: usize = 11;

/// A cycle in a result.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct CycleResult {
    /// Value of the parameter.
    pub value: f64,
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
    /// Nothing where that is not decided.
    pub stable: Option<bool>,
    /// Error estimate relative to the amplitudes.
    pub error_estimate: f64,
    /// Mesh intervals.
    pub intervals: usize,
    /// Of special points, of values asked for, of the ends.
    pub label: Option<String>,
    /// Test functions by the label of the cycle at which each changes its sign.
    pub tests: NamedNumbers,
    /// The normal form of a special cycle, by name.
    #[serde(default, skip_serializing_if = "NamedNumbers::is_empty")]
    pub normal_form: NamedNumbers,
    /// The cycle itself, where a computation can start from it.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub orbit: Option<Orbit>,
    /// The start of the branch that leaves there.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub branching: Option<Branching>,
}

/// A branch of limit cycles.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct CyclesResult {
    /// The parameters that do not vary.
    #[serde(skip_serializing)]
    pub parameters: NamedNumbers,
    /// The model.
    pub model: StoredModel,
    /// The parameter that varies.
    pub along: VaryingParameter,
    /// Where the branch starts.
    pub from: Origin,
    /// Why it ends, at its first and at its last point.
    pub ends: [End; 2],
    /// What was detected but not located.
    pub unlocated: Vec<UnlocatedResult>,
    /// The cycles in the order of the branch.
    pub points: Vec<CycleResult>,
}

impl CyclesResult {
    /// Schema of the result file.
    pub const SCHEMA: &'static str = "arclength.cycles";

    /// The result of a branch.
    pub fn new(
        chosen: &ChosenModel,
        active: usize,
        along: &Interval,
        from: Origin,
        branch: CycleBranch,
    ) -> Self {
        let count = branch.points.len();
        let points: Vec<CycleResult> = (0..)
            .zip(branch.points)
            .map(|(index, point)| {
                let own = point.label.map(|label| label.to_string());
                let label = own.or_else(|| labels::of_end(index, count));
                CycleResult::new(chosen, point, label)
            })
            .collect();
        let last = |point: Option<&CycleResult>| {
            let values =
                point.map(|point| [(along.key.clone(), point.value), ("period".to_owned(), point.period)]);
            NamedNumbers(values.into_iter().flatten().collect())
        };
        let [first, second] = &branch.stops;
        let keys = [along.key.as_str()];
        let ends = [
            End::of(first.as_ref(), &keys, last(points.first())),
            End::of(second.as_ref(), &keys, last(points.last())),
        ];
        Self {
            parameters: chosen.named_parameters(&[active]),
            model: chosen.stored.clone(),
            along: along.into(),
            from,
            ends,
            unlocated: branch.unlocated.iter().map(UnlocatedResult::of).collect(),
            points,
        }
    }

    /// What was detected but not located, each change once.
    pub fn warnings(&self) -> Vec<String> {
        let mut texts: Vec<String> =
            self.unlocated.iter().map(|change| change.text(&self.along.key)).collect();
        texts.dedup();
        shortened(texts)
    }

    /// Names of the states.
    pub fn states(&self) -> Vec<&str> {
        let first = self.points.first();
        first.iter().flat_map(|point| point.max.0.iter().map(|(name, _)| name.as_str())).collect()
    }

    /// What is drawn of a state over the parameter: its largest and its smallest value.
    pub fn curves(&self, state: &str) -> Vec<Curve> {
        let curve = |end: fn(&CycleResult) -> &NamedNumbers| {
            Curve::of(
                "limit cycle, extremes",
                palette::VERMILION,
                self.points.iter().filter_map(|point| {
                    Some(((point.value, end(point).named(state)?), point.stable, point.label.as_deref()))
                }),
            )
        };
        vec![curve(|point| &point.max), curve(|point| &point.min).without_labels()]
    }
}

impl CycleResult {
    fn new(chosen: &ChosenModel, point: CyclePoint, label: Option<String>) -> Self {
        let finite = point.normal_form.iter().filter(|(_, value)| value.is_finite());
        let normal_form = NamedNumbers(finite.map(|(name, value)| ((*name).to_owned(), *value)).collect());
        Self {
            value: point.value,
            period: point.period,
            max: chosen.named_state(&point.max),
            min: chosen.named_state(&point.min),
            multipliers: pairs(&point.multipliers),
            trivial_multiplier_error: point.trivial_multiplier_error,
            stable: point.stable,
            error_estimate: point.error_estimate,
            intervals: point.orbit.mesh.len().saturating_sub(1),
            tests: tests(point.tests.iter().map(|(name, value)| (name.as_ref(), *value))),
            normal_form,
            branching: point.branching,
            orbit: label.as_ref().map(|_| point.orbit),
            label,
        }
    }

    fn remark(&self) -> String {
        normal_form::of_cycle(self.label.as_deref(), &self.normal_form)
    }
}

impl Report for CyclesResult {
    fn schema(&self) -> Schema {
        Schema::first(Self::SCHEMA)
    }

    fn parameters(&self) -> NamedNumbers {
        self.parameters.clone()
    }

    fn write_table(&self, out: &mut dyn Write) -> io::Result<()> {
        writeln!(out, "limit cycles of {} at {}", self.model.name, parameters(&self.parameters.0))?;
        writeln!(out, "{} points, from {}", self.points.len(), self.from.text())?;
        writeln!(out, "  first: {}\n  last:  {}\n", self.ends[0].text(), self.ends[1].text())?;
        let state = self.states().first().copied().unwrap_or_default();
        let [largest, smallest] = ["max", "min"].map(|end| format!("{end} {state}"));
        let mut table =
            Table::new(["label", &self.along.key, "period", &largest, &smallest, "error", "", ""]);
        for point in self.points.iter().filter(|point| point.label.is_some()) {
            table.row([
                point.label.clone().into(),
                Cell::Digits(point.value, DIGITS),
                Cell::Digits(point.period, DIGITS),
                point.max.get(0).into(),
                point.min.get(0).into(),
                Cell::Digits(point.error_estimate, 2),
                stability(point.stable, is_bifurcation(point.label.as_deref())).into(),
                point.remark().into(),
            ]);
        }
        table.write(out)
    }

    fn columns(&self) -> Columns {
        let points = || self.points.iter();
        let mut columns = Columns::new()
            .texts("label", points().map(|point| point.label.clone()))
            .numbers("value", points().map(|point| point.value))
            .numbers("period", points().map(|point| point.period))
            .booleans("stable", points().map(|point| point.stable))
            .numbers("error_estimate", points().map(|point| point.error_estimate))
            .counts("intervals", points().map(|point| point.intervals as u64))
            .numbers("trivial_multiplier_error", points().map(|point| point.trivial_multiplier_error));
        let states = self.states();
        for (index, name) in states.iter().enumerate() {
            columns = columns
                .optional_numbers(format!("max_{name}"), points().map(|point| point.max.get(index)))
                .optional_numbers(format!("min_{name}"), points().map(|point| point.min.get(index)));
        }
        columns
            .complex_numbers("multiplier", states.len(), points().map(|point| &point.multipliers))
            .named_numbers("test", points().map(|point| &point.tests))
    }

    fn figure(&self) -> Result<Option<Figure>, FigureError> {
        let description = format!("Limit cycles of {} along {}", self.model.name, self.along.key);
        let panels = self.states().into_iter().map(|state| (state.to_owned(), self.curves(state)));
        Ok(Some(picture::bifurcation_diagram(&description, &self.along.key, panels)))
    }

    fn story(&self) -> Option<Story> {
        let places: Vec<Place<'_>> = self
            .points
            .iter()
            .map(|point| Place {
                value: point.value,
                stable: point.stable,
                label: point.label.as_deref(),
                remark: is_bifurcation(point.label.as_deref()).then(|| point.remark()),
            })
            .collect();
        let mut story = Story::new();
        story.tell("start", self.from.text());
        course::tell_ends(&mut story, &self.ends);
        course::tell_way(&mut story, &self.along.key, &places);
        let unlocated = self.unlocated.iter().map(|change| change.text(&self.along.key));
        unlocated.for_each(|text| story.tell("not located", text));
        let meshes = self.points.iter().map(|point| point.intervals);
        if let (Some(fewest), Some(most)) = (meshes.clone().min(), meshes.max()) {
            let degree = self.points.iter().find_map(|point| point.orbit.as_ref()).map(|orbit| orbit.degree);
            let degree = degree.map_or(String::new(), |degree| format!(", polynomials of degree {degree}"));
            story.tell("meshes", format!("{fewest} to {most} intervals{degree}"));
        }
        let largest = |values: fn(&CycleResult) -> f64| self.points.iter().map(values).fold(0.0, f64::max);
        story.tell(
            "errors",
            format!(
                "at most {:.1e} of the amplitudes, trivial multiplier at most {:.1e} from 1",
                largest(|point| point.error_estimate),
                largest(|point| point.trivial_multiplier_error)
            ),
        );
        Some(story)
    }
}
