//! `arclength equilibria`: a branch of equilibria of a model.

use super::branch::{VaryingParameter, pairs, parameters, stability};
use super::model::{ChosenModel, ModelOptions};
use super::picture::{self, Curve};
use crate::columns::Columns;
use crate::document::{NamedNumbers, Schema};
use crate::failure::Failure;
use crate::labels::is_bifurcation;
use crate::numbers::{readable, significant};
use crate::options::OutputOptions;
use crate::progress::Progress;
use crate::range::{Range, Values};
use crate::report::Report;
use crate::stored::StoredModel;
use crate::table::{Cell, Table};
use arclength::equilibrium::{EquilibriumBranch, EquilibriumPoint, SpecialPoint};
use clap::Args;
use kingpin_figure::{Figure, FigureError};
use serde::Serialize;
use std::io::{self, Write};
use std::ops::ControlFlow;

/// States that are shown in a table.
const SHOWN_STATES: usize = 4;

/// Equilibria along a parameter, with folds, branch points and Hopf points
#[derive(Args, Debug)]
#[command(after_help = "Example: arclength equilibria model.ode --along p=0:1 -o equilibria.json")]
pub struct Equilibria {
    #[command(flatten)]
    model: ModelOptions,

    /// Parameter and its interval
    #[arg(long, value_name = "KEY=A:B")]
    along: Range,

    /// Values of the parameter at which equilibria are wanted exactly
    #[arg(long, value_name = "[KEY=]A,B,..", allow_hyphen_values = true)]
    at: Vec<Values>,

    #[command(flatten)]
    output: OutputOptions,
}

impl Equilibria {
    /// Runs the command.
    ///
    /// # Errors
    /// Why it failed.
    pub fn run(&self) -> Result<(), Failure> {
        let output = self.output.prepare(true)?;
        let chosen = self.model.choose(&output)?;
        let active = chosen.along(&self.along)?;
        let at = chosen.values(active, &self.along, &self.at)?;
        let name = &chosen.model.parameters()[active];
        let progress = Progress::spinner("equilibria", output.is_quiet());
        let branch = arclength::equilibrium::Equilibria::of(&chosen.model)
            .start(&chosen.start)
            .parameters(&chosen.parameters)
            .along(name, self.along.start..=self.along.end)
            .at(&at)
            .observed(&mut |value, _| {
                progress.message(format!("equilibria, {name} = {}", readable(value)));
                ControlFlow::Continue(())
            })?;
        drop(progress);
        output.deliver(&EquilibriaReport::new(chosen, active, &self.along, &branch))
    }
}

/// An equilibrium in a result.
#[derive(Debug, Serialize)]
struct PointReport {
    value: f64,
    state: NamedNumbers,
    eigenvalues: Vec<[f64; 2]>,
    stable: Option<bool>,
    label: Option<String>,
    /// The normal form.
    #[serde(skip_serializing_if = "Option::is_none")]
    special: Option<SpecialPoint>,
}

/// A branch of equilibria.
#[derive(Debug, Serialize)]
struct EquilibriaReport {
    #[serde(skip)]
    chosen: ChosenModel,
    #[serde(skip)]
    active: usize,
    model: StoredModel,
    along: VaryingParameter,
    ends: [String; 2],
    points: Vec<PointReport>,
}

impl EquilibriaReport {
    fn new(chosen: ChosenModel, active: usize, range: &Range, branch: &EquilibriumBranch) -> Self {
        let point = |point: &EquilibriumPoint| PointReport {
            value: point.parameter,
            state: chosen.named_state(&point.state),
            eigenvalues: pairs(&point.eigenvalues),
            stable: point.stability.is_stable(),
            label: point.label.map(|label| label.to_string()),
            special: point.special.as_deref().cloned(),
        };
        Self {
            active,
            model: chosen.stored.clone(),
            along: range.into(),
            ends: [branch.backward_stop.to_string(), branch.forward_stop.to_string()],
            points: branch.points.iter().map(point).collect(),
            chosen,
        }
    }
}

/// What the normal form says.
fn remark(special: &SpecialPoint) -> String {
    match special {
        SpecialPoint::Hopf(hopf) => {
            let lyapunov = hopf.first_lyapunov.map_or("-".to_owned(), |value| significant(value, 6));
            format!("frequency {}, first Lyapunov coefficient {lyapunov}", significant(hopf.frequency, 8))
        }
        SpecialPoint::Fold(fold) => match fold.quadratic {
            Some(quadratic) => format!("quadratic coefficient {}", significant(quadratic, 6)),
            None => String::new(),
        },
        SpecialPoint::Degenerate { .. } => "degenerate".to_owned(),
        _ => String::new(),
    }
}

impl Report for EquilibriaReport {
    fn schema(&self) -> Schema {
        Schema::first("arclength.equilibria")
    }

    fn parameters(&self) -> NamedNumbers {
        self.chosen.named_parameters(Some(self.active))
    }

    fn write_table(&self, out: &mut dyn Write) -> io::Result<()> {
        writeln!(out, "equilibria of {} at {}", self.model.name, parameters(&self.parameters().0))?;
        writeln!(
            out,
            "{} points\n  first: {}\n  last:  {}\n",
            self.points.len(),
            self.ends[0],
            self.ends[1]
        )?;
        let states = self.chosen.model.states().iter().take(SHOWN_STATES);
        let headings = ["label", self.along.key.as_str()].into_iter().chain(states.map(String::as_str));
        let mut table = Table::new(headings.chain(["", ""]));
        let last = self.points.len().saturating_sub(1);
        for (index, point) in self.points.iter().enumerate() {
            if point.label.is_some() || index == 0 || index == last {
                let mut cells: Vec<Cell> = vec![point.label.clone().into(), point.value.into()];
                cells.extend(point.state.0.iter().take(SHOWN_STATES).map(|(_, value)| Cell::from(*value)));
                cells.push(stability(point.stable, is_bifurcation(point.label.as_deref())).into());
                cells.push(point.special.as_ref().map(remark).unwrap_or_default().into());
                table.row(cells);
            }
        }
        table.write(out)
    }

    fn columns(&self) -> Columns {
        let points = || self.points.iter();
        let mut columns = Columns::new()
            .texts("label", points().map(|point| point.label.clone()))
            .numbers("value", points().map(|point| point.value))
            .booleans("stable", points().map(|point| point.stable));
        for (index, name) in self.chosen.model.states().iter().enumerate() {
            columns = columns.optional_numbers(name, points().map(|point| point.state.get(index)));
        }
        for number in 0..self.chosen.model.states().len() {
            for (part, name) in ["real", "imaginary"].into_iter().enumerate() {
                columns = columns.optional_numbers(
                    format!("eigenvalue_{}_{name}", number + 1),
                    points().map(|point| point.eigenvalues.get(number).map(|pair| pair[part])),
                );
            }
        }
        columns
    }

    fn figure(&self) -> Result<Option<Figure>, FigureError> {
        let curve = Curve {
            name: "equilibrium",
            points: self
                .points
                .iter()
                .map(|point| (point.value, point.stable, point.label.as_deref()))
                .collect(),
            extremes: self
                .chosen
                .model
                .states()
                .iter()
                .enumerate()
                .map(|(index, _)| vec![self.points.iter().map(|point| point.state.get(index)).collect()])
                .collect(),
        };
        Ok(Some(picture::bifurcation_diagram(&self.chosen, &self.along, &curve)))
    }
}
