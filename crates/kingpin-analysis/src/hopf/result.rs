//! Hopf points of the uniform motion as a result.

use super::search::label;
use crate::along::varying;
use crate::description;
use crate::parameters::parameters_of;
use crate::states::named_state;
use arclength_analysis::VaryingParameter;
use arclength_analysis::normal_form::criticality;
use kingpin::Wheel;
use kingpin::branches::{Along, HopfPoint, HopfSearch};
use kingpin::rolling::STATE_NAMES;
use kingpin_report::numbers::readable;
use kingpin_report::{Columns, NamedNumbers, Number, Report, Schema, Table};
use serde::Serialize;
use std::io::{self, Write};

/// A Hopf point in a result.
#[derive(Debug, Serialize)]
pub struct HopfPointResult {
    value: Number,
    frequency: f64,
    first_lyapunov: Option<f64>,
    criticality: &'static str,
    state: NamedNumbers,
    label: String,
}

/// Hopf points along a parameter.
#[derive(Debug, Serialize)]
pub struct HopfResult {
    #[serde(skip)]
    wheel: Wheel,
    #[serde(skip)]
    interval: Along,
    along: VaryingParameter,
    searched: [Number; 2],
    stable_at_ends: [Option<bool>; 2],
    points: Vec<HopfPointResult>,
}

impl HopfResult {
    /// The result of a search.
    pub(super) fn new(wheel: Wheel, interval: Along, search: &HopfSearch) -> Self {
        let point = |(index, point): (usize, &HopfPoint)| HopfPointResult {
            value: Number(point.value),
            frequency: point.frequency,
            first_lyapunov: point.first_lyapunov,
            criticality: criticality(point.criticality),
            state: named_state(&point.state),
            label: label(index),
        };
        Self {
            wheel,
            interval,
            along: varying(&interval),
            searched: [search.searched.0, search.searched.1].map(Number),
            stable_at_ends: search.stable_at_ends.into(),
            points: search.points.iter().enumerate().map(point).collect(),
        }
    }
}

impl Report for HopfResult {
    fn schema(&self) -> Schema {
        Schema::first("kingpin.hopf")
    }

    fn parameters(&self) -> NamedNumbers {
        parameters_of(&self.wheel, &[self.interval.key()])
    }

    fn write_table(&self, out: &mut dyn Write) -> io::Result<()> {
        let key = self.interval.key();
        let [low, high] = self.searched.map(|Number(value)| readable(value));
        writeln!(out, "uniform motion at {}", description::of(&self.wheel, &[key]))?;
        writeln!(out, "Hopf points for {key} from {low} to {high} {}\n", key.unit())?;
        let mut table = Table::new([
            "label".to_owned(),
            format!("{key} ({})", key.unit()),
            "frequency (rad/s)".to_owned(),
            "first Lyapunov coefficient".to_owned(),
            String::new(),
        ]);
        for point in &self.points {
            table.row([
                point.label.as_str().into(),
                point.value.0.into(),
                point.frequency.into(),
                point.first_lyapunov.into(),
                point.criticality.into(),
            ]);
        }
        table.write(out)
    }

    fn columns(&self) -> Columns {
        let points = || self.points.iter();
        let columns = Columns::new()
            .texts("label", points().map(|point| Some(point.label.clone())))
            .numbers("value", points().map(|point| point.value.0))
            .numbers("frequency", points().map(|point| point.frequency))
            .optional_numbers("first_lyapunov", points().map(|point| point.first_lyapunov))
            .texts("criticality", points().map(|point| Some(point.criticality.to_owned())));
        STATE_NAMES.into_iter().enumerate().fold(columns, |columns, (index, name)| {
            columns.optional_numbers(name, points().map(move |point| point.state.get(index)))
        })
    }
}
