//! A time history of a model as a result.

use crate::branch::parameters;
use crate::model::ChosenModel;
use crate::stored_model::StoredModel;
use kingpin_figure::{Axis, Figure, FigureError, Line, Panel, palette};
use kingpin_report::history::{drawn, extremes};
use kingpin_report::numbers::readable;
use kingpin_report::{Columns, NamedNumbers, Report, Schema, Table};
use serde::de::{MapAccess, Visitor};
use serde::ser::{SerializeMap, Serializer};
use serde::{Deserialize, Deserializer, Serialize};
use std::io::{self, Write};

/// Most panels of the picture.
const MOST_PANELS: usize = 6;

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
pub struct HistoryResult {
    /// The parameters.
    #[serde(skip_serializing)]
    pub parameters: NamedNumbers,
    /// The model.
    pub model: StoredModel,
    /// Times.
    pub t: Vec<f64>,
    /// For every state its values at these times.
    pub states: Histories,
}

impl HistoryResult {
    /// Schema of the result file.
    pub const SCHEMA: &'static str = "arclength.simulate";
    /// Label of the end, from which computations can start.
    pub const END: &'static str = "END";

    /// The result of a motion: times, and for every state its values at these times.
    pub fn new(chosen: &ChosenModel, times: Vec<f64>, values: Vec<Vec<f64>>) -> Self {
        Self {
            parameters: chosen.named_parameters(&[]),
            model: chosen.stored.clone(),
            t: times,
            states: Histories { names: chosen.model.states().to_vec(), values },
        }
    }

    /// How long it lasts, and the state at its end.
    pub fn end(&self) -> (f64, NamedNumbers) {
        let states = self.states.iter().filter_map(|(name, values)| Some((name.clone(), *values.last()?)));
        (self.t.last().copied().unwrap_or(0.0), NamedNumbers(states.collect()))
    }
}

impl Report for HistoryResult {
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
