//! A time history of a model as a result.

use super::picture::{self, DrawnPlot};
use super::section::SectionDirection;
use crate::branch::at_parameters;
use crate::model::ChosenModel;
use crate::phase_plane::PhasePlane;
use crate::stored_model::StoredModel;
use kingpin_figure::{Axis, Figure, FigureError, Line, Panel, palette};
use kingpin_report::history::extremes;
use kingpin_report::numbers::readable;
use kingpin_report::{Columns, NamedNumbers, Parameters, Report, Schema, Table};
use serde::de::{MapAccess, Visitor};
use serde::ser::{SerializeMap, Serializer};
use serde::{Deserialize, Deserializer, Serialize};
use std::io::{self, Write};

/// Most panels of the picture.
const MOST_PANELS: usize = 6;

/// A list of values for every quantity; what is not finite is nothing in a file.
#[derive(Clone, Debug, Default)]
pub struct Histories {
    names: Vec<String>,
    values: Vec<Vec<f64>>,
}

impl Histories {
    fn is_empty(&self) -> bool {
        self.names.is_empty()
    }

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
                while let Some((name, values)) = entries.next_entry::<String, Vec<Option<f64>>>()? {
                    histories.names.push(name);
                    histories
                        .values
                        .push(values.into_iter().map(|value| value.unwrap_or(f64::NAN)).collect());
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
    /// For every auxiliary quantity its values at these times.
    #[serde(default, skip_serializing_if = "Histories::is_empty")]
    pub aux: Histories,
    /// The section at whose crossings the samples are.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub section: Option<SectionResult>,
    /// Phase planes that were asked for.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub phase_planes: Vec<PhasePlane>,
    /// What is worth knowing about it.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub warnings: Vec<String>,
    /// What its picture shows.
    #[serde(skip)]
    pub(super) plots: Vec<DrawnPlot>,
}

/// A section at whose crossings there are samples.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct SectionResult {
    /// The expression that is zero there.
    pub expression: String,
    /// Which crossings count.
    pub direction: SectionDirection,
}

impl HistoryResult {
    /// Schema of the result file.
    pub const SCHEMA: &'static str = "arclength.simulate";
    /// Label of the end, from which computations can start.
    pub const END: &'static str = "END";

    /// The result of a motion: times, the states at these times, and what is worth knowing about it.
    pub fn new(
        chosen: &ChosenModel,
        times: Vec<f64>,
        states: &[Vec<f64>],
        mut warnings: Vec<String>,
    ) -> Self {
        let names = chosen.auxiliary_names();
        let mut auxiliary = vec![Vec::with_capacity(times.len()); names.len()];
        for (time, state) in times.iter().zip(states) {
            let quantities = chosen.auxiliary(*time, state, &chosen.parameters);
            auxiliary.iter_mut().zip(quantities).for_each(|(values, quantity)| values.push(quantity));
        }
        let values = (0..chosen.model.states().len())
            .map(|index| states.iter().map(|state| state[index]).collect())
            .collect();
        for (name, values) in names.iter().zip(&auxiliary) {
            let first = values.iter().zip(&times).find(|(value, _)| !value.is_finite());
            if let Some((_, time)) = first {
                warnings.push(format!("the quantity {name} is not finite first at t = {}", readable(*time)));
            }
        }
        Self {
            parameters: chosen.named_parameters(&[]),
            model: chosen.stored.clone(),
            t: times,
            states: Histories { names: chosen.model.states().to_vec(), values },
            aux: Histories { names, values: auxiliary },
            section: None,
            phase_planes: Vec::new(),
            warnings,
            plots: Vec::new(),
        }
    }

    /// How long it lasts, and the state at its end.
    pub fn end(&self) -> (f64, NamedNumbers) {
        let states = self.states.iter().filter_map(|(name, values)| Some((name.clone(), *values.last()?)));
        (self.duration(), NamedNumbers(states.collect()))
    }

    /// Time from the first sample to the last.
    fn duration(&self) -> f64 {
        self.t.last().zip(self.t.first()).map_or(0.0, |(last, first)| last - first)
    }

    /// States and auxiliary quantities.
    pub(super) fn quantities(&self) -> impl Iterator<Item = (&String, &Vec<f64>)> {
        self.states.iter().chain(self.aux.iter())
    }
}

impl Report for HistoryResult {
    fn schema(&self) -> Schema {
        Schema::first(Self::SCHEMA)
    }

    fn parameters(&self) -> Parameters {
        self.parameters.clone().into()
    }

    fn write_table(&self, out: &mut dyn Write) -> io::Result<()> {
        writeln!(out, "motion of {}{}", self.model.name, at_parameters(&self.parameters.0))?;
        match &self.section {
            Some(SectionResult { expression, direction }) => {
                let direction = match direction {
                    SectionDirection::Both => "",
                    SectionDirection::Rising => ", rising",
                    SectionDirection::Falling => ", falling",
                };
                writeln!(out, "{} crossings of {expression} = 0{direction}\n", self.t.len())?;
            }
            None => writeln!(out, "{} samples over {}\n", self.t.len(), readable(self.duration()))?,
        }
        if self.t.is_empty() {
            return Ok(());
        }
        let mut table = Table::new(["", "start", "end", "smallest", "largest"]);
        for (name, values) in self.quantities() {
            let [smallest, largest] = extremes(values);
            let [start, end] = [values.first(), values.last()].map(|end| end.copied().into());
            table.row([name.as_str().into(), start, end, smallest.into(), largest.into()]);
        }
        table.write(out)
    }

    fn columns(&self) -> Columns {
        let times = Columns::new().numbers("t", self.t.iter().copied());
        self.quantities().fold(times, |columns, (name, values)| columns.numbers(name, values.iter().copied()))
    }

    fn figure(&self) -> Result<Option<Figure>, FigureError> {
        let name = &self.model.name;
        if !self.plots.is_empty() {
            return Ok(Some(picture::figure(&format!("Motion of {name}"), &self.plots)));
        }
        let panels = self.quantities().count().min(MOST_PANELS);
        let figure = if panels > 1 { Figure::double_column().columns(2) } else { Figure::single_column() };
        let mut figure = figure.description(format!("Time histories of {name}"));
        let [start, end] = [self.t.first(), self.t.last()].map(|time| time.copied().unwrap_or(0.0));
        for (name, values) in self.quantities().take(panels) {
            let line = Line::new(picture::history(&self.t, values)).color(palette::BLUE);
            let time = Axis::new("$t$").limits(start, end);
            figure = figure.panel(Panel::new(time, Axis::new(name)).curve(line));
        }
        Ok(Some(figure))
    }
}
