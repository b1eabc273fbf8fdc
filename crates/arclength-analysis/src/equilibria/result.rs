//! A branch of equilibria as a result.

use crate::branch::{Origin, at_parameters, pairs, stability, tests};
use crate::course::{self, ToldPoint};
use crate::end::End;
use crate::interval::Interval;
use crate::labels::{self, is_bifurcation};
use crate::model::ChosenModel;
use crate::monitor::{monitored, named};
use crate::normal_form;
use crate::picture::{self, Curve};
use crate::stored_model::StoredModel;
use crate::unlocated::{UnlocatedResult, warnings};
use crate::varying_parameter::VaryingParameter;
use arclength::equilibrium::{EquilibriumBranch, EquilibriumPoint, SpecialPoint};
use kingpin_figure::{Figure, FigureError, palette};
use kingpin_report::numbers::readable;
use kingpin_report::{Cell, Columns, NamedNumbers, Parameters, Report, Schema, Story, Table};
use serde::{Deserialize, Serialize};
use std::io::{self, Write};

/// States that are shown in a table.
const SHOWN_STATES: usize = 4;
/// Digits of the parameter at labelled points.
const DIGITS: usize = 12;

/// An equilibrium in a result.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct EquilibriumResult {
    /// Value of the parameter.
    pub value: f64,
    /// The equilibrium.
    pub state: NamedNumbers,
    /// The auxiliary quantities of the model, where they have a value.
    #[serde(default, skip_serializing_if = "NamedNumbers::is_empty")]
    pub aux: NamedNumbers,
    /// Eigenvalues by descending real part.
    pub eigenvalues: Vec<[Option<f64>; 2]>,
    /// Nothing where that is not decided.
    pub stable: Option<bool>,
    /// Of special points, of values asked for, of the ends.
    pub label: Option<String>,
    /// Test functions by the label of the point at which each changes its sign.
    pub tests: NamedNumbers,
    /// What was monitored, where it exists.
    #[serde(default, skip_serializing_if = "NamedNumbers::is_empty")]
    pub monitors: NamedNumbers,
    /// The normal form.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub special: Option<SpecialPoint>,
}

/// A linear combination of the states that every motion conserves.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct ConservedResult {
    /// The combination.
    pub total: String,
    /// The value at which it is kept.
    pub value: f64,
}

/// A branch of equilibria.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct EquilibriaResult {
    /// The parameters that do not vary.
    #[serde(skip_serializing)]
    pub parameters: NamedNumbers,
    /// The model.
    pub model: StoredModel,
    /// The parameter that varies.
    pub along: VaryingParameter,
    /// What is conserved, and kept at its value at the start: the eigenvalues zero that belong to it do not count.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub conserved: Vec<ConservedResult>,
    /// Where the branch starts.
    pub from: Origin,
    /// Why it ends, at its first and at its last point.
    pub ends: [End; 2],
    /// What was detected but not located.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub unlocated: Vec<UnlocatedResult>,
    /// The equilibria in the order of the branch.
    pub points: Vec<EquilibriumResult>,
}

impl EquilibriaResult {
    /// Schema of the result file.
    pub const SCHEMA: &'static str = "arclength.equilibria";

    /// The result of a branch, with the names of its monitors.
    pub fn new(
        chosen: &ChosenModel,
        along: &Interval,
        from: Origin,
        monitors: &[String],
        branch: &EquilibriumBranch,
    ) -> Self {
        let count = branch.points.len();
        let auxiliary = chosen.auxiliary_names();
        // What depends on the time has no value of its own, unless the time is frozen.
        let time = chosen.stored.frozen_time.unwrap_or(f64::NAN);
        let parameters = |value: f64| {
            let mut parameters = chosen.parameters.clone();
            branch.active.iter().for_each(|&active| parameters[active] = value);
            parameters
        };
        let point = |(index, point): (usize, &EquilibriumPoint)| EquilibriumResult {
            value: point.value,
            state: chosen.named_state(&point.state),
            aux: named(&auxiliary, &chosen.auxiliary(time, &point.state, &parameters(point.value))),
            eigenvalues: pairs(&point.eigenvalues),
            stable: point.stability.is_stable(),
            label: point.label.map(|label| label.to_string()).or_else(|| labels::of_end(index, count)),
            tests: tests(point.tests.iter().map(|(name, value)| (name.as_ref(), *value))),
            monitors: named(monitors, &point.monitors),
            special: point.special.as_deref().cloned(),
        };
        let points: Vec<EquilibriumResult> = branch.points.iter().enumerate().map(point).collect();
        let last = |point: Option<&EquilibriumResult>| {
            let value = point.map(|point| (along.key.clone(), point.value));
            let states = point.iter().flat_map(|point| point.state.0.iter().cloned());
            NamedNumbers(value.into_iter().chain(states).collect())
        };
        let varying = [VaryingParameter::from(along)];
        let ends = [
            End::monitored(branch.stops[0].as_ref(), &varying, monitors, last(points.first())),
            End::monitored(branch.stops[1].as_ref(), &varying, monitors, last(points.last())),
        ];
        Self {
            parameters: chosen.named_parameters(&branch.active),
            model: chosen.stored.clone(),
            along: along.into(),
            conserved: Vec::new(),
            from,
            ends,
            unlocated: branch.unlocated.iter().map(UnlocatedResult::from).collect(),
            points,
        }
    }

