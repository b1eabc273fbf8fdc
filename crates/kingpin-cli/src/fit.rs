//! `kingpin fit`: parameters of a wheel from records of its motion.

use crate::wheel_options::{WheelOptions, parameter_help};
use arclength_analysis::Assignment;
use clap::Args;
use kingpin_analysis::fit::{FitRequest, RecordRequest};
use kingpin_report::ReportError;
use kingpin_report::files::{Staged, check_writable};
use kingpin_terminal::{Failure, OutputOptions, ProgressDisplay};
use std::path::PathBuf;

const EXAMPLE: &str = "kingpin fit decay.csv --wheel mine.toml -o fit.svg --write-wheel fitted.toml
         kingpin fit slow.csv:v=0.5 fast.csv:v=2 --estimate k,c_psi,M_f --offset psi";

/// Parameters of a wheel from records of its motion, with their intervals
///
/// A record is a file of comma-separated values with a line of names: t and one or more states, mostly psi. It begins after the
/// caster was released or the wheel hit, while it swings. Parameters, and the states at the start of every record, are those with
/// the smallest sum of squared residuals; intervals hold the truth 95 times in 100 if the noise is independent from sample to
/// sample and normal. What is not estimated is as the wheel has it, and what is estimated starts from there. A line
/// `# v = 1.5` of the file (or `# v: 1.5 m/s, r: 2`), or FILE.csv:v=1.5, says at which speed a record was taken. A caster that was held and released has
/// --start Omega=uniform: its rate is known.
#[derive(Args, Debug)]
#[command(after_help = format!("Example: {EXAMPLE}"), after_long_help = parameter_help(EXAMPLE))]
pub(crate) struct Fit {
    /// Records, each with parameters of its own where it was taken at others
    #[arg(value_name = "FILE.csv[:KEY=VALUE,..]", required = true)]
    records: Vec<RecordRequest>,

    /// Keys of the parameters that are estimated [default: k, or k_q where it differs from k_u, c_q, c_psi, M_f]
    #[arg(long, value_name = "KEY,..", value_delimiter = ',')]
    estimate: Vec<String>,

    /// Measured states that count [default: all]
    #[arg(long, value_name = "KEY,..", value_delimiter = ',')]
    states: Vec<String>,

    /// What is known of a state at the first sample of every record: a value, `uniform` (that of the uniform motion) or `free`;
    /// repeatable [default: free where it was measured and for q, psi and Omega, else uniform]
    #[arg(long, value_name = "KEY=VALUE", allow_hyphen_values = true)]
    start: Vec<Assignment>,

    /// Measured states whose instrument has an unknown zero
    #[arg(long, value_name = "KEY,..", value_delimiter = ',')]
    offset: Vec<String>,

    /// Standard deviation of the noise of a state, if it is known; repeatable
    #[arg(long, value_name = "KEY=VALUE")]
    sigma: Vec<Assignment>,

    /// Do not look for the largest safe blow, which takes longest
    #[arg(long)]
    no_blow: bool,

    /// Write the wheel with the estimates, as --wheel reads it
    #[arg(long, value_name = "FILE.toml")]
    write_wheel: Option<PathBuf>,

    #[command(flatten)]
    wheel: WheelOptions,
    #[command(flatten)]
    output: OutputOptions,
}

impl Fit {
    /// Runs the command.
    ///
    /// # Errors
    /// Why it failed.
    pub(crate) fn run(&self) -> Result<(), Failure> {
        let output = self.output.prepare()?;
        if let Some(path) = &self.write_wheel {
            check_writable(path).map_err(|error| Failure::Option {
                option: "--write-wheel",
                given: path.display().to_string(),
                problem: match error {
                    ReportError::Unwritable { source, .. } => format!("cannot write there: {source}"),
                    other => other.to_string(),
                },
                allowed: "a file in a folder in which files can be written".to_owned(),
            })?;
        }
        let request = FitRequest {
            wheel: self.wheel.request(),
            records: self.records.clone(),
            estimate: self.estimate.clone(),
            states: self.states.clone(),
            start: self.start.clone(),
            offset: self.offset.clone(),
            sigma: self.sigma.clone(),
            no_blow: self.no_blow,
        };
        let analysis = request.validate()?;
        output.warn_of(analysis.warnings());
        let progress = ProgressDisplay::bar("fit", output.is_quiet());
        let (result, _) = output.watch(progress, |control| analysis.run(control));
        let result = result?;
        output.warn_of(&result.warnings());
        let wheel = self.write_wheel.as_ref().map(|path| {
            Staged::new(path, |out| {
                let text = result.wheel.to_toml();
                out.write_all(text.as_bytes())
                    .map_err(|source| ReportError::Encoding { format: "TOML", source })
            })
        });
        output.deliver_with(&result, wheel)
    }
}
