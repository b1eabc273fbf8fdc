//! Fates over grids and random samples of initial states, in tiles.

use super::{Destinations, Fate};
use crate::parallel;
use crate::rolling::STATE_NAMES;
use crate::simulation::SimulationError;
use crate::tyre::TYRE_STATE_NAMES;
use crate::wheel::Wheel;
use arclength::control::Control;

/// Initial states in one tile: those of a rolling wheel fill the registers, those of one that may slide are few, since each takes
/// long and a tile that was not finished is lost.
const ROLLING_TILE: usize = 64;
const SLIDING_TILE: usize = 4;
/// Index of the forward speed among the states.
const FORWARD: usize = 3;
/// So many of the initial states, from the first to the last, are followed beforehand to become acquainted with shimmy.
const SCOUTS: usize = 4;

/// A state that is varied between two values; the states that are not varied are those of the uniform motion.
#[derive(Clone, Debug, PartialEq)]
pub struct Axis {
    name: &'static str,
    /// Its index among `(u, q, psi, V1, V2, Omega, W or y_t)`.
    state: usize,
    from: f64,
    to: f64,
}

impl Axis {
    /// The state with this name, one of `(u, q, psi, V, Omega)`, from one value to another.
    ///
    /// # Errors
    /// An unknown name or a value that is not finite.
    pub fn new(name: &str, from: f64, to: f64) -> Result<Self, SimulationError> {
        Self::among(&STATE_NAMES, name, from, to)
    }

    /// The same, one of the [states that a wheel can take](Wheel::free_states).
    ///
    /// # Errors
    /// As [`new`](Self::new).
    pub fn of_wheel(wheel: &Wheel, name: &str, from: f64, to: f64) -> Result<Self, SimulationError> {
        Self::among(wheel.free_states(), name, from, to)
    }

    fn among(names: &[&'static str], name: &str, from: f64, to: f64) -> Result<Self, SimulationError> {
        let name = names.iter().copied().find(|&candidate| candidate == name).ok_or_else(|| {
            SimulationError::UnknownState { given: name.to_owned(), allowed: names.join(", ") }
        })?;
        // What is not among those of a tyre is the speed without one.
        let state = TYRE_STATE_NAMES.iter().position(|&candidate| candidate == name).unwrap_or(FORWARD);
        for value in [from, to] {
            if !value.is_finite() {
                return Err(SimulationError::out_of_range(name, value, "a finite range"));
            }
        }
        Ok(Self { name, state, from, to })
    }

    /// Name of the state.
    pub fn name(&self) -> &'static str {
        self.name
    }

    /// The value of the state in one of the [initial states](BasinMap::initial_states).
    pub fn value_in(&self, initial: &[f64; 7]) -> f64 {
        initial[self.state]
    }

    /// Equidistant values from one end to the other.
    pub fn values(&self, count: usize) -> Vec<f64> {
        (0..count).map(|index| self.value(fraction(index, count))).collect()
    }

    /// The value at a fraction of the way.
    pub fn value(&self, fraction: f64) -> f64 {
        self.from + fraction * (self.to - self.from)
    }
}

/// Fates of the states of one tile.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Tile {
    /// Index of the tile.
    pub index: usize,
    /// Index of its first state.
    pub first: usize,
    /// Fates of its states.
    pub fates: Vec<Fate>,
}

/// How many of a sample had a fate, with an interval for the share in the population.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Fraction {
    /// The fate.
    pub fate: Fate,
    /// How many had it.
    pub count: usize,
    /// Their share.
    pub share: f64,
    /// Wilson's interval of confidence 95 % for the share.
    pub interval: (f64, f64),
}

