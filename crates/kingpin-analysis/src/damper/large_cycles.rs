//! Large cycles in spite of a damper: where in speed and damping they end.
//!
//! Cycles are followed from the Hopf points of weaker dampers, beyond the range of speeds too; from those in the range on along the
//! damping, until they fold; and the folds in speed and damping. The largest damping on all of these is where the last cycle that is
//! known dies: in the range, where an isola shrinks to a point, or at its end (Takács, Stépán and Hogan, SIAM Journal on Applied
//! Dynamical Systems, 2009). A closed branch that no Hopf point and no fold leads to is not found.

use crate::cycles::from_hopf_points;
use crate::error::{Error, unless_stopped};
use crate::parabola::vertex;
use arclength::branch::SpecialKind;
use arclength::continuation::Settings;
use arclength::cycle::Orbit;
use arclength_analysis::Control;
use kingpin::branches::{Along, CurveOptions, CycleOptions};
use kingpin::{CycleForces, Key, KingpinError, Wheel};
use std::ops::ControlFlow;

/// Dampers from whose Hopf points cycles are followed, as parts of the one that small motions take.
const WEAKER: [f64; 2] = [0.5, 0.9];
/// Slowest and fastest speed along which they are followed, as parts of the largest of the range.
const SLOWEST: f64 = 1e-2;
const FASTEST: f64 = 4.0;
/// Speeds, as parts of the largest, from whose cycles the damping is raised.
const SPEEDS: [f64; 4] = [0.25, 0.5, 0.75, 1.0];
/// The largest damper that is tried, as a multiple of the one that small motions take, and of one that would take the lateral motion
/// a period to die out.
const LARGEST: f64 = 64.0;
const LARGEST_NATURAL: f64 = 16.0;
/// Folds whose speed, damping and period agree to this part are one.
const SAME: f64 = 1e-2;
/// Steps after which a branch or a curve is given up that gets nowhere.
const MOST_STEPS: usize = 200;
/// Times that the speed of the largest damping is narrowed down, and by how much each time.
const REFINEMENTS: usize = 4;
const NARROWER: f64 = 0.1;

/// A cycle at the largest damping at which one was found.
#[derive(Clone, Debug)]
pub(super) struct LastCycle {
    /// Damping in the unit of the key.
    pub damping: f64,
    /// Speed in m/s.
    pub speed: f64,
    pub period: f64,
    /// Smallest and largest caster angle in rad.
    pub angles: [f64; 2],
    pub orbit: Orbit,
}

/// What was found.
#[derive(Debug, Default)]
pub(super) struct LargeCycles {
    /// The last of the cycles in the range of speeds.
    pub last: Option<LastCycle>,
    /// Whether there were cycles with the largest damper that was tried.
    pub at_every_damper: bool,
    /// The largest damper that was tried.
    pub largest: f64,
    /// Numbers of branches of cycles and of curves of folds that were followed.
    pub branches: usize,
    pub curves: usize,
    /// Why some were not followed.
    pub problems: Vec<String>,
}

impl LargeCycles {
    /// Seeks them; `wheel` has no damper, and `needed` is the damper that small motions take.
    ///
    /// # Errors
    /// [`Error::Stopped`].
    pub(super) fn seek(
        wheel: &Wheel,
        key: Key,
        [needed, up_to]: [f64; 2],
        control: &Control<'_>,
    ) -> Result<Self, Error> {
        let largest = (LARGEST * needed).max(LARGEST_NATURAL * natural_damper(wheel, key));
        let largest = largest.min(key.allowed().highest);
        let plane = [Along::new(Key::V, SLOWEST * up_to, up_to)?, Along::new(key, 0.0, largest)?];
        let mut search =
            Search { plane, control, found: Self { largest, ..Self::default() }, folds: Vec::new() };
        let weaker: Vec<f64> =
            if needed > 0.0 { WEAKER.iter().map(|part| part * needed).collect() } else { vec![0.0] };
        for damping in weaker {
            search.along_speed(&wheel.with(key, damping)?, up_to)?;
            unless_stopped(control)?;
        }
        search.along_folds(wheel)?;
        unless_stopped(control)?;
        Ok(search.found)
    }
}

impl LastCycle {
    /// The forces along it; nothing where they are not known.
    pub(super) fn forces(&self, wheel: &Wheel, key: Key) -> Result<CycleForces, KingpinError> {
        wheel.with(Key::V, self.speed)?.with(key, self.damping)?.cycle_forces(&self.orbit)
    }
}

