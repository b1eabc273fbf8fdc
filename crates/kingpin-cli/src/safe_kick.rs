//! `kingpin safe-kick`: the smallest disturbance of the uniform motion that does not return.

use crate::classification_options::ClassificationOptions;
use crate::disturbance_options::DisturbanceOptions;
use crate::wheel_options::{WheelOptions, parameter_help};
use clap::Args;
use kingpin_analysis::safe_kick::SafeKickRequest;
use kingpin_terminal::{Failure, OutputOptions, ProgressDisplay};

const EXAMPLE: &str = "kingpin safe-kick -s v=6 -o edge.svg
         kingpin safe-kick --kind step-steer --contact sliding -s v=2 -s r=inf -s c_u=0.1";

/// Smallest disturbance of a kind from which the wheel does not return to its uniform motion
///
/// Both directions are tried. Magnitudes up to --largest are scanned at 64 equal distances for the first that does not
/// return, and the edge before it is narrowed down by bisection to a millionth. Up to the edge 64 magnitudes are tried once more, and
/// 32 closer ones just below it; the search goes on from there if one does not return. The result says how far apart
/// magnitudes were tried (`resolution`): failures in a narrower range may lie below the edge. Files hold the motions on
/// both sides of it.
#[derive(Args, Debug)]
#[command(after_help = format!("Example: {EXAMPLE}"), after_long_help = parameter_help(EXAMPLE))]
pub(crate) struct SafeKick {
    #[command(flatten)]
    disturbance: DisturbanceOptions,
    #[command(flatten)]
    classification: ClassificationOptions,
    #[command(flatten)]
    wheel: WheelOptions,
    #[command(flatten)]
    output: OutputOptions,
}

impl SafeKick {
    /// Runs the command.
    ///
    /// # Errors
    /// Why it failed.
    pub(crate) fn run(&self) -> Result<(), Failure> {
        let output = self.output.prepare()?;
        let request = SafeKickRequest {
            wheel: self.wheel.request(),
            disturbance: (&self.disturbance).into(),
            classification: (&self.classification).into(),
        };
        let analysis = request.validate()?;
        output.warn_of(analysis.warnings());
        let progress = ProgressDisplay::bar("smallest disturbance that does not return", output.is_quiet());
        let (result, _) = output.watch(progress, |control| analysis.run(control));
        output.deliver(&result?)
    }
}
