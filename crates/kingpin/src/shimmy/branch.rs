//! Branches of periodic motions with sliding phases along a parameter.

use super::curve::{CurvePoint, SlidingCurve};
use super::error::{Grazing, Refusal, ShimmyError};
use super::{PeriodicSliding, SAME};
use crate::branches::Along;
use crate::error::KingpinError;
use arclength::branch::SpecialKind;
use arclength::continuation::{Bound, Origin, Request, Settings, Solution, Stop, follow};
use arclength::control::Control;
use std::ops::ControlFlow;

/// Most renewals of the start on one branch.
const MOST_SEGMENTS: usize = 1000;

/// How a branch is followed.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub struct SlidingBranchOptions {
    /// Parameter values at which motions are wanted exactly.
    pub at: Vec<f64>,
    /// Whether to go on beyond a grazing with a motion of another sequence of phases, where there is one that differs by less
    /// than three hundredths of its size. With `mu_s > mu_d` the motion may jump there: a wheel that just sticks is held
    /// for a finite time, while one that just misses is not.
    pub through_grazings: bool,
    /// Settings of the continuation.
    pub settings: Settings,
}

impl Default for SlidingBranchOptions {
    /// Steps as for other branches, corrections to what the integration resolves, an end at the first grazing.
    fn default() -> Self {
        let settings = Settings::default()
            .corrector_tolerance(1e-8)
            .smallest_step(1e-8)
            .predictor_error(0.02)
            .largest_step(0.5)
            .most_steps(500);
        Self { at: Vec::new(), through_grazings: false, settings }
    }
}

impl SlidingBranchOptions {
    /// The same with parameter values at which motions are wanted exactly.
    pub fn at(mut self, values: &[f64]) -> Self {
        self.at = values.to_vec();
        self
    }

    /// The same with going on beyond grazings, or not.
    pub fn through_grazings(mut self, goes_on: bool) -> Self {
        self.through_grazings = goes_on;
        self
    }

    /// The same with other settings of the continuation.
    pub fn settings(mut self, settings: Settings) -> Self {
        self.settings = settings;
        self
    }
}

/// Why a motion is part of a branch.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SlidingRole {
    /// A step of the continuation, or an end of it.
    Step,
    /// Asked for by its parameter value.
    Requested,
    /// A bifurcation.
    Bifurcation(SpecialKind),
    /// The last motion before the sequence of phases changes; the next one has another sequence.
    Grazing(Grazing),
}

/// A motion of a branch.
#[derive(Clone, Debug)]
pub struct SlidingBranchPoint {
    /// Value of the parameter.
    pub value: f64,
    /// The motion.
    pub motion: PeriodicSliding,
    /// Why it is part of the branch.
    pub role: SlidingRole,
}

/// Why a branch ends.
#[derive(Debug)]
#[non_exhaustive]
pub enum SlidingBranchEnd {
    /// The sequence of phases changes.
    Grazing {
        /// How it changes.
        change: Grazing,
        /// Parameter value of the last motion with the old sequence.
        value: f64,
        /// Distance in the parameter to the nearest value that was tried and refused: how well the change is located.
        located_within: f64,
    },
    /// Beyond it periods and extrema of the motions are known too badly to tell them apart, however short the step.
    Inexact {
        /// Error of the nearest motion beyond it, relative to period and range of the angle.
        error: f64,
        /// Parameter value of the last motion.
        value: f64,
    },
    /// Beyond it the motion cannot be followed over a period, however short the step.
    NotFollowed {
        /// What happened.
        cause: Refusal,
        /// Parameter value of the last motion.
        value: f64,
    },
    /// Another reason.
    Continuation(Stop),
}

impl std::fmt::Display for SlidingBranchEnd {
    fn fmt(&self, formatter: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Grazing { change, value, .. } => write!(formatter, "{change} (at {value})"),
            Self::Inexact { error, value } => write!(
                formatter,
                "beyond {value} the motion is known to a part of {error:.1e} only, however short the step"
            ),
            Self::NotFollowed { cause, value } => {
                write!(formatter, "beyond {value} the motion cannot be followed: {cause}")
            }
            Self::Continuation(stop) => write!(formatter, "{stop}"),
        }
    }
}

