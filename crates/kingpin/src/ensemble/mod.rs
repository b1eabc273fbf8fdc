//! Many trajectories of the rolling wheel at once.
//!
//! The equations are integrated in quadratic form by Taylor's method, as many trajectories side by
//! side as the processor's registers have lanes (eight with AVX-512, four with AVX2), on all cores. A lane whose
//! trajectory has ended is refilled from a queue. Lanes do not interact, so a trajectory is the same to the
//! last bit whatever its neighbours, the chunk it is in and the number of threads.

mod quadratic;
mod queue;
mod taylor;
#[cfg(test)]
mod tests;
mod trajectory;

pub use trajectory::{Ending, Monitor, Outcome, Progress};

use crate::simulation::SimulationError;
use crate::wheel::Wheel;
use arclength::control::{Control, Interrupted};
use quadratic::QuadraticWheel;
use rayon::prelude::*;
use trajectory::Unwatched;

/// Trajectories that one thread takes at a time.
const CHUNK: usize = 256;
/// Largest number of steps of one trajectory unless another is set.
const MAXIMUM_STEPS: u32 = 1_000_000;

/// An integrator of many trajectories of one wheel.
///
/// ```
/// use arclength::control::Control;
/// use kingpin::{Wheel, ensemble::Ensemble};
///
/// let wheel = Wheel::default();
/// let ensemble = Ensemble::new(&wheel)?.tolerance(1e-10);
/// let start = wheel.perturbed_uniform_motion(&[("psi", 0.2)])?;
/// let ends = ensemble.integrate(&[start, start], 10.0, &Control::none())?;
/// assert_eq!(ends[0], ends[1]);
/// # Ok::<(), kingpin::simulation::SimulationError>(())
/// ```
#[derive(Clone, Debug)]
pub struct Ensemble {
    wheel: QuadraticWheel,
    tolerance: f64,
    maximum_steps: u32,
}

impl Ensemble {
    /// An ensemble of this wheel with a tolerance of 1e-10.
    ///
    /// # Errors
    /// The wheel must have the same stiffness and damping in both directions.
    pub fn new(wheel: &Wheel) -> Result<Self, SimulationError> {
        Ok(Self { wheel: QuadraticWheel::new(wheel)?, tolerance: 1e-10, maximum_steps: MAXIMUM_STEPS })
    }

    /// Sets the tolerance: the size of the last term of the Taylor series relative to the state, all states measured
    /// as speeds at the wheel. It is between 1e-16 and 1e-2.
    pub fn tolerance(mut self, tolerance: f64) -> Self {
        self.tolerance = tolerance;
        self
    }

    /// Sets the largest number of steps of one trajectory.
    pub fn maximum_steps(mut self, steps: u32) -> Self {
        self.maximum_steps = steps;
        self
    }

    /// Follows a trajectory from each of the initial states `(u, q, psi, V, Omega)` for `duration` seconds.
    ///
    /// # Errors
    /// A tolerance or duration that is out of range, [`SimulationError::Interrupted`]. A trajectory that grows without bound is not an error
    /// but an [`Ending`].
    pub fn integrate(
        &self,
        initial: &[[f64; 5]],
        duration: f64,
        control: &Control<'_>,
    ) -> Result<Vec<Outcome>, SimulationError> {
        self.integrate_watched(initial, duration, control, |_| Unwatched)
    }

    /// As [`integrate`](Self::integrate), with a monitor made for each trajectory from its index.
    ///
    /// # Errors
    /// As [`integrate`](Self::integrate).
    pub fn integrate_watched<M: Monitor>(
        &self,
        initial: &[[f64; 5]],
        duration: f64,
        control: &Control<'_>,
        monitor: impl Fn(usize) -> M + Sync,
    ) -> Result<Vec<Outcome>, SimulationError> {
        if !(duration >= 0.0 && duration.is_finite()) {
            return Err(SimulationError::out_of_range("duration", duration, "at least 0 and finite, in s"));
        }
        if !(1e-16..=1e-2).contains(&self.tolerance) {
            return Err(SimulationError::out_of_range("tolerance", self.tolerance, "1e-16 to 1e-2"));
        }
        let mut outcomes =
            vec![Outcome { time: 0.0, state: [0.0; 5], steps: 0, ending: Ending::NotFinite }; initial.len()];
        let arch = pulp::Arch::new();
        let progress = control.count(initial.len());
        outcomes.par_chunks_mut(CHUNK).zip(initial.par_chunks(CHUNK)).enumerate().try_for_each(
            |(chunk, (outcomes, initial))| {
                arch.dispatch(queue::Queue {
                    wheel: &self.wheel,
                    tolerance: self.tolerance,
                    maximum_steps: self.maximum_steps,
                    initial,
                    first: chunk * CHUNK,
                    duration,
                    monitor: &monitor,
                    control,
                    outcomes,
                })?;
                progress.advance(initial.len());
                Ok::<_, Interrupted>(())
            },
        )?;
        Ok(outcomes)
    }
}
