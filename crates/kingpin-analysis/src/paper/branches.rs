//! The branches of limit cycles that figures 5 and 6 show: each from its Hopf point along the speed, and the one of
//! straight running, which has no Hopf point in the speed, by following a cycle in the turning radius to infinity.

use super::rolling_limit::HEAVIEST;
use super::tasks::Tasks;
use super::wheel::{RADII, paper_wheel};
use crate::error::Error;
use arclength::continuation::{Settings, Stop};
use arclength::cycle::CyclePoint;
use arclength_analysis::Control;
use kingpin::branches::{Along, CycleOptions, HopfPoint, WheelCycles};
use kingpin::parallel;
use kingpin::{CycleForces, Key, Wheel};
use std::ops::ControlFlow;

/// Caster lengths of figure 5 in m, and its turning radius.
pub(super) const FIGURE_5_LENGTHS: [f64; 5] = [0.05, 0.08, 0.11, 0.14, 0.17];
pub(super) const FIGURE_5_RADIUS: f64 = 1.0;
/// Caster length of figure 6 in m; its radii are [`RADII`].
pub(super) const FIGURE_6_LENGTH: f64 = 0.08;
/// Branches that are computed side by side; that of straight running belongs to the one it starts from.
pub(super) const TASKS: usize = FIGURE_5_LENGTHS.len() + RADII.len() - 2;
/// Smallest speed of all branches in m/s.
pub(super) const SLOWEST: f64 = 0.2;
/// Largest speed of figure 6 in m/s: here the branch of straight running ends.
pub(super) const FASTEST: f64 = 18.0;
/// Speeds in m/s at which cycles are computed exactly, to be compared with each other.
pub(super) const COMPARED_SPEEDS: [f64; 5] = [0.5, 1.0, 2.0, 4.0, 8.0];
/// A Hopf point is looked for between these parts of the closed form of the critical speed.
const SEARCH: (f64, f64) = (0.9, 1.1);
/// Part of its range by which the speed changes in one step at most, and the error of the predictor that the step control
/// aims at: small enough to draw smooth curves through the points.
const LARGEST_CHANGE: f64 = 0.02;
const PREDICTOR_ERROR: f64 = 0.005;
/// A cycle that was located at the rolling limit needs more than there is by less than this part.
const AT_THE_LIMIT: f64 = 1e-6;
/// Radius and speed, in m and m/s, of the cycle that is followed to straight running.
const TOWARDS_STRAIGHT: (f64, f64) = (5.0, 4.0);

/// A branch of limit cycles of the paper's wheel along the speed.
pub(super) struct Branch {
    pub caster_length: f64,
    pub radius: f64,
    /// The Hopf point, which straight running does not have.
    pub hopf: Option<HopfPoint>,
    /// The cycles by descending speed.
    pub cycles: Vec<CyclePoint>,
    /// The forces along them under the largest load of figure 4, on which the cycles themselves do not depend.
    pub forces: Vec<CycleForces>,
    /// Which points of the branch, its Hopf point among them, need more friction than there is under that load.
    pub beyond_rolling: Vec<bool>,
}

/// Everything that figures 5 and 6 are drawn from.
pub(super) struct Branches {
    /// In the order of [`FIGURE_5_LENGTHS`], then those of figure 6 that are not among them.
    all: Vec<Branch>,
}

impl Branches {
    pub(super) fn compute(tasks: &Tasks<'_>) -> Result<Self, Error> {
        let lengths = FIGURE_5_LENGTHS.map(|length| (length, FIGURE_5_RADIUS));
        // The longest task comes first, so that no core waits for it in the end.
        let mut places: Vec<(f64, f64)> = RADII
            .into_iter()
            .rev()
            .filter(|radius| radius.is_finite() && *radius != FIGURE_5_RADIUS)
            .map(|radius| (FIGURE_6_LENGTH, radius))
            .collect();
        places.extend(lengths);
        let found = parallel::try_map(&places, |&(length, radius)| {
            let mut branches = vec![from_hopf_point(length, radius)?];
            if (length, radius) == (FIGURE_6_LENGTH, TOWARDS_STRAIGHT.0) {
                branches.push(straight(&branches[0])?);
            }
            tasks.step()?;
            Ok::<_, Error>(branches)
        })?;
        Ok(Self { all: found.into_iter().flatten().collect() })
    }

    /// The branches of figure 5, in the order of the caster length.
    pub(super) fn of_figure_5(&self) -> impl Iterator<Item = &Branch> {
        FIGURE_5_LENGTHS.into_iter().filter_map(|length| self.branch(length, FIGURE_5_RADIUS))
    }

    /// The branches of figure 6, in the order of the radius.
    pub(super) fn of_figure_6(&self) -> impl Iterator<Item = &Branch> {
        RADII.into_iter().filter_map(|radius| self.branch(FIGURE_6_LENGTH, radius))
    }

    /// Every branch once.
    pub(super) fn iter(&self) -> impl Iterator<Item = &Branch> {
        self.all.iter()
    }

    /// The branch at a caster length and a radius.
    pub(super) fn branch(&self, caster_length: f64, radius: f64) -> Option<&Branch> {
        self.all.iter().find(|branch| branch.caster_length == caster_length && branch.radius == radius)
    }
}

