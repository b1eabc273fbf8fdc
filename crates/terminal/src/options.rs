//! Options that many commands share.

use crate::failure::Failure;
use crate::output::{Format, Output};
use arclength_analysis::{Interval, Mesh, Steps, Values};
use clap::Args;
use kingpin_report::FileFormat;
use std::ops::RangeInclusive;
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
    /// Checks the options for a result that can be drawn, and starts the threads.
    ///
    /// # Errors
    /// Those of [`Output::new`], and [`Failure::Threads`].
    pub fn prepare(&self) -> Result<Output, Failure> {
        self.prepare_for(FileFormat::ALL)
    }

    /// Checks the options for a result of which there is no picture, and starts the threads.
    ///
    /// # Errors
    /// Those of [`Output::new`], and [`Failure::Threads`].
    pub fn prepare_without_picture(&self) -> Result<Output, Failure> {
        self.prepare_for(FileFormat::DATA)
    }

    fn prepare_for(&self, allowed: &[FileFormat]) -> Result<Output, Failure> {
        let output = Output::new(self.format, &self.out, self.quiet, allowed)?;
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
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads.into());
        pool.build_global().map_err(Failure::Threads)?;
    }
    Ok(())
}

/// A range as the parser of options wants it.
fn allowed(range: RangeInclusive<u32>) -> RangeInclusive<i64> {
    (*range.start()).into()..=(*range.end()).into()
}

/// How steps along a branch are taken.
#[derive(Args, Clone, Copy, Debug)]
#[command(next_help_heading = "Steps")]
pub struct StepOptions {
    /// Most steps in one direction
    #[arg(long, value_name = "N", default_value_t = Steps::default().steps,
          value_parser = clap::value_parser!(u32).range(allowed(Steps::STEPS)))]
    steps: u32,

    /// Take steps K times shorter, so that special points that lie close together are told apart
    #[arg(long, value_name = "K", default_value_t = Steps::default().finer,
          value_parser = clap::value_parser!(u32).range(allowed(Steps::FINER)))]
    finer: u32,
}

impl From<StepOptions> for Steps {
    fn from(StepOptions { steps, finer }: StepOptions) -> Self {
        Self { steps, finer }
    }
}

/// How finely cycles are resolved.
#[derive(Args, Clone, Copy, Debug)]
#[command(next_help_heading = "Steps")]
pub struct MeshOptions {
    /// Error estimate, relative to the amplitude, that no cycle exceeds; the mesh follows from it
    #[arg(long, value_name = "E", default_value_t = Mesh::default().tolerance, allow_negative_numbers = true)]
    tolerance: f64,

    /// Most mesh intervals
    #[arg(long, value_name = "N", default_value_t = Mesh::default().intervals,
          value_parser = clap::value_parser!(u32).range(allowed(Mesh::INTERVALS)))]
    intervals: u32,
}

impl From<MeshOptions> for Mesh {
    fn from(MeshOptions { tolerance, intervals }: MeshOptions) -> Self {
        Self { tolerance, intervals }
    }
}

/// The two parameters of a curve of special points.
#[derive(Args, Clone, Debug)]
pub struct PlaneOptions {
    /// The two parameters and their intervals
    #[arg(long = "in", value_name = "KEY=A:B,KEY=C:D", value_delimiter = ',', num_args = 1..)]
    plane: Vec<Interval>,
}

impl PlaneOptions {
    /// Both of them.
    ///
    /// # Errors
    /// [`Failure::Option`] unless there are two.
    pub fn intervals(&self) -> Result<[Interval; 2], Failure> {
        let refused = |problem: &str| {
            let keys: Vec<&str> = self.plane.iter().map(|interval| interval.key.as_str()).collect();
            Failure::Option {
                option: "--in",
                given: keys.join(","),
                problem: problem.to_owned(),
                allowed: "two parameters with their intervals, such as p=0:1,q=2:5".to_owned(),
            }
        };
        match self.plane.as_slice() {
            [one, other] if one.key == other.key => {
                let key = &one.key;
                Err(refused(&format!("`{key}` and `{key}` cannot vary together: they are one parameter")))
            }
            [one, other] => Ok([one.clone(), other.clone()]),
            [_] => Err(refused("a curve of special points needs two parameters, and this is one")),
            _ => Err(refused("a curve of special points needs two parameters, no more and no less")),
        }
    }
}

/// The values of `--at`, whose keys, where they are given, must be that of the parameter that varies.
///
/// # Errors
/// [`Failure::Option`] with another key.
pub fn requested_values(
    given: &[Values],
    key: &str,
    is_same: impl Fn(&str, &str) -> bool,
) -> Result<Vec<f64>, Failure> {
    match given.iter().filter_map(|values| values.key.as_ref()).find(|other| !is_same(other, key)) {
        Some(other) => Err(Failure::Option {
            option: "--at",
            given: other.clone(),
            problem: "this parameter does not vary here".to_owned(),
            allowed: format!("values of {key}"),
        }),
        None => Ok(given.iter().flat_map(|values| values.values.iter().copied()).collect()),
    }
}
