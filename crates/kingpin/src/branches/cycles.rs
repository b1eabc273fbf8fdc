//! Limit cycles of the rolling wheel along a parameter.

use super::{Along, FRICTION_MONITOR, HopfPoint, MotionMonitor};
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
/// Part of the friction by which a cycle that was located where all of it is used may differ from that.
const AT_LIMIT: f64 = 1e-8;

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
    /// What is recorded along the branch.
    pub monitors: Vec<MotionMonitor<Orbit>>,
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

    /// The same with one more quantity that is recorded along the branch.
    pub fn monitor(mut self, monitor: MotionMonitor<Orbit>) -> Self {
        self.monitors.push(monitor);
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
    /// number where it comes within 0.01 rad of `psi = pi/2`; their error is up to `1/cos psi` times that of the others. Monitors are
    /// those of the options, in their order.
    pub points: Vec<CyclePoint>,
    /// Why the branch ends, at its first and at its last point, in values of the key; the first is `None` at a Hopf point.
    pub stops: [Option<Stop<CycleEnd>>; 2],
    /// Changes of test functions behind which no special cycle could be located.
    pub unlocated: Vec<Unlocated>,
    /// Indices of the cycles whose largest friction force is `mu_s N`: on one side of them the wheel rolls, on the other it cannot.
    pub rolling_limits: Vec<usize>,
    /// Words for the monitors, in the order in which a [`Stop::Monitor`] counts them.
    pub monitors: Vec<String>,
    /// Values of the key between which the largest friction force passes `mu_s N`, and no cycle could be located where it does.
    pub missed_rolling_limits: Vec<[f64; 2]>,
}

/// Takes the label of a requested value off the cycles that were not asked for, and numbers the others anew. A monitor has its value
/// there: either that of the border, which is an end as any other, or that of the friction. Returns the indices of the latter.
fn take_rolling_limits(
    points: &mut [CyclePoint],
    stops: &[Option<Stop<CycleEnd>>; 2],
    asked: &[f64],
    has_border: bool,
) -> Vec<usize> {
    let [starts_at_border, ends_at_border] =
        stops.each_ref().map(|stop| has_border && matches!(stop, Some(Stop::Monitor { index: 0, .. })));
    let last = points.len().saturating_sub(1);
    let mut rolling_limits = Vec::new();
    let mut number = 0;
    for (index, point) in points.iter_mut().enumerate() {
        let Some(label) = point.label.as_mut().filter(|label| label.kind == SpecialKind::Requested) else {
            continue;
        };
        let is_border = index == 0 && starts_at_border || index == last && ends_at_border;
        let is_at_limit = (friction_ratio(&point.monitors) - 1.0).abs() < AT_LIMIT;
        if asked.contains(&point.value) || !is_border && !is_at_limit {
            number += 1;
            label.number = number;
            continue;
        }
        point.label = None;
        if !is_border {
            rolling_limits.push(index);
        }
    }
    rolling_limits
}

/// Neighbours of which one needs more friction than there is and the other does not, neither being a rolling limit.
fn missed_rolling_limits(points: &[CyclePoint], rolling_limits: &[usize]) -> Vec<[f64; 2]> {
    let known = |index: usize| rolling_limits.contains(&index) || rolling_limits.contains(&(index + 1));
    let passes =
        |pair: &[CyclePoint]| is_passed([&pair[0], &pair[1]].map(|point| friction_ratio(&point.monitors)));
    let missed = points.windows(2).enumerate().filter(|(index, pair)| !known(*index) && passes(pair));
    missed.map(|(_, pair)| [pair[0].value, pair[1].value]).collect()
}

/// The largest friction force over `mu_s N` on a cycle of a branch, the last of its monitors; not a number where there is none.
fn friction_ratio(monitors: &[f64]) -> f64 {
    monitors.last().copied().unwrap_or(f64::NAN)
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
            let mut branch =
                self.wheel.cycles_told_to(self.start(width), along, &options, &mut |point, ratio| {
                    let ratio = *first.get_or_insert(ratio);
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
        self.cycles_told_to(start, along, options, &mut |point, _| observer(point))
    }

    /// [`cycles_from`](Self::cycles_from), compiled once and not for every observer, who is told the largest friction force over
    /// `mu_s N` too.
    fn cycles_told_to(
        &self,
        start: CycleStart,
        along: Along,
        options: &CycleOptions,
        observer: &mut dyn FnMut(&CyclePoint, f64) -> ControlFlow<()>,
    ) -> Result<WheelCycles, KingpinError> {
        let value = self.get(along.key());
        if !along.contains(value) {
            let (start, end) = along.ends();
            return Err(KingpinError::OutsideInterval { key: along.key(), value, start, end });
        }
        let key = along.followed();
        let model = self.rolling_model(&[key])?;
        let at: Vec<f64> = options.at.iter().map(|value| along.convert(*value)).collect();
        let border = self.border_of_cycles();
        let complete = |point: &mut CyclePoint| {
            model.complete_extrema(&point.orbit, &mut point.max, &mut point.min, &[point.value]);
            point.value = along.told(point.value);
            point.parameters = vec![point.value];
        };
        // What stays are the monitors that were asked for.
        let strip = |point: &mut CyclePoint| {
            point.monitors.pop();
            point.monitors.drain(..usize::from(border.is_some()));
        };
        if let CycleStart::Orbit(orbit) = &start {
            model.check_forwards(orbit, &[along.convert(value)])?;
        }
        let used = Monitor::new(FRICTION_MONITOR, |point: &CyclePoint| {
            model.friction_ratio_max(&point.orbit, &[point.value])
        })
        .mark(&[1.0]);
        let cycles = Cycles::of(&model, start);
        let cycles = match border {
            Some((words, end)) => {
                let to_border = |point: &CyclePoint| model.distance_from_border(&point.orbit, &[point.value]);
                cycles.monitor(Monitor::new(words, to_border).until(&[end]))
            }
            None => cycles,
        };
        let asked_for = options
            .monitors
            .iter()
            .map(|monitor| monitor.on_cycles(&model, |point: &CyclePoint| (&point.orbit, vec![point.value])));
        let mut branch = asked_for
            .fold(cycles, Cycles::monitor)
            .monitor(used)
            .parameters(&[along.convert(value)])
            .along(key.name(), along.range())
            .at(&at)
            .resolution(options.resolution)
            .settings(options.settings)
            .observer(|point| {
                let mut told = point.clone();
                complete(&mut told);
                strip(&mut told);
                observer(&told, friction_ratio(&point.monitors))
            })
            .run()?;
        branch.points.iter_mut().for_each(complete);
        let asked: Vec<f64> = options.at.iter().map(|&value| along.as_found(value)).collect();
        let rolling_limits = take_rolling_limits(&mut branch.points, &branch.stops, &asked, border.is_some());
        for missed in &mut branch.unlocated {
            missed.between.iter_mut().flatten().for_each(|value| *value = along.convert(*value));
        }
        let missed_rolling_limits = missed_rolling_limits(&branch.points, &rolling_limits);
        branch.points.iter_mut().for_each(strip);
        let asked_for = options.monitors.iter().map(MotionMonitor::name);
        let monitors = border.iter().map(|(words, _)| *words).chain(asked_for).map(str::to_owned).collect();
        Ok(WheelCycles {
            wheel: *self,
            along,
            points: branch.points,
            stops: branch.stops.map(|stop| stop.map(|stop| along.convert_stop(stop))),
            unlocated: branch.unlocated,
            rolling_limits,
            missed_rolling_limits,
            monitors,
        })
    }
}
