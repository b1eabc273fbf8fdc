//! `kingpin locus`: a curve of Hopf points or of special cycles in two parameters.

use crate::wheel_options::parameter_help;
use arclength_analysis::{Monitored, PointReference, Values};
use clap::Args;
use kingpin_analysis::locus::LocusRequest;
use kingpin_terminal::{
    Failure, MeshOptions, MonitorOptions, OutputOptions, PlaneOptions, ProgressDisplay, StepOptions,
    requested_values,
};

const EXAMPLE: &str =
    "kingpin locus --from hopf.json:HB1 --in v=1:12,c_q=0:0.2 -o boundary.json -o boundary.svg";

/// The curve of special points in two parameters, with its points of codimension two
///
/// Hopf points (HB) of the uniform motion; folds (LPC), period doublings (PD) and torus bifurcations (NS) of cycles. With
/// --hold any uniform motions or cycles on which a quantity keeps its value.
///
/// An expression of --monitor, --until or --hold may name the states, the parameters and friction_force, king_pin_force (N) and damper_power (W);
/// capital letters count: v is the towing speed, V that of the wheel.
#[derive(Args, Debug)]
#[command(after_help = format!("Example: {EXAMPLE}"), after_long_help = parameter_help(EXAMPLE))]
pub(crate) struct Locus {
    /// Labelled point of a file that `hopf` (HB), `cycles` (HB, LPC, PD, NS; any with --hold) or `locus` wrote, with its wheel
    #[arg(long, value_name = "FILE.json:LABEL")]
    from: PointReference,

    #[command(flatten)]
    plane: PlaneOptions,

    /// Values of the first parameter at which points are wanted exactly
    #[arg(long, value_name = "[KEY=]A,B,..", allow_hyphen_values = true)]
    at: Vec<Values>,

    /// Follow the uniform motions or cycles on which an expression keeps its value (the one at the start if none is given), such as
    /// psi=0.1; on cycles in max(..), min(..), mean(..), at(.., PHASE), period and parameters, such as "max(psi)=0.3"
    #[arg(long, value_name = "EXPRESSION[=VALUE]", allow_hyphen_values = true)]
    hold: Option<Monitored>,

    #[command(flatten)]
    monitors: MonitorOptions,

    /// Tell the story of the run after the table
    #[arg(long)]
    explain: bool,

    #[command(flatten)]
    steps: StepOptions,
    #[command(flatten)]
    mesh: MeshOptions,
    #[command(flatten)]
    output: OutputOptions,
}

impl Locus {
    /// Runs the command.
    ///
    /// # Errors
    /// Why it failed.
    pub(crate) fn run(&self) -> Result<(), Failure> {
        let output = self.output.prepare()?.explain(self.explain);
        let plane = self.plane.intervals()?;
        let request = LocusRequest {
            from: self.from.clone(),
            at: requested_values(&self.at, &plane[0].key, |given, key| given == key)?,
            plane,
            hold: self.hold.clone(),
            monitors: self.monitors.asked(),
            steps: self.steps.into(),
            mesh: self.mesh.into(),
        };
        let analysis = request.validate()?;
        let progress = ProgressDisplay::spinner("curve", output.is_quiet());
        let (result, interruption) = output.watch(progress, |control| analysis.run(control));
        let result = result?;
        output.warn_of(&result.warnings());
        output.deliver(&result)?;
        interruption.check_branch()
    }
}
