//! `arclength simulate`: a time history of a model.

use super::branch::parameters;
use super::model::{ChosenModel, ModelOptions};
use crate::columns::Columns;
use crate::document::{NamedNumbers, Schema};
use crate::failure::Failure;
use crate::history::{drawn, extremes};
use crate::numbers::readable;
use crate::options::OutputOptions;
use crate::report::Report;
use crate::stored::StoredModel;
use crate::table::Table;
use arclength::integration::{Integrator, from_fn};
use clap::Args;
use kingpin_figure::{Axis, Figure, FigureError, Line, Panel, palette};
use serde::ser::{Serialize, SerializeMap, Serializer};
use std::io::{self, Write};

/// Most samples.
const MOST_POINTS: u64 = 1_000_000;
/// Relative tolerance; the absolute one is a hundredth of it.
const TOLERANCE: f64 = 1e-10;
/// Most panels of the picture.
const MOST_PANELS: usize = 6;

/// Time history from the initial state of the model
#[derive(Args, Debug)]
#[command(after_help = "Example: arclength simulate model.ode --duration 100 --start x=1 -o history.svg")]
pub struct Simulate {
    #[command(flatten)]
    model: ModelOptions,

    /// Time
    #[arg(long, value_name = "T", allow_negative_numbers = true)]
    duration: f64,

    /// Number of samples, at equal distances from 0 to T
    #[arg(long, value_name = "N", default_value_t = 1001,
          value_parser = clap::value_parser!(u64).range(2..=MOST_POINTS))]
    points: u64,

    #[command(flatten)]
    output: OutputOptions,
}

impl Simulate {
    /// Runs the command.
    ///
    /// # Errors
    /// Why it failed.
    pub fn run(&self) -> Result<(), Failure> {
        if !(self.duration > 0.0 && self.duration.is_finite()) {
            return Err(Failure::Option {
                option: "--duration",
                given: self.duration.to_string(),
                problem: "not a duration".to_owned(),
                allowed: "positive and finite".to_owned(),
            });
        }
        let output = self.output.prepare(true)?;
        let chosen = self.model.choose(&output)?;
        let last = (self.points - 1) as f64;
        let times: Vec<f64> = (0..self.points).map(|index| self.duration * (index as f64 / last)).collect();
        let dimension = chosen.model.states().len();
        let system = from_fn(dimension, |time, state, derivative| {
            chosen.model.evaluate_at(time, state, &chosen.parameters, derivative);
        });
        let solution = Integrator::with_tolerance(TOLERANCE).sample(system, &chosen.start, &times)?;
        let states =
            (0..dimension).map(|index| solution.samples().map(|(_, state)| state[index]).collect()).collect();
        output.deliver(&HistoryReport {
            model: chosen.stored.clone(),
            states: Histories { names: chosen.model.states().to_vec(), values: states },
            chosen,
            t: times,
        })
    }
}

/// A list of values for every state.
#[derive(Debug)]
struct Histories {
    names: Vec<String>,
    values: Vec<Vec<f64>>,
}

impl Histories {
    fn iter(&self) -> impl Iterator<Item = (&String, &Vec<f64>)> {
        self.names.iter().zip(&self.values)
    }
}

impl Serialize for Histories {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let mut map = serializer.serialize_map(Some(self.names.len()))?;
        self.iter().try_for_each(|(name, values)| map.serialize_entry(name, values))?;
        map.end()
    }
}

/// A time history.
#[derive(Debug, serde::Serialize)]
struct HistoryReport {
    #[serde(skip)]
    chosen: ChosenModel,
    model: StoredModel,
    t: Vec<f64>,
    states: Histories,
}

impl Report for HistoryReport {
    fn schema(&self) -> Schema {
        Schema::first("arclength.simulate")
    }

    fn parameters(&self) -> NamedNumbers {
        self.chosen.named_parameters(None)
    }

    fn write_table(&self, out: &mut dyn Write) -> io::Result<()> {
        let duration = self.t.last().copied().unwrap_or(0.0);
        writeln!(out, "motion of {} at {}", self.model.name, parameters(&self.parameters().0))?;
        writeln!(out, "{} samples over {}\n", self.t.len(), readable(duration))?;
        let mut table = Table::new(["", "start", "end", "smallest", "largest"]);
        for (name, values) in self.states.iter() {
            let [smallest, largest] = extremes(values);
            let [start, end] = [values.first(), values.last()].map(|end| end.copied().into());
            table.row([name.as_str().into(), start, end, smallest.into(), largest.into()]);
        }
        table.write(out)
    }

    fn columns(&self) -> Columns {
        let times = Columns::new().numbers("t", self.t.iter().copied());
        self.states
            .iter()
            .fold(times, |columns, (name, values)| columns.numbers(name, values.iter().copied()))
    }

    fn figure(&self) -> Result<Option<Figure>, FigureError> {
        let panels = self.states.names.len().min(MOST_PANELS);
        let figure = if panels > 1 { Figure::double_column().columns(2) } else { Figure::single_column() };
        let mut figure = figure.description(format!("Time histories of {}", self.model.name));
        let duration = self.t.last().copied().unwrap_or(0.0);
        for (name, values) in self.states.iter().take(panels) {
            let line = Line::new(drawn(&self.t, values)).color(palette::BLUE);
            let time = Axis::new("$t$").limits(0.0, duration);
            figure = figure.panel(Panel::new(time, Axis::new(name)).curve(line));
        }
        Ok(Some(figure))
    }
}
