//! Limit cycles of the rolling wheel along a parameter.

use super::{Along, FRICTION_MONITOR, HopfPoint};
use crate::{KingpinError, Wheel};
use arclength::branch::{Monitor, SpecialKind, Unlocated};
use arclength::continuation::{Settings, Stop};
use arclength::cycle::{CycleEnd, CyclePoint, CycleStart, Cycles, Orbit, Resolution};
use std::ops::ControlFlow;

/// A first cycle that already needs more friction than there is, while the uniform motion does not, is made smaller at most so often.
const MOST_REDUCTIONS: usize = 4;
/// By how much at most in all.
const SMALLEST_SHARE: f64 = 1e-5;
/// Part of the friction left that a smaller first cycle is to take.
const TAKEN: f64 = 0.5;

/// How a branch of cycles is computed.
#[derive(Clone, Debug, Default)]
#[non_exhaustive]
pub struct CycleOptions {
    /// Parameter values at which cycles are wanted exactly.
    pub at: Vec<f64>,
    /// Resolution of the cycles.
    pub resolution: Resolution,
    /// Settings of the continuation.
    pub settings: Settings,
}

impl CycleOptions {
    /// The same with parameter values at which cycles are wanted exactly.
    pub fn at(mut self, values: &[f64]) -> Self {
        self.at = values.to_vec();
        self
    }

    /// The same with another resolution of the cycles.
    pub fn resolution(mut self, resolution: Resolution) -> Self {
        self.resolution = resolution;
        self
    }

    /// The same with other settings of the continuation.
    pub fn settings(mut self, settings: Settings) -> Self {
        self.settings = settings;
        self
    }
}

/// A branch of limit cycles of the wheel.
#[derive(Debug)]
pub struct WheelCycles {
    /// The wheel at the start.
    pub wheel: Wheel,
    /// The parameter and its interval.
    pub along: Along,
    /// The cycles, with `value` a value of the key, which alone is in `parameters`; extrema are those of [all states](Wheel::states), the states of the orbits are the
    /// [free ones](Wheel::free_states). With lateral elasticity only the extrema of `V` are those along the orbit, not a
    /// number where it comes within 0.01 rad of `psi = pi/2`; their error is up to `1/cos psi` times that of the others.
    pub points: Vec<CyclePoint>,
    /// Why the branch ends, at its first and at its last point, in values of the key; the first is `None` at a Hopf point.
    pub stops: [Option<Stop<CycleEnd>>; 2],
    /// Changes of test functions behind which no special cycle could be located.
    pub unlocated: Vec<Unlocated>,
    /// Indices of the cycles whose largest friction force is `mu_s N`: on one side of them the wheel rolls, on the other it cannot.
    pub rolling_limits: Vec<usize>,
    /// Values of the key between which the largest friction force passes `mu_s N`, and no cycle could be located where it does.
    pub missed_rolling_limits: Vec<[f64; 2]>,
}

/// Takes the label of a requested value off the cycles that were not asked for, and numbers the others anew. A monitor has its value
/// there: either one that ends the branch, which is an end as any other, or that of the friction. Returns the indices of the latter.
fn take_rolling_limits(
    points: &mut [CyclePoint],
    stops: &[Option<Stop<CycleEnd>>; 2],
    asked: &[f64],
) -> Vec<usize> {
    let [starts_at_monitor, ends_at_monitor] =
        stops.each_ref().map(|stop| matches!(stop, Some(Stop::Monitor { .. })));
    let last = points.len().saturating_sub(1);
    let mut rolling_limits = Vec::new();
    let mut number = 0;
    for (index, point) in points.iter_mut().enumerate() {
        let Some(label) = point.label.as_mut().filter(|label| label.kind == SpecialKind::Requested) else {
            continue;
        };
        if asked.contains(&point.value) {
            number += 1;
            label.number = number;
            continue;
        }
        point.label = None;
        if !(index == 0 && starts_at_monitor || index == last && ends_at_monitor) {
            rolling_limits.push(index);
        }
    }
    rolling_limits
}

