//! Hopf points of the uniform motion: where shimmy is born.

use super::birth::Birth;
use super::{Along, FORWARD_MONITOR, MotionMonitor, RACING, RACING_MONITOR, STANDING};
use crate::tyre::Onset;
use crate::{Key, KingpinError, RollingModel, Tyre, UniformMotion, Wheel};
use arclength::branch::{Criticality, Monitor, SpecialKind};
use arclength::continuation::{Settings, Stop, Wording};
use arclength::control::Control;
use arclength::cycle::CycleStart;
use arclength::equilibrium::{
    Equilibria, EquilibriumEnd, EquilibriumPoint, SpecialPoint, equilibrium_settings,
};
use std::ops::ControlFlow;

/// Distance of the first cycle from a Hopf point where the amplitude grows in proportion to it, as a part of the interval.
const FIRST_DISTANCE: f64 = 4e-4;

/// Monitors that are recorded along a branch beside those that are asked for, before them.
const OWN_MONITORS: usize = 1;

/// A Hopf point of the uniform motion.
#[derive(Clone, Debug)]
pub struct HopfPoint {
    /// Value of the parameter along which it was found.
    pub value: f64,
    /// Error estimate of that value.
    pub location_error: f64,
    /// Angular frequency in rad/s.
    pub frequency: f64,
    /// First Lyapunov coefficient in Kuznetsov's scaling, states in SI units; straight under the brush law of the tyre there is none.
    pub first_lyapunov: Option<f64>,
    /// Where there is none: slope of the largest caster angle of the cycles in the parameter, in rad over its unit, negative where they
    /// lie below the Hopf point.
    pub psi_max_slope: Option<f64>,
    /// Whether the cycles that are born are unstable (subcritical) or stable (supercritical).
    pub criticality: Criticality,
    /// How cycles are born: mode, stable side, growth.
    pub birth: Birth,
    /// The uniform motion, in [all states](Wheel::states).
    pub state: Vec<f64>,
    /// The wheel at this point.
    pub wheel: Wheel,
    /// The point as the continuation engine knows it, to start cycles from.
    pub detail: arclength::equilibrium::HopfPoint,
    /// How cycles grow where there is no first Lyapunov coefficient.
    onset: Option<Onset>,
}

/// Caster angles in rad that differ by less are those of the same uniform motion.
const SAME_ANGLE: f64 = 1e-6;

impl HopfPoint {
    /// The uniform motion of which it is a Hopf point. Behind a fold that is not the one that [`Wheel::uniform_motion`] gives.
    pub fn motion(&self) -> UniformMotion {
        self.wheel.motion_in(&self.state)
    }

    /// Whether that is the one that [`Wheel::uniform_motion`] gives.
    pub fn is_of_wheels_own_motion(&self) -> bool {
        let angle = self.motion().psi();
        self.wheel.uniform_motion().is_ok_and(|own| (own.psi() - angle).abs() < SAME_ANGLE)
    }

    /// The point as the start of cycles along an interval of some width.
    pub(super) fn start(&self, width: f64) -> CycleStart {
        let mut start = CycleStart::from(&self.detail);
        if let (CycleStart::Hopf { crossing_speed, cubic_coefficient, .. }, Some(onset)) =
            (&mut start, self.onset)
        {
            let equivalent = onset.cubic_coefficient(*crossing_speed, FIRST_DISTANCE * width);
            *cubic_coefficient = if equivalent.is_finite() { equivalent } else { 0.0 };
        }
        start
    }
}

/// The uniform motion followed along a parameter.
#[derive(Debug)]
pub struct MotionBranch {
    /// The motions, from the lower end of the interval to the upper one where the branch does not turn; `value` is a value of
    /// the key and `state` is in [all states](Wheel::states); the stability is that of [`UniformMotion::stability`], which does not count
    /// a longitudinal motion without damping. What is known of special points is as the continuation found it, which
    /// follows `1/r` in place of `r`. Monitors are those of the options, in their order.
    pub motions: Vec<EquilibriumPoint>,
    /// The Hopf points in ascending order of the parameter.
    pub hopf_points: Vec<HopfPoint>,
    /// Why the branch ends, at its first and at its last motion, in values of the key.
    pub stops: [Option<Stop<EquilibriumEnd>>; 2],
    /// The parameter and its interval.
    pub along: Along,
    /// Words for the monitors, in the order in which a [`Stop::Monitor`] counts them.
    pub monitors: Vec<String>,
}

impl MotionBranch {
    /// Part of the interval in which the uniform motion was followed; not numbers where there is no motion.
    pub fn searched(&self) -> [f64; 2] {
        let values = || self.motions.iter().map(|motion| motion.value);
        [values().fold(f64::NAN, f64::min), values().fold(f64::NAN, f64::max)]
    }

    /// Why the branch ends at its first, `0`, or last motion, in words; nothing where that is not known.
    pub fn end_in_words(&self, end: usize) -> Option<String> {
        let key = self.along.key();
        let wording =
            Wording::of([(key.name(), Some(key.unit()))]).monitors(self.monitors.iter().map(String::as_str));
        Some(self.stops.get(end)?.as_ref()?.explain(&wording).cause)
    }
}