/// A damper that would take the lateral motion about a period to die out.
fn natural_damper(wheel: &Wheel, key: Key) -> f64 {
    let rotational = wheel.natural_rotational_damping();
    if key == Key::CPsi { rotational } else { rotational / wheel.get(Key::L).powi(2) }
}

struct Search<'a> {
    /// Speeds of the range and dampers.
    plane: [Along; 2],
    control: &'a Control<'a>,
    found: LargeCycles,
    folds: Vec<LastCycle>,
}

impl Search<'_> {
    fn key(&self) -> Key {
        self.plane[1].key()
    }

    fn observer(&self) -> ControlFlow<()> {
        if self.control.is_stopped() { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
    }

    /// What was followed, where it could be.
    fn followed<T>(&mut self, result: Result<T, Error>) -> Result<Option<T>, Error> {
        match result {
            Ok(followed) => Ok(Some(followed)),
            Err(Error::Stopped) => Err(Error::Stopped),
            Err(error) => {
                self.found.problems.push(error.to_string());
                Ok(None)
            }
        }
    }

    fn take(&mut self, cycle: LastCycle) {
        if self.found.last.as_ref().is_none_or(|last| cycle.damping > last.damping) {
            self.found.last = Some(cycle);
        }
    }

    /// Follows the cycles that are born with a damper, along the speed, and some of them along the damping.
    fn along_speed(&mut self, damped: &Wheel, up_to: f64) -> Result<(), Error> {
        let speeds = Along::new(Key::V, SLOWEST * up_to, FASTEST * up_to)?;
        let damping = damped.get(self.key());
        let search = damped.hopf_points(speeds, self.control).map_err(Error::from);
        let Some(search) = self.followed(search)? else { return Ok(()) };
        let at = SPEEDS.map(|part| part * up_to).to_vec();
        let options = CycleOptions { at, settings: settings(), ..CycleOptions::default() };
        for index in 0..search.points.len() {
            let branches =
                from_hopf_points(&search.points, Some(index), speeds, &options, |_| self.observer());
            let Some(branches) = self.followed(branches)? else { continue };
            self.found.branches += branches.len();
            for point in branches.iter().flat_map(|branch| &branch.cycles.points) {
                let kind = point.label.map(|label| label.kind);
                if point.value > up_to {
                    continue;
                }
                let angles = caster_angles(damped, &point.min, &point.max);
                let (speed, period) = (point.value, point.period);
                let cycle = LastCycle { damping, speed, period, angles, orbit: point.orbit.clone() };
                match kind {
                    Some(SpecialKind::FoldOfCycles) => self.folds.push(cycle),
                    Some(SpecialKind::Requested) => self.along_damping(damped, &cycle)?,
                    _ => {}
                }
            }
        }
        Ok(())
    }

    /// Raises the damping of a cycle until it folds.
    fn along_damping(&mut self, wheel: &Wheel, cycle: &LastCycle) -> Result<(), Error> {
        let wheel = wheel.with(Key::V, cycle.speed)?;
        let along = self.plane[1];
        let options = CycleOptions { settings: settings(), ..CycleOptions::default() };
        let branch =
            wheel.cycles_through(&cycle.orbit, along, &options, |_| self.observer()).map_err(Error::from);
        let Some(branch) = self.followed(branch)? else { return Ok(()) };
        self.found.branches += 1;
        for point in branch.points {
            let angles = caster_angles(&wheel, &point.min, &point.max);
            let reached = LastCycle {
                damping: point.value,
                speed: cycle.speed,
                period: point.period,
                angles,
                orbit: point.orbit,
            };
            self.found.at_every_damper |= reached.damping >= along.ends().1;
            if point.label.is_some_and(|label| label.kind == SpecialKind::FoldOfCycles) {
                self.folds.push(reached.clone());
            }
            self.take(reached);
        }
        Ok(())
    }

    /// Follows the folds in speed and damping, each curve once.
    fn along_folds(&mut self, wheel: &Wheel) -> Result<(), Error> {
        let mut known: Vec<Vec<LastCycle>> = Vec::new();
        for fold in std::mem::take(&mut self.folds) {
            if known.iter().any(|curve| lies_on(&fold, curve)) {
                continue;
            }
            let Some(curve) = self.folds_through(wheel, &fold, self.plane[0], &[])? else { continue };
            self.found.curves += 1;
            if let Some(largest) = curve.iter().max_by(|a, b| a.damping.total_cmp(&b.damping)).cloned() {
                self.take(largest);
            }
            if let Some(extremum) = self.narrowed(wheel, &curve)? {
                self.take(extremum);
            }
            known.push(curve);
        }
        Ok(())
    }

    fn folds_through(
        &mut self,
        wheel: &Wheel,
        fold: &LastCycle,
        speeds: Along,
        at: &[f64],
    ) -> Result<Option<Vec<LastCycle>>, Error> {
        let key = self.key();
        let wheel = wheel.with(Key::V, fold.speed)?.with(key, fold.damping)?;
        let plane = [speeds, self.plane[1]];
        let options = CurveOptions { at: at.to_vec(), settings: Some(settings()), ..CurveOptions::default() };
        let kind = SpecialKind::FoldOfCycles;
        let curve = wheel.cycle_curve(kind, &fold.orbit, plane, &options, |_| self.observer());
        let Some(curve) = self.followed(curve.map_err(Error::from))? else { return Ok(None) };
        let cycle = |point: arclength::locus::CycleLocusPoint| LastCycle {
            damping: point.values[1],
            speed: point.values[0],
            period: point.period,
            angles: caster_angles(&wheel, &point.min, &point.max),
            orbit: point.orbit,
        };
        Ok(Some(curve.points.into_iter().map(cycle).collect()))
    }

    /// The fold with the largest damping inside a curve: vertices of parabolas through three folds, at closer and closer speeds.
    fn narrowed(&mut self, wheel: &Wheel, curve: &[LastCycle]) -> Result<Option<LastCycle>, Error> {
        let inside = 1..curve.len().saturating_sub(1);
        let Some(highest) = inside.max_by(|&a, &b| curve[a].damping.total_cmp(&curve[b].damping)) else {
            return Ok(None);
        };
        let around = &curve[highest - 1..=highest + 1];
        if around[0].damping.max(around[2].damping) >= around[1].damping {
            return Ok(None);
        }
        let mut triple = [0, 1, 2].map(|index| around[index].clone());
        for _ in 0..REFINEMENTS {
            let [left, middle, right] = &triple;
            let Some(vertex) = vertex([left, middle, right].map(|fold| [fold.speed, fold.damping])) else {
                break;
            };
            let (low, high) = self.plane[0].ends();
            let width = NARROWER * (right.speed - left.speed).abs();
            let wanted = [vertex - width, vertex, vertex + width].map(|speed| speed.clamp(low, high));
            let reach = wanted.iter().chain([&middle.speed]);
            let (from, to) =
                reach.fold((f64::INFINITY, 0.0_f64), |(from, to), &speed| (from.min(speed), to.max(speed)));
            let window = Along::new(Key::V, from - 0.1 * width, to + 0.1 * width)?;
            let middle = middle.clone();
            let Some(folds) = self.folds_through(wheel, &middle, window, &wanted)? else { break };
            let at = |speed: f64| folds.iter().find(|fold| fold.speed == speed).cloned();
            let [Some(left), Some(middle), Some(right)] = wanted.map(at) else { break };
            triple = [left, middle, right];
        }
        Ok(Some(triple[1].clone()))
    }
}

fn settings() -> Settings {
    Settings { most_steps: MOST_STEPS, ..Settings::default() }
}

/// Whether a fold is one of a curve, or between two of them.
fn lies_on(fold: &LastCycle, curve: &[LastCycle]) -> bool {
    curve.windows(2).any(|pair| {
        let part = (fold.speed - pair[0].speed) / (pair[1].speed - pair[0].speed);
        let between =
            |value: fn(&LastCycle) -> f64| value(&pair[0]) + part * (value(&pair[1]) - value(&pair[0]));
        let near = |value: fn(&LastCycle) -> f64| (between(value) / value(fold) - 1.0).abs() < SAME;
        (0.0..=1.0).contains(&part) && near(|fold| fold.damping) && near(|fold| fold.period)
    })
}

/// Smallest and largest caster angle, of the extremes of the free states or of all of them.
fn caster_angles(wheel: &Wheel, min: &[f64], max: &[f64]) -> [f64; 2] {
    let index = wheel.states().iter().position(|name| *name == "psi").unwrap_or_default();
    [min, max].map(|values| values.get(index).copied().unwrap_or(f64::NAN))
}
