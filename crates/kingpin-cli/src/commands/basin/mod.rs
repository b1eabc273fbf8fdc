//! `kingpin basin`: where motions end, depending on where they start.

pub mod classification;
mod report;

use crate::error::Error;
use crate::journal::Journal;
use crate::wheel_options::{WheelOptions, parameter_help, parameters_of};
use arclength_analysis::Progress as Step;
use arclength_analysis::SampledInterval;
use clap::Args;
use classification::{Classification, NamedFate};
use kingpin::basin::{Axis, BasinMap, Destinations, Fate, Tile};
use kingpin_terminal::Interruption;
use kingpin_terminal::OutputOptions;
use kingpin_terminal::Progress;
use report::{BasinReport, Starts};
use serde_json::json;
use std::collections::BTreeMap;
use std::sync::atomic::{AtomicUsize, Ordering};

const EXAMPLE: &str = "kingpin basin --x psi=-1:1:161 --y Omega=-60:60:121 -s v=6 -o basin.png
         kingpin basin --contact sliding -s r=inf -s c_u=0.1 --samples 1000 --seed 7";
/// Most initial states.
const MOST_POINTS: usize = 10_000_000;

/// Where motions end, depending on where they start: the basin of attraction of the uniform motion
///
/// Two states of the initial condition vary, the others are those of the uniform motion. A motion ends in the uniform motion,
/// in shimmy (the caster swings to and fro: the motion repeats itself and comes back after a push, or is irregular with a size that
/// has no trend), tumbling (it turns right round), escape (the motion grows beyond fifty times the reference speed), or is
/// undecided. In rectilinear towing only the lateral motion counts: without c_u the longitudinal oscillation rings for ever
/// and is no shimmy. With --out every finished part is kept in PATH.journal until the result is written, so that an interrupted
/// run can be resumed.
#[derive(Args, Debug)]
#[command(after_help = format!("Example: {EXAMPLE}"), after_long_help = parameter_help(EXAMPLE))]
pub struct Basin {
    /// State across (u, q, psi, V, Omega), from A to B at N points
    #[arg(long, value_name = "STATE=A:B:N", default_value = "psi=-1:1:81", allow_hyphen_values = true)]
    x: SampledInterval,

    /// State upwards, from A to B at N points
    #[arg(long, value_name = "STATE=A:B:N", default_value = "Omega=-60:60:61", allow_hyphen_values = true)]
    y: SampledInterval,

    /// Draw N random initial conditions in the rectangle in place of the grid
    #[arg(long, value_name = "N", allow_negative_numbers = true,
          value_parser = clap::value_parser!(u64).range(1..=MOST_POINTS as u64))]
    samples: Option<u64>,

    /// Seed of the random numbers
    #[arg(long, value_name = "N", default_value_t = 1, requires = "samples")]
    seed: u64,

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

impl Basin {
    /// Runs the command.
    ///
    /// # Errors
    /// Why it failed.
    pub fn run(&self) -> Result<(), Error> {
        let axes = self.axes()?;
        let output = self.output.prepare()?;
        let wheel = self.wheel.wheel()?;
        let settings = self.classification.settings(&wheel)?;
        let model = self.classification.model();
        let destinations = Destinations::new(&wheel, model, settings)?;
        self.classification.warn(&wheel, &output)?;
        let counts = [self.x.count, self.y.count];
        let map = match self.samples {
            None => BasinMap::grid(&destinations, &axes, counts)?,
            Some(count) => BasinMap::samples(&destinations, &axes, count as usize, self.seed)?,
        };
        let ends = |interval: &SampledInterval| {
            (interval.interval.key.clone(), interval.interval.start, interval.interval.end)
        };
        let computation = json!({
            "program": env!("CARGO_PKG_VERSION"),
            "command": "basin",
            "parameters": parameters_of(&wheel, &[]),
            "axes": [ends(&self.x), ends(&self.y)],
            "counts": if self.samples.is_some() { None } else { Some(counts) },
            "samples": self.samples.map(|count| (count, self.seed)),
            "contact": model.name(),
            "duration": settings.duration,
        });
        let (journal, finished) =
            Journal::open::<Vec<NamedFate>>(output.first_file(), &computation, self.resume)?;
        if self.resume {
            output.note(&format!("{} of {} parts were finished", finished.len(), map.tiles()));
        }
        let fates = self.follow(&map, &journal, finished, output.is_quiet())?;
        let starts = match self.samples {
            None => Starts::grid(&axes, counts),
            Some(_) => Starts::sample(&axes, map.initial_states(), self.seed),
        };
        output.deliver(&BasinReport::new(destinations, &axes, starts, fates))?;
        journal.finish()
    }

    fn axes(&self) -> Result<[Axis; 2], Error> {
        let axis = |interval: &SampledInterval| {
            Axis::new(&interval.interval.key, interval.interval.start, interval.interval.end)
        };
        let axes = [axis(&self.x)?, axis(&self.y)?];
        if axes[0].name() == axes[1].name() {
            return Err(Error::invalid(
                &["x", "y"],
                axes[0].name().to_owned(),
                "the same state on both axes".to_owned(),
                "two different states".to_owned(),
            ));
        }
        let points = self.x.count.checked_mul(self.y.count);
        if self.samples.is_none() && points.is_none_or(|points| points > MOST_POINTS) {
            return Err(Error::invalid(
                &["x", "y"],
                format!("{} x {} points", self.x.count, self.y.count),
                "too many".to_owned(),
                format!("at most {MOST_POINTS} points in all"),
            ));
        }
        Ok(axes)
    }

    /// The fates of all starts, those of the finished tiles as they were kept.
    fn follow(
        &self,
        map: &BasinMap<'_>,
        journal: &Journal,
        finished: BTreeMap<usize, Vec<NamedFate>>,
        quiet: bool,
    ) -> Result<Vec<Fate>, Error> {
        for (&index, fates) in &finished {
            if fates.len() != map.states_of(index).len() || fates.is_empty() {
                return Err(Error::invalid(
                    &["resume"],
                    format!("part {index} of the journal"),
                    format!("{} fates", fates.len()),
                    "as many as the part has; delete the journal".to_owned(),
                ));
            }
        }
        let cancelled = Interruption::watch()?.flag();
        let progress = Progress::bar("basin", quiet);
        let done = AtomicUsize::new(finished.len());
        let keep = |tile: &Tile| {
            let fates: Vec<NamedFate> = tile.fates.iter().copied().map(NamedFate).collect();
            journal.keep(tile.index, &fates, cancelled);
            let done = done.fetch_add(1, Ordering::Relaxed) + 1;
            progress.show(Step::Done(done as f64 / map.tiles() as f64));
        };
        let computed = map.run(cancelled, |index| finished.contains_key(&index), keep)?;
        drop(progress);
        journal.checked(finished.len() + computed.len(), map.tiles())?;
        let mut all: BTreeMap<usize, Vec<Fate>> = finished
            .into_iter()
            .map(|(index, fates)| (index, fates.into_iter().map(|fate| fate.0).collect()))
            .collect();
        all.extend(computed.into_iter().map(|tile| (tile.index, tile.fates)));
        Ok(all.into_values().flatten().collect())
    }
}
