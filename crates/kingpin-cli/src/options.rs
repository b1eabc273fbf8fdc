//! The options that all commands share.

use crate::document::NamedNumbers;
use crate::failure::Failure;
use crate::numbers::readable;
use crate::output::{Format, Output};
use crate::range::{Assignment, Range};
use crate::table::Table;
use clap::Args;
use kingpin::{Axis, Key, KingpinError, Wheel};
use std::path::PathBuf;

/// Most threads that may be asked for.
pub const MOST_THREADS: i64 = 1024;

/// Where results go.
#[derive(Args, Clone, Debug)]
#[command(next_help_heading = "Output")]
pub struct OutputOptions {
    /// Format of standard output
    #[arg(long, value_enum, default_value_t)]
    pub format: Format,

    /// Write a file too, its ending picks the format; repeatable
    #[arg(short, long, value_name = "PATH")]
    pub out: Vec<PathBuf>,

    /// Number of threads; results do not depend on it [default: one per core]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=MOST_THREADS))]
    pub threads: Option<u16>,

    /// No progress and no warnings; with --out nothing on standard output
    #[arg(short, long)]
    pub quiet: bool,
}

impl OutputOptions {
    /// Checks the options and starts the threads.
    ///
    /// # Errors
    /// Those of [`Output::new`], and [`Failure::Threads`].
    pub fn prepare(&self, pictures: bool) -> Result<Output, Failure> {
        let output = Output::new(self.format, &self.out, self.quiet, pictures)?;
        start_threads(self.threads)?;
        Ok(output)
    }
}

/// Starts as many threads as were asked for.
///
/// # Errors
/// [`Failure::Threads`].
pub fn start_threads(threads: Option<u16>) -> Result<(), Failure> {
    if let Some(threads) = threads {
        rayon::ThreadPoolBuilder::new().num_threads(threads.into()).build_global()?;
    }
    Ok(())
}

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
    pub fn wheel(&self) -> Result<Wheel, Failure> {
        let wheel = self.wheel.as_ref().map_or(Ok(Wheel::default()), Wheel::read)?;
        self.change(wheel)
    }

    /// A wheel with the parameters that are set.
    ///
    /// # Errors
    /// What is wrong with a parameter.
    pub fn change(&self, mut wheel: Wheel) -> Result<Wheel, Failure> {
        for Assignment { key, value } in &self.set {
            wheel
                .set(key, value)
                .map_err(|source| Failure::Set { given: format!("{key}={value}"), source })?;
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
pub fn axis(range: &Range) -> Result<Axis, KingpinError> {
    let key: Key = range.key.parse()?;
    if key == Key::TurningRadius && range.end == f64::INFINITY {
        // The largest radius at the other end gives the smallest curvature, zero.
        let smallest = Axis::new(key, range.start..=key.allowed().highest)?.start();
        return Axis::new(Key::Curvature, 0.0..=smallest.recip());
    }
    Axis::new(key, range.start..=range.end)
}

/// Says that an interval of `r` became one of `curvature`.
pub fn note_conversion(range: &Range, axis: &Axis, output: &Output) {
    if range.key == Key::TurningRadius.name() && axis.key() == Key::Curvature {
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
