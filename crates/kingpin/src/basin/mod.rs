//! Basins of attraction: where a motion ends, depending on where it starts.
//!
//! [`Destinations`] follows motions of one wheel, rolling ideally or with sliding, and tells their [`Fate`].
//! [`BasinMap`] does so for grids and random samples of initial states in tiles that can be computed apart, stopped and
//! resumed; [`SafeKick`] finds the smallest disturbance from which the wheel does not return.

mod fate;
mod kick;
mod map;
#[cfg(test)]
mod tests;

pub use fate::{ClassificationSettings, Fate};
pub use kick::{Disturbance, DisturbedMotion, SafeKick};
pub use map::{Axis, BasinMap, Fraction, Tile, wilson_interval};

use crate::ensemble::{Ending, Ensemble, Progress};
use crate::parameters::Key;
use crate::simulation::{SIMULATION_TOLERANCE, SimulationError};
use crate::sliding::SlidingWheel;
use crate::wheel::Wheel;
use arclength::integration::{IntegrationError, Integrator, Stepper, autonomous};
use fate::{Target, Watch};
use std::ops::ControlFlow;

/// Tolerance of the integration of motions that are only classified.
const CLASSIFICATION_TOLERANCE: f64 = 1e-10;
/// Motions with sliding are followed and looked at in windows of this many samples.
const SAMPLES_PER_WINDOW: usize = 50;
/// Samples of a motion with sliding in one natural period of the springs.
const SAMPLES_PER_PERIOD: f64 = 20.0;

/// Whether the wheel is allowed to slide.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ContactModel {
    /// It rolls whatever force that takes.
    Rolling,
    /// Coulomb friction: it slides where rolling takes more than the static friction.
    Sliding,
}

impl ContactModel {
    /// Name as it is written in options and results.
    pub const fn name(self) -> &'static str {
        match self {
            ContactModel::Rolling => "rolling",
            ContactModel::Sliding => "sliding",
        }
    }
}

/// Tells where motions of one wheel end.
///
/// ```
/// use kingpin::{Wheel, basin::{ContactModel, ClassificationSettings, Destinations, Fate}};
///
/// let wheel = Wheel::default();
/// let near = wheel.perturbed_uniform_motion(&[("psi", 0.1)])?;
/// let far = wheel.perturbed_uniform_motion(&[("Omega", 80.0)])?;
/// let destinations = Destinations::new(&wheel, ContactModel::Rolling, ClassificationSettings::default())?;
/// let fates = destinations.of(&[near, far])?;
/// assert_eq!(fates, [Fate::UniformMotion, Fate::Tumbling]);
/// # Ok::<(), kingpin::simulation::SimulationError>(())
/// ```
#[derive(Clone, Debug)]
pub struct Destinations {
    wheel: Wheel,
    model: ContactModel,
    settings: ClassificationSettings,
    target: Target,
    follower: Follower,
}

#[derive(Clone, Debug)]
enum Follower {
    /// The quadratic form, many at once.
    Ensemble(Ensemble),
    /// Rolling wheels that have no quadratic form.
    Rolling,
    Sliding(Box<SlidingWheel>),
}

impl Destinations {
    /// For motions of this wheel.
    ///
    /// # Errors
    /// A setting out of range, no uniform motion, or what [`Wheel::sliding`] refuses; with sliding also a uniform motion for
    /// which the static friction does not suffice.
    pub fn new(
        wheel: &Wheel,
        model: ContactModel,
        settings: ClassificationSettings,
    ) -> Result<Self, SimulationError> {
        settings.check()?;
        wheel.check_elastic()?;
        let motion = wheel.uniform_motion()?;
        if model == ContactModel::Sliding && !motion.rolls() {
            return Err(SimulationError::UniformMotionSlides {
                needed: motion.contact_force().friction(),
                available: wheel.get(Key::MuS) * wheel.normal_force(),
            });
        }
        let isotropic = wheel.get(Key::KU) == wheel.get(Key::KQ) && wheel.get(Key::CU) == wheel.get(Key::CQ);
        let follower = match model {
            ContactModel::Sliding => Follower::Sliding(Box::new(wheel.sliding()?)),
            ContactModel::Rolling if isotropic => {
                Follower::Ensemble(Ensemble::new(wheel)?.tolerance(CLASSIFICATION_TOLERANCE))
            }
            ContactModel::Rolling => Follower::Rolling,
        };
        Ok(Self { wheel: *wheel, model, target: Target::new(wheel)?, settings, follower })
    }

    /// The wheel.
    pub fn wheel(&self) -> &Wheel {
        &self.wheel
    }

    /// How motions are classified.
    pub fn settings(&self) -> ClassificationSettings {
        self.settings
    }

