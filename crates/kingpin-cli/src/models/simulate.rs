//! `arclength simulate`: a time history of a model.

use super::branch::{StoredModel, named_parameters, parameters};
use super::model::ModelOptions;
use crate::columns::Columns;
use crate::document::{NamedNumbers, Schema};
use crate::failure::Failure;
use crate::history::{drawn, extremes};
use crate::numbers::readable;
use crate::options::OutputOptions;
use crate::report::Report;
use crate::table::Table;
use arclength::integration::{Integrator, from_fn};
use clap::Args;
use kingpin_figure::{Axis, Figure, FigureError, Line, Panel, palette};
use serde::de::{MapAccess, Visitor};
use serde::ser::{SerializeMap, Serializer};
use serde::{Deserialize, Deserializer, Serialize};
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
        let (chosen, _) = self.model.choose(&output)?;
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
            parameters: named_parameters(&chosen, &[]),
            t: times,
        })
    }
}

/// A list of values for every state.
#[derive(Clone, Debug)]
pub struct Histories {
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

impl<'de> Deserialize<'de> for Histories {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct InOrder;
        impl<'de> Visitor<'de> for InOrder {
            type Value = Histories;

            fn expecting(&self, formatter: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
                formatter.write_str("an object of lists of numbers")
            }

            fn visit_map<A: MapAccess<'de>>(self, mut entries: A) -> Result<Histories, A::Error> {
                let mut histories = Histories { names: Vec::new(), values: Vec::new() };
                while let Some((name, values)) = entries.next_entry()? {
                    histories.names.push(name);
                    histories.values.push(values);
                }
                Ok(histories)
            }
        }
        deserializer.deserialize_map(InOrder)
    }
}

/// A time history.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct HistoryReport {
    #[serde(skip_serializing)]
    pub(crate) parameters: NamedNumbers,
    /// The model.
    pub model: StoredModel,
    /// Times.
    pub t: Vec<f64>,
    /// For every state its values at these times.
    pub states: Histories,
}

impl HistoryReport {
    /// Schema of the result file.
    pub const SCHEMA: &'static str = "arclength.simulate";
    /// Label of the end, from which computations can start.
    pub const END: &'static str = "END";

    /// How long it lasts, and the state at its end.
    pub fn end(&self) -> (f64, NamedNumbers) {
        let states = self.states.iter().filter_map(|(name, values)| Some((name.clone(), *values.last()?)));
        (self.t.last().copied().unwrap_or(0.0), NamedNumbers(states.collect()))
    }
}

impl Report for HistoryReport {
    fn schema(&self) -> Schema {
        Schema::first(Self::SCHEMA)
    }

    fn parameters(&self) -> NamedNumbers {
        self.parameters.clone()
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
