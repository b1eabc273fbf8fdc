//! The smallest disturbance from which the wheel does not return.

use super::{ClassificationSettings, ContactModel, Destinations, Fate};
use crate::error::KingpinError;
use crate::parameters::Key;
use crate::simulation::SimulationError;
use crate::wheel::Wheel;
use arclength::control::Control;
use rayon::prelude::*;

/// Magnitudes that are tried, at equal distances, before the first failure is narrowed down.
const SCAN: usize = 64;
/// What that is of the whole time, roughly.
const PART_OF_SCAN: f64 = 0.7;
/// The magnitude is narrowed down to this, relative to the largest one.
const RESOLUTION: f64 = 1e-6;
/// How often the duration of a history is halved where the motion leaves the range of numbers.
const SHORTENINGS: usize = 20;

/// A kind of disturbance of the uniform motion. Magnitudes may be negative: the other direction.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Disturbance {
    /// A sideways blow of so many N s across the caster, on the rim of the wheel, `R` ahead of its centre. In ideal rolling the ground
    /// takes the sideways momentum and the moment turns the caster; a wheel that may slide also moves sideways.
    Impulse,
    /// The caster is released at an angle of so many rad from the uniform motion, not turning in the towing frame.
    ReleaseAngle,
    /// The towing speed rises by so many m/s at once, to that of the wheel.
    Jolt,
    /// From straight towing the curvature of the path becomes so many 1/m at once, in place of that of the wheel.
    StepSteer,
}

impl Disturbance {
    /// All kinds.
    pub const ALL: [Disturbance; 4] =
        [Disturbance::Impulse, Disturbance::ReleaseAngle, Disturbance::Jolt, Disturbance::StepSteer];

    /// Name as it is written in options and results.
    pub const fn name(self) -> &'static str {
        match self {
            Disturbance::Impulse => "impulse",
            Disturbance::ReleaseAngle => "release-angle",
            Disturbance::Jolt => "jolt",
            Disturbance::StepSteer => "step-steer",
        }
    }

    /// Unit of the magnitude.
    pub const fn unit(self) -> &'static str {
        match self {
            Disturbance::Impulse => "N s",
            Disturbance::ReleaseAngle => "rad",
            Disturbance::Jolt => "m/s",
            Disturbance::StepSteer => "1/m",
        }
    }

    /// The motion after the disturbance for `duration`, or as much of it as can be followed, sampled at equal intervals.
    ///
    /// # Errors
    /// As [`apply`](Self::apply), and what the simulations refuse.
    pub fn history(
        self,
        wheel: &Wheel,
        model: ContactModel,
        magnitude: f64,
        duration: f64,
        samples: usize,
        control: &Control<'_>,
    ) -> Result<DisturbedMotion, SimulationError> {
        let (wheel, state) = self.apply(wheel, model, magnitude)?;
        let [u, q, psi, speed, _, yaw, _] = state;
        let mut duration = duration;
        for _ in 0..SHORTENINGS {
            let motion = match model {
                ContactModel::Rolling => {
                    wheel.simulate_from(&[u, q, psi, speed, yaw], duration, samples, control).map(|history| {
                        let widen = |&[u, q, psi, speed, yaw]: &[f64; 5]| [u, q, psi, speed, 0.0, yaw, speed];
                        let states = history.states.iter().map(widen).collect();
                        DisturbedMotion { times: history.times, states }
                    })
                }
                ContactModel::Sliding => wheel
                    .sliding()?
                    .simulate_from(&state, duration, samples, control)
                    .map(|history| DisturbedMotion { times: history.times, states: history.states }),
            };
            match motion {
                Err(SimulationError::Integration(_)) => duration *= 0.5,
                other => return other,
            }
        }
        Ok(DisturbedMotion { times: vec![0.0], states: vec![state] })
    }

    /// The wheel after the disturbance and its state (u, q, psi, V1, V2, Omega, W).
    ///
    /// # Errors
    /// A magnitude at which there is no uniform motion, or `k_u = inf`.
    pub fn apply(
        self,
        wheel: &Wheel,
        model: ContactModel,
        magnitude: f64,
    ) -> Result<(Wheel, [f64; 7]), SimulationError> {
        wheel.check_elastic()?;
        let rolling = |[u, q, psi, speed, yaw]: [f64; 5]| [u, q, psi, speed, 0.0, yaw, speed];
        let start = |wheel: &Wheel| Ok::<_, SimulationError>(rolling(wheel.uniform_motion()?.state()));
        match self {
            Disturbance::Impulse => {
                let mut state = start(wheel)?;
                let body = wheel.body();
                let mass = wheel.get(Key::MW) + wheel.get(Key::MC);
                // Ahead is along +e1; the yaw rate counts from e2 to e1.
                let moment = magnitude * wheel.get(Key::WheelRadius);
                match model {
                    ContactModel::Rolling => state[5] += moment * body.inverse_yaw_inertia,
                    ContactModel::Sliding => {
                        let determinant = mass * body.yaw_inertia - body.static_moment.powi(2);
                        state[4] +=
                            (body.yaw_inertia * magnitude - body.static_moment * moment) / determinant;
                        state[5] += (mass * moment - body.static_moment * magnitude) / determinant;
                    }
                }
                Ok((*wheel, state))
            }
            Disturbance::ReleaseAngle => {
                let mut state = start(wheel)?;
                state[2] += magnitude;
                Ok((*wheel, state))
            }
            Disturbance::Jolt => Ok((*wheel, start(&wheel.with(Key::V, wheel.get(Key::V) - magnitude)?)?)),
            Disturbance::StepSteer => {
                let state = start(&wheel.with(Key::Curvature, 0.0)?)?;
                Ok((wheel.with(Key::Curvature, magnitude)?, state))
            }
        }
    }
}

