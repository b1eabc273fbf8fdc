//! One of the trajectories: how it is watched on its way and what is told of its end.

use super::quadratic::{self, QuadraticWheel};
use std::ops::ControlFlow;

/// How a trajectory ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Ending {
    /// It was followed for the whole duration.
    Completed,
    /// The monitor stopped it.
    Stopped,
    /// It grew beyond what numbers can hold.
    NotFinite,
    /// It took the largest number of steps.
    TooManySteps,
}

/// The end of a trajectory.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Outcome {
    /// Time that was reached, in s.
    pub time: f64,
    /// State `(u, q, psi, V, Omega)` at that time.
    pub state: [f64; 5],
    /// Number of steps.
    pub steps: u32,
    /// How it ended.
    pub ending: Ending,
}

/// A trajectory that is being followed, as a [`Monitor`] sees it after every step.
#[derive(Clone, Copy, Debug)]
pub struct Progress<'a> {
    /// Index of the initial state.
    pub trajectory: usize,
    /// Time in s.
    pub time: f64,
    pub(super) state: &'a [f64; quadratic::STATES],
}

impl Progress<'_> {
    /// Spring deflection along and across the caster in m.
    pub fn deflection(&self) -> (f64, f64) {
        (self.state[quadratic::A], self.state[quadratic::B])
    }
    /// Caster angle in rad, not reduced to one turn.
    pub fn psi(&self) -> f64 {
        self.state[quadratic::PSI]
    }
    /// Forward speed of the wheel in m/s.
    pub fn forward_speed(&self) -> f64 {
        self.state[quadratic::SPEED]
    }
    /// Absolute yaw rate of the caster in rad/s.
    pub fn yaw_rate(&self) -> f64 {
        self.state[quadratic::YAW]
    }
    /// State `(u, q, psi, V, Omega)`.
    pub fn state(&self) -> [f64; 5] {
        QuadraticWheel::rolling_state(*self.state)
    }
}

/// Watches trajectories and may end them early.
///
/// There is one monitor for each trajectory, so that it may remember what it saw; what it does must not
/// depend on other trajectories.
pub trait Monitor {
    /// Called after every step.
    fn observe(&mut self, progress: Progress<'_>) -> ControlFlow<()>;
}

impl<F: FnMut(Progress<'_>) -> ControlFlow<()>> Monitor for F {
    #[inline(always)]
    fn observe(&mut self, progress: Progress<'_>) -> ControlFlow<()> {
        self(progress)
    }
}

/// Never ends a trajectory.
#[derive(Clone, Copy, Debug)]
pub(super) struct Unwatched;

impl Monitor for Unwatched {
    #[inline(always)]
    fn observe(&mut self, _: Progress<'_>) -> ControlFlow<()> {
        ControlFlow::Continue(())
    }
}
