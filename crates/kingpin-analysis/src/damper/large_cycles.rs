//! Large cycles in spite of a damper: where in speed and damping they end.
//!
//! Cycles are followed from the Hopf points of weaker dampers, beyond the range of speeds too; from those in the range on along the
//! damping, until they fold; and the folds in speed and damping. The largest damping on all of these is where the last cycle that is
//! known dies: in the range, where an isola shrinks to a point, or at its end (Takács, Stépán and Hogan, SIAM Journal on Applied
//! Dynamical Systems, 2009). A closed branch that no Hopf point and no fold leads to is not found.

use crate::cycles::{Followed, from_hopf_points};
use crate::error::{Error, unless_stopped};
use crate::last_fold::LastFold;
use arclength::branch::SpecialKind;
use arclength::continuation::Settings;
use arclength::cycle::Orbit;
use arclength::locus::CycleLocusPoint;
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
/// Times that the last fold is followed along circles and loads and along the speed again, and by which part it has to rise to go on.
const ROUNDS: usize = 4;
const HIGHER: f64 = 1e-6;
/// Part by which the last stretch to the extremum is longer than it has to be.
const MARGIN: f64 = 1e-3;

/// A cycle at the largest damping at which one was found.
#[derive(Clone, Debug)]
pub(super) struct LastCycle {
    /// Damping in the unit of the key.
    pub damping: f64,
    /// Speed in m/s.
    pub speed: f64,
    /// The wheel that it belongs to, with that speed and damping.
    pub wheel: Wheel,
    pub period: f64,
    /// Smallest and largest caster angle in rad.
    pub angles: [f64; 2],
    pub orbit: Orbit,
    /// Whether it is a fold: with more damping there is none beside it.
    pub is_fold: bool,
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
    /// Seeks them in a wheel, which has no damper; `needed` is the damper that its small motions take.
    ///
    /// # Errors
    /// [`Error::Stopped`].
    pub(super) fn seek(
        wheel: &Wheel,
        key: Key,
        [needed, up_to]: [f64; 2],
        control: &Control<'_>,
    ) -> Result<Self, Error> {
        let mut search = Search::new(wheel, key, [needed, up_to], control)?;
        let weaker: Vec<f64> =
            if needed > 0.0 { WEAKER.iter().map(|part| part * needed).collect() } else { vec![0.0] };
        for damping in weaker {
            search.along_speed(&wheel.with(key, damping)?, up_to)?;
            unless_stopped(control)?;
        }
        search.along_folds()?;
        unless_stopped(control)?;
        Ok(search.found)
    }

    /// Follows the last fold along other parameters, and along the speed again, as long as the damping rises.
    ///
    /// # Errors
    /// [`Error::Stopped`].
    pub(super) fn followed_along(
        self,
        variables: &[Along],
        key: Key,
        up_to: f64,
        control: &Control<'_>,
    ) -> Result<Self, Error> {
        let Some(last) = self.last.clone().filter(|last| last.is_fold) else { return Ok(self) };
        let mut search = Search::new(&last.wheel, key, [last.damping, up_to], control)?;
        search.found = Self { largest: search.found.largest.max(self.largest), ..self };
        let speeds = search.plane[0];
        for _ in 0..ROUNDS {
            let before = search.last_damping();
            for along in variables.iter().chain([&speeds]) {
                let Some(last) = search.found.last.clone() else { break };
                search.along_curve(&last, *along)?;
                unless_stopped(control)?;
            }
            if search.last_damping() < before * (1.0 + HIGHER) {
                break;
            }
        }
        Ok(search.found)
    }

    /// Both, with the last of their cycles.
    pub(super) fn and(self, other: Self) -> Self {
        let damping = |found: &Self| found.last.as_ref().map_or(0.0, |last| last.damping);
        let is_later = self.last.is_none() || damping(&other) > damping(&self);
        let last = if is_later { other.last } else { self.last };
        Self {
            last,
            at_every_damper: self.at_every_damper || other.at_every_damper,
            largest: self.largest.max(other.largest),
            branches: self.branches + other.branches,
            curves: self.curves + other.curves,
            problems: [self.problems, other.problems].concat(),
        }
    }
}

