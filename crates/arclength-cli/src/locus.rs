//! `arclength locus`: a curve of special points in two parameters.

use arclength_analysis::locus::LocusRequest;
use arclength_analysis::{Monitored, PointReference, Values};
use clap::Args;
use kingpin_terminal::{
    Failure, MeshOptions, MonitorOptions, OutputOptions, PlaneOptions, ProgressDisplay, StepOptions,
    requested_values,
};

/// The curve of special points in two parameters, with its points of codimension two
///
/// Folds (LP), Hopf points (HB) and branch points (BP) of equilibria; folds (LPC), period doublings (PD) and torus
/// bifurcations (NS) of cycles. With --hold any equilibria or cycles on which a quantity keeps its value: cycles with a large
/// period follow homoclinic orbits.
#[derive(Args, Debug)]
#[command(
    after_help = "Example: arclength locus --from equilibria.json:HB1 --in p=0:1,q=2:5 -o hopf.json -o hopf.svg"
)]
pub(crate) struct Locus {
    /// Labelled point of a file that `equilibria` (LP, HB, BP) or `cycles` (LPC, PD, NS) wrote, any with --hold, with its model
    #[arg(long, value_name = "FILE.json:LABEL")]
    from: PointReference,

    #[command(flatten)]
    plane: PlaneOptions,

    /// Values of the first parameter at which points are wanted exactly
    #[arg(long, value_name = "[KEY=]A,B,..", allow_hyphen_values = true)]
    at: Vec<Values>,

    /// Follow the equilibria or cycles on which an expression keeps its value (the one at the start if none is given), such as
    /// x=0.3; on cycles in max(..), min(..), mean(..), at(.., PHASE), period and parameters, such as period=50
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
            at: requested_values(&self.at, &plane[0].key, str::eq_ignore_ascii_case)?,
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