/// Initial states whose fates are to be found, divided into tiles.
///
/// A tile depends on nothing but its states and a few of the others, so tiles can be computed in any order, in several runs.
///
/// ```
/// use arclength::control::Control;
/// use kingpin::Wheel;
/// use kingpin::basin::{Axis, BasinMap, ClassificationSettings, ContactModel, Destinations, Fate};
///
/// let settings = ClassificationSettings::with_duration(20.0);
/// let destinations = Destinations::new(&Wheel::default(), ContactModel::Rolling, settings)?;
/// let axes = [Axis::new("psi", -0.2, 0.2)?, Axis::new("Omega", -5.0, 5.0)?];
/// let map = BasinMap::grid(&destinations, &axes, [6, 4])?;
/// let fates = map.run(&Control::none(), |_| false, |_tile| {})?;
/// assert_eq!(fates.len(), 1);
/// assert_eq!(fates[0].fates, vec![Fate::UniformMotion; 24]);
/// # Ok::<(), kingpin::simulation::SimulationError>(())
/// ```
#[derive(Clone, Debug)]
pub struct BasinMap<'a> {
    destinations: &'a Destinations,
    initial: Vec<[f64; 7]>,
    tile: usize,
}

impl<'a> BasinMap<'a> {
    fn new(destinations: &'a Destinations, initial: Vec<[f64; 7]>) -> Self {
        let tile = if destinations.follows_many_at_once() { ROLLING_TILE } else { SLIDING_TILE };
        Self { destinations, initial, tile }
    }

    /// A grid with `counts` points on each of two axes, ends included; the second axis is the outer one.
    ///
    /// # Errors
    /// Fewer than two points on an axis, or no uniform motion.
    pub fn grid(
        destinations: &'a Destinations,
        axes: &[Axis; 2],
        counts: [usize; 2],
    ) -> Result<Self, SimulationError> {
        for count in counts {
            if count < 2 {
                return Err(SimulationError::out_of_range("number of points", count as f64, "at least 2"));
            }
        }
        let origin = destinations.disturbed_state(&destinations.wheel().uniform_motion()?.state());
        let mut initial = Vec::with_capacity(counts[0] * counts[1]);
        for outer in 0..counts[1] {
            for inner in 0..counts[0] {
                let mut state = origin;
                state[axes[0].state] = axes[0].value(fraction(inner, counts[0]));
                state[axes[1].state] = axes[1].value(fraction(outer, counts[1]));
                initial.push(destinations.without_slip(state));
            }
        }
        Ok(Self::new(destinations, initial))
    }

    /// Independent states, uniformly distributed in the box of the axes. The same seed gives the same states.
    ///
    /// # Errors
    /// No uniform motion.
    pub fn samples(
        destinations: &'a Destinations,
        axes: &[Axis],
        count: usize,
        seed: u64,
    ) -> Result<Self, SimulationError> {
        let origin = destinations.disturbed_state(&destinations.wheel().uniform_motion()?.state());
        let initial = (0..count)
            .map(|index| {
                let mut state = origin;
                for (dimension, axis) in axes.iter().enumerate() {
                    let counter = (index * axes.len() + dimension) as u64;
                    state[axis.state] = axis.value(uniform_number(seed, counter));
                }
                destinations.without_slip(state)
            })
            .collect();
        Ok(Self::new(destinations, initial))
    }

    /// The states of one tile.
    pub fn states_of(&self, tile: usize) -> &[[f64; 7]] {
        let last = self.initial.len();
        &self.initial[(tile * self.tile).min(last)..((tile + 1) * self.tile).min(last)]
    }

    /// The initial states `(u, q, psi, V1, V2, Omega, W)`, with a tyre `(u, q, psi, V1, V2, Omega, y_t)`, in order.
    pub fn initial_states(&self) -> &[[f64; 7]] {
        &self.initial
    }

    /// Number of initial states of a tile; the last may have fewer.
    pub fn states_of_a_tile(&self) -> usize {
        self.tile
    }

    /// Number of tiles.
    pub fn tiles(&self) -> usize {
        self.initial.len().div_ceil(self.tile)
    }

    /// Computes the tiles that are not `finished` on all cores, until all are done or the control stops it. Every new tile is
    /// handed to `on_tile` as soon as it is known, for keeping; all new tiles are returned in order. Those that are missing
    /// after an interruption were not computed.
    ///
    /// # Errors
    /// A motion that cannot be followed.
    pub fn run(
        &self,
        control: &Control<'_>,
        finished: impl Fn(usize) -> bool + Sync,
        on_tile: impl Fn(&Tile) + Sync,
    ) -> Result<Vec<Tile>, SimulationError> {
        let wanted: Vec<usize> = (0..self.tiles()).filter(|&index| !finished(index)).collect();
        let known = self.tiles() - wanted.len();
        self.run_tiles(&wanted, &control.part(known as f64 / self.tiles() as f64..1.0), &on_tile)
    }

