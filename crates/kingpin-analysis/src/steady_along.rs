//! The uniform motion along a parameter.

use crate::along::{along, drawn_as, varying};
use crate::error::Error;
use crate::parameters::parameters_over;
use crate::states;
use crate::steady::SteadyResult;
use crate::uniform_curve::uniform_motion;
use crate::wheel_request::WheelRequest;
use crate::{axis_label, description};
use arclength_analysis::{SampledInterval, VaryingParameter};
use kingpin::branches::Along;
use kingpin::{Key, KingpinError, Wheel};
use kingpin_figure::{Axis, Figure, FigureError, Legend, Line, Panel, palette};
use kingpin_report::{Cell, Columns, Parameters, Report, Schema, Table};
use serde::{Deserialize, Serialize};
use std::io::{self, Write};

/// Most values of the parameter.
const MOST_POINTS: usize = 100_000;

/// The uniform motion of a wheel at several values of a parameter.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct SteadyAlongRequest {
    /// Which wheel.
    #[serde(flatten)]
    pub wheel: WheelRequest,
    /// Parameter and its values.
    pub along: SampledInterval,
}

impl SteadyAlongRequest {
    /// Computes it.
    ///
    /// # Errors
    /// What is wrong with the wheel or the values; no uniform motion at any of them.
    pub fn run(&self) -> Result<SteadyAlongResult, Error> {
        let interval = along(&self.along.interval)?;
        let (key, abscissa) = drawn_as(&interval);
        let count = self.along.count;
        if !(2..=MOST_POINTS).contains(&count) {
            let allowed = format!("2 to {MOST_POINTS}");
            return Err(Error::invalid(
                &["along"],
                format!("{count} values"),
                "too few or too many",
                allowed,
            ));
        }
        let wheel = self.wheel.read()?;
        let (start, end) = interval.ends();
        let (start, end) = (abscissa(start), abscissa(end));
        let mut points = Vec::new();
        let mut missing = None;
        for index in 0..count {
            let drawn = start + (end - start) * (index as f64 / (count - 1) as f64);
            let at = wheel.with(key, drawn)?;
            match at.uniform_motion() {
                Ok(motion) => points.push(SteadyPoint {
                    value: at.get(interval.key()),
                    stable: motion.is_stable(),
                    motion: SteadyResult::of(&motion),
                }),
                Err(error @ KingpinError::NoUniformMotion { .. }) => missing = Some(error),
                Err(error) => return Err(error.into()),
            }
        }
        match missing {
            Some(error) if points.is_empty() => Err(error.into()),
            _ => Ok(SteadyAlongResult { wheel, interval, along: varying(&interval), points }),
        }
    }
}

/// The uniform motion at one value of the parameter.
#[derive(Debug, Serialize)]
pub struct SteadyPoint {
    /// Value of the parameter.
    #[serde(with = "kingpin_report::number")]
    pub value: f64,
    /// Whether it is stable; nothing where rounding decides.
    pub stable: Option<bool>,
    /// The motion.
    #[serde(flatten)]
    pub motion: SteadyResult,
}

/// The uniform motion along a parameter, where it exists.
#[derive(Debug, Serialize)]
pub struct SteadyAlongResult {
    /// The wheel.
    #[serde(skip)]
    pub wheel: Wheel,
    /// The parameter and its interval.
    #[serde(skip)]
    pub interval: Along,
    /// The parameter that varies.
    pub along: VaryingParameter,
    /// The motions.
    pub points: Vec<SteadyPoint>,
}

impl SteadyAlongResult {
    fn numbers(&self, value: impl Fn(&SteadyResult) -> f64) -> Vec<f64> {
        self.points.iter().map(|point| value(&point.motion)).collect()
    }

    fn state_names(&self) -> &'static [&'static str] {
        self.wheel.states()
    }
}

impl Report for SteadyAlongResult {
    fn schema(&self) -> Schema {
        Schema::first("kingpin.steady-along")
    }

