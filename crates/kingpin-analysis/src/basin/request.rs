//! What a basin of attraction is asked for by, and how it is computed.

use super::result::{BasinResult, FATE, Starts};
use crate::by_chunks::{ByChunks, Keep, in_a_chunk};
use crate::classification::{Classification, NamedFate};
use crate::error::Error;
use crate::journal::Journal;
use crate::parameters::parameters_of;
use crate::wheel_request::WheelRequest;
use arclength_analysis::{Control, SampledInterval};
use kingpin::Wheel;
use kingpin::basin::{Axis, BasinMap, Destinations, Fate, Tile};
use kingpin_report::{Columns, Entries};
use serde::{Deserialize, Serialize};
use serde_json::{Value, json};
use std::collections::BTreeMap;
use std::ops::Range;
use std::path::Path;
use std::sync::{Mutex, PoisonError};

/// Most chunks of a run that is divided into shards: each is two files.
const MOST_CHUNKS: usize = 10_000;

/// Where motions end, depending on where they start: two states of the initial condition vary, the others are those of the
/// uniform motion.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct BasinRequest {
    /// Which wheel.
    #[serde(flatten)]
    pub wheel: WheelRequest,
    /// State across (u, q, psi, V, Omega; with a tyre u, q, psi, V1, V2, Omega, y_t; of those the ones that the wheel can take).
    pub x: SampledInterval,
    /// State upwards.
    pub y: SampledInterval,
    /// So many random initial conditions in the rectangle in place of the grid.
    pub samples: Option<u64>,
    /// Seed of the random numbers.
    pub seed: u64,
    /// How motions are followed.
    #[serde(flatten)]
    pub classification: Classification,
}

impl Default for BasinRequest {
    fn default() -> Self {
        Self {
            wheel: WheelRequest::default(),
            x: SampledInterval::new("psi", -1.0, 1.0, 81),
            y: SampledInterval::new("Omega", -60.0, 60.0, 61),
            samples: None,
            seed: 1,
            classification: Classification::default(),
        }
    }
}

/// A request that makes sense.
#[derive(Debug)]
pub struct BasinAnalysis {
    axes: [Axis; 2],
    counts: [usize; 2],
    sample: Option<(usize, u64)>,
    destinations: Destinations,
    warnings: Vec<String>,
    /// What the journal says that it belongs to.
    computation: Value,
}

impl BasinRequest {
    /// Most initial states.
    pub const MOST_POINTS: usize = 10_000_000;

    /// Reads the wheel and checks every field.
    ///
    /// # Errors
    /// What is wrong with the wheel or a field; no uniform motion.
    pub fn validate(&self) -> Result<BasinAnalysis, Error> {
        self.validate_for(self.wheel.read()?)
    }

    /// The same for a wheel that was read.
    pub(crate) fn validate_for(&self, wheel: Wheel) -> Result<BasinAnalysis, Error> {
        let axes = self.axes(&wheel)?;
        let settings = self.classification.settings(&wheel)?;
        let contact = self.classification.contact_or_rolling();
        let model = contact.model();
        let destinations = Destinations::new(&wheel, model, settings)?;
        let counts = [self.x.count, self.y.count];
        let ends =
            |axis: &SampledInterval| (axis.interval.key.clone(), axis.interval.start, axis.interval.end);
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
        Ok(BasinAnalysis {
            axes,
            counts,
            sample: self.samples.map(|count| (count as usize, self.seed)),
            destinations,
            warnings: self.classification.warnings(&wheel, contact)?,
            computation,
        })
    }

    fn axes(&self, wheel: &Wheel) -> Result<[Axis; 2], Error> {
        self.x.check_count(&["x"])?;
        self.y.check_count(&["y"])?;
        let axis = |axis: &SampledInterval| {
            Axis::of_wheel(wheel, &axis.interval.key, axis.interval.start, axis.interval.end)
        };
        let axes = [axis(&self.x)?, axis(&self.y)?];
        if axes[0].name() == axes[1].name() {
            return Err(Error::invalid(
                &["x", "y"],
                axes[0].name(),
                "the same state on both axes",
                "two different states",
            ));
        }
        if let Some(count) = self.samples.filter(|count| !(1..=Self::MOST_POINTS as u64).contains(count)) {
            let allowed = format!("1 to {}", Self::MOST_POINTS);
            return Err(Error::invalid(&["samples"], count.to_string(), "too few or too many", allowed));
        }
        let points = self.x.count.checked_mul(self.y.count);
        if self.samples.is_none() && points.is_none_or(|points| points > Self::MOST_POINTS) {
            return Err(Error::invalid(
                &["x", "y"],
                format!("{} x {} points", self.x.count, self.y.count),
                "too many",
                format!("at most {} points in all", Self::MOST_POINTS),
            ));
        }
        Ok(axes)
    }
}

impl BasinAnalysis {
    /// What is worth knowing before it runs.
    pub fn warnings(&self) -> &[String] {
        &self.warnings
    }

    /// The journal of the run beside a result file, where its finished parts are kept.
    ///
    /// # Errors
    /// [`Error::Invalid`] and [`Error::Journal`].
    pub fn journal(&self, result: Option<&Path>, resume: bool) -> Result<Journal<Vec<NamedFate>>, Error> {
        Journal::open(result, &self.computation, resume)
    }

