//! `kingpin damper`: the smallest dampers with which no shimmy is born up to a speed.

use crate::wheel_options::{WheelOptions, parameter_help};
use arclength_analysis::Assignment;
use clap::Args;
use kingpin_analysis::damper::{DamperRequest, Range};
use kingpin_terminal::{Failure, OutputOptions, ProgressDisplay};

const EXAMPLE: &str = "kingpin damper --up-to v=3 -s l=0.04 -s r=inf
         kingpin damper --up-to v=3 -s l=0.04 --radius 1:inf";

/// Smallest dampers with which no shimmy is born up to a speed
///
/// The least c_q and the least c_psi with which the uniform motion is stable at every speed from a thousandth of the one given
/// to that one, each alone and both together, and the speed that decides. The wheel's own c_q and c_psi do not count. Large
/// cycles beside stable motion (an isola) may take more: they are followed from the Hopf points of weaker dampers along the speed, the
/// damping and their folds in both, and the wheel is kicked at random; the result says what was searched, which is no proof that there
/// are none. With --radius and --load the dampers are enough on all these circles and under all these loads, wherever the motion grows
/// fastest; the fold of the last cycle is followed from the radii at the ends, and from that which decides, over the others.
#[derive(Args, Debug)]
#[command(after_help = format!("Example: {EXAMPLE}"), after_long_help = parameter_help(EXAMPLE))]
pub(crate) struct Damper {
    /// Speed up to which the motion is to be stable
    #[arg(long, value_name = "v=VALUE")]
    up_to: Assignment,

    /// Radii in m for which the damper is to be enough: all from A to B, perhaps inf, or A,B,C
    #[arg(long, value_name = "A:B")]
    radius: Option<Range>,

    /// Loads in N (F_Az, negative presses down) for which it is to be enough: all from A to B, or A,B,C
    #[arg(long, value_name = "A:B", allow_hyphen_values = true)]
    load: Option<Range>,

    /// Only what small motions take: large cycles are not sought
    #[arg(long)]
    small_motions: bool,

    #[command(flatten)]
    wheel: WheelOptions,
    #[command(flatten)]
    output: OutputOptions,
}

impl Damper {
    /// Runs the command.
    ///
    /// # Errors
    /// Why it failed.
    pub(crate) fn run(&self) -> Result<(), Failure> {
        let output = self.output.prepare_without_picture()?;
        let request = DamperRequest {
            wheel: self.wheel.request(),
            up_to: self.up_to.clone(),
            radius: self.radius.clone(),
            load: self.load.clone(),
            small_motions: self.small_motions,
        };
        let progress = ProgressDisplay::bar("dampers", output.is_quiet());
        let (result, _) = output.watch(progress, |control| request.run(control));
        output.deliver(&result?)
    }
}