impl LastCycle {
    /// The forces along it; nothing where they are not known.
    pub(super) fn forces(&self) -> Result<CycleForces, KingpinError> {
        self.wheel.cycle_forces(&self.orbit)
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

impl<'a> Search<'a> {
    fn new(
        wheel: &Wheel,
        key: Key,
        [needed, up_to]: [f64; 2],
        control: &'a Control<'a>,
    ) -> Result<Self, Error> {
        let largest = (LARGEST * needed).max(LARGEST_NATURAL * natural_damper(wheel, key));
        let largest = largest.min(key.allowed().highest);
        let plane = [Along::new(Key::V, SLOWEST * up_to, up_to)?, Along::new(key, 0.0, largest)?];
        let found = LargeCycles { largest, ..LargeCycles::default() };
        Ok(Self { plane, control, found, folds: Vec::new() })
    }

    fn last_damping(&self) -> f64 {
        self.found.last.as_ref().map_or(0.0, |last| last.damping)
    }

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
        let options = CycleOptions::default().at(&at).settings(settings());
        for index in 0..search.points.len() {
            let branches =
                from_hopf_points(&search.points, Some(index), speeds, &options, |_| self.observer());
            let Some(Followed { branches, .. }) = self.followed(branches)? else { continue };
            self.found.branches += branches.len();
            for point in branches.iter().flat_map(|branch| &branch.cycles.points) {
                let kind = point.label.map(|label| label.kind);
                if point.value > up_to {
                    continue;
                }
                let angles = caster_angles(damped, &point.min, &point.max);
                let (speed, period) = (point.value, point.period);
                let is_fold = kind == Some(SpecialKind::FoldOfCycles);
                let wheel = damped.with(Key::V, speed)?;
                let orbit = point.orbit.clone();
                let cycle = LastCycle { damping, speed, wheel, period, angles, orbit, is_fold };
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
        let options = CycleOptions::default().settings(settings());
        let branch =
            wheel.cycles_through(&cycle.orbit, along, &options, |_| self.observer()).map_err(Error::from);
        let Some(branch) = self.followed(branch)? else { return Ok(()) };
        self.found.branches += 1;
        for point in branch.points {
            let angles = caster_angles(&wheel, &point.min, &point.max);
            let is_fold = point.label.is_some_and(|label| label.kind == SpecialKind::FoldOfCycles);
            let reached = LastCycle {
                damping: point.value,
                speed: cycle.speed,
                wheel: wheel.with(along.key(), point.value)?,
                period: point.period,
                angles,
                orbit: point.orbit,
                is_fold,
            };
            self.found.at_every_damper |= reached.damping >= along.ends().1;
            if is_fold {
                self.folds.push(reached.clone());
            }
            self.take(reached);
        }
        Ok(())
    }

    /// Follows the folds in speed and damping, each curve once.
    fn along_folds(&mut self) -> Result<(), Error> {
        let mut known: Vec<Vec<LastCycle>> = Vec::new();
        for fold in std::mem::take(&mut self.folds) {
            if known.iter().any(|curve| lies_on(&fold, curve)) {
                continue;
            }
            if let Some(curve) = self.along_curve(&fold, self.plane[0])? {
                known.push(curve);
            }
        }
        Ok(())
    }

    /// Follows a fold along a parameter and the damping, and takes the one with the largest damping.
    fn along_curve(&mut self, fold: &LastCycle, along: Along) -> Result<Option<Vec<LastCycle>>, Error> {
        let wheel = fold.wheel;
        let Some(points) = self.folds_through(&wheel, &fold.orbit, along, &[])? else { return Ok(None) };
        self.found.curves += 1;
        let curve =
            points.iter().map(|point| self.cycle(&wheel, along, point)).collect::<Result<Vec<_>, _>>()?;
        if let Some(largest) = curve.iter().max_by(|a, b| a.damping.total_cmp(&b.damping)).cloned() {
            self.take(largest);
        }
        let extremum = LastFold::inside(
            &points,
            |_| f64::NAN,
            |start, [from, to], wanted| {
                let allowed = along.key().allowed();
                let window = Along::new(along.key(), from.max(allowed.lowest), to.min(allowed.highest))?;
                let wheel = wheel.with(along.key(), start.values[0])?.with(self.key(), start.values[1])?;
                Ok::<_, Error>(self.folds_through(&wheel, &start.orbit, window, wanted)?.unwrap_or_default())
            },
        )?;
        let (low, high) = along.ends();
        if let Some(LastFold { value, .. }) = extremum.filter(|fold| (low..=high).contains(&fold.value)) {
            let nearest = points
                .iter()
                .min_by(|a, b| (a.values[0] - value).abs().total_cmp(&(b.values[0] - value).abs()));
            if let Some(start) = nearest {
                let wheel = wheel.with(along.key(), start.values[0])?.with(self.key(), start.values[1])?;
                let [from, to] = [start.values[0].min(value), start.values[0].max(value)];
                let margin = 0.1 * (to - from) + MARGIN * value.abs();
                let (low, high) = (along.key().allowed().lowest, along.key().allowed().highest);
                let window = Along::new(along.key(), (from - margin).max(low), (to + margin).min(high))?;
                let points = self.folds_through(&wheel, &start.orbit, window, &[value])?.unwrap_or_default();
                for point in points.iter().filter(|point| point.values[0] == value) {
                    let last = self.cycle(&wheel, along, point)?;
                    self.take(last);
                }
            }
        }
        Ok(Some(curve))
    }

    /// The folds through one of a wheel along a parameter and the damping.
    fn folds_through(
        &mut self,
        wheel: &Wheel,
        orbit: &Orbit,
        along: Along,
        at: &[f64],
    ) -> Result<Option<Vec<CycleLocusPoint>>, Error> {
        let plane = [along, self.plane[1]];
        let options = CurveOptions::default().at(at).settings(settings());
        let kind = SpecialKind::FoldOfCycles;
        let curve = wheel.cycle_curve(kind, orbit, plane, &options, |_| self.observer());
        Ok(self.followed(curve.map_err(Error::from))?.map(|curve| curve.points))
    }

    /// A fold of a curve.
    fn cycle(&self, wheel: &Wheel, along: Along, point: &CycleLocusPoint) -> Result<LastCycle, Error> {
        let [value, damping] = point.values;
        let wheel = wheel.with(along.key(), value)?.with(self.key(), damping)?;
        Ok(LastCycle {
            damping,
            speed: wheel.get(Key::V),
            wheel,
            period: point.period,
            angles: caster_angles(&wheel, &point.min, &point.max),
            orbit: point.orbit.clone(),
            is_fold: true,
        })
    }
}

fn settings() -> Settings {
    Settings::default().most_steps(MOST_STEPS)
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