/// Neighbours of which one needs more friction than there is and the other does not, neither being a rolling limit.
fn missed_rolling_limits(points: &[CyclePoint], rolling_limits: &[usize]) -> Vec<[f64; 2]> {
    let known = |index: usize| rolling_limits.contains(&index) || rolling_limits.contains(&(index + 1));
    let passes = |pair: &[CyclePoint]| is_passed([&pair[0], &pair[1]].map(friction_ratio));
    let missed = points.windows(2).enumerate().filter(|(index, pair)| !known(*index) && passes(pair));
    missed.map(|(_, pair)| [pair[0].value, pair[1].value]).collect()
}

/// The largest friction force over `mu_s N` on a cycle of a branch, whose last monitor it is; not a number where there is none.
fn friction_ratio(point: &CyclePoint) -> f64 {
    point.monitors.last().copied().unwrap_or(f64::NAN)
}

/// Whether one of two motions needs more friction than there is, and the other does not.
fn is_passed([one, other]: [f64; 2]) -> bool {
    (one < 1.0 && other > 1.0) || (one > 1.0 && other < 1.0)
}

impl HopfPoint {
    /// The branch of limit cycles that is born here, followed over the interval.
    ///
    /// `observer` is told every cycle that is found, special ones too, and may end the run.
    ///
    /// # Errors
    /// [`KingpinError::Continuation`].
    ///
    /// ```
    /// use arclength::control::Control;
    /// use kingpin::{Key, Wheel, branches::{Along, CycleOptions}};
    /// use std::ops::ControlFlow;
    /// let along = Along::new(Key::V, 1.0, 12.0)?;
    /// let hopf = Wheel::default().hopf_points(along, &Control::none())?.points.remove(0);
    /// let options = CycleOptions::default().at(&[4.0]);
    /// let branch = hopf.cycles(along, &options, |_| ControlFlow::Continue(()))?;
    /// let cycle = branch.points.iter().find(|cycle| cycle.value == 4.0).unwrap();
    /// assert!((cycle.period - 0.15274192836).abs() < 1e-9);
    /// # Ok::<(), kingpin::KingpinError>(())
    /// ```
    pub fn cycles(
        &self,
        along: Along,
        options: &CycleOptions,
        mut observer: impl FnMut(&CyclePoint) -> ControlFlow<()>,
    ) -> Result<WheelCycles, KingpinError> {
        self.cycles_told_to(along, options, &mut observer)
    }

    /// [`cycles`](Self::cycles), compiled once and not for every observer.
    fn cycles_told_to(
        &self,
        along: Along,
        options: &CycleOptions,
        observer: &mut dyn FnMut(&CyclePoint) -> ControlFlow<()>,
    ) -> Result<WheelCycles, KingpinError> {
        let width = along.range().end() - along.range().start();
        let uniform = self.wheel.motion_in(&self.state).forces()?.friction_ratio_max().unwrap_or(f64::NAN);
        let mut options = options.clone();
        let (mut share, mut reductions) = (1.0, 0);
        loop {
            // Where the friction is used up between the Hopf point and the first cycle, a smaller one leaves that for the branch.
            let mut first = None;
            let may_reduce = reductions < MOST_REDUCTIONS && share > SMALLEST_SHARE;
            let mut branch = self.wheel.cycles_from(self.start(width), along, &options, |point| {
                let ratio = *first.get_or_insert_with(|| friction_ratio(point));
                if may_reduce && is_passed([uniform, ratio]) {
                    ControlFlow::Break(())
                } else {
                    observer(point)
                }
            })?;
            match first.filter(|&ratio| is_passed([uniform, ratio])) {
                Some(ratio) if may_reduce => {
                    let reduction = TAKEN * ((1.0 - uniform) / (ratio - uniform)).min(1.0);
                    share *= reduction;
                    reductions += 1;
                    // The first cycle is as much smaller as the first step is shorter than that of the engine.
                    let step = &mut options.settings.initial_step;
                    *step = reduction * step.min(Settings::default().initial_step);
                }
                Some(_) => {
                    branch.missed_rolling_limits.insert(0, [self.value, branch.points[0].value]);
                    return Ok(branch);
                }
                None => return Ok(branch),
            }
        }
    }
}

