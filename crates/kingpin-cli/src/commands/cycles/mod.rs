//! `kingpin cycles`: limit cycles from the Hopf points of an interval, or from a labelled point of an earlier result.

mod picture;
mod report;

use crate::along::{along, as_followed, values_on};
use crate::commands::hopf;
use crate::error::Error;
use crate::stored::LabelledPoint;
use crate::wheel_options::{WheelOptions, parameter_help};
use arclength::continuation::Stop;
use arclength::cycle::CycleStart;
use arclength_analysis::PointReference;
use arclength_analysis::Progress as Step;
use arclength_analysis::{Interval, Values};
use clap::Args;
use kingpin::branches::{Along, CycleOptions, HopfPoint, WheelCycles};
use kingpin::{KingpinError, Wheel};
use kingpin_report::numbers::readable;
use kingpin_terminal::Interruption;
use kingpin_terminal::OutputOptions;
use kingpin_terminal::Progress;
use report::CyclesReport;
use std::ops::ControlFlow;
use std::sync::atomic::Ordering;

const EXAMPLE: &str = "kingpin cycles --along v=0.5:9 --at 1,2,4 -o cycles.json -o cycles.svg
         kingpin cycles --from cycles.json:AT3 --along r=1:inf";
/// Results that a computation of cycles can start from.
const SCHEMAS: [&str; 2] = ["kingpin.hopf", "kingpin.cycles"];
/// Relative distance of parameter values within which two Hopf points are the same.
const SAME_HOPF_POINT: f64 = 1e-6;

/// Limit cycles along a parameter, from Hopf points or from a labelled point of an earlier result
#[derive(Args, Debug)]
#[command(after_help = format!("Example: {EXAMPLE}"), after_long_help = parameter_help(EXAMPLE))]
pub struct Cycles {
    /// Parameter and its interval; r may reach inf
    #[arg(long, value_name = "KEY=A:B")]
    along: Interval,

    /// Values of the parameter at which cycles are wanted exactly
    #[arg(long, value_name = "[KEY=]A,B,..", allow_hyphen_values = true)]
    at: Vec<Values>,

    /// Start from a labelled point of a file that `hopf` or `cycles` wrote, with its wheel
    #[arg(long, value_name = "FILE.json:LABEL", conflicts_with = "wheel")]
    from: Option<PointReference>,

    /// At a period doubling or a branch point follow the branch of the point itself, not the one that leaves there
    #[arg(long, requires = "from")]
    stay: bool,

    #[command(flatten)]
    wheel: WheelOptions,
    #[command(flatten)]
    output: OutputOptions,
}

/// Where branches of cycles come from.
enum Start {
    /// All Hopf points of the interval, and the one to start from where it is not all.
    Hopf {
        points: Vec<HopfPoint>,
        only: Option<usize>,
    },
    Cycle {
        origin: String,
        start: CycleStart,
    },
}

/// A branch with the label of what it starts from.
#[derive(Debug)]
struct Branch {
    origin: String,
    /// The Hopf point that it starts from.
    hopf: Option<HopfPoint>,
    /// The Hopf point at which it ends.
    reached: Option<(String, HopfPoint)>,
    cycles: WheelCycles,
}

impl Cycles {
    /// Runs the command.
    ///
    /// # Errors
    /// Why it failed.
    pub fn run(&self) -> Result<(), Error> {
        let output = self.output.prepare()?;
        let along = along(&self.along)?;
        let at = values_on(&along, &self.at)?;
        let options = CycleOptions { at, ..CycleOptions::default() };
        let (wheel, start) = self.start(along)?;
        let progress = Progress::spinner("cycles", output.is_quiet());
        let interruption = Interruption::watch()?;
        let mut found = 0;
        let mut observer = |value: f64, period: f64| {
            found += 1;
            let (value, period) = (readable(value), readable(period));
            let message = format!("{found} cycles, {} = {value}, period {period} s", along.key());
            progress.show(Step::At(&message));
            if interruption.flag().load(Ordering::Relaxed) {
                ControlFlow::Break(())
            } else {
                ControlFlow::Continue(())
            }
        };
        let branches = match start {
            Start::Cycle { origin, start } => {
                let cycles = wheel.cycles_from(start, along, &options, &mut observer)?;
                vec![Branch { origin, hopf: None, reached: None, cycles }]
            }
            Start::Hopf { points, only } => from_hopf_points(&points, only, along, &options, &mut observer)?,
        };
        drop(progress);
        let on_branches = |value: f64| {
            branches.iter().flat_map(|branch| &branch.cycles.points).any(|cycle| cycle.value == value)
        };
        for value in
            options.at.iter().filter(|value| !on_branches(as_followed(&along, as_followed(&along, **value))))
        {
            output.warn(&format!(
                "no cycle at {} = {}: no branch passes there",
                along.key(),
                readable(*value)
            ));
        }
        output.deliver(&CyclesReport::new(wheel, along, &branches)?)?;
        Ok(interruption.check_branch()?)
    }

