//! `arclength locus`: a curve of special points in two parameters.

mod cycles;
mod report;

pub use cycles::{CycleLocusPointReport, CycleLocusReport, UnlocatedChangeReport};
pub use report::{LocusPointReport, LocusReport};

use super::branch::{Interruption, Origin, StepOptions};
use super::model::ChosenModel;
use super::start::{What, read};
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
use arclength::cycle::Orbit;
use arclength::equilibrium::{SpecialPoint, equilibrium_settings};
use arclength::locus::{CycleLocus, EquilibriumLocus};
use clap::Args;
use std::ops::ControlFlow;

/// The curve of special points in two parameters, with its points of codimension two
///
/// Folds (LP), Hopf points (HB) and branch points (BP) of equilibria; folds (LPC), period doublings (PD) and torus
/// bifurcations (NS) of cycles.
#[derive(Args, Debug)]
#[command(
    after_help = "Example: arclength locus --from equilibria.json:HB1 --in p=0:1,q=2:5 -o hopf.json -o hopf.svg"
)]
pub struct Locus {
    /// Labelled point of a file that `equilibria` (LP, HB, BP) or `cycles` (LPC, PD, NS) wrote, with its model
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
        let request = Request { chosen, ranges: [first, second], at };
        match &point.what {
            What::Equilibrium(Some(special)) => self.of_equilibria(&request, &point.label, special, &output),
            What::Cycle { orbit, .. } => self.of_cycles(&request, &point.label, orbit, &output),
            _ => Err(self.no_curve(&point.label)),
        }
    }

    fn no_curve(&self, label: &str) -> Failure {
        self.from.failure(format!(
            "no curve of special points starts at {label}; allowed: folds (LP), Hopf points (HB) and branch points (BP) of \
             equilibria, folds (LPC), period doublings (PD) and torus bifurcations (NS) of cycles"
        ))
    }

    fn of_equilibria(
        &self,
        request: &Request<'_>,
        label: &str,
        special: &SpecialPoint,
        output: &Output,
    ) -> Result<(), Failure> {
        let curve = EquilibriumLocus::of(&request.chosen.model);
        let (curve, what) = match special {
            SpecialPoint::Fold(fold) => (curve.from_fold(fold), "the folds through it"),
            SpecialPoint::Hopf(hopf) => (curve.from_hopf(hopf), "the Hopf points through it"),
            SpecialPoint::BranchPoint(point) => {
                (curve.from_branch_point(point), "the branch points through it")
            }
            _ => return Err(self.no_curve(label)),
        };
        let [first, second] = request.ranges;
        let names = request.names();
        let interruption = Interruption::watch()?;
        let progress = Progress::spinner("curve", output.is_quiet());
        let branch = curve
            .along(&names[0], first.start..=first.end)
            .and(&names[1], second.start..=second.end)
            .at(&request.at)
            .settings(self.steps.apply(equilibrium_settings()))
            .observed(&mut |values, _| request.tell(&progress, interruption, values))?;
        drop(progress);
        let origin = Origin::labelled(label, what);
        let mut report = LocusReport::new(request.chosen, request.ranges, origin, &branch);
        report.explain = self.explain;
        output.deliver(&report)?;
        interruption.report()
    }

    fn of_cycles(
        &self,
        request: &Request<'_>,
        label: &str,
        orbit: &Orbit,
        output: &Output,
    ) -> Result<(), Failure> {
        let (special, what) = match kind(label) {
            "LPC" => (SpecialKind::FoldOfCycles, "the folds of cycles through it"),
            "PD" => (SpecialKind::PeriodDoubling, "the period doublings through it"),
            "NS" => (SpecialKind::Torus, "the torus bifurcations through it"),
            _ => return Err(self.no_curve(label)),
        };
        let [first, second] = request.ranges;
        let names = request.names();
        let interruption = Interruption::watch()?;
        let progress = Progress::spinner("curve", output.is_quiet());
        let branch = CycleLocus::of(&request.chosen.model)
            .from_cycle(special, orbit, &request.chosen.parameters)
            .along(&names[0], first.start..=first.end)
            .and(&names[1], second.start..=second.end)
            .at(&request.at)
            .settings(self.steps.apply(Settings::default()))
            .observed(&mut |values, _| request.tell(&progress, interruption, values))?;
        drop(progress);
        let origin = Origin::labelled(label, what);
        let mut report = CycleLocusReport::new(request.chosen, request.ranges, origin, branch);
        report.explain = self.explain;
        output.deliver(&report)?;
        report.warn(output);
        interruption.report()
    }
}

/// A curve that was asked for.
struct Request<'a> {
    chosen: &'a ChosenModel,
    ranges: [&'a Range; 2],
    at: Vec<f64>,
}

impl Request<'_> {
    /// The parameters as the model writes their names.
    fn names(&self) -> [String; 2] {
        self.ranges.map(|range| {
            let index = self.chosen.model.parameter_index(&range.key);
            index.map_or_else(|| range.key.clone(), |index| self.chosen.model.parameters()[index].clone())
        })
    }

    fn tell(&self, progress: &Progress, interruption: Interruption, values: [f64; 2]) -> ControlFlow<()> {
        let [one, two] = values.map(readable);
        let [first, second] = self.ranges.map(|range| range.key.as_str());
        progress.message(format!("curve, {first} = {one}, {second} = {two}"));
        interruption.flow()
    }
}