impl Wheel {
    /// The branch of limit cycles through a cycle of this wheel, followed both ways over the interval.
    ///
    /// The wheel's own value of the parameter has to lie in the interval.
    ///
    /// # Errors
    /// [`KingpinError::OutsideInterval`], [`KingpinError::Continuation`].
    pub fn cycles_through(
        &self,
        orbit: &Orbit,
        along: Along,
        options: &CycleOptions,
        observer: impl FnMut(&CyclePoint) -> ControlFlow<()>,
    ) -> Result<WheelCycles, KingpinError> {
        self.cycles_from(CycleStart::Orbit(orbit.clone()), along, options, observer)
    }

    /// The branch of limit cycles from any start that the continuation knows, such as the branch that leaves a period doubling
    /// or a branch point of cycles, followed over the interval.
    ///
    /// # Errors
    /// As [`cycles_through`](Self::cycles_through).
    pub fn cycles_from(
        &self,
        start: CycleStart,
        along: Along,
        options: &CycleOptions,
        mut observer: impl FnMut(&CyclePoint) -> ControlFlow<()>,
    ) -> Result<WheelCycles, KingpinError> {
        self.cycles_told_to(start, along, options, &mut observer)
    }

    /// [`cycles_from`](Self::cycles_from), compiled once and not for every observer.
    fn cycles_told_to(
        &self,
        start: CycleStart,
        along: Along,
        options: &CycleOptions,
        observer: &mut dyn FnMut(&CyclePoint) -> ControlFlow<()>,
    ) -> Result<WheelCycles, KingpinError> {
        let value = self.get(along.key());
        if !along.contains(value) {
            let (start, end) = along.ends();
            return Err(KingpinError::OutsideInterval { key: along.key(), value, start, end });
        }
        let key = along.followed();
        let model = self.rolling_model(&[key])?;
        let at: Vec<f64> = options.at.iter().map(|value| along.convert(*value)).collect();
        let complete = |point: &mut CyclePoint| {
            model.complete_extrema(&point.orbit, &mut point.max, &mut point.min, &[point.value]);
            point.value = along.convert(point.value);
            point.parameters = vec![point.value];
        };
        if let CycleStart::Orbit(orbit) = &start {
            model.check_forwards(orbit, &[along.convert(value)])?;
        }
        let used = Monitor::new(FRICTION_MONITOR, |point: &CyclePoint| {
            model.friction_ratio_max(&point.orbit, &[point.value])
        })
        .mark(&[1.0]);
        let cycles = Cycles::of(&model, start);
        let cycles = match self.border_of_cycles() {
            Some((words, end)) => {
                let to_border = |point: &CyclePoint| model.distance_from_border(&point.orbit, &[point.value]);
                cycles.monitor(Monitor::new(words, to_border).until(&[end]))
            }
            None => cycles,
        };
        let mut branch = cycles
            .monitor(used)
            .parameters(&[along.convert(value)])
            .along(key.name(), along.range())
            .at(&at)
            .resolution(options.resolution)
            .settings(options.settings)
            .observer(|point| {
                let mut told = point.clone();
                complete(&mut told);
                observer(&told)
            })
            .run()?;
        branch.points.iter_mut().for_each(complete);
        let asked: Vec<f64> = options.at.iter().map(|&value| along.as_found(value)).collect();
        let rolling_limits = take_rolling_limits(&mut branch.points, &branch.stops, &asked);
        for missed in &mut branch.unlocated {
            missed.between.iter_mut().flatten().for_each(|value| *value = along.convert(*value));
        }
        let missed_rolling_limits = missed_rolling_limits(&branch.points, &rolling_limits);
        Ok(WheelCycles {
            wheel: *self,
            along,
            points: branch.points,
            stops: branch.stops.map(|stop| stop.map(|stop| along.convert_stop(stop))),
            unlocated: branch.unlocated,
            rolling_limits,
            missed_rolling_limits,
        })
    }
}