/// What a search for Hopf points found.
#[derive(Clone, Debug)]
pub struct HopfSearch {
    /// The Hopf points in ascending order of the parameter.
    pub points: Vec<HopfPoint>,
    /// Whether the uniform motion is stable where the search ended below and above; both may be below where the motion turns at a fold.
    pub stable_at_ends: (Option<bool>, Option<bool>),
    /// Part of the interval in which the uniform motion was followed.
    pub searched: (f64, f64),
    /// Why the search ended below and above.
    pub stops: (String, String),
}

impl From<MotionBranch> for HopfSearch {
    fn from(branch: MotionBranch) -> Self {
        let stable = |end: Option<&EquilibriumPoint>| end.and_then(|motion| motion.stability.is_stable());
        let text = |end: usize| branch.end_in_words(end).unwrap_or_default();
        Self {
            stable_at_ends: (stable(branch.motions.first()), stable(branch.motions.last())),
            searched: branch.searched().into(),
            stops: (text(0), text(1)),
            points: branch.hopf_points,
        }
    }
}

/// How a branch of uniform motions is computed.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub struct MotionOptions {
    /// Settings of the continuation.
    pub settings: Settings,
    /// What is recorded along the branch.
    pub monitors: Vec<MotionMonitor<[f64]>>,
}

impl Default for MotionOptions {
    /// The settings of the engine for equilibria, and no monitors.
    fn default() -> Self {
        Self { settings: equilibrium_settings(), monitors: Vec::new() }
    }
}

impl MotionOptions {
    /// The same with other settings of the continuation.
    pub fn settings(mut self, settings: Settings) -> Self {
        self.settings = settings;
        self
    }

    /// The same with one more quantity that is recorded along the branch.
    pub fn monitor(mut self, monitor: MotionMonitor<[f64]>) -> Self {
        self.monitors.push(monitor);
        self
    }
}

impl Wheel {
    /// The Hopf points of the uniform motion along a parameter.
    ///
    /// # Errors
    /// Those of [`motion_branch`](Self::motion_branch), and [`KingpinError::Interrupted`].
    ///
    /// ```
    /// use arclength::control::Control;
    /// use kingpin::{Key, Wheel, branches::Along};
    /// let search = Wheel::default().hopf_points(Along::new(Key::V, 1.0, 12.0)?, &Control::none())?;
    /// assert!((search.points[0].value - 8.43103697014).abs() < 1e-9);
    /// # Ok::<(), kingpin::KingpinError>(())
    /// ```
    pub fn hopf_points(&self, along: Along, control: &Control<'_>) -> Result<HopfSearch, KingpinError> {
        let branch = self.motion_branch(along, &MotionOptions::default(), |_| control.flow())?;
        control.check()?;
        Ok(branch.into())
    }

    /// The uniform motion followed along a parameter, with its special points.
    ///
    /// `observer` is told the parameter at every motion found and may end the run. With a tyre the motion ends where the wheel stops
    /// rolling forwards, `V1 = 0`.
    ///
    /// # Errors
    /// [`KingpinError::NoUniformMotion`] when there is none anywhere in the interval (the reason is that at its
    /// start), [`KingpinError::Continuation`] when the branch cannot be followed.
    pub fn motion_branch(
        &self,
        along: Along,
        options: &MotionOptions,
        mut observer: impl FnMut(f64) -> ControlFlow<()>,
    ) -> Result<MotionBranch, KingpinError> {
        self.motion_branch_told_to(along, options, &mut observer)
    }

    /// [`motion_branch`](Self::motion_branch), compiled once and not for every observer.
    fn motion_branch_told_to(
        &self,
        along: Along,
        options: &MotionOptions,
        observer: &mut dyn FnMut(f64) -> ControlFlow<()>,
    ) -> Result<MotionBranch, KingpinError> {
        let mut first_error = None;
        let key = along.followed();
        for candidate in along.candidates(self) {
            let wheel = self.with(key, candidate)?;
            let motion = match wheel.uniform_motion() {
                Ok(motion) => motion,
                Err(error) => {
                    first_error.get_or_insert(error);
                    continue;
                }
            };
            let model = wheel.rolling_model(&[key])?;
            let equilibria = Equilibria::of(&model);
            // Where the motion, or what its equations hold for, ends.
            let border = if self.tyre() == Tyre::Rigid { RACING_MONITOR } else { FORWARD_MONITOR };
            let equilibria = if self.tyre() == Tyre::Rigid {
                let slowness = |point: &EquilibriumPoint| slowness(&wheel, &model, key, point);
                equilibria.monitor(Monitor::new(border, slowness).until(&[RACING]))
            } else {
                let forwards = |point: &EquilibriumPoint| model.speed_ratio(&point.state, &[point.value]);
                equilibria.monitor(Monitor::new(border, forwards).until(&[STANDING]))
            };
            let asked_for = options.monitors.iter().map(|monitor| {
                monitor.on_motions(&model, |point: &EquilibriumPoint| (&point.state, vec![point.value]))
            });
            let branch = asked_for
                .fold(equilibria, Equilibria::monitor)
                .start(&model.free_state(&motion.states()))
                .parameters(&[candidate])
                .along(&key.to_string(), along.range())
                .settings(options.settings)
                .observer(|point| observer(along.convert(point.value)))
                .run()?;
            let mut motions = branch.points;
            let hopf_points = hopf_points_among(&mut motions, &model, along)?;
            if motions.is_empty() {
                continue;
            }
            complete(&mut motions, &model, along)?;
            let mut stops = branch.stops.map(|stop| stop.map(|stop| along.convert_stop(stop)));
            if let [first, .., last] = &motions[..]
                && first.value > last.value
            {
                motions.reverse();
                stops.reverse();
            }
            take_off_borders(&mut motions, &stops);
            let asked_for = options.monitors.iter().map(MotionMonitor::name);
            let monitors = std::iter::once(border).chain(asked_for).map(str::to_owned).collect();
            return Ok(MotionBranch { motions, hopf_points, stops, along, monitors });
        }
        let (start, end) = along.ends();
        Err(first_error.unwrap_or(KingpinError::EmptyInterval { key: along.key(), start, end }))
    }
}