    fn parameters(&self) -> Parameters {
        parameters_over(&self.wheel, &[(self.interval.key(), self.interval.ends().into())])
    }

    fn write_table(&self, out: &mut dyn Write) -> io::Result<()> {
        let key = self.interval.key();
        writeln!(out, "uniform motion at {}\n", description::on_lines(&self.wheel, &[key]))?;
        let unit = |unit: &str| if unit.is_empty() { String::new() } else { format!(" ({unit})") };
        let mut headings = vec![format!("{key}{}", unit(key.unit()))];
        headings.extend(self.state_names().iter().map(|name| format!("{name}{}", unit(states::unit(name)))));
        headings.extend(["friction (N)".to_owned(), "rolls".to_owned(), String::new()]);
        let mut table = Table::new(headings);
        for SteadyPoint { value, stable, motion } in &self.points {
            let mut row: Vec<Cell> = vec![(*value).into()];
            row.extend(motion.state.0.iter().map(|(_, value)| Cell::from(*value)));
            row.push(motion.friction_force.into());
            row.push(if motion.rolls { "yes" } else { "no" }.into());
            row.push(
                match stable {
                    Some(true) => "stable",
                    Some(false) => "unstable",
                    None => "undecided",
                }
                .into(),
            );
            table.row(row);
        }
        table.write(out)
    }

    fn columns(&self) -> Columns {
        let key = self.interval.key();
        let value = Columns::new().numbers(key.name(), self.points.iter().map(|point| point.value));
        let states =
            self.state_names().iter().enumerate().fold(value.unit(key.unit()), |columns, (index, name)| {
                columns
                    .numbers(*name, self.numbers(|motion| motion.state.0[index].1))
                    .unit(states::unit(name))
            });
        states
            .numbers("residual", self.numbers(|motion| motion.residual))
            .numbers("friction_force", self.numbers(|motion| motion.friction_force))
            .unit("N")
            .numbers("normal_force", self.numbers(|motion| motion.normal_force))
            .unit("N")
            .booleans("rolls", self.points.iter().map(|point| point.motion.rolls))
            .booleans("stable", self.points.iter().map(|point| point.stable))
    }

    fn figure(&self) -> Result<Option<Figure>, FigureError> {
        let (key, abscissa) = drawn_as(&self.interval);
        let (start, end) = self.interval.ends();
        let (start, end) = (abscissa(start), abscissa(end));
        let axis = || Axis::new(axis_label::of(key)).limits(start.min(end), start.max(end));
        let (uniform, dashes) = uniform_motion(&self.wheel, &self.interval, Vec::new());
        let angle = Panel::new(axis(), Axis::new("$\\psi$ (rad)"))
            .curve(uniform.color(palette::BLUE))
            .legend(Legend::Below);
        let angle = dashes.legend().fold(angle, Panel::legend_entry);
        let line = |value: &dyn Fn(&SteadyPoint) -> f64| {
            Line::new(self.points.iter().map(|point| (abscissa(point.value), value(point))))
        };
        let needed = line(&|point| point.motion.friction_force).color(palette::BLUE);
        let limit = |point: &SteadyPoint| {
            let wheel = self.wheel.with(self.interval.key(), point.value);
            wheel.map_or(f64::NAN, |wheel| wheel.get(Key::MuS) * point.motion.normal_force)
        };
        let force = Panel::new(axis(), Axis::new("friction force (N)"))
            .curve(needed.legend("needed to roll"))
            .curve(line(&limit).color(palette::VERMILION).legend("$\\mu_s N$"))
            .legend(Legend::Below);
        let description = format!(
            "Caster angle of the uniform motion, solid where it is stable and dotted where the wheel cannot roll, and its friction force, against {key} at {}",
            description::of(&self.wheel, &[self.interval.key()])
        );
        Ok(Some(Figure::double_column().columns(2).description(description).panel(angle).panel(force)))
    }
}
