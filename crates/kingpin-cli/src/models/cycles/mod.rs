//! `arclength cycles`: a branch of limit cycles from a labelled point of an earlier result.

mod report;

pub use report::{CycleReport, CyclesReport, UnlocatedReport};

use super::branch::{Interruption, Origin, StepOptions};
use super::model::ParameterOptions;
use super::start::{LabelledPoint, What, read};
use crate::failure::Failure;
use crate::labels::kind;
use crate::numbers::readable;
use crate::options::OutputOptions;
use crate::output::Output;
use crate::progress::Progress;
use crate::range::{Range, Values};
use crate::stored::PointReference;
use arclength::branch::SpecialKind;
use arclength::continuation::Settings;
use arclength::cycle::{CycleStart, Orbit, Resolution, Role};
use arclength::equilibrium::SpecialPoint;
use clap::Args;

/// Limit cycles along a parameter, from a Hopf point, a cycle or a time history of an earlier result
///
/// From a Hopf point (HB) the cycles that are born there are followed, from a period doubling (PD) the doubled ones, from a
/// branch point of cycles (BPC) the other branch, from any other cycle the branch through it, and from the end (END) of a
/// time history the cycle on which it has settled.
#[derive(Args, Debug)]
#[command(
    after_help = "Example: arclength cycles --from equilibria.json:HB1 --along p=0:1 --at 0.5 -o cycles.json"
)]
pub struct Cycles {
    /// Labelled point of a file that `equilibria`, `cycles` or `simulate` wrote, with its model and parameters
    #[arg(long, value_name = "FILE.json:LABEL")]
    from: PointReference,

    /// Parameter and its interval
    #[arg(long, value_name = "KEY=A:B")]
    along: Range,

    /// Values of the parameter at which cycles are wanted exactly
    #[arg(long, value_name = "[KEY=]A,B,..", allow_hyphen_values = true)]
    at: Vec<Values>,

    /// Follow the branch of the labelled cycle itself, not the one that bifurcates there
    #[arg(long)]
    stay: bool,

    /// Tell the story of the run after the table
    #[arg(long)]
    explain: bool,

    #[command(flatten)]
    parameters: ParameterOptions,
    #[command(flatten)]
    steps: StepOptions,
    #[command(flatten)]
    mesh: MeshOptions,
    #[command(flatten)]
    output: OutputOptions,
}

/// How finely cycles are resolved.
#[derive(Args, Clone, Copy, Debug)]
#[command(next_help_heading = "Steps")]
struct MeshOptions {
    /// Error estimate, relative to the amplitude, that no cycle exceeds; the mesh follows from it
    #[arg(long, value_name = "E", default_value_t = Resolution::default().tolerance)]
    tolerance: f64,

    /// Most mesh intervals
    #[arg(long, value_name = "N", default_value_t = 2000,
          value_parser = clap::value_parser!(u32).range(4..=100_000))]
    intervals: u32,
}

impl Cycles {
    /// Runs the command.
    ///
    /// # Errors
    /// Why it failed.
    pub fn run(&self) -> Result<(), Failure> {
        let output = self.output.prepare(true)?;
        let point = read(&self.from)?;
        let mut chosen = point.chosen.clone();
        chosen.set(&self.parameters)?;
        let active = chosen.along("--along", &self.along)?;
        chosen.starts_within("--along", &self.along, &point.label)?;
        let at = chosen.values(active, &self.along, &self.at)?;
        let (start, origin) = self.start(&point, &chosen.parameters, &output)?;
        let name = &chosen.model.parameters()[active];
        let interruption = Interruption::watch()?;
        let progress = Progress::spinner("cycles", output.is_quiet());
        let mut branch = arclength::cycle::Cycles::of(&chosen.model, start)
            .parameters(&chosen.parameters)
            .along(active, self.along.start..=self.along.end)
            .at(&at)
            .settings(self.steps.apply(Settings::default()))
            .resolution(Resolution {
                most_intervals: self.mesh.intervals as usize,
                ..Resolution::with_tolerance(self.mesh.tolerance)
            })
            .observer(|value, period| {
                let (value, period) = (readable(value), readable(period));
                progress.message(format!("cycles, {name} = {value}, period {period}"));
                interruption.flow()
            })
            .run()?;
        drop(progress);
        // The cycle at which the branch starts may be one of those asked for.
        for cycle in &mut branch.points {
            if cycle.role == Role::Step && at.contains(&cycle.value) {
                cycle.role = Role::Requested;
            }
        }
        let mut report = CyclesReport::new(&chosen, active, &self.along, origin, branch);
        report.explain = self.explain;
        report.warn(name, &output);
        output.deliver(&report)?;
        interruption.report()
    }

    /// What the branch starts from.
    fn start(
        &self,
        point: &LabelledPoint,
        parameters: &[f64],
        output: &Output,
    ) -> Result<(CycleStart, Origin), Failure> {
        let origin = |how: &str| Origin::labelled(&point.label, how);
        match &point.what {
            What::Cycle { orbit, branching } => match branching {
                // The doubled cycles leave along every parameter, the other branch at a branch point along its own.
                Some((branching, key)) if !self.stay && (branching.doubled || *key == self.along.key) => {
                    let how =
                        if branching.doubled { "the doubled cycles" } else { "the other branch through it" };
                    Ok((CycleStart::Branching(branching.clone()), origin(how)))
                }
                // At a branch point Newton's method alone could find either branch.
                Some((branching, key))
                    if *key == self.along.key
                        && let Some(known) = branching.known_branch() =>
                {
                    Ok((CycleStart::Branching(known), origin("the branch on which it was found")))
                }
                _ => {
                    if !self.stay && matches!(kind(&point.label), "PD" | "BPC") {
                        output.warn(&format!(
                            "the branch of the cycle {} itself is followed, not the one that bifurcates there",
                            point.label
                        ));
                    }
                    Ok((CycleStart::Orbit(orbit.clone()), origin("the branch through it")))
                }
            },
            What::Equilibrium(Some(SpecialPoint::Hopf(hopf))) => {
                Ok((CycleStart::from(hopf), origin("the cycles that are born there")))
            }
            What::Motion { duration } => {
                let model = &point.chosen.model;
                let orbit = Orbit::from_time_history(model, parameters, &point.chosen.start, *duration)?;
                Ok((CycleStart::Orbit(orbit), origin("the cycle on which the time history has settled")))
            }
            What::Equilibrium(Some(SpecialPoint::Degenerate { of: SpecialKind::Hopf, .. })) => {
                Err(self.from.failure(format!(
                    "no cycles can be started at {}: it is degenerate and only bracketed, either because several pairs of \
                     eigenvalues cross there together or because a pair does not cross with a speed other than zero; start \
                     at a regular Hopf point or from the end (END) of a time history on a cycle",
                    point.label
                )))
            }
            What::Equilibrium(_) => Err(self.from.failure(format!(
                "no cycles start at {}; allowed: Hopf points (HB), cycles, and the end (END) of a time history on a cycle",
                point.label
            ))),
        }
    }
}