/// A branch of periodic motions with sliding phases, all with the same sequence of phases between grazings.
#[derive(Debug)]
pub struct SlidingBranch {
    /// The parameter and its interval.
    pub along: Along,
    /// The motions in the order of the branch.
    pub points: Vec<SlidingBranchPoint>,
    /// Why the branch ends, at its first and at its last point.
    pub ends: [SlidingBranchEnd; 2],
}

impl PeriodicSliding {
    /// The branch of periodic motions through this one, followed both ways over the interval until the sequence of phases
    /// changes. `observer` is told value and motion and may end the run, as the control does: the branch then ends there.
    ///
    /// # Errors
    /// An interval without the value of this motion, or a start from which nothing can be followed.
    ///
    /// ```
    /// use arclength::control::Control;
    /// use kingpin::{Key, Wheel, branches::Along, shimmy::{SlidingBranchOptions, SlidingMotionSearch}};
    /// use std::ops::ControlFlow;
    ///
    /// let mut wheel = Wheel::default();
    /// for (key, value) in [("l", "0.03"), ("v", "0.5"), ("r", "inf"), ("c_u", "0.1"), ("c_q", "0.1")] {
    ///     wheel.set(key, value)?;
    /// }
    /// let start = wheel.perturbed_uniform_motion(&[("psi", 0.2)])?;
    /// let search = SlidingMotionSearch { settling_time: 5.0, ..SlidingMotionSearch::default() };
    /// let motion = wheel.sliding_motion(&start, &search, &Control::none())?;
    /// let along = Along::new(Key::V, 0.49, 0.51)?;
    /// let branch = motion.along(along, &SlidingBranchOptions::default(), &Control::none(), |_, _| ControlFlow::Continue(()))?;
    /// assert_eq!(branch.points[0].value, 0.49);
    /// # Ok::<(), kingpin::shimmy::ShimmyError>(())
    /// ```
    pub fn along(
        &self,
        along: Along,
        options: &SlidingBranchOptions,
        control: &Control<'_>,
        mut observer: impl FnMut(f64, &PeriodicSliding) -> ControlFlow<()>,
    ) -> Result<SlidingBranch, ShimmyError> {
        let value = self.wheel.get(along.key());
        if !along.contains(value) {
            let (start, end) = along.ends();
            return Err(KingpinError::OutsideInterval { key: along.key(), value, start, end }.into());
        }
        let mut halves = Vec::with_capacity(2);
        for direction in [-1.0, 1.0] {
            halves.push(self.half(along, direction, options, control, &mut observer)?);
        }
        let [(backward, first), (forward, last)] =
            <[_; 2]>::try_from(halves).map_err(|_| Refusal::Singular)?;
        let mut points: Vec<SlidingBranchPoint> = backward;
        points.reverse();
        points.pop();
        points.extend(forward);
        Ok(SlidingBranch { along, points, ends: [first, last] })
    }

