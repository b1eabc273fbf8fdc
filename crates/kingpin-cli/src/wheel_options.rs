//! Options that say which wheel, and how parameters of the wheel are written.

use crate::error::Error;
use arclength_analysis::{Assignment, Interval};
use clap::Args;
use kingpin::{Axis, Key, KingpinError, Wheel};
use kingpin_report::numbers::readable;
use kingpin_report::{NamedNumbers, Table};
use kingpin_terminal::Output;
use std::path::PathBuf;

/// Which wheel.
#[derive(Args, Clone, Debug)]
#[command(next_help_heading = "Wheel")]
pub struct WheelOptions {
    /// Read the wheel from a file of `key = value` lines [default: the paper's wheel]
    #[arg(long, value_name = "FILE.toml")]
    pub wheel: Option<PathBuf>,

    /// Set a parameter, wins over the file; repeatable, for example -s l=0.1 -s r=inf
    #[arg(short, long, value_name = "KEY=VALUE")]
    pub set: Vec<Assignment>,
}

impl WheelOptions {
    /// The wheel of the file, or the paper's, with the parameters that are set.
    ///
    /// # Errors
    /// What is wrong with the file or a parameter.
    pub fn wheel(&self) -> Result<Wheel, Error> {
        let wheel = self.wheel.as_ref().map_or(Ok(Wheel::default()), Wheel::read)?;
        self.change(wheel)
    }

    /// A wheel with the parameters that are set.
    ///
    /// # Errors
    /// What is wrong with a parameter.
    pub fn change(&self, mut wheel: Wheel) -> Result<Wheel, Error> {
        for Assignment { key, value } in &self.set {
            wheel.set(key, value).map_err(|source| Error::Set { given: format!("{key}={value}"), source })?;
        }
        wheel.check()?;
        Ok(wheel)
    }
}

/// Every parameter that a wheel stores, without those that vary.
pub fn parameters_of(wheel: &Wheel, varying: &[Key]) -> NamedNumbers {
    let fixed =
        wheel.parameters().filter(|(key, _)| !varying.iter().any(|active| active.sets().contains(key)));
    NamedNumbers(fixed.map(|(key, value)| (key.name().to_owned(), value)).collect())
}

/// The interval of a parameter of the wheel. An interval of `r` that reaches to infinity becomes one of `curvature`.
///
/// # Errors
/// An unknown key, or ends that the parameter may not take.
pub fn axis(interval: &Interval) -> Result<Axis, KingpinError> {
    let key: Key = interval.key.parse()?;
    if key == Key::TurningRadius && interval.end == f64::INFINITY {
        // The largest radius at the other end gives the smallest curvature, zero.
        let smallest = Axis::new(key, interval.start..=key.allowed().highest)?.start();
        return Axis::new(Key::Curvature, 0.0..=smallest.recip());
    }
    Axis::new(key, interval.start..=interval.end)
}

/// Says that an interval of `r` became one of `curvature`.
pub fn note_conversion(interval: &Interval, axis: &Axis, output: &Output) {
    if interval.key == Key::TurningRadius.name() && axis.key() == Key::Curvature {
        output.warn(&format!(
            "r reaches inf: curvature = 1/r varies instead, from {} to {} 1/m",
            axis.start(),
            readable(axis.end())
        ));
    }
}

/// The parameters of the wheel with symbol, unit, default, allowed range and meaning, for the long help.
pub fn parameter_help(example: &str) -> String {
    let mut table = Table::new(["key", "symbol", "unit", "default", "allowed", "meaning"]);
    for key in Key::ALL {
        table.row([
            key.name().into(),
            key.symbol().into(),
            key.unit().into(),
            readable(key.default_value()).into(),
            key.allowed().to_string().into(),
            key.meaning().into(),
        ]);
    }
    let mut text = Vec::new();
    // Writing to memory does not fail.
    let _ = table.write(&mut text);
    format!("Example: {example}\n\nParameters, in SI units and radians:\n{}", String::from_utf8_lossy(&text))
}