impl Branch {
    fn new(
        [caster_length, radius]: [f64; 2],
        hopf: Option<HopfPoint>,
        cycles: Vec<CyclePoint>,
    ) -> Result<Self, Error> {
        let loaded = |speed: f64| paper_wheel(speed, caster_length, radius)?.with(Key::FAz, HEAVIEST);
        let mut beyond_rolling = Vec::with_capacity(cycles.len() + 1);
        if let Some(hopf) = &hopf {
            beyond_rolling.push(!loaded(hopf.value)?.uniform_motion()?.rolls());
        }
        let mut forces = Vec::with_capacity(cycles.len());
        for cycle in &cycles {
            let found = loaded(cycle.value)?.cycle_forces(&cycle.orbit)?;
            beyond_rolling.push(found.friction_ratio_max().is_some_and(|ratio| ratio > 1.0 + AT_THE_LIMIT));
            forces.push(found);
        }
        Ok(Self { caster_length, radius, hopf, cycles, forces, beyond_rolling })
    }

    /// The wheel at a speed.
    pub(super) fn wheel(&self, speed: f64) -> Result<Wheel, Error> {
        Ok(paper_wheel(speed, self.caster_length, self.radius)?)
    }

    /// Caster angle of the uniform motion at a speed.
    pub(super) fn uniform_angle(&self, speed: f64) -> Result<f64, Error> {
        Ok(self.wheel(speed)?.uniform_motion()?.psi())
    }

    /// The cycles and the forces along them.
    pub(super) fn cycles_with_forces(&self) -> impl Iterator<Item = (&CyclePoint, &CycleForces)> {
        self.cycles.iter().zip(&self.forces)
    }

    /// The cycle that was asked for at a speed, and the forces along it.
    pub(super) fn cycle_at(&self, speed: f64) -> Option<(&CyclePoint, &CycleForces)> {
        self.cycles_with_forces().find(|(cycle, _)| cycle.value == speed)
    }

    /// Speed, largest and smallest caster angle along the branch, from its Hopf point on.
    pub(super) fn extremes(&self) -> impl Iterator<Item = (f64, f64, f64)> {
        let start = self.hopf.iter().map(|hopf| (hopf.value, hopf.state[2], hopf.state[2]));
        start.chain(self.cycles.iter().map(|cycle| (cycle.value, cycle.max[2], cycle.min[2])))
    }
}

/// The Hopf point of the paper's wheel at a caster length and a radius, found along the speed.
pub(super) fn hopf_point(caster_length: f64, radius: f64) -> Result<HopfPoint, Error> {
    let not_found = || Error::not_found("Hopf point", &format!("l = {caster_length} m, r = {radius} m"));
    let anywhere = paper_wheel(1.0, caster_length, radius)?;
    let critical = radius * anywhere.critical_yaw_rate().ok_or_else(not_found)?;
    let along = Along::new(Key::V, SEARCH.0 * critical, SEARCH.1 * critical)?;
    // The load changes no motion; with it cycles are located at the rolling limit under it.
    let wheel = paper_wheel(SEARCH.0 * critical, caster_length, radius)?.with(Key::FAz, HEAVIEST)?;
    wheel.hopf_points(along, &Control::none())?.points.into_iter().next().ok_or_else(not_found)
}

/// How cycles are followed along an interval of the speed.
fn options(along: Along) -> CycleOptions {
    let speeds: Vec<f64> = COMPARED_SPEEDS.into_iter().filter(|speed| along.contains(*speed)).collect();
    CycleOptions::default().at(&speeds).settings(
        Settings::default().largest_parameter_change(LARGEST_CHANGE).predictor_error(PREDICTOR_ERROR),
    )
}

fn from_hopf_point(caster_length: f64, radius: f64) -> Result<Branch, Error> {
    let hopf = hopf_point(caster_length, radius)?;
    let along = Along::new(Key::V, SLOWEST, SEARCH.1 * hopf.value)?;
    let found = hopf.cycles(along, &options(along), |_| ControlFlow::Continue(()))?;
    Branch::new([caster_length, radius], Some(hopf), complete(found)?)
}

/// The cycles of a branch that was followed to the ends of its interval, by descending speed.
fn complete(found: WheelCycles) -> Result<Vec<CyclePoint>, Error> {
    let WheelCycles { wheel, mut points, stops, .. } = found;
    for stop in stops.into_iter().flatten() {
        if !matches!(stop, Stop::RangeEnd { .. }) {
            let [length, radius] = [Key::L, Key::TurningRadius].map(|key| wheel.get(key));
            let place = format!("l = {length} m, r = {radius} m");
            return Err(Error::BranchEnds { place, reason: stop.to_string() });
        }
    }
    if points.first().map(|point| point.value) < points.last().map(|point| point.value) {
        points.reverse();
    }
    Ok(points)
}

/// The branch of straight running, from a cycle at a finite radius.
fn straight(branch: &Branch) -> Result<Branch, Error> {
    let (radius, speed) = TOWARDS_STRAIGHT;
    let not_found =
        |radius: f64| Error::not_found("limit cycle", &format!("v = {speed} m/s, r = {radius} m"));
    let (cycle, _) = branch.cycle_at(speed).ok_or_else(|| not_found(radius))?;
    let along = Along::new(Key::TurningRadius, radius, f64::INFINITY)?;
    let goal = CycleOptions::default().at(&[f64::INFINITY]);
    let reached =
        branch.wheel(speed)?.cycles_through(&cycle.orbit, along, &goal, |_| ControlFlow::Continue(()))?;
    let last = reached
        .points
        .iter()
        .find(|cycle| cycle.value.is_infinite())
        .ok_or_else(|| not_found(f64::INFINITY))?;
    let along = Along::new(Key::V, SLOWEST, FASTEST)?;
    let wheel = paper_wheel(speed, branch.caster_length, f64::INFINITY)?.with(Key::FAz, HEAVIEST)?;
    let found = wheel.cycles_through(&last.orbit, along, &options(along), |_| ControlFlow::Continue(()))?;
    Branch::new([branch.caster_length, f64::INFINITY], None, complete(found)?)
}