    /// Number of parts in which it runs.
    ///
    /// # Errors
    /// [`Error::Simulation`].
    pub fn parts(&self) -> Result<usize, Error> {
        Ok(self.map()?.tiles())
    }

    /// Follows every motion that the journal has not.
    ///
    /// # Errors
    /// [`Error::Simulation`], [`Error::Journal`], and [`Error::Interrupted`] where the control stops it.
    pub fn run(
        &self,
        control: &Control<'_>,
        journal: &Journal<Vec<NamedFate>>,
    ) -> Result<BasinResult, Error> {
        let map = self.map()?;
        let fates = follow(&map, control, journal)?;
        Ok(self.result(&map, fates))
    }

    fn result(&self, map: &BasinMap<'_>, fates: Vec<Fate>) -> BasinResult {
        let starts = match self.sample {
            None => Starts::grid(&self.axes, self.counts),
            Some((_, seed)) => Starts::sample(&self.axes, map.initial_states(), seed),
        };
        BasinResult::new(self.destinations.clone(), &self.axes, starts, fates)
    }

    fn map(&self) -> Result<BasinMap<'_>, Error> {
        Ok(match self.sample {
            None => BasinMap::grid(&self.destinations, &self.axes, self.counts)?,
            Some((count, seed)) => BasinMap::samples(&self.destinations, &self.axes, count, seed)?,
        })
    }
}

impl ByChunks for BasinAnalysis {
    type Result = BasinResult;

    fn computation(&self) -> &Value {
        &self.computation
    }

    fn points(&self) -> usize {
        self.sample.map_or(self.counts[0] * self.counts[1], |(count, _)| count)
    }

    /// Whole tiles, by the number of which the folder does not overflow.
    fn chunk(&self, shards: usize) -> Result<usize, Error> {
        let map = self.map()?;
        let most = map.tiles().div_ceil(MOST_CHUNKS);
        Ok(map.states_of_a_tile() * in_a_chunk(map.tiles(), most, shards))
    }

    fn compute(&self, chunks: &[Range<usize>], keep: Keep<'_>, control: &Control<'_>) -> Result<(), Error> {
        let map = self.map()?;
        let tile = map.states_of_a_tile();
        let tiles_of = |chunk: &Range<usize>| chunk.start / tile..chunk.end.div_ceil(tile);
        let wanted: Vec<usize> = chunks.iter().flat_map(tiles_of).collect();
        // The fates of the tiles of every chunk that are known.
        let known: Vec<Mutex<BTreeMap<usize, Vec<Fate>>>> = chunks.iter().map(|_| Mutex::default()).collect();
        let on_tile = |found: &Tile| {
            let of = |chunk: &Range<usize>| chunk.contains(&found.first);
            let Some(chunk) = chunks.iter().position(of) else { return };
            let mut tiles = known[chunk].lock().unwrap_or_else(PoisonError::into_inner);
            tiles.insert(found.index, found.fates.clone());
            if tiles.len() == tiles_of(&chunks[chunk]).len() {
                let fates: Vec<Fate> = tiles.values().flatten().copied().collect();
                keep(chunk, &self.columns_of(&map.initial_states()[chunks[chunk].clone()], &fates));
            }
        };
        Ok(map.run_tiles(&wanted, control, &on_tile).map(drop)?)
    }

    fn put_together(&self, columns: &Columns, _: &Control<'_>) -> Result<Option<BasinResult>, Error> {
        let Some(Entries::Texts(names)) = columns.named(FATE) else { return Ok(None) };
        let named =
            |name: &Option<String>| Fate::ALL.into_iter().find(|fate| Some(fate.name()) == name.as_deref());
        let fates: Option<Vec<Fate>> = names.iter().map(named).collect();
        let map = self.map()?;
        Ok(fates.map(|fates| self.result(&map, fates)))
    }
}

impl BasinAnalysis {
    /// The columns of a chunk, as in the result.
    fn columns_of(&self, states: &[[f64; 7]], fates: &[Fate]) -> Columns {
        let values = |axis: usize| states.iter().map(move |state| self.axes[axis].value_in(state));
        Columns::new()
            .numbers(self.axes[0].name(), values(0))
            .numbers(self.axes[1].name(), values(1))
            .texts(FATE, fates.iter().map(|fate| Some(fate.name().to_owned())))
    }
}

/// The fates of all starts, those of the finished tiles as they were kept.
fn follow(
    map: &BasinMap<'_>,
    control: &Control<'_>,
    journal: &Journal<Vec<NamedFate>>,
) -> Result<Vec<Fate>, Error> {
    let finished = journal.finished();
    for (&index, fates) in finished {
        if fates.len() != map.states_of(index).len() || fates.is_empty() {
            return Err(Error::invalid(
                &["resume"],
                format!("part {index} of the journal"),
                format!("{} fates", fates.len()),
                "as many as the part has; delete the journal",
            ));
        }
    }
    let named = |fates: &[Fate]| fates.iter().copied().map(NamedFate).collect::<Vec<_>>();
    let keep = |tile: &Tile| journal.keep(tile.index, &named(&tile.fates), control.stop());
    let computed = map.run(control, |index| finished.contains_key(&index), keep)?;
    let computed = computed.into_iter().map(|tile| (tile.index, named(&tile.fates)));
    let all = journal.checked(computed, map.tiles())?;
    Ok(all.into_iter().flatten().map(|fate| fate.0).collect())
}
