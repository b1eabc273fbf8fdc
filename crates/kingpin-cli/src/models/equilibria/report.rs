//! A branch of equilibria as a result.

use crate::columns::Columns;
use crate::document::{NamedNumbers, Schema};
use crate::labels::is_bifurcation;
use crate::models::branch::{
    End, Origin, StoredModel, VaryingParameter, label_ends, named_parameters, pairs, parameters, stability,
    tests,
};
use crate::models::model::ChosenModel;
use crate::models::normal_form;
use crate::models::picture::{self, Curve};
use crate::models::story::{self, Part, Place};
use crate::range::Range;
use crate::report::Report;
use crate::table::{Cell, Table};
use arclength::equilibrium::{EquilibriumBranch, EquilibriumPoint, SpecialPoint};
use kingpin_figure::{Figure, FigureError, palette};
use serde::{Deserialize, Serialize};
use std::io::{self, Write};

/// States that are shown in a table.
const SHOWN_STATES: usize = 4;
/// Digits of the parameter at labelled points.
const DIGITS: usize = 12;

/// An equilibrium in a result.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct EquilibriumReport {
    /// Value of the parameter.
    pub value: f64,
    /// The equilibrium.
    pub state: NamedNumbers,
    /// Eigenvalues by descending real part.
    pub eigenvalues: Vec<[Option<f64>; 2]>,
    /// Nothing where that is not decided.
    pub stable: Option<bool>,
    /// Of special points, of values asked for, of the ends.
    pub label: Option<String>,
    /// Test functions by the label of the point at which each changes its sign.
    pub tests: NamedNumbers,
    /// The normal form.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub special: Option<SpecialPoint>,
}

/// A branch of equilibria.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct EquilibriaReport {
    #[serde(skip_serializing)]
    pub(crate) parameters: NamedNumbers,
    /// The model.
    pub model: StoredModel,
    /// The parameter that varies.
    pub along: VaryingParameter,
    /// Where the branch starts.
    pub from: Origin,
    /// Why it ends, at its first and at its last point.
    pub ends: [End; 2],
    /// The equilibria in the order of the branch.
    pub points: Vec<EquilibriumReport>,
    /// Whether the story of the run is told.
    #[serde(skip)]
    pub explain: bool,
}

impl EquilibriaReport {
    /// Schema of the result file.
    pub const SCHEMA: &'static str = "arclength.equilibria";

    /// The result of a branch.
    pub fn new(chosen: &ChosenModel, range: &Range, from: Origin, branch: &EquilibriumBranch) -> Self {
        let point = |point: &EquilibriumPoint| EquilibriumReport {
            value: point.parameter,
            state: chosen.named_state(&point.state),
            eigenvalues: pairs(&point.eigenvalues),
            stable: point.stability.is_stable(),
            label: point.label.map(|label| label.to_string()),
            tests: tests(point.tests.iter().map(|(name, value)| (name.as_ref(), *value))),
            special: point.special.as_deref().cloned(),
        };
        let mut points: Vec<EquilibriumReport> = branch.points.iter().map(point).collect();
        let last = |point: Option<&EquilibriumReport>| {
            let value = point.map(|point| (range.key.clone(), point.value));
            let states = point.iter().flat_map(|point| point.state.0.iter().cloned());
            NamedNumbers(value.into_iter().chain(states).collect())
        };
        let ends = [
            End::of(&branch.backward_stop, &[&range.key], last(points.first())),
            End::of(&branch.forward_stop, &[&range.key], last(points.last())),
        ];
        label_ends(&mut points, |point| &mut point.label);
        Self {
            parameters: named_parameters(chosen, &[branch.active]),
            model: chosen.stored.clone(),
            along: range.into(),
            from,
            ends,
            points,
            explain: false,
        }
    }

    /// Names of the states.
    pub fn states(&self) -> Vec<&str> {
        let first = self.points.first();
        first.iter().flat_map(|point| point.state.0.iter().map(|(name, _)| name.as_str())).collect()
    }

    /// What is drawn of a state over the parameter.
    pub fn curves(&self, state: &str) -> Vec<Curve> {
        let height = |point: &EquilibriumReport| point.state.named(state);
        vec![Curve::of(
            "equilibrium",
            palette::BLUE,
            self.points.iter().filter_map(|point| {
                Some(((point.value, height(point)?), point.stable, point.label.as_deref()))
            }),
        )]
    }

    fn story(&self) -> Vec<Part> {
        let places: Vec<Place<'_>> = self
            .points
            .iter()
            .map(|point| Place {
                value: point.value,
                stable: point.stable,
                label: point.label.as_deref(),
                remark: point.special.as_ref().map(normal_form::of_equilibrium),
            })
            .collect();
        let mut parts = vec![Part::new("start", self.from.text())];
        parts.extend(story::ends(&self.ends));
        parts.extend(story::course(&self.along.key, &places));
        let degenerate =
            |point: &&EquilibriumReport| matches!(point.special, Some(SpecialPoint::Degenerate { .. }));
        for point in self.points.iter().filter(degenerate) {
            let label = point.label.clone().unwrap_or_default();
            parts.push(Part::new(
                "not located",
                format!("{label} is only bracketed: its defining system is singular there"),
            ));
        }
        let largest = self.points.iter().filter_map(|point| Some(point.special.as_ref()?.location_error()));
        let largest = largest.filter(|error| error.is_finite()).fold(0.0, f64::max);
        if largest > 0.0 {
            parts.push(Part::new(
                "errors",
                format!("special points are located to {largest:.1e} or better in {}", self.along.key),
            ));
        }
        parts
    }
}

impl Report for EquilibriaReport {
    fn schema(&self) -> Schema {
        Schema::first(Self::SCHEMA)
    }

    fn parameters(&self) -> NamedNumbers {
        self.parameters.clone()
    }

    fn write_table(&self, out: &mut dyn Write) -> io::Result<()> {
        writeln!(out, "equilibria of {} at {}", self.model.name, parameters(&self.parameters.0))?;
        writeln!(out, "{} points, from {}", self.points.len(), self.from.text())?;
        writeln!(out, "  first: {}\n  last:  {}\n", self.ends[0].text(), self.ends[1].text())?;
        let states = self.states().into_iter().take(SHOWN_STATES);
        let headings = ["label", self.along.key.as_str()].into_iter().chain(states);
        let mut table = Table::new(headings.chain(["", ""]));
        for point in self.points.iter().filter(|point| point.label.is_some()) {
            let mut cells: Vec<Cell> = vec![point.label.clone().into(), Cell::Digits(point.value, DIGITS)];
            cells.extend(point.state.0.iter().take(SHOWN_STATES).map(|(_, value)| Cell::from(*value)));
            cells.push(stability(point.stable, is_bifurcation(point.label.as_deref())).into());
            cells.push(point.special.as_ref().map(normal_form::of_equilibrium).unwrap_or_default().into());
            table.row(cells);
        }
        table.write(out)?;
        if self.explain { story::write(&self.story(), out) } else { Ok(()) }
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
        columns
            .complex_numbers("eigenvalue", states.len(), points().map(|point| &point.eigenvalues))
            .named_numbers("test", points().map(|point| &point.tests))
    }

    fn figure(&self) -> Result<Option<Figure>, FigureError> {
        let description = format!("Equilibria of {} along {}", self.model.name, self.along.key);
        let panels = self.states().into_iter().map(|state| (state.to_owned(), self.curves(state)));
        Ok(Some(picture::bifurcation_diagram(&description, &self.along.key, panels)))
    }
}