    /// Whether the wheel may slide.
    pub fn model(&self) -> ContactModel {
        self.model
    }

    /// Fates of the motions from states `(u, q, psi, V, Omega)` without slip.
    ///
    /// # Errors
    /// A motion that cannot be followed for another reason than that it grows without bound.
    pub fn of(&self, initial: &[[f64; 5]]) -> Result<Vec<Fate>, SimulationError> {
        let watch = |state: &[f64; 5]| Watch::new(&self.target, &self.settings, state);
        match &self.follower {
            Follower::Ensemble(ensemble) => {
                let slots: Vec<std::sync::Mutex<Watch>> =
                    initial.iter().map(|state| std::sync::Mutex::new(watch(state))).collect();
                let monitor = |trajectory: usize| {
                    let slot = &slots[trajectory];
                    move |progress: Progress<'_>| match slot.lock() {
                        Ok(mut watch) => watch.observe(progress.time, &progress.state()),
                        Err(_) => ControlFlow::Break(()),
                    }
                };
                let outcomes = ensemble.integrate_watched(initial, self.settings.duration, monitor)?;
                Ok(outcomes
                    .iter()
                    .zip(slots)
                    .map(|(outcome, slot)| match (outcome.ending, slot.into_inner()) {
                        (Ending::NotFinite, _) => Fate::Escape,
                        (_, Ok(watch)) => watch.fate(),
                        (_, Err(_)) => Fate::Undecided,
                    })
                    .collect())
            }
            Follower::Rolling => initial.iter().map(|state| self.of_rolling(state, watch(state))).collect(),
            Follower::Sliding(sliding) => initial
                .iter()
                .map(|state| {
                    let [u, q, psi, speed, yaw] = *state;
                    self.of_sliding(sliding, [u, q, psi, speed, 0.0, yaw, speed], watch(state))
                })
                .collect(),
        }
    }

    /// Fate of a motion from the seven states of the wheel that slides; without sliding only `V1` and `Omega` count.
    ///
    /// # Errors
    /// As [`of`](Self::of).
    pub fn of_sliding_state(&self, initial: &[f64; 7]) -> Result<Fate, SimulationError> {
        let [u, q, psi, speed, _, yaw, _] = *initial;
        match &self.follower {
            Follower::Sliding(sliding) => {
                let watch = Watch::new(&self.target, &self.settings, &[u, q, psi, speed, yaw]);
                self.of_sliding(sliding, *initial, watch)
            }
            _ => Ok(self.of(&[[u, q, psi, speed, yaw]])?.first().copied().unwrap_or(Fate::Undecided)),
        }
    }

    fn of_rolling(&self, initial: &[f64; 5], mut watch: Watch) -> Result<Fate, SimulationError> {
        let field = self.wheel.rolling(&[])?;
        let integrator = Integrator::with_tolerance(SIMULATION_TOLERANCE);
        let mut stepper =
            Stepper::new(autonomous(&field, &[]), &integrator, 0.0, initial, self.settings.duration)?;
        while !stepper.is_finished() {
            match stepper.advance() {
                Ok(()) => {}
                Err(error) => return unbounded_is_escape(error),
            }
            let state = std::array::from_fn(|i| stepper.state()[i]);
            if watch.observe(stepper.time(), &state).is_break() {
                break;
            }
        }
        Ok(watch.fate())
    }

    fn of_sliding(
        &self,
        sliding: &SlidingWheel,
        initial: [f64; 7],
        mut watch: Watch,
    ) -> Result<Fate, SimulationError> {
        let spacing = self.target.natural_period / SAMPLES_PER_PERIOD;
        let window = spacing * SAMPLES_PER_WINDOW as f64;
        let mut state = initial;
        let mut time = 0.0;
        while time < self.settings.duration {
            let history = match sliding.simulate_from(&state, window, SAMPLES_PER_WINDOW + 1) {
                Ok(history) => history,
                Err(SimulationError::Integration(error)) => return unbounded_is_escape(error),
                Err(error) => return Err(error),
            };
            for (&after, sample) in history.times.iter().zip(&history.states).skip(1) {
                let [u, q, psi, forward, lateral, yaw, _] = *sample;
                let speed = forward.hypot(lateral).copysign(forward);
                if watch.observe(time + after, &[u, q, psi, speed, yaw]).is_break() {
                    return Ok(watch.fate());
                }
                state = *sample;
            }
            time += window;
        }
        Ok(watch.fate())
    }
}

/// A motion that leaves the range of numbers has escaped.
fn unbounded_is_escape(error: IntegrationError) -> Result<Fate, SimulationError> {
    match error {
        IntegrationError::NotFinite { .. } | IntegrationError::StepTooSmall { .. } => Ok(Fate::Escape),
        other => Err(other.into()),
    }
}
