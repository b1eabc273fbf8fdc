//! `kingpin margin`: the smallest disturbance that does not return along a parameter, beside the unstable limit cycle.

mod report;

use crate::commands::basin::classification::Classification;
use crate::commands::safe_kick::edge::{DisturbanceOptions, Edge};
use crate::error::Error;
use crate::journal::Journal;
use crate::wheel_options::{WheelOptions, parameter_help, parameters_of};
use arclength_analysis::Progress as Step;
use arclength_analysis::SampledInterval;
use clap::Args;
use kingpin::branches::{Along, CycleOptions};
use kingpin::simulation::SimulationError;
use kingpin::{Key, KingpinError, Wheel};
use kingpin_report::numbers::readable;
use kingpin_terminal::Interruption;
use kingpin_terminal::Output;
use kingpin_terminal::OutputOptions;
use kingpin_terminal::Progress;
use rayon::prelude::*;
use report::MarginReport;
use serde::{Deserialize, Serialize};
use serde_json::json;
use std::collections::BTreeMap;
use std::ops::ControlFlow;
use std::sync::atomic::{AtomicUsize, Ordering};

const EXAMPLE: &str = "kingpin margin --along v=1:8:15 --kind release-angle -o margin.svg";
/// Cycles are followed to this part of the smallest value, so that it lies inside.
const BELOW: f64 = 0.99;
/// Most values of the parameter.
const MOST_POINTS: usize = 10_000;
/// The Hopf point whose cycles are wanted is sought in intervals that reach so many times as far at either end, one after the
/// other: with the shortest in which there is one its branch is followed.
const SEARCHED: [f64; 4] = [2.0, 4.0, 8.0, 16.0];

/// Safe disturbances along a parameter, beside the amplitude of the unstable limit cycle
///
/// At each value the smallest disturbance that does not return is found as by `safe-kick`, in both directions. The paper takes
/// the amplitude of the unstable cycle for the size of the basin; the ratio of the two tells how good an indicator it is.
/// With --out every finished part, the value of the parameter, is kept in PATH.journal until the result is written, so that an interrupted run can be
/// resumed.
#[derive(Args, Debug)]
#[command(after_help = format!("Example: {EXAMPLE}"), after_long_help = parameter_help(EXAMPLE))]
pub struct Margin {
    /// Parameter, from A to B at N values
    #[arg(long, value_name = "KEY=A:B:N", default_value = "v=1:8:15")]
    along: SampledInterval,

    #[command(flatten)]
    disturbance: DisturbanceOptions,
    #[command(flatten)]
    classification: Classification,

    /// Go on with the run that is kept in PATH.journal
    #[arg(long)]
    resume: bool,

    #[command(flatten)]
    wheel: WheelOptions,
    #[command(flatten)]
    output: OutputOptions,
}

/// What was found at one value of the parameter.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
struct Cell {
    positive: Option<Edge>,
    negative: Option<Edge>,
    /// Why no edge was sought.
    problem: Option<String>,
}

impl Margin {
    /// Runs the command.
    ///
    /// # Errors
    /// Why it failed.
    pub fn run(&self) -> Result<(), Error> {
        let key: Key = self.along.interval.key.parse()?;
        let along = Along::new(key, self.along.interval.start, self.along.interval.end)?;
        let count = self.along.count;
        if count > MOST_POINTS || self.along.interval.end.is_infinite() {
            return Err(Error::invalid(
                &["along"],
                format!("{} values up to {}", count, self.along.interval.end),
                "too many, or infinite".to_owned(),
                format!("at most {MOST_POINTS} finite values; `curvature` goes to 0 where r goes to inf"),
            ));
        }
        let (start, end) = along.ends();
        let values: Vec<f64> =
            (0..count).map(|index| start + (end - start) * (index as f64 / (count - 1) as f64)).collect();
        let output = self.output.prepare()?;
        let wheel = self.wheel.wheel()?;
        self.disturbance.check(&wheel.with(key, end)?)?;
        if let Some(duration) = self.classification.duration() {
            // A duration that makes no sense is refused before anything is computed.
            self.classification.settings(&wheel.with(key, start)?).map(|_| duration)?;
        }
        let computation = json!({
            "program": env!("CARGO_PKG_VERSION"),
            "command": "margin",
            "parameters": parameters_of(&wheel, &[key]),
            "along": (key.name(), start, end, count),
            "kind": self.disturbance.kind().name(),
            "largest": self.disturbance.given(),
            "contact": self.classification.model().name(),
            "duration": self.classification.duration(),
        });
        let (journal, finished) = Journal::open::<Cell>(output.first_file(), &computation, self.resume)?;
        if self.resume {
            output.note(&format!("{} of {count} parts were finished", finished.len()));
        }
        let cells = self.cells(&wheel, key, &values, &journal, finished, output.is_quiet())?;
        let cycles = unstable_cycles(&wheel, along, &values, &output)?;
        output.deliver(&MarginReport::new(
            wheel,
            along,
            self.disturbance.kind(),
            self.classification.model(),
            values,
            cells,
            cycles,
        ))?;
        journal.finish()
    }