/// A motion after a disturbance.
#[derive(Clone, Debug, PartialEq)]
pub struct DisturbedMotion {
    /// Times in s.
    pub times: Vec<f64>,
    /// States (u, q, psi, V1, V2, Omega, W), one for each time.
    pub states: Vec<[f64; 7]>,
}

/// The edge of what the wheel returns from.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SafeKick {
    /// Largest magnitude, below the first failure, from which it was seen to return.
    pub returns: f64,
    /// Smallest magnitude, next to that, from which it does not; both are 0 where the uniform motion is unstable, and the fate is
    /// that of a small disturbance.
    pub fails: f64,
    /// What becomes of it from there. [`Fate::Undecided`] where it did none of the other things in the time that it was
    /// followed: then this is only where the patience ends and no edge. `None` where there is no uniform motion (that rolls)
    /// to return to after a step of the curvature.
    pub fate: Option<Fate>,
    /// The wheel after the disturbance that fails: at the edge its motion lingers where the basin ends.
    pub wheel: Wheel,
    /// State (u, q, psi, V1, V2, Omega, W) after the disturbance that fails.
    pub state: [f64; 7],
}

impl SafeKick {
    /// Finds the smallest disturbance up to `largest` from which the uniform motion does not return: the first
    /// failure among equidistant magnitudes, narrowed down by bisection. `None` if there is no failure.
    ///
    /// Not to have returned in the time that motions are followed counts as failure; near the edge of a basin they linger, and
    /// the fate at the edge tells whether that time was too short.
    ///
    /// # Errors
    /// A largest magnitude that is zero or not finite, or a magnitude on the way at which there is no uniform motion;
    /// [`SimulationError::Interrupted`].
    pub fn find(
        wheel: &Wheel,
        model: ContactModel,
        settings: ClassificationSettings,
        disturbance: Disturbance,
        largest: f64,
        control: &Control<'_>,
    ) -> Result<Option<Self>, SimulationError> {
        if !largest.is_finite() || largest == 0.0 {
            return Err(SimulationError::out_of_range("largest disturbance", largest, "finite and not 0"));
        }
        let fate = |magnitude: f64| -> Result<Option<Fate>, SimulationError> {
            let (wheel, state) = disturbance.apply(wheel, model, magnitude)?;
            match Destinations::new(&wheel, model, settings) {
                Ok(destinations) => destinations.of_sliding_state(&state, &control.quiet()).map(Some),
                Err(error) if disturbance == Disturbance::StepSteer && magnitude != 0.0 => match error {
                    SimulationError::UniformMotionSlides { .. }
                    | SimulationError::Wheel(KingpinError::NoUniformMotion { .. }) => Ok(None),
                    error => Err(error),
                },
                Err(error) => Err(error),
            }
        };
        let magnitude = |index: usize| largest * (index as f64 / SCAN as f64);
        let progress = control.part(0.0..PART_OF_SCAN).count(SCAN + 1);
        let scanned: Vec<Option<Fate>> = (0..=SCAN)
            .into_par_iter()
            .map(|index| {
                let fate = fate(magnitude(index))?;
                progress.advance(1);
                Ok(fate)
            })
            .collect::<Result<_, SimulationError>>()?;
        let Some(first) = scanned.iter().position(|&fate| fate != Some(Fate::UniformMotion)) else {
            return Ok(None);
        };
        let (mut returns, mut fails) = (magnitude(first.saturating_sub(1)), magnitude(first));
        // Where the uniform motion is unstable, the motion that is not disturbed at all tells nothing.
        let mut beyond = scanned[first.max(1)];
        let halvings = (SCAN as f64 * RESOLUTION).recip().log2().ceil() as usize;
        let progress = control.part(PART_OF_SCAN..1.0).count(halvings);
        while (fails - returns).abs() > RESOLUTION * largest.abs() {
            let middle = 0.5 * (returns + fails);
            match fate(middle)? {
                Some(Fate::UniformMotion) => returns = middle,
                other => (fails, beyond) = (middle, other),
            }
            progress.advance(1);
        }
        let (wheel, state) = disturbance.apply(wheel, model, fails)?;
        Ok(Some(Self { returns, fails, fate: beyond, wheel, state }))
    }
}
