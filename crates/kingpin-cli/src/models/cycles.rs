//! `arclength cycles`: a branch of limit cycles from a labelled point of an earlier result.

use super::branch::{VaryingParameter, pairs, parameters, stability};
use super::model::{ChosenModel, ParameterOptions};
use super::picture::{self, Curve};
use crate::columns::Columns;
use crate::document::{NamedNumbers, Schema};
use crate::failure::Failure;
use crate::labels::{Labels, is_bifurcation, kind};
use crate::numbers::{readable, significant};
use crate::options::OutputOptions;
use crate::progress::Progress;
use crate::range::{Range, Values};
use crate::report::Report;
use crate::stored::{PointReference, StoredModel};
use crate::table::Table;
use arclength::cycle::{CycleBranch, CyclePoint, CycleStart, Orbit};
use arclength::equilibrium::{HopfPoint, SpecialPoint};
use clap::Args;
use kingpin_figure::{Figure, FigureError};
use serde::Serialize;
use std::io::{self, Write};
use std::ops::ControlFlow;

/// Results that a computation of cycles can start from.
const SCHEMAS: [&str; 2] = ["arclength.equilibria", "arclength.cycles"];

/// Limit cycles along a parameter, from a Hopf point or a cycle of an earlier result
#[derive(Args, Debug)]
#[command(
    after_help = "Example: arclength cycles --from equilibria.json:HB1 --along p=0:1 --at 0.5 -o cycles.json"
)]
pub struct Cycles {
    /// Labelled point of a file that `equilibria` or `cycles` wrote, with its model and parameters
    #[arg(long, value_name = "FILE.json:LABEL")]
    from: PointReference,

    /// Parameter and its interval
    #[arg(long, value_name = "KEY=A:B")]
    along: Range,

    /// Values of the parameter at which cycles are wanted exactly
    #[arg(long, value_name = "[KEY=]A,B,..", allow_hyphen_values = true)]
    at: Vec<Values>,

    #[command(flatten)]
    parameters: ParameterOptions,
    #[command(flatten)]
    output: OutputOptions,
}

impl Cycles {
    /// Runs the command.
    ///
    /// # Errors
    /// Why it failed.
    pub fn run(&self) -> Result<(), Failure> {
        let output = self.output.prepare(true)?;
        let point = self.from.read(&SCHEMAS)?;
        let stored = point.model.ok_or_else(|| self.from.failure("it has no model".to_owned()))?;
        let mut chosen = ChosenModel::stored(&self.from.path, stored, &point.parameters)?;
        chosen.set(&self.parameters)?;
        let active = chosen.along(&self.along)?;
        let at = chosen.values(active, &self.along, &self.at)?;
        let dimension = chosen.model.states().len();
        let start = match (point.orbit, point.special) {
            (Some(orbit), _) => {
                self.from.check(&orbit, dimension)?;
                CycleStart::Orbit(orbit)
            }
            (None, Some(SpecialPoint::Hopf(hopf))) => {
                check(&hopf, dimension).map_err(|problem| self.from.failure(problem))?;
                CycleStart::from(&hopf)
            }
            _ => {
                let problem =
                    format!("no cycles start at {}; allowed: Hopf points and cycles", self.from.label);
                return Err(self.from.failure(problem));
            }
        };
        if matches!(kind(&self.from.label), "PD" | "BPC") {
            output.warn(&format!(
                "the branch of the cycle {} itself is followed, not the one that bifurcates there",
                self.from.label
            ));
        }
        let name = &chosen.model.parameters()[active];
        let progress = Progress::spinner("cycles", output.is_quiet());
        let branch = arclength::cycle::Cycles::of(&chosen.model, start)
            .parameters(&chosen.parameters)
            .along(active, self.along.start..=self.along.end)
            .at(&at)
            .observer(|value, period| {
                let (value, period) = (readable(value), readable(period));
                progress.message(format!("cycles, {name} = {value}, period {period}"));
                ControlFlow::Continue(())
            })
            .run()?;
        drop(progress);
        for change in &branch.unlocated {
            let [first, second] = change.between.map(readable);
            output.warn(&format!(
                "the test for a {} changes between {name} = {first} and {second}, but no such cycle was located there",
                change.test
            ));
        }
        output.deliver(&CyclesReport::new(chosen, active, self, branch))
    }
}

/// That a Hopf point that was read is one of a model with so many states.
fn check(hopf: &HopfPoint, dimension: usize) -> Result<(), String> {
    let finite = hopf.state.iter().all(|value| value.is_finite())
        && hopf.eigenvector.iter().all(|value| value.is_finite());
    if hopf.state.len() == dimension && hopf.eigenvector.len() == dimension && finite && hopf.frequency > 0.0
    {
        return Ok(());
    }
    Err(format!("its Hopf point is none of a model with {dimension} states"))
}