    fn cells(
        &self,
        wheel: &Wheel,
        key: Key,
        values: &[f64],
        journal: &Journal,
        finished: BTreeMap<usize, Cell>,
        quiet: bool,
    ) -> Result<Vec<Cell>, Error> {
        let cancelled = Interruption::watch()?.flag();
        let progress = Progress::bar("margin", quiet);
        let done = AtomicUsize::new(finished.len());
        let computed: Vec<(usize, Cell)> = (0..values.len())
            .into_par_iter()
            .filter(|index| !finished.contains_key(index) && !cancelled.load(Ordering::Relaxed))
            .map(|index| {
                let cell = self.cell(&wheel.with(key, values[index])?)?;
                journal.keep(index, &cell, cancelled);
                let done = done.fetch_add(1, Ordering::Relaxed) + 1;
                progress.show(Step::Done(done as f64 / values.len() as f64));
                Ok((index, cell))
            })
            .collect::<Result<_, Error>>()?;
        drop(progress);
        let mut all = finished;
        all.extend(computed);
        journal.checked(all.len(), values.len())?;
        Ok(all.into_values().collect())
    }

    fn cell(&self, wheel: &Wheel) -> Result<Cell, Error> {
        let without =
            |problem: &str| Ok(Cell { positive: None, negative: None, problem: Some(problem.to_owned()) });
        let settings = match self.classification.settings(wheel) {
            Err(Error::Simulation(SimulationError::Wheel(KingpinError::NoUniformMotion { .. }))) => {
                return without("no uniform motion");
            }
            settings => settings?,
        };
        match self.disturbance.edges(wheel, self.classification.model(), settings) {
            Ok([positive, negative]) => Ok(Cell { positive, negative, problem: None }),
            Err(SimulationError::UniformMotionSlides { .. }) => without("the uniform motion slides"),
            Err(error) => Err(error.into()),
        }
    }
}

/// The unstable limit cycles beside the safe disturbances.
#[derive(Clone, Debug, Default)]
struct UnstableCycles {
    /// Half the range of the caster angle of the smallest one at each value, where there is one.
    amplitudes: Vec<Option<f64>>,
    /// Why there is none at some values.
    remarks: Vec<String>,
}

/// Finds them from the Hopf points in the interval, or, where it has none, in the nearest part beside it.
fn unstable_cycles(
    wheel: &Wheel,
    along: Along,
    values: &[f64],
    output: &Output,
) -> Result<UnstableCycles, Error> {
    let progress = Progress::spinner("unstable limit cycles", output.is_quiet());
    let mut found = UnstableCycles { amplitudes: vec![None; values.len()], remarks: Vec::new() };
    let key = along.key();
    let (start, end) = along.ends();
    // A search begins at the wheel's own value where that is inside.
    let wheel = wheel.with(key, 0.5 * (start + end))?;
    let mut searched = along;
    let mut hopf_points = Vec::new();
    for reach in SEARCHED {
        let allowed = key.allowed();
        let ends = [start / reach, end * reach].map(|end| end.clamp(allowed.lowest, allowed.highest));
        let wider = Along::new(key, ends[0].min(start), ends[1].max(end))?;
        match wheel.hopf_points(wider) {
            Ok(search) => (searched, hopf_points) = (wider, search.points),
            Err(error) => {
                found.remarks.push(format!("no Hopf points were sought: {error}"));
                break;
            }
        }
        if !hopf_points.is_empty() {
            break;
        }
    }
    if hopf_points.is_empty() {
        let (low, high) = searched.ends();
        found.remarks.push(format!(
            "no limit cycles: the uniform motion has no Hopf point in {key} = {}:{}",
            readable(low),
            readable(high)
        ));
    }
    let options = CycleOptions { at: values.to_vec(), ..CycleOptions::default() };
    for hopf in &hopf_points {
        let born = format!("the limit cycles from the Hopf point at {key} = {}", readable(hopf.value));
        // Only as far down as it is needed: slow cycles take long.
        let (lowest, highest) = searched.ends();
        let lowest = if hopf.value > start { lowest.max(BELOW * start) } else { lowest };
        let branch = match hopf
            .cycles(Along::new(key, lowest, highest)?, &options, |_, _| ControlFlow::Continue(()))
        {
            Ok(branch) => branch,
            Err(error) => {
                found.remarks.push(format!("{born}: {error}"));
                continue;
            }
        };
        for cycle in branch.points.iter().filter(|cycle| cycle.unstable_multipliers > 0) {
            let amplitude = 0.5 * (cycle.max[2] - cycle.min[2]);
            let places = values.iter().zip(&mut found.amplitudes).filter(|(value, _)| **value == cycle.value);
            for (_, smallest) in places {
                *smallest = Some(smallest.map_or(amplitude, |other| other.min(amplitude)));
            }
        }
        let reached = branch.points.iter().map(|cycle| cycle.value);
        let [low, high] =
            reached.fold([hopf.value; 2], |[low, high], value| [f64::min(low, value), f64::max(high, value)]);
        if values.iter().any(|value| !(low..=high).contains(value)) {
            found.remarks.push(format!("{born} exist in {key} = {}:{}", readable(low), readable(high)));
        }
    }
    if found.amplitudes.iter().all(Option::is_some) {
        found.remarks.clear();
    }
    drop(progress);
    Ok(found)
}
