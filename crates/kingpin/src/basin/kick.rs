//! The smallest disturbance from which the wheel does not return.

use super::{ClassificationSettings, ContactModel, Destinations, Fate};
use crate::error::KingpinError;
use crate::parallel;
use crate::parameters::{Key, Tyre};
use crate::simulation::{SimulationError, TimeHistory};
use crate::swinging::LYING_ACROSS;
use crate::wheel::Wheel;
use arclength::control::Control;

/// Magnitudes that are tried, at equal distances, up to the largest one and then again up to the edge that was found.
const SCAN: usize = 64;
/// Magnitudes that are tried between an edge and the nearest one below it: the basin is often torn just there.
const BESIDE_EDGE: usize = 32;
/// Parts of the largest magnitude that are followed beforehand to become acquainted with shimmy.
const SCOUTS: [f64; 2] = [0.5, 1.0];
/// When the scouts, the scan and the first edge are done, as parts of the whole time, roughly.
const PARTS: [f64; 3] = [0.1, 0.5, 0.7];
/// The edge is narrowed down to this part of it.
const RESOLUTION: f64 = 1e-6;
const HALVINGS: usize = 20;
/// To this one where what is beyond is undecided: there the patience ends, at each of many long motions, and no basin.
const END_OF_PATIENCE: f64 = 1e-2;
/// Where nothing down to this part of the largest magnitude returns, nothing does.
const SMALLEST: f64 = 1e-9;
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

    /// Number of its directions: that of a step of the curvature does not matter, the other one is the mirror image.
    pub const fn directions(self) -> usize {
        if matches!(self, Disturbance::StepSteer) { 1 } else { 2 }
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
                ContactModel::Rolling if wheel.tyre() != Tyre::Rigid => wheel
                    .simulate_with_tyre_from(&state, duration, samples, control)
                    .map(|history| DisturbedMotion {
                        times: history.times,
                        states: history.states,
                        model_ends_at: history.stopped_at,
                    }),
                ContactModel::Rolling => wheel
                    .simulate_from(&[u, q, psi, speed, yaw], duration, samples, control)
                    .map(|history| DisturbedMotion::rolling(&wheel, history)),
                ContactModel::Sliding => {
                    wheel.sliding()?.simulate_from(&state, duration, samples, control).map(|history| {
                        DisturbedMotion { times: history.times, states: history.states, model_ends_at: None }
                    })
                }
            };
            match motion {
                Err(SimulationError::Integration(_)) => duration *= 0.5,
                other => return other,
            }
        }
        Ok(DisturbedMotion { times: vec![0.0], states: vec![state], model_ends_at: None })
    }

    /// The wheel after the disturbance and its state (u, q, psi, V1, V2, Omega, W), with a tyre (u, q, psi, V1, V2, Omega, y_t). Of the states
    /// those that are not [free](Wheel::free_states) follow from the others.
    ///
    /// # Errors
    /// A magnitude at which there is no uniform motion.
    pub fn apply(
        self,
        wheel: &Wheel,
        model: ContactModel,
        magnitude: f64,
    ) -> Result<(Wheel, [f64; 7]), SimulationError> {
        let start = |wheel: &Wheel| {
            let motion = wheel.uniform_motion()?;
            let [u, q, psi, speed, yaw] = motion.state();
            let rolling = [u, q, psi, speed, 0.0, yaw, speed];
            Ok::<_, SimulationError>(motion.tyre_state().unwrap_or(rolling))
        };
        let (wheel, state) = match self {
            Disturbance::Impulse => {
                let mut state = start(wheel)?;
                let [lateral, yaw] = wheel.velocity_change(magnitude, model)?;
                state[4] += lateral;
                state[5] += yaw;
                (*wheel, state)
            }
            Disturbance::ReleaseAngle => {
                let mut state = start(wheel)?;
                state[2] += magnitude;
                (*wheel, state)
            }
            Disturbance::Jolt => (*wheel, start(&wheel.with(Key::V, wheel.get(Key::V) - magnitude)?)?),
            Disturbance::StepSteer => {
                let state = start(&wheel.with(Key::Curvature, 0.0)?)?;
                (wheel.with(Key::Curvature, magnitude)?, state)
            }
        };
        match model {
            ContactModel::Rolling => Ok((wheel, wheel.with_states_that_follow(state)?)),
            ContactModel::Sliding => Ok((wheel, state)),
        }
    }
}