    /// What was detected but not located, each change once.
    pub fn warnings(&self) -> Vec<String> {
        warnings(&self.unlocated, &self.along)
    }

    /// Names of the states.
    pub fn states(&self) -> Vec<&str> {
        let first = self.points.first();
        first.iter().flat_map(|point| point.state.0.iter().map(|(name, _)| name.as_str())).collect()
    }

    /// What is drawn of a state over the parameter.
    pub fn curves(&self, state: &str) -> Vec<Curve> {
        let height = |point: &EquilibriumResult| point.state.named(state);
        vec![Curve::of(
            "equilibrium",
            palette::BLUE,
            &["LP"],
            self.points.iter().filter_map(|point| {
                Some(((point.value, height(point)?), point.stable, point.label.as_deref()))
            }),
        )]
    }
}

impl Report for EquilibriaResult {
    fn schema(&self) -> Schema {
        Schema::first(Self::SCHEMA)
    }

    fn parameters(&self) -> Parameters {
        self.parameters.clone().into()
    }

    fn write_table(&self, out: &mut dyn Write) -> io::Result<()> {
        writeln!(out, "equilibria of {}{}", self.model.name, at_parameters(&self.parameters.0))?;
        writeln!(out, "{} points, from {}", self.points.len(), self.from.text())?;
        writeln!(out, "  first: {}\n  last:  {}", self.ends[0].text(), self.ends[1].text())?;
        if !self.conserved.is_empty() {
            let kept = self.conserved.iter().map(|kept| format!("{} = {}", kept.total, readable(kept.value)));
            writeln!(out, "  conserved by every motion and kept: {}", kept.collect::<Vec<_>>().join(", "))?;
        }
        writeln!(out)?;
        let states = self.states().into_iter().take(SHOWN_STATES);
        let headings = ["label", self.along.key.as_str()].into_iter().chain(states);
        let auxiliary: Vec<&str> =
            monitored(self.points.iter().map(|point| &point.aux)).into_iter().take(SHOWN_STATES).collect();
        let headings = headings.chain(auxiliary.iter().copied());
        let monitors: Vec<&str> = monitored(self.points.iter().map(|point| &point.monitors));
        let mut table = Table::new(headings.chain(monitors.iter().copied()).chain(["", ""]));
        for point in self.points.iter().filter(|point| point.label.is_some()) {
            let mut cells: Vec<Cell> = vec![point.label.clone().into(), Cell::Digits(point.value, DIGITS)];
            cells.extend(point.state.0.iter().take(SHOWN_STATES).map(|(_, value)| Cell::from(*value)));
            cells.extend(auxiliary.iter().map(|name| Cell::from(point.aux.named(name))));
            cells.extend(monitors.iter().map(|name| Cell::from(point.monitors.named(name))));
            cells.push(stability(point.stable, is_bifurcation(point.label.as_deref())).into());
            cells.push(point.special.as_ref().map(normal_form::of_equilibrium).unwrap_or_default().into());
            table.row(cells);
        }
        table.write(out)
    }

    fn columns(&self) -> Columns {
        let points = || self.points.iter();
        let mut columns = Columns::new()
            .texts("label", points().map(|point| point.label.clone()))
            .numbers("value", points().map(|point| point.value))
            .booleans("stable", points().map(|point| point.stable));
        let states = self.states();
        for (index, name) in states.iter().enumerate() {
            columns = columns.optional_numbers(*name, points().map(|point| point.state.get(index)));
        }
        for name in monitored(points().map(|point| &point.aux)) {
            columns = columns.optional_numbers(name, points().map(|point| point.aux.named(name)));
        }
        columns
            .complex_numbers("eigenvalue", states.len(), points().map(|point| &point.eigenvalues))
            .named_numbers("test", points().map(|point| &point.tests))
            .named_numbers("monitor", points().map(|point| &point.monitors))
    }

    fn figure(&self) -> Result<Option<Figure>, FigureError> {
        let description = format!("Equilibria of {} along {}", self.model.name, self.along.key);
        let panels = self.states().into_iter().map(|state| (state.to_owned(), self.curves(state)));
        Ok(Some(picture::bifurcation_diagram(&description, &self.along.key, panels)))
    }

    fn story(&self) -> Option<Story> {
        let places: Vec<ToldPoint<'_>> = self
            .points
            .iter()
            .map(|point| ToldPoint {
                value: point.value,
                stable: point.stable,
                label: point.label.as_deref(),
                remark: point.special.as_ref().map(normal_form::of_equilibrium),
            })
            .collect();
        let mut story = Story::new();
        story.tell("start", self.from.text());
        course::tell_ends(&mut story, &self.ends);
        course::tell_way(&mut story, &self.along, &places);
        let degenerate = |point: &&EquilibriumResult| {
            matches!(point.special, Some(SpecialPoint::Degenerate { at_border: false, .. }))
        };
        for point in self.points.iter().filter(degenerate) {
            let label = point.label.clone().unwrap_or_default();
            story.tell(
                "not located",
                format!("{label} is only bracketed: its defining system is singular there"),
            );
        }
        let largest = self.points.iter().filter_map(|point| Some(point.special.as_ref()?.location_error()));
        let largest = largest.filter(|error| error.is_finite()).fold(0.0, f64::max);
        if largest > 0.0 {
            story.tell(
                "errors",
                format!("special points are located to {largest:.1e} or better in {}", self.along.key),
            );
        }
        Some(story)
    }
}
