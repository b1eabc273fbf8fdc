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
/// Magnitudes that are tried between an edge and the one scanned magnitude below it: the basin is often torn just there.
const BESIDE_EDGE: usize = 32;
/// What the scan, and what then the first edge is of the whole time, roughly.
const PARTS: [f64; 2] = [0.5, 0.7];
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
    /// Distance of the magnitudes that are tried up to a largest one: failures in a narrower range may be missed.
    pub fn resolution(largest: f64) -> f64 {
        largest.abs() / SCAN as f64
    }

    /// Distance of the magnitudes that are tried next to an edge, up to the [resolution](Self::resolution) below it.
    pub fn resolution_beside_edge(largest: f64) -> f64 {
        Self::resolution(largest) / BESIDE_EDGE as f64
    }

    /// Finds the smallest disturbance up to `largest` from which the uniform motion does not return: the first
    /// failure among equidistant magnitudes, narrowed down by bisection; then the first among closer ones just below that, as long
    /// as there is one. `None` if there is no failure.
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
        let returned = |&fate: &Option<Fate>| fate == Some(Fate::UniformMotion);
        let scan = |magnitudes: Vec<f64>, control: &Control<'_>| -> Result<_, SimulationError> {
            let progress = control.count(magnitudes.len());
            let fates = magnitudes.par_iter().map(|&magnitude| {
                let fate = fate(magnitude)?;
                progress.advance(1);
                Ok(fate)
            });
            let fates = fates.collect::<Result<Vec<Option<Fate>>, SimulationError>>()?;
            let first = fates.iter().position(|fate| !returned(fate));
            Ok(first.map(|first| {
                // Where the uniform motion is unstable, the motion that is not disturbed at all tells nothing.
                let beyond = fates[first.max(usize::from(magnitudes[first] == 0.0))];
                (magnitudes[first.saturating_sub(1)], magnitudes[first], beyond)
            }))
        };
        let narrow = |(mut returns, mut fails, mut beyond): (f64, f64, Option<Fate>),
                      control: &Control<'_>| {
            let halvings = (SCAN as f64 * RESOLUTION).recip().log2().ceil() as usize;
            let progress = control.count(halvings);
            while (fails - returns).abs() > RESOLUTION * largest.abs() {
                let middle = 0.5 * (returns + fails);
                match fate(middle)? {
                    Some(Fate::UniformMotion) => returns = middle,
                    other => (fails, beyond) = (middle, other),
                }
                progress.advance(1);
            }
            Ok::<_, SimulationError>((returns, fails, beyond))
        };
        let [scanned, narrowed] = PARTS;
        let mut magnitudes: Vec<f64> =
            (0..=SCAN).map(|index| largest * (index as f64 / SCAN as f64)).collect();
        let undisturbed = disturbance.apply(wheel, model, 0.0)?.0;
        if !Destinations::new(&undisturbed, model, settings)?.attracts() {
            // Nothing returns; the smallest one tells where motions end.
            magnitudes.truncate(2);
        }
        let Some(first) = scan(magnitudes, &control.part(0.0..scanned))? else { return Ok(None) };
        let (mut returns, mut fails, mut beyond) = narrow(first, &control.part(scanned..narrowed))?;
        let beside = control.part(narrowed..1.0);
        // Each turn goes down by one of the closer steps at least.
        while returns != 0.0 {
            let lowest = returns - Self::resolution(largest).min(returns.abs()).copysign(largest);
            let part = |index: usize| lowest + (returns - lowest) * (index as f64 / BESIDE_EDGE as f64);
            let magnitudes = (0..BESIDE_EDGE).map(part).collect();
            let Some(lower) = scan(magnitudes, &beside)? else { break };
            let (mut below, failed, fate) = lower;
            if failed == lowest {
                // The nearest magnitude below it that is known to return is one of the first scan.
                let step = largest / SCAN as f64;
                below = step * ((lowest / step).ceil() - 1.0).max(0.0);
            }
            (returns, fails, beyond) = narrow((below, failed, fate), &control.quiet())?;
        }
        let (wheel, state) = disturbance.apply(wheel, model, fails)?;
        Ok(Some(Self { returns, fails, fate: beyond, wheel, state }))
    }
}