    /// One direction of a branch.
    fn half(
        &self,
        along: Along,
        direction: f64,
        options: &SlidingBranchOptions,
        control: &Control<'_>,
        observer: &mut dyn FnMut(f64, &PeriodicSliding) -> ControlFlow<()>,
    ) -> Result<(Vec<SlidingBranchPoint>, SlidingBranchEnd), ShimmyError> {
        let range = along.range();
        let (lower, upper) = (*range.start(), *range.end());
        let value = along.convert(self.wheel.get(along.key()));
        let mut curve =
            SlidingCurve::new(self.map.clone(), along.followed(), upper - lower, options.settings, control);
        let mut unknown = curve.unknown(&self.start, value);
        let mut tangent = vec![0.0; unknown.len()];
        if let Some(last) = tangent.last_mut() {
            *last = direction * curve.range;
        }
        let request = Request {
            bounds: vec![Bound { from_end: 1, lower, upper }],
            values: options.at.iter().map(|value| along.convert(*value)).collect(),
            targets: Vec::new(),
            settings: options.settings,
        };
        let mut points: Vec<SlidingBranchPoint> = Vec::new();
        let mut interrupted = false;
        let mut crosses = false;
        for _ in 0..MOST_SEGMENTS {
            let mut watch = |solution: &Solution<CurvePoint>, _: Origin<SpecialKind>| {
                let value = along.convert(solution.unknown[solution.unknown.len() - 1]);
                interrupted = control.is_stopped() || observer(value, &solution.point.motion).is_break();
                if interrupted { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
            };
            let followed = match follow(&mut curve, unknown, tangent, &request, &mut watch) {
                Err(_) if control.is_stopped() => break,
                followed => followed?,
            };
            // A renewed start repeats the last motion.
            let first = usize::from(!points.is_empty() && !std::mem::take(&mut crosses));
            points.extend(
                followed
                    .solutions
                    .iter()
                    .skip(first)
                    .map(|(solution, origin)| point(along, solution, *origin)),
            );
            let Some((last, _)) = followed.solutions.last() else { break };
            let end = match followed.stop {
                Stop::Interrupted if curve.wants_new_start && !interrupted => None,
                Stop::StepTooSmall { .. } | Stop::Failed(_) if control.is_stopped() => {
                    Some(SlidingBranchEnd::Continuation(Stop::Interrupted))
                }
                Stop::StepTooSmall { .. } => match curve.refusal.take() {
                    Some(Refusal::Grazing(change)) => {
                        let at = last.unknown[last.unknown.len() - 1];
                        let tried = curve.map.wheel.get(along.followed());
                        let known = |value: f64, motion: &PeriodicSliding| {
                            is_known(&points, along.convert(value), motion)
                        };
                        let crossed = match options.through_grazings {
                            true => curve.cross(last, (lower, upper), &known),
                            false => None,
                        };
                        if let Some(beyond) = crossed {
                            if let Some(point) = points.last_mut() {
                                point.role = SlidingRole::Grazing(change);
                            }
                            (unknown, tangent) = beyond;
                            crosses = true;
                            continue;
                        }
                        Some(SlidingBranchEnd::Grazing {
                            change,
                            value: along.convert(at),
                            located_within: (along.convert(tried) - along.convert(at)).abs(),
                        })
                    }
                    Some(Refusal::Inexact { error }) => Some(SlidingBranchEnd::Inexact {
                        error,
                        value: along.convert(last.unknown[last.unknown.len() - 1]),
                    }),
                    Some(cause @ Refusal::Integration(_)) => Some(SlidingBranchEnd::NotFollowed {
                        cause,
                        value: along.convert(last.unknown[last.unknown.len() - 1]),
                    }),
                    _ => Some(SlidingBranchEnd::Continuation(followed.stop)),
                },
                stop => Some(SlidingBranchEnd::Continuation(stop)),
            };
            if let Some(end) = end {
                return Ok((points, end));
            }
            (unknown, tangent) = match curve.renew(last) {
                Err(Refusal::Interrupted(_)) => break,
                renewed => renewed?,
            };
        }
        if points.is_empty() {
            // Stopped before the first step.
            let value = self.wheel.get(along.key());
            points.push(SlidingBranchPoint { value, motion: self.clone(), role: SlidingRole::Step });
        }
        let stop = if control.is_stopped() { Stop::Interrupted } else { Stop::MostSteps };
        Ok((points, SlidingBranchEnd::Continuation(stop)))
    }
}

/// Whether the branch has been at this motion: between two neighbouring points with as many phases.
fn is_known(points: &[SlidingBranchPoint], value: f64, motion: &PeriodicSliding) -> bool {
    points.windows(2).any(|pair| {
        let [before, after] = pair else { return false };
        let span = after.value - before.value;
        let fraction = (value - before.value) / span;
        let same_phases = before.motion.phases.len() == motion.phases.len();
        if span == 0.0 || !(0.0..=1.0).contains(&fraction) || !same_phases {
            return false;
        }
        let size = motion.psi_max - motion.psi_min;
        let difference = |of: &dyn Fn(&PeriodicSliding) -> f64| {
            (of(&before.motion) + fraction * (of(&after.motion) - of(&before.motion)) - of(motion)).abs()
        };
        difference(&|motion| motion.period) < SAME * motion.period
            && difference(&|motion| motion.psi_max) < SAME * size
            && difference(&|motion| motion.psi_min) < SAME * size
    })
}

fn point(along: Along, solution: &Solution<CurvePoint>, origin: Origin<SpecialKind>) -> SlidingBranchPoint {
    let role = match origin {
        Origin::Special(kind) => SlidingRole::Bifurcation(kind),
        Origin::Requested => SlidingRole::Requested,
        _ => SlidingRole::Step,
    };
    SlidingBranchPoint {
        value: along.convert(solution.unknown[solution.unknown.len() - 1]),
        motion: solution.point.motion.clone(),
        role,
    }
}