    fn start(&self, along: Along) -> Result<(Wheel, Start), Error> {
        let Some(reference) = &self.from else {
            let wheel = self.wheel.wheel()?;
            let points = hopf::search(&wheel, along)?.points;
            return Ok((wheel, Start::Hopf { points, only: None }));
        };
        let LabelledPoint { parameters, orbit, branching } = LabelledPoint::read(reference, &SCHEMAS)?;
        let wheel = stored_wheel(&parameters).map_err(|error| reference.failure(error.to_string()))?;
        let wheel = self.wheel.change(wheel)?;
        let value = wheel.get(along.key());
        let (start, end) = along.ends();
        if !along.contains(value) {
            return Err(KingpinError::OutsideInterval { key: along.key(), value, start, end }.into());
        }
        if let Some(orbit) = orbit {
            let states = wheel.free_states();
            if orbit.dimension != states.len() {
                return Err(reference
                    .failure(format!(
                        "the orbit of {} has {} states, this wheel {} ({}): leave k_u as it is in the file",
                        reference.label,
                        orbit.dimension,
                        states.len(),
                        states.join(", ")
                    ))
                    .into());
            }
            reference.check(&orbit, states.len())?;
            // The doubled cycles leave along every parameter, the other branch at a branch point along its own.
            let branching = branching
                .filter(|(branching, key)| branching.doubled || *key == along.key().to_string())
                .and_then(
                    |(branching, _)| if self.stay { branching.known_branch() } else { Some(branching) },
                );
            let origin = match &branching {
                Some(branching) if branching.doubled => format!("{}, the doubled cycles", reference.label),
                Some(_) if self.stay => format!("{}, the branch on which it was found", reference.label),
                Some(_) => format!("{}, the other branch through it", reference.label),
                None => reference.label.clone(),
            };
            let start = match branching {
                Some(branching) => {
                    branching.check(states.len()).map_err(|error| reference.failure(error.to_string()))?;
                    CycleStart::Branching(branching)
                }
                None => CycleStart::Orbit(orbit),
            };
            return Ok((wheel, Start::Cycle { origin, start }));
        }
        // The point of an earlier search is found again along the parameter that now varies, on the way from one end: a
        // search that starts at the point itself would not see the growth rate change its sign.
        let points = hopf::search(&wheel.with(along.key(), start)?, along)?.points;
        match points.iter().position(|point| same_value(point.value, value)) {
            Some(only) => Ok((wheel, Start::Hopf { points, only: Some(only) })),
            None => Err(Error::NothingFound(format!(
                "{} is no Hopf point along {}: the wheel was changed, or the growth rate does not change its sign \
                 there; without --from all Hopf points of the interval are found",
                reference.label,
                along.key()
            ))),
        }
    }
}

/// Every branch once: one that ends at another of the Hopf points is not followed again from there.
fn from_hopf_points(
    points: &[HopfPoint],
    only: Option<usize>,
    along: Along,
    options: &CycleOptions,
    mut observer: impl FnMut(f64, f64) -> ControlFlow<()>,
) -> Result<Vec<Branch>, Error> {
    let mut branches: Vec<Branch> = Vec::new();
    for (index, hopf) in points.iter().enumerate().filter(|(index, _)| only.is_none_or(|only| only == *index))
    {
        let origin = hopf::label(index);
        if branches.iter().any(|branch| branch.reached.as_ref().is_some_and(|(label, _)| *label == origin)) {
            continue;
        }
        let cycles = hopf.cycles(along, options, &mut observer)?;
        let reached = points.iter().enumerate().find(|(_, other)| match cycles.stops.1 {
            Stop::HopfPoint { parameter, .. } => same_value(as_followed(&along, other.value), parameter),
            _ => false,
        });
        let reached = reached.map(|(index, other)| (hopf::label(index), other.clone()));
        branches.push(Branch { origin, hopf: Some(hopf.clone()), reached, cycles });
    }
    Ok(branches)
}

fn same_value(first: f64, second: f64) -> bool {
    first == second || (first - second).abs() <= SAME_HOPF_POINT * first.abs().max(second.abs())
}

/// The wheel of a result file.
fn stored_wheel(parameters: &[(String, f64)]) -> Result<Wheel, KingpinError> {
    let mut wheel = Wheel::default();
    for (name, value) in parameters {
        wheel.set_value(name.parse()?, *value)?;
    }
    Ok(wheel)
}