impl Wheel {
    /// A state of the rolling wheel as [`Disturbance::apply`] gives it, in which the states that are not free are those that follow
    /// from the free ones: with `k_u = inf` the speed changes with the angle and the yaw rate.
    fn with_states_that_follow(&self, state: [f64; 7]) -> Result<[f64; 7], KingpinError> {
        let model = self.rolling_model(&[])?;
        let [u, q, psi, speed, _, yaw, _] = state;
        let all = if self.tyre() == Tyre::Rigid { vec![u, q, psi, speed, yaw] } else { state.to_vec() };
        let all = model.full_state(&model.free_state(&all), &[]);
        Ok(match all[..] {
            [u, q, psi, speed, yaw] => [u, q, psi, speed, 0.0, yaw, speed],
            _ => std::array::from_fn(|index| all[index]),
        })
    }

    /// What a sideways blow in N s on the rim of the wheel, `R` ahead of its centre, changes `V2` (m/s) and `Omega` (rad/s) of the uniform
    /// motion by. In ideal rolling the ground takes the sideways momentum, and the support what it is rigid against; a wheel that may
    /// slide, or that has a tyre, moves sideways as far as its king pin lets it.
    ///
    /// # Errors
    /// No uniform motion.
    pub fn velocity_change(&self, blow: f64, model: ContactModel) -> Result<[f64; 2], KingpinError> {
        let body = self.body();
        let mass = self.mass();
        // Ahead is along +e1; the yaw rate counts from e2 to e1.
        let moment = blow * self.get(Key::WheelRadius);
        let motion = self.uniform_motion()?;
        let (sine, cosine) = motion.psi().sin_cos();
        let lateral_only = self.has_lateral_elasticity_only();
        if model == ContactModel::Rolling && self.tyre() == Tyre::Rigid {
            if lateral_only {
                // The forward speed follows the yaw rate, V cos psi = v - omega q - l Omega sin psi.
                let arm = body.caster_length * sine / cosine;
                return Ok([0.0, moment / (body.yaw_inertia + body.rolling_mass * arm * arm)]);
            }
            return Ok([0.0, moment * body.inverse_yaw_inertia]);
        }
        if !lateral_only && self.get(Key::KQ).is_finite() {
            let determinant = mass * body.yaw_inertia - body.static_moment.powi(2);
            return Ok([
                (body.yaw_inertia * blow - body.static_moment * moment) / determinant,
                (mass * moment - body.static_moment * blow) / determinant,
            ]);
        }
        // About the king pin, which moves in the direction that is left to it.
        let length = body.caster_length;
        let about_king_pin = body.yaw_inertia + (mass * length - 2.0 * body.static_moment) * length;
        let turned = moment - blow * length;
        let [along, across] = match (lateral_only, self.get(Key::KQ).is_finite()) {
            (true, true) => [-sine, cosine],
            (false, _) => [cosine, sine],
            (true, false) => {
                let yaw = turned / about_king_pin;
                return Ok([-length * yaw, yaw]);
            }
        };
        let moved = along * along * body.rolling_mass + across * across * mass;
        let coupling = across * (mass * length - body.static_moment);
        let determinant = moved * about_king_pin - coupling * coupling;
        let speed = (across * blow * about_king_pin + coupling * turned) / determinant;
        let yaw = (moved * turned + coupling * across * blow) / determinant;
        Ok([across * speed - length * yaw, yaw])
    }
}

/// A motion after a disturbance.
#[derive(Clone, Debug, PartialEq)]
pub struct DisturbedMotion {
    /// Times in s.
    pub times: Vec<f64>,
    /// States (u, q, psi, V1, V2, Omega, W), with a tyre (u, q, psi, V1, V2, Omega, y_t), one for each time.
    pub states: Vec<[f64; 7]>,
    /// Time in s at which the model ends: with a tyre where `V1` falls to zero, which ends the motion; with `k_u = inf` the first sample at
    /// which the caster lies across.
    pub model_ends_at: Option<f64>,
}

