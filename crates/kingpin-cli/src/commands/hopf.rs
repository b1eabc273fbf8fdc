//! `kingpin hopf`: Hopf points of the uniform motion along a parameter.

use crate::along::{VaryingParameter, along};
use crate::description;
use crate::error::Error;
use crate::wheel_options::{WheelOptions, parameter_help, parameters_of};
use arclength::branch::Criticality;
use arclength_analysis::Interval;
use clap::Args;
use kingpin::branches::{Along, HopfPoint, HopfSearch};
use kingpin::rolling::STATE_NAMES;
use kingpin::{Key, Wheel};
use kingpin_report::Columns;
use kingpin_report::Report;
use kingpin_report::Table;
use kingpin_report::numbers::readable;
use kingpin_report::{NamedNumbers, Number, Schema};
use kingpin_terminal::OutputOptions;
use serde::Serialize;
use std::io::{self, Write};

const EXAMPLE: &str = "kingpin hopf --along v=0.5:12 -s l=0.1";

/// Hopf points of the uniform motion along a parameter: where shimmy is born
#[derive(Args, Debug)]
#[command(after_help = format!("Example: {EXAMPLE}"), after_long_help = parameter_help(EXAMPLE))]
pub struct Hopf {
    /// Parameter and its interval; r may reach inf
    #[arg(long, value_name = "KEY=A:B")]
    along: Interval,

    #[command(flatten)]
    wheel: WheelOptions,
    #[command(flatten)]
    output: OutputOptions,
}

impl Hopf {
    /// Runs the command.
    ///
    /// # Errors
    /// Why it failed.
    pub fn run(&self) -> Result<(), Error> {
        let output = self.output.prepare_without_picture()?;
        let wheel = self.wheel.wheel()?;
        let along = along(&self.along)?;
        let search = search(&wheel, along)?;
        Ok(output.deliver(&HopfReport::new(wheel, along, &search))?)
    }
}

/// The Hopf points of the interval, of which there must be one.
///
/// # Errors
/// [`Error::NothingFound`] with the stability at both ends, and those of the search.
pub fn search(wheel: &Wheel, along: Along) -> Result<HopfSearch, Error> {
    let search = wheel.hopf_points(along)?;
    if !search.points.is_empty() {
        return Ok(search);
    }
    let stability = |stable: Option<bool>| match stable {
        Some(true) => "stable",
        Some(false) => "unstable",
        None => "neither clearly stable nor clearly unstable",
    };
    let (low, high) = search.searched;
    let (start, end) = along.ends();
    let mut message = format!(
        "no Hopf point for {} from {} to {} at {}: the uniform motion is {} at {} and {} at {}",
        along.key(),
        readable(start),
        readable(end),
        description::of(wheel, &[along.key()]),
        stability(search.stable_at_ends.0),
        description::quantity(along.key(), low),
        stability(search.stable_at_ends.1),
        description::quantity(along.key(), high),
    );
    for (reached, wanted, stop) in [(low, start, &search.stops.0), (high, end, &search.stops.1)] {
        if reached != wanted {
            message += &format!("; beyond {} it could not be followed ({stop})", readable(reached));
        }
    }
    let straight = wheel.get(Key::TurningRadius).is_infinite() && along.key() != Key::TurningRadius;
    if straight && wheel.get(Key::CU) == 0.0 && !wheel.has_lateral_elasticity_only() {
        message += "; on a straight path without c_u the longitudinal motion is undamped, which hides Hopf points: \
                    set a small c_u, or follow cycles from a circle with `kingpin cycles --along r=A:inf`";
        return Err(Error::NothingFound(message));
    }
    message += "; try a wider interval, or see with `kingpin chart` where the stability changes";
    Err(Error::NothingFound(message))
}

/// The name of the sense of a Hopf bifurcation.
pub fn criticality(criticality: Criticality) -> &'static str {
    match criticality {
        Criticality::Subcritical => "subcritical",
        Criticality::Supercritical => "supercritical",
        Criticality::Degenerate => "degenerate",
    }
}

/// Label of the Hopf point with an index.
pub fn label(index: usize) -> String {
    format!("HB{}", index + 1)
}

/// A state of the wheel, by name, without what is not a number.
pub fn named_state(state: &[f64]) -> NamedNumbers {
    let numbers = STATE_NAMES.into_iter().map(str::to_owned).zip(state.iter().copied());
    NamedNumbers(numbers.filter(|(_, value)| !value.is_nan()).collect())
}

/// A Hopf point in a result.
#[derive(Debug, Serialize)]
struct PointReport {
    value: Number,
    frequency: f64,
    first_lyapunov: Option<f64>,
    criticality: &'static str,
    state: NamedNumbers,
    label: String,
}

/// Hopf points along a parameter.
#[derive(Debug, Serialize)]
struct HopfReport {
    #[serde(skip)]
    wheel: Wheel,
    #[serde(skip)]
    interval: Along,
    along: VaryingParameter,
    searched: [Number; 2],
    stable_at_ends: [Option<bool>; 2],
    points: Vec<PointReport>,
}

impl HopfReport {
    fn new(wheel: Wheel, interval: Along, search: &HopfSearch) -> Self {
        let point = |(index, point): (usize, &HopfPoint)| PointReport {
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
            along: interval.into(),
            searched: [search.searched.0, search.searched.1].map(Number),
            stable_at_ends: search.stable_at_ends.into(),
            points: search.points.iter().enumerate().map(point).collect(),
        }
    }
}

impl Report for HopfReport {
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
