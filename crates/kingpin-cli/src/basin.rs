//! `kingpin basin`: where motions end, depending on where they start.

use crate::classification_options::ClassificationOptions;
use crate::shard_options::{ShardOptions, run_shard};
use crate::wheel_options::{WheelOptions, parameter_help};
use arclength_analysis::SampledInterval;
use clap::Args;
use kingpin_analysis::basin::BasinRequest;
use kingpin_analysis::sharded::ShardedRequest;
use kingpin_terminal::{Failure, OutputOptions, ProgressDisplay};

const EXAMPLE: &str = "kingpin basin --x psi=-1:1:161 --y Omega=-60:60:121 -s v=6 -o basin.png
         kingpin basin --contact sliding -s r=inf -s c_u=0.1 --samples 1000 --seed 7";

/// Where motions end, depending on where they start: the basin of attraction of the uniform motion
///
/// Two states of the initial condition vary, the others are those of the uniform motion. A motion ends in the uniform motion,
/// in shimmy (the caster swings to and fro: the motion repeats itself and comes back after a push), tumbling (it turns right round),
/// escape (the motion grows beyond fifty times the reference speed), or is undecided: irregular swinging, the end of the model (with
/// a tyre V1 = 0, with k_u = inf the caster across), or none of these. In rectilinear towing only the lateral motion counts: without c_u the longitudinal oscillation rings for ever
/// and is no shimmy. With --out every finished part is kept in PATH.journal until the result is written, so that an interrupted
/// run can be resumed.
#[derive(Args, Debug)]
#[command(after_help = format!("Example: {EXAMPLE}"), after_long_help = parameter_help(EXAMPLE))]
pub(crate) struct Basin {
    /// State across (u, q, psi, V, Omega; with a tyre u, q, psi, V1, V2, Omega, y_t), from A to B at N points
    #[arg(long, value_name = "STATE=A:B:N", default_value_t = BasinRequest::default().x, allow_hyphen_values = true)]
    x: SampledInterval,

    /// State upwards, from A to B at N points
    #[arg(long, value_name = "STATE=A:B:N", default_value_t = BasinRequest::default().y, allow_hyphen_values = true)]
    y: SampledInterval,

    /// Draw N random initial conditions in the rectangle in place of the grid
    #[arg(long, value_name = "N", allow_negative_numbers = true,
          allow_negative_numbers = true, value_parser = clap::value_parser!(u64).range(1..=BasinRequest::MOST_POINTS as u64))]
    samples: Option<u64>,

    /// Seed of the random numbers
    #[arg(long, value_name = "N", default_value_t = BasinRequest::default().seed, allow_negative_numbers = true, requires = "samples")]
    seed: u64,

    #[command(flatten)]
    classification: ClassificationOptions,

    /// Go on with the run that is kept in PATH.journal
    #[arg(long, conflicts_with = "shard")]
    resume: bool,

    #[command(flatten)]
    shard: ShardOptions,

    #[command(flatten)]
    wheel: WheelOptions,
    #[command(flatten)]
    output: OutputOptions,
}

impl Basin {
    /// Runs the command.
    ///
    /// # Errors
    /// Why it failed.
    pub(crate) fn run(&self) -> Result<(), Failure> {
        let request = BasinRequest {
            wheel: self.wheel.request(),
            x: self.x.clone(),
            y: self.y.clone(),
            samples: self.samples,
            seed: self.seed,
            classification: (&self.classification).into(),
        };
        if let Some(shard) = self.shard.shard {
            return run_shard(shard, &ShardedRequest::Basin(request), &self.output, "basin");
        }
        let output = self.output.prepare()?;
        let analysis = request.validate()?;
        output.warn_of(analysis.warnings());
        let journal = analysis.journal(output.first_file(), self.resume)?;
        if self.resume {
            let (done, parts) = (journal.finished().len(), analysis.parts()?);
            output.note(&format!("{done} of {parts} parts were finished"));
        }
        let progress = ProgressDisplay::bar("basin", output.is_quiet());
        let (result, _) = output.watch(progress, |control| analysis.run(control, &journal));
        output.deliver(&result?)?;
        Ok(journal.finish()?)
    }
}