impl DisturbedMotion {
    /// Of a wheel without a tyre, which does not slide.
    fn rolling(wheel: &Wheel, history: TimeHistory) -> Self {
        let lies_across = |&(_, state): &(&f64, &[f64; 5])| state[2].cos().abs() < LYING_ACROSS;
        let mut samples = history.times.iter().zip(&history.states);
        let across = samples.find(lies_across).map(|(time, _)| *time);
        let widen = |&[u, q, psi, speed, yaw]: &[f64; 5]| [u, q, psi, speed, 0.0, yaw, speed];
        Self {
            states: history.states.iter().map(widen).collect(),
            times: history.times,
            model_ends_at: across.filter(|_| wheel.has_lateral_elasticity_only()),
        }
    }
}

/// Why a scan of magnitudes ends before the last.
enum Scan {
    /// At this one, by its index, it does not return.
    Loses(usize, Option<Fate>),
    Fails(SimulationError),
}

/// The edge of what the wheel returns from.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SafeKick {
    /// Largest magnitude, below the first failure, from which it was seen to return; 0 where it is not known whether small motions die out
    /// ([`Destinations::attracts`]), so that smaller ones are undecided.
    pub returns: f64,
    /// Smallest magnitude, next to that, from which it does not; both are 0 where the uniform motion is unstable, and the fate is
    /// that of a small disturbance. Where it is stable and yet nothing down to a billionth of the largest magnitude returns, as where slip
    /// grows that is however small, `returns` is 0 and this is the smallest that was tried.
    pub fails: f64,
    /// What becomes of it from there. [`Fate::Undecided`] where it did none of the other things in the time that it was
    /// followed: then this is only where the patience ends and no edge. `None` where there is no uniform motion (that rolls)
    /// to return to after a step of the curvature.
    pub fate: Option<Fate>,
    /// Whether it is not known of smaller magnitudes whether they return: see [`Destinations::attracts`]. Where none was found that ends
    /// elsewhere, `fails` is the largest that was tried and the fate is [`Fate::Undecided`].
    pub smaller_are_undecided: bool,
    /// The wheel after the disturbance that fails: at the edge its motion lingers where the basin ends.
    pub wheel: Wheel,
    /// State after the disturbance that fails, as that of [`Disturbance::apply`].
    pub state: [f64; 7],
}

impl SafeKick {
    /// Distance of the magnitudes that are tried up to an edge, or to the largest one where there is no edge: failures in a narrower
    /// range may be missed.
    pub fn resolution(reached: f64) -> f64 {
        reached.abs() / SCAN as f64
    }

    /// Distance of the magnitudes that are tried next to an edge, up to the [resolution](Self::resolution) below it.
    pub fn resolution_beside_edge(edge: f64) -> f64 {
        Self::resolution(edge) / BESIDE_EDGE as f64
    }