/// The towing speed as a part of the forward speed of the wheel, which vanishes where that grows without bound; nothing where both vanish.
fn slowness(wheel: &Wheel, model: &RollingModel, key: Key, motion: &EquilibriumPoint) -> Option<f64> {
    let towing_speed = if key == Key::V { motion.value } else { wheel.get(Key::V) };
    let [_, _, _, forward_speed, ..] = model.full_state(&motion.state, &[motion.value])[..] else {
        return None;
    };
    Some(towing_speed / forward_speed).filter(|ratio| ratio.is_finite())
}

/// The Hopf points among motions as the continuation found them, in ascending order of the parameter. Those that have no first Lyapunov
/// coefficient lose the one that the continuation computed.
fn hopf_points_among(
    motions: &mut [EquilibriumPoint],
    model: &RollingModel,
    along: Along,
) -> Result<Vec<HopfPoint>, KingpinError> {
    let mut hopf_points = Vec::new();
    for motion in motions {
        let Some(SpecialPoint::Hopf(point)) = motion.special.as_deref_mut() else { continue };
        let onset = model.onset(point);
        if let Some(onset) = onset {
            (point.first_lyapunov, point.first_lyapunov_error, point.c1_real) = (None, None, None);
            point.criticality = onset.criticality;
        }
        let wheel = model.wheel_at(&[point.value])?;
        let state = model.full_state(&point.state, &[point.value]);
        hopf_points.push(HopfPoint {
            value: along.told(point.value),
            location_error: along.convert_error(along.convert(point.value), point.location_error),
            frequency: point.frequency,
            first_lyapunov: point.first_lyapunov,
            psi_max_slope: onset.and_then(|onset| onset.psi_max_slope),
            criticality: point.criticality,
            birth: Birth::at(point, &wheel.motion_in(&state), along)?,
            state,
            wheel,
            detail: point.clone(),
            onset,
        });
    }
    hopf_points.sort_by(|a, b| a.value.total_cmp(&b.value));
    Ok(hopf_points)
}

/// Takes the label of a requested value off the motions at the border where the equations cease to hold, and numbers the others anew.
fn take_off_borders(motions: &mut [EquilibriumPoint], stops: &[Option<Stop<EquilibriumEnd>>; 2]) {
    let last = motions.len().saturating_sub(1);
    let mut number = 0;
    for (index, motion) in motions.iter_mut().enumerate() {
        let is_end_at_border = [0, last]
            .into_iter()
            .zip(stops)
            .any(|(end, stop)| end == index && matches!(stop, Some(Stop::Monitor { index: 0, .. })));
        let Some(label) = motion.label.as_mut().filter(|label| label.kind == SpecialKind::Requested) else {
            continue;
        };
        number += usize::from(!is_end_at_border);
        label.number = number;
        if is_end_at_border {
            motion.label = None;
        }
    }
}

/// Gives motions as the continuation found them in all states and in values of the key, with the stability of the uniform motion and the
/// monitors that were asked for.
fn complete(
    motions: &mut [EquilibriumPoint],
    model: &RollingModel,
    along: Along,
) -> Result<(), KingpinError> {
    for motion in motions {
        let state = model.full_state(&motion.state, &[motion.value]);
        motion.stability = model.wheel_at(&[motion.value])?.motion_in(&state).stability();
        motion.state = state;
        motion.value = along.told(motion.value);
        motion.monitors.drain(..OWN_MONITORS.min(motion.monitors.len()));
        if let Some(SpecialPoint::Degenerate { value, location_error, .. }) = motion.special.as_deref_mut() {
            *value = motion.value;
            *location_error = along.convert_error(motion.value, *location_error);
        }
    }
    Ok(())
}
