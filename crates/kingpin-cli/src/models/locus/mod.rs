//! `arclength locus`: a curve of special points in two parameters.

mod report;

pub use report::{LocusPointReport, LocusReport};

use super::branch::{Origin, StepOptions};
use super::start::{What, read};
use crate::failure::Failure;
use crate::numbers::readable;
use crate::options::OutputOptions;
use crate::progress::Progress;
use crate::range::{Range, Values};
use crate::stored::PointReference;
use arclength::equilibrium::{SpecialPoint, equilibrium_settings};
use arclength::locus::EquilibriumLocus;
use clap::Args;
use std::ops::ControlFlow;

/// The curve of folds, Hopf points or branch points in two parameters, with its points of codimension two
#[derive(Args, Debug)]
#[command(
    after_help = "Example: arclength locus --from equilibria.json:HB1 --in p=0:1,q=2:5 -o hopf.json -o hopf.svg"
)]
pub struct Locus {
    /// Labelled point (LP, HB, BP) of a file that `equilibria` wrote, with its model and parameters
    #[arg(long, value_name = "FILE.json:LABEL")]
    from: PointReference,

    /// The two parameters and their intervals
    #[arg(long = "in", value_name = "KEY=A:B,KEY=C:D", value_delimiter = ',', num_args = 1..)]
    plane: Vec<Range>,

    /// Values of the first parameter at which points are wanted exactly
    #[arg(long, value_name = "[KEY=]A,B,..", allow_hyphen_values = true)]
    at: Vec<Values>,

    /// Tell the story of the run after the table
    #[arg(long)]
    explain: bool,

    #[command(flatten)]
    steps: StepOptions,
    #[command(flatten)]
    output: OutputOptions,
}

impl Locus {
    /// Runs the command.
    ///
    /// # Errors
    /// Why it failed.
    pub fn run(&self) -> Result<(), Failure> {
        let output = self.output.prepare(true)?;
        let [first, second] = &self.plane[..] else {
            return Err(Failure::Option {
                option: "--in",
                given: format!("{} parameters", self.plane.len()),
                problem: "a curve of special points needs two".to_owned(),
                allowed: "two parameters with their intervals, such as p=0:1,q=2:5".to_owned(),
            });
        };
        let point = read(&self.from)?;
        let chosen = &point.chosen;
        let active = [chosen.along("--in", first)?, chosen.along("--in", second)?];
        if active[0] == active[1] {
            return Err(Failure::Option {
                option: "--in",
                given: format!("{} twice", first.key),
                problem: "both parameters are the same".to_owned(),
                allowed: "two different parameters".to_owned(),
            });
        }
        for range in [first, second] {
            chosen.starts_within("--in", range, &point.label)?;
        }
        let at = chosen.values(active[0], first, &self.at)?;
        let curve = EquilibriumLocus::of(&chosen.model);
        let (curve, what) = match &point.what {
            What::Equilibrium(Some(SpecialPoint::Fold(fold))) => {
                (curve.from_fold(fold), "the folds through it")
            }
            What::Equilibrium(Some(SpecialPoint::Hopf(hopf))) => {
                (curve.from_hopf(hopf), "the Hopf points through it")
            }
            What::Equilibrium(Some(SpecialPoint::BranchPoint(branch_point))) => {
                (curve.from_branch_point(branch_point), "the branch points through it")
            }
            _ => {
                return Err(self.from.failure(format!(
                    "no curve of special points starts at {}; allowed: folds (LP), Hopf points (HB) and branch points (BP) \
                     of equilibria",
                    point.label
                )));
            }
        };
        let names = active.map(|index| chosen.model.parameters()[index].clone());
        let progress = Progress::spinner("curve", output.is_quiet());
        let branch = curve
            .along(&names[0], first.start..=first.end)
            .and(&names[1], second.start..=second.end)
            .at(&at)
            .settings(self.steps.apply(equilibrium_settings()))
            .observed(&mut |values, _| {
                let [one, two] = values.map(readable);
                progress.message(format!("curve, {} = {one}, {} = {two}", names[0], names[1]));
                ControlFlow::Continue(())
            })?;
        drop(progress);
        let origin = Origin::labelled(&point.label, what);
        let mut report = LocusReport::new(chosen, [first, second], origin, &branch);
        report.explain = self.explain;
        output.deliver(&report)
    }
}
