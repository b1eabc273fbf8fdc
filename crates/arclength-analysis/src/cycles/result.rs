//! A branch of limit cycles as a result.

use super::cycle::{AlongCycle, CycleResult};
use super::story::tell;
use crate::branch::{Origin, at_parameters, stability};
use crate::end::End;
use crate::interval::Interval;
use crate::labels::{self, is_bifurcation};
use crate::model::ChosenModel;
use crate::monitor::{monitored, named};
use crate::picture::{self, Curve};
use crate::stored_model::StoredModel;
use crate::unlocated::{UnlocatedResult, warnings};
use crate::varying_parameter::VaryingParameter;
use arclength::cycle::CycleBranch;
use kingpin_figure::{Figure, FigureError, palette};
use kingpin_report::{Cell, Columns, NamedNumbers, Parameters, Report, Schema, Story, Table};
use serde::{Deserialize, Serialize};
use std::io::{self, Write};

/// Digits of parameter and period at labelled points.
const DIGITS: usize = 11;

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

    /// The result of a branch along a parameter of this index, with the names of its monitors.
    pub fn new(
        chosen: &ChosenModel,
        (active, along): (usize, &Interval),
        from: Origin,
        monitors: &[String],
        branch: CycleBranch,
    ) -> Self {
        let count = branch.points.len();
        let points: Vec<CycleResult> = (0..)
            .zip(branch.points)
            .map(|(index, point)| {
                let own = point.label.map(|label| label.to_string());
                let label = own.or_else(|| labels::of_end(index, count));
                let monitors = named(monitors, &point.monitors);
                let mut parameters = chosen.parameters.clone();
                parameters[active] = point.value;
                let aux = AlongCycle::auxiliary(chosen, &point, &parameters);
                CycleResult {
                    monitors,
                    aux,
                    ..CycleResult::new(point, label, |state| chosen.named_state(state))
                }
            })
            .collect();
        let last = |point: Option<&CycleResult>| {
            let values =
                point.map(|point| [(along.key.clone(), point.value), ("period".to_owned(), point.period)]);
            NamedNumbers(values.into_iter().flatten().collect())
        };
        let [first, second] = &branch.stops;
        let varying = [VaryingParameter::from(along)];
        let ends = [
            End::monitored(first.as_ref(), &varying, monitors, last(points.first())),
            End::monitored(second.as_ref(), &varying, monitors, last(points.last())),
        ];
        Self {
            parameters: chosen.named_parameters(&[active]),
            model: chosen.stored.clone(),
            along: along.into(),
            from,
            ends,
            unlocated: branch.unlocated.iter().map(UnlocatedResult::from).collect(),
            points,
        }
    }

    /// What was detected but not located.
    pub fn warnings(&self) -> Vec<String> {
        warnings(&self.unlocated, &self.along)
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
                &["HB", "LPC"],
                self.points.iter().filter_map(|point| {
                    Some(((point.value, end(point).named(state)?), point.stable, point.label.as_deref()))
                }),
            )
        };
        vec![curve(|point| &point.max), curve(|point| &point.min).without_labels()]
    }
}

impl Report for CyclesResult {
    fn schema(&self) -> Schema {
        Schema::first(Self::SCHEMA)
    }

    fn parameters(&self) -> Parameters {
        self.parameters.clone().into()
    }

    fn write_table(&self, out: &mut dyn Write) -> io::Result<()> {
        writeln!(out, "limit cycles of {}{}", self.model.name, at_parameters(&self.parameters.0))?;
        writeln!(out, "{} points, from {}", self.points.len(), self.from.text())?;
        writeln!(out, "  first: {}\n  last:  {}", self.ends[0].text(), self.ends[1].text())?;
        if self.points.iter().any(|point| point.neutral) {
            let key = &self.along.key;
            writeln!(
                out,
                "  neutral: {key} stands still along a family of cycles, as it does where something is conserved; their multiplier is 1"
            )?;
        }
        writeln!(out)?;
        let state = self.states().first().copied().unwrap_or_default();
        let [largest, smallest] = ["max", "min"].map(|end| format!("{end} {state}"));
        let monitors: Vec<&str> = monitored(self.points.iter().map(|point| &point.monitors));
        let headings = ["label", &self.along.key, "period", &largest, &smallest, "error"];
        let mut table = Table::new(headings.into_iter().chain(monitors.iter().copied()).chain(["", ""]));
        for point in self.points.iter().filter(|point| point.label.is_some()) {
            let mut cells: Vec<Cell> = vec![
                point.label.clone().into(),
                Cell::Digits(point.value, point.certain_digits().min(DIGITS)),
                Cell::Digits(point.period, DIGITS),
                point.max.get(0).into(),
                point.min.get(0).into(),
                Cell::Digits(point.error_estimate, 2),
            ];
            cells.extend(monitors.iter().map(|name| Cell::from(point.monitors.named(name))));
            let stability = stability(point.stable, is_bifurcation(point.label.as_deref()));
            cells.push(if point.neutral { "neutral" } else { stability }.into());
            cells.push(point.remark().into());
            table.row(cells);
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
        for name in monitored(points().map(|point| &point.aux.max)) {
            columns = columns
                .optional_numbers(format!("max_{name}"), points().map(|point| point.aux.max.named(name)))
                .optional_numbers(format!("min_{name}"), points().map(|point| point.aux.min.named(name)))
                .optional_numbers(format!("mean_{name}"), points().map(|point| point.aux.mean.named(name)));
        }
        columns
            .complex_numbers("multiplier", states.len(), points().map(|point| &point.multipliers))
            .named_numbers("test", points().map(|point| &point.tests))
            .named_numbers("monitor", points().map(|point| &point.monitors))
    }

    fn figure(&self) -> Result<Option<Figure>, FigureError> {
        let description = format!("Limit cycles of {} along {}", self.model.name, self.along.key);
        let panels = self.states().into_iter().map(|state| (state.to_owned(), self.curves(state)));
        Ok(Some(picture::bifurcation_diagram(&description, &self.along.key, panels)))
    }

    fn story(&self) -> Option<Story> {
        let mut story = Story::new();
        story.tell("start", self.from.text());
        tell(&mut story, &self.along, &self.ends, &self.unlocated, &self.points.iter().collect::<Vec<_>>());
        Some(story)
    }
}