    /// Finds the smallest disturbance up to `largest` from which the uniform motion does not return: the first
    /// failure among equidistant magnitudes, narrowed down by bisection; then the first among closer ones up to that, and still closer
    /// ones just below it, as long as there is one. `None` if there is no failure.
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
        let undisturbed = disturbance.apply(wheel, model, 0.0)?.0;
        let mut destinations = Destinations::new(&undisturbed, model, settings)?;
        let steers = disturbance == Disturbance::StepSteer;
        let [scouted, scanned, narrowed] = PARTS;
        let attracts = destinations.attracts();
        if attracts != Some(false) && !steers {
            // The strongest ones show the shimmy that others end in.
            let scouts = SCOUTS.map(|part| Ok(disturbance.apply(wheel, model, part * largest)?.1));
            let scouts = scouts.into_iter().collect::<Result<Vec<_>, SimulationError>>()?;
            destinations = destinations.acquainted(&scouts, &control.part(0.0..scouted))?;
        }
        let fate = |magnitude: f64| -> Result<Option<Fate>, SimulationError> {
            let (wheel, state) = disturbance.apply(wheel, model, magnitude)?;
            if !steers {
                return destinations.of_disturbed(&state, &control.quiet()).map(Some);
            }
            match Destinations::new(&wheel, model, settings) {
                Ok(destinations) => destinations.of_disturbed(&state, &control.quiet()).map(Some),
                Err(
                    SimulationError::UniformMotionSlides { .. }
                    | SimulationError::Wheel(KingpinError::NoUniformMotion { .. }),
                ) if magnitude != 0.0 => Ok(None),
                Err(error) => Err(error),
            }
        };
        if attracts == Some(false) {
            // Nothing returns; a small one tells where motions end.
            let (wheel, state) = disturbance.apply(wheel, model, 0.0)?;
            let beyond = fate(Self::resolution(largest).copysign(largest))?;
            return Ok(Some(Self {
                returns: 0.0,
                fails: 0.0,
                fate: beyond,
                smaller_are_undecided: false,
                wheel,
                state,
            }));
        }
        // Where nothing is known to return, the first is sought that ends elsewhere.
        let returned = |&fate: &Option<Fate>| match attracts {
            Some(_) => fate == Some(Fate::UniformMotion),
            None => fate.is_some_and(|fate| fate == Fate::UniformMotion || fate.is_undecided()),
        };
        // What is larger than the first that does not return does not matter, and may take long.
        let scan = |magnitudes: Vec<f64>, control: &Control<'_>| -> Result<_, SimulationError> {
            let progress = control.count(magnitudes.len());
            let until_one_is_lost = |index: usize| {
                let fate = fate(magnitudes[index]).map_err(Scan::Fails)?;
                progress.advance(1);
                if returned(&fate) { Ok(()) } else { Err(Scan::Loses(index, fate)) }
            };
            match parallel::try_map_indices(magnitudes.len(), until_one_is_lost) {
                Ok(_) => Ok(None),
                Err(Scan::Loses(first, fate)) => {
                    let below = first.checked_sub(1).map_or(0.0, |index| magnitudes[index]);
                    Ok(Some((below, magnitudes[first], fate)))
                }
                Err(Scan::Fails(error)) => Err(error),
            }
        };
        let narrow = |(mut returns, mut fails, mut beyond): (f64, f64, Option<Fate>),
                      control: &Control<'_>| {
            let unresolved = |returns: f64, fails: f64, beyond: Option<Fate>| {
                let is_edge = beyond.is_none_or(|fate| fate != Fate::Undecided);
                let resolution = if is_edge { RESOLUTION } else { END_OF_PATIENCE };
                (fails - returns).abs() > resolution * fails.abs() && fails.abs() > SMALLEST * largest.abs()
            };
            // About as often as the distance has to be halved to the resolution.
            let progress = control.count(HALVINGS);
            while unresolved(returns, fails, beyond) {
                progress.advance(1);
                let middle = 0.5 * (returns + fails);
                let found = fate(middle)?;
                if returned(&found) {
                    returns = middle
                } else {
                    (fails, beyond) = (middle, found)
                }
                control.check()?;
            }
            Ok::<_, SimulationError>((returns, fails, beyond))
        };
        let magnitudes = (0..=SCAN).map(|index| largest * (index as f64 / SCAN as f64)).collect();
        let Some(first) = scan(magnitudes, &control.part(scouted..scanned))? else {
            if attracts.is_some() {
                return Ok(None);
            }
            // None was found that ends elsewhere, which is not to say that they return.
            let (wheel, state) = disturbance.apply(wheel, model, largest)?;
            return Ok(Some(Self {
                returns: 0.0,
                fails: largest,
                fate: Some(Fate::Undecided),
                smaller_are_undecided: true,
                wheel,
                state,
            }));
        };
        let (mut returns, mut fails, mut beyond) = narrow(first, &control.part(scanned..narrowed))?;
        let finer = control.part(narrowed..1.0);
        // Each turn goes down by one of the closest steps at least.
        while returns != 0.0 {
            let step = returns / SCAN as f64;
            let up_to_edge = (1..SCAN).map(|index| step * index as f64);
            let beside = |index: usize| returns - step * (1.0 - index as f64 / BESIDE_EDGE as f64);
            let magnitudes = up_to_edge.chain((1..BESIDE_EDGE).map(beside)).collect();
            let Some(lower) = scan(magnitudes, &finer)? else { break };
            (returns, fails, beyond) = narrow(lower, &control.quiet())?;
        }
        let (wheel, state) = disturbance.apply(wheel, model, fails)?;
        let returns = if attracts.is_some() { returns } else { 0.0 };
        Ok(Some(Self {
            returns,
            fails,
            fate: beyond,
            smaller_are_undecided: attracts.is_none(),
            wheel,
            state,
        }))
    }
}