    /// Computes some of the tiles, whose progress is that of the control; otherwise as [`run`](Self::run).
    ///
    /// # Errors
    /// A motion that cannot be followed.
    pub fn run_tiles(
        &self,
        wanted: &[usize],
        control: &Control<'_>,
        on_tile: &(dyn Fn(&Tile) + Sync),
    ) -> Result<Vec<Tile>, SimulationError> {
        if wanted.is_empty() {
            return Ok(Vec::new());
        }
        // The same for every tile, whichever are wanted.
        let scout = |scout: usize| self.initial[scout * (self.initial.len() - 1) / (SCOUTS - 1)];
        let scouts: Vec<[f64; 7]> = (0..SCOUTS).map(scout).collect();
        let destinations = match self.destinations.clone().acquainted(&scouts, &control.quiet()) {
            Err(SimulationError::Interrupted(_)) => return Ok(Vec::new()),
            destinations => destinations?,
        };
        let progress = control.count(wanted.len());
        let compute = |&index: &usize| {
            if control.is_stopped() {
                return Ok(None);
            }
            let first = index * self.tile;
            let tile = match destinations.of_all(self.states_of(index), &control.quiet()) {
                Ok(fates) => Tile { index, first, fates },
                Err(SimulationError::Interrupted(_)) => return Ok(None),
                Err(error) => return Err(error),
            };
            on_tile(&tile);
            progress.advance(1);
            Ok(Some(tile))
        };
        parallel::try_map(wanted, compute).map(|tiles| tiles.into_iter().flatten().collect())
    }
}

/// The share of every fate.
impl Fraction {
    /// Shares of all fates in the tiles of a random sample.
    pub fn of(tiles: &[Tile]) -> Vec<Fraction> {
        let total: usize = tiles.iter().map(|tile| tile.fates.len()).sum();
        Fate::ALL
            .into_iter()
            .map(|fate| {
                let count =
                    tiles.iter().flat_map(|tile| &tile.fates).filter(|&&candidate| candidate == fate).count();
                Fraction {
                    fate,
                    count,
                    share: if total == 0 { 0.0 } else { count as f64 / total as f64 },
                    interval: wilson_interval(count, total),
                }
            })
            .collect()
    }
}

/// Wilson's score interval of confidence 95 % for a share of which `count` in `total` was seen (Wilson, Journal of the
/// American Statistical Association 22, 1927).
pub fn wilson_interval(count: usize, total: usize) -> (f64, f64) {
    /// Quantile of the normal distribution at 97.5 %.
    const QUANTILE: f64 = 1.959_963_984_540_054;
    if total == 0 {
        return (0.0, 1.0);
    }
    let (n, square) = (total as f64, QUANTILE * QUANTILE);
    let share = count as f64 / n;
    let centre = (share + square / (2.0 * n)) / (1.0 + square / n);
    let half = QUANTILE / (1.0 + square / n) * (share * (1.0 - share) / n + square / (4.0 * n * n)).sqrt();
    // Where none or all were seen that end is exact; rounding must not move it.
    let low = if count == 0 { 0.0 } else { (centre - half).max(0.0) };
    let high = if count == total { 1.0 } else { (centre + half).min(1.0) };
    (low, high)
}

fn fraction(index: usize, count: usize) -> f64 {
    index as f64 / (count - 1).max(1) as f64
}

/// A number in [0, 1) from a seed and a counter: SplitMix64 (Steele, Lea and Flood, OOPSLA 2014).
fn uniform_number(seed: u64, counter: u64) -> f64 {
    let mut bits = seed.wrapping_add(counter.wrapping_add(1).wrapping_mul(0x9e37_79b9_7f4a_7c15));
    bits = (bits ^ (bits >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    bits = (bits ^ (bits >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    ((bits ^ (bits >> 31)) >> 11) as f64 / (1u64 << 53) as f64
}