/// A cycle in a result.
#[derive(Debug, Serialize)]
struct PointReport {
    value: f64,
    period: f64,
    max: NamedNumbers,
    min: NamedNumbers,
    multipliers: Vec<[f64; 2]>,
    trivial_multiplier_error: f64,
    stable: Option<bool>,
    error_estimate: f64,
    label: Option<String>,
    #[serde(skip_serializing_if = "Option::is_none")]
    orbit: Option<Orbit>,
}

/// A branch of limit cycles.
#[derive(Debug, Serialize)]
struct CyclesReport {
    #[serde(skip)]
    chosen: ChosenModel,
    #[serde(skip)]
    active: usize,
    model: StoredModel,
    along: VaryingParameter,
    from: String,
    ends: [String; 2],
    points: Vec<PointReport>,
}

impl CyclesReport {
    fn new(chosen: ChosenModel, active: usize, command: &Cycles, branch: CycleBranch) -> Self {
        let mut labels = Labels::default();
        let point = |point: CyclePoint| {
            let label = labels.of(&point);
            PointReport {
                value: point.value,
                period: point.period,
                max: chosen.named_state(&point.max),
                min: chosen.named_state(&point.min),
                multipliers: pairs(&point.multipliers),
                trivial_multiplier_error: point.trivial_multiplier_error,
                stable: point.stable,
                error_estimate: point.error_estimate,
                orbit: label.as_ref().map(|_| point.orbit),
                label,
            }
        };
        let points = branch.points.into_iter().map(point).collect();
        let (first, last) = &branch.stops;
        let from = command.from.label.clone();
        let first = first.as_ref().map_or_else(|| format!("starts at {from}"), ToString::to_string);
        Self {
            active,
            model: chosen.stored.clone(),
            along: (&command.along).into(),
            from,
            ends: [first, last.to_string()],
            points,
            chosen,
        }
    }
}

impl Report for CyclesReport {
    fn schema(&self) -> Schema {
        Schema::first("arclength.cycles")
    }

    fn parameters(&self) -> NamedNumbers {
        self.chosen.named_parameters(Some(self.active))
    }

    fn write_table(&self, out: &mut dyn Write) -> io::Result<()> {
        writeln!(out, "limit cycles of {} at {}", self.model.name, parameters(&self.parameters().0))?;
        writeln!(out, "{} points from {}", self.points.len(), self.from)?;
        writeln!(out, "  first: {}\n  last:  {}\n", self.ends[0], self.ends[1])?;
        let state = self.chosen.model.states().first().map_or("", String::as_str);
        let [largest, smallest] = ["max", "min"].map(|end| format!("{end} {state}"));
        let mut table = Table::new(["label", &self.along.key, "period", &largest, &smallest, "error", ""]);
        let last = self.points.len().saturating_sub(1);
        for (index, point) in self.points.iter().enumerate() {
            if point.label.is_some() || index == 0 || index == last {
                table.row([
                    point.label.clone().into(),
                    point.value.into(),
                    point.period.into(),
                    point.max.get(0).into(),
                    point.min.get(0).into(),
                    significant(point.error_estimate, 2).into(),
                    stability(point.stable, is_bifurcation(point.label.as_deref())).into(),
                ]);
            }
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
            .numbers("error_estimate", points().map(|point| point.error_estimate));
        for (index, name) in self.chosen.model.states().iter().enumerate() {
            columns = columns
                .optional_numbers(format!("max_{name}"), points().map(|point| point.max.get(index)))
                .optional_numbers(format!("min_{name}"), points().map(|point| point.min.get(index)));
        }
        for number in 0..self.chosen.model.states().len() {
            for (part, name) in ["real", "imaginary"].into_iter().enumerate() {
                columns = columns.optional_numbers(
                    format!("multiplier_{}_{name}", number + 1),
                    points().map(|point| point.multipliers.get(number).map(|pair| pair[part])),
                );
            }
        }
        columns
    }

    fn figure(&self) -> Result<Option<Figure>, FigureError> {
        let ends = |index: usize| {
            let list = |end: fn(&PointReport) -> &NamedNumbers| {
                self.points.iter().map(|point| end(point).get(index)).collect()
            };
            vec![list(|point| &point.max), list(|point| &point.min)]
        };
        let curve = Curve {
            name: "limit cycle, extremes",
            points: self
                .points
                .iter()
                .map(|point| (point.value, point.stable, point.label.as_deref()))
                .collect(),
            extremes: (0..self.chosen.model.states().len()).map(ends).collect(),
        };
        Ok(Some(picture::bifurcation_diagram(&self.chosen, &self.along, &curve)))
    }
}
