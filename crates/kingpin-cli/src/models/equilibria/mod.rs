//! `arclength equilibria`: a branch of equilibria of a model, from its initial state or from a labelled point.

mod report;

pub use report::{EquilibriaReport, EquilibriumReport};

use super::branch::{Interruption, Origin, StepOptions};
use super::model::ModelOptions;
use super::start::{LabelledPoint, What};
use crate::failure::Failure;
use crate::numbers::readable;
use crate::options::OutputOptions;
use crate::progress::Progress;
use crate::range::{Range, Values};
use arclength::equilibrium::{BranchPoint, SpecialPoint, equilibrium_settings};
use clap::Args;

/// Equilibria along a parameter, with folds, branch points and Hopf points
///
/// Starts at the equilibrium near the initial state of the model, or at a labelled point of an earlier result: from a
/// branch point the other branch is followed, from any other point the branch through it.
#[derive(Args, Debug)]
#[command(after_help = "Example: arclength equilibria model.ode --along p=0:1 -o equilibria.json\n         \
                        arclength equilibria --from equilibria.json:BP1 --along p=0:1 -o other.json")]
pub struct Equilibria {
    #[command(flatten)]
    model: ModelOptions,

    /// Parameter and its interval
    #[arg(long, value_name = "KEY=A:B")]
    along: Range,

    /// Values of the parameter at which equilibria are wanted exactly
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

impl Equilibria {
    /// Runs the command.
    ///
    /// # Errors
    /// Why it failed.
    pub fn run(&self) -> Result<(), Failure> {
        let output = self.output.prepare(true)?;
        let (chosen, point) = self.model.choose(&output)?;
        let active = chosen.along("--along", &self.along)?;
        let at = chosen.values(active, &self.along, &self.at)?;
        let (branch_point, mut origin) = match &point {
            Some(point) => {
                chosen.starts_within("--along", &self.along, &point.label)?;
                self.departure(point)
            }
            None => (None, Origin::initial_state()),
        };
        let name = &chosen.model.parameters()[active];
        let interruption = Interruption::watch()?;
        let progress = Progress::spinner("equilibria", output.is_quiet());
        let equilibria = arclength::equilibrium::Equilibria::of(&chosen.model)
            .start(&chosen.start)
            .parameters(&chosen.parameters);
        let exact = matches!(&point, Some(point) if matches!(point.what, What::Equilibrium(_)));
        let equilibria = match &branch_point {
            Some(point) => equilibria.from_branch_point(point),
            None if exact && !self.model.changes_anything() => equilibria.through(&chosen.start),
            None => equilibria,
        };
        let branch = equilibria
            .along(name, self.along.start..=self.along.end)
            .at(&at)
            .settings(self.steps.apply(equilibrium_settings()))
            .observed(&mut |value, _| {
                progress.message(format!("equilibria, {name} = {}", readable(value)));
                interruption.flow()
            })?;
        drop(progress);
        // Whether branches cross there along this parameter too shows when they are followed.
        let start = branch.points.get(branch.start).and_then(|point| point.special.as_deref());
        if let (Some(point), Some(_), Some(SpecialPoint::BranchPoint(_))) = (&point, &branch_point, start) {
            origin = Origin::labelled(&point.label, "the other branch through it");
        }
        let mut report = EquilibriaReport::new(&chosen, &self.along, origin, &branch);
        report.explain = self.explain;
        output.deliver(&report)?;
        interruption.report()
    }

    /// What to do at a labelled point: the other branch at a branch point, else the branch through it.
    fn departure(&self, point: &LabelledPoint) -> (Option<BranchPoint>, Origin) {
        let branch_point = match &point.what {
            What::Equilibrium(Some(SpecialPoint::BranchPoint(known))) if !self.model.changes_anything() => {
                Some(known.clone())
            }
            _ => None,
        };
        (branch_point, Origin::labelled(&point.label, "the branch through it"))
    }
}
