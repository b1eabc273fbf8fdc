//! Basins of attraction: where a motion ends, depending on where it starts.
//!
//! [`Destinations`] follows motions of one wheel, rolling ideally or with sliding, and tells their [`Fate`]. No fate is guessed:
//! a motion that keeps its amplitude, as near an unstable cycle, is followed on until it leaves, and is shimmy only if it
//! comes back after a push; what cannot be told in the end is undecided.
//! [`BasinMap`] does so for grids and random samples of initial states in tiles that can be computed apart, stopped and
//! resumed; [`SafeKick`] finds the smallest disturbance from which the wheel does not return.

mod attractor;
mod contact_model;
mod course;
#[cfg(test)]
mod dry_friction_tests;
mod fate;
mod kick;
mod lasting;
mod map;
mod maxima;
mod pushed;
#[cfg(test)]
mod tests;

pub use contact_model::ContactModel;
pub use fate::{ClassificationSettings, Fate};
pub use kick::{Disturbance, DisturbedMotion, SafeKick};
pub use map::{Axis, BasinMap, Fraction, Tile, wilson_interval};

use crate::ensemble::{Ending, Ensemble, Outcome, Progress};
use crate::parallel;
use crate::parameters::{Key, Tyre};
use crate::simulation::SimulationError;
use crate::sliding::SlidingWheel;
use crate::swinging::SwingingWheel;
use crate::wheel::Wheel;
use arclength::control::Control;
use attractor::Attractor;
use course::Course;
use fate::{PATIENCE, Target, Watch};
use lasting::{BRIEF, Lasting, Seen, THOROUGH};
use std::ops::ControlFlow;
use std::sync::{Mutex, PoisonError};

/// Tolerance of the integration of motions that are only classified, ...
const CLASSIFICATION_TOLERANCE: f64 = 1e-10;
/// ... and of those that slide.
const SLIDING_CLASSIFICATION_TOLERANCE: f64 = 1e-9;
/// Slip speeds in m/s from which on, and down to which, the slip of motions that are only classified is followed: beyond them it
/// keeps to its limit direction, with errors of second order in the one and of first order in the other.
const ONSET_SLIP: f64 = 1e-4;
const VANISHING_SLIP: f64 = 1e-7;

/// Tells where motions of one wheel end.
///
/// ```
/// use arclength::control::Control;
/// use kingpin::{Wheel, basin::{ContactModel, ClassificationSettings, Destinations, Fate}};
///
/// let wheel = Wheel::default();
/// let near = wheel.perturbed_uniform_motion(&[("psi", 0.1)])?;
/// let far = wheel.perturbed_uniform_motion(&[("Omega", 80.0)])?;
/// let destinations = Destinations::new(&wheel, ContactModel::Rolling, ClassificationSettings::default())?;
/// let fates = destinations.of(&[near, far], &Control::none())?;
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
    /// Shimmy that is known.
    attractors: Vec<Attractor>,
}

#[derive(Clone, Debug)]
enum Follower {
    /// The quadratic form, many at once.
    Ensemble(Ensemble),
    /// Rolling wheels that have no quadratic form.
    Rolling,
    /// Wheels that may slide, or whose caster swings and sticks.
    Hybrid(Box<SlidingWheel>),
    /// Wheels with a tyre, or with lateral elasticity only.
    Swinging(Box<SwingingWheel>),
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
        let motion = wheel.uniform_motion()?;
        let isotropic = wheel.get(Key::KU) == wheel.get(Key::KQ) && wheel.get(Key::CU) == wheel.get(Key::CQ);
        let follower = match model {
            ContactModel::Sliding => Follower::Hybrid(Box::new(
                wheel
                    .sliding()?
                    .slips(ONSET_SLIP, VANISHING_SLIP)
                    .tolerance(SLIDING_CLASSIFICATION_TOLERANCE),
            )),
            ContactModel::Rolling if wheel.tyre() != Tyre::Rigid || wheel.has_lateral_elasticity_only() => {
                Follower::Swinging(Box::new(wheel.swinging(CLASSIFICATION_TOLERANCE)?))
            }
            ContactModel::Rolling if wheel.get(Key::MF) > 0.0 => {
                Follower::Hybrid(Box::new(wheel.always_rolling()?.tolerance(CLASSIFICATION_TOLERANCE)))
            }
            ContactModel::Rolling if isotropic => {
                Follower::Ensemble(Ensemble::new(wheel)?.tolerance(CLASSIFICATION_TOLERANCE))
            }
            ContactModel::Rolling => Follower::Rolling,
        };
        // What a wheel whose sliding is not computed would need does not matter.
        if model == ContactModel::Sliding && !motion.rolls() {
            return Err(SimulationError::UniformMotionSlides {
                needed: motion.contact_force().friction(),
                available: wheel.get(Key::MuS) * wheel.normal_force(),
            });
        }
        let target = Target::new(wheel, model)?;
        Ok(Self { wheel: *wheel, model, target, settings, follower, attractors: Vec::new() })
    }

    /// The wheel.
    pub fn wheel(&self) -> &Wheel {
        &self.wheel
    }

    /// How motions are classified.
    pub fn settings(&self) -> ClassificationSettings {
        self.settings
    }

    /// Whether small motions die out: without dry friction about the king pin by the eigenvalues, with it by the factor of a swing, with a
    /// tyre besides always. Nothing where that is not known: on a circle, where they grow without dry friction.
    pub fn attracts(&self) -> Option<bool> {
        self.target.attracts()
    }

    /// Whether the wheel may slide.
    pub fn model(&self) -> ContactModel {
        self.model
    }

    /// Fates of the motions from states `(u, q, psi, V, Omega)` without slip; with a tyre the others are those of the uniform motion.
    ///
    /// # Errors
    /// A motion that cannot be followed for another reason than that it grows without bound;
    /// [`SimulationError::Interrupted`].
    pub fn of(&self, initial: &[[f64; 5]], control: &Control<'_>) -> Result<Vec<Fate>, SimulationError> {
        match &self.follower {
            Follower::Swinging(_) => {
                let all = |state: &[f64; 5]| self.of_disturbed(&self.disturbed_state(state), control);
                parallel::try_map(initial, all)
            }
            Follower::Ensemble(ensemble) => self.of_ensemble(ensemble, initial, control),
            Follower::Rolling => {
                let fate = |state: &[f64; 5]| self.of_course(Course::rolling(&self.wheel, *state)?, control);
                parallel::try_map(initial, fate)
            }
            Follower::Hybrid(sliding) => {
                let fate = |state: &[f64; 5]| {
                    self.of_course(Course::hybrid(sliding, sliding.rolling_state(state)), control)
                };
                parallel::try_map(initial, fate)
            }
        }
    }

    /// The seven states `(u, q, psi, V1, V2, Omega, W)`, with a tyre `(u, q, psi, V1, V2, Omega, y_t)`, of a wheel without slip, with a
    /// tyre with the lateral speed and the deflection of the uniform motion, from `(u, q, psi, V, Omega)`.
    pub fn disturbed_state(&self, &[u, q, psi, speed, yaw]: &[f64; 5]) -> [f64; 7] {
        match *self.target.states() {
            [_, _, _, _, lateral, _, deflection] => [u, q, psi, speed, lateral, yaw, deflection],
            _ => [u, q, psi, speed, 0.0, yaw, speed],
        }
    }

    /// States `(u, q, psi, V1, V2, Omega, W or y_t)` whose rim has the speed of the wheel where there is no tyre.
    fn without_slip(&self, mut states: [f64; 7]) -> [f64; 7] {
        if self.wheel.tyre() == Tyre::Rigid {
            states[6] = states[3];
        }
        states
    }

    /// Whether many motions are followed side by side.
    fn follows_many_at_once(&self) -> bool {
        matches!(self.follower, Follower::Ensemble(_))
    }

    /// Fates of motions from the states after disturbances.
    fn of_all(&self, initial: &[[f64; 7]], control: &Control<'_>) -> Result<Vec<Fate>, SimulationError> {
        if let Follower::Ensemble(ensemble) = &self.follower {
            let reduced = |&[u, q, psi, speed, _, yaw, _]: &[f64; 7]| [u, q, psi, speed, yaw];
            return self.of_ensemble(ensemble, &initial.iter().map(reduced).collect::<Vec<_>>(), control);
        }
        parallel::try_map(initial, |state| self.of_disturbed(state, control))
    }

    /// Fate of a motion from the states after a [`Disturbance`]: the seven of the wheel that slides, of which without sliding only `V1`
    /// and `Omega` count, or those of the wheel with a tyre.
    ///
    /// # Errors
    /// As [`of`](Self::of).
    pub fn of_disturbed(&self, initial: &[f64; 7], control: &Control<'_>) -> Result<Fate, SimulationError> {
        match &self.follower {
            Follower::Swinging(wheel) => self.of_course(self.swinging_course(wheel, initial), control),
            Follower::Hybrid(sliding) => {
                self.of_course(Course::hybrid(sliding, sliding.slipping_state(initial)), control)
            }
            _ => {
                let [u, q, psi, speed, _, yaw, _] = *initial;
                Ok(self.of(&[[u, q, psi, speed, yaw]], control)?.first().copied().unwrap_or(Fate::Undecided))
            }
        }
    }

    /// The motion of a wheel with a tyre, or with lateral elasticity only, from the states after a disturbance.
    fn swinging_course<'a>(&self, wheel: &'a SwingingWheel, initial: &[f64; 7]) -> Course<'a> {
        let [u, q, psi, speed, _, yaw, _] = *initial;
        match self.wheel.tyre() {
            Tyre::Rigid => Course::swinging(wheel, &[u, q, psi, speed, yaw]),
            _ => Course::swinging(wheel, initial),
        }
    }

    /// The same, acquainted with the shimmy that motions from some states after a disturbance settle on: others that
    /// come as near to it as one was pushed from which it came back need not be followed any longer.
    ///
    /// # Errors
    /// As [`of`](Self::of).
    pub fn acquainted(mut self, starts: &[[f64; 7]], control: &Control<'_>) -> Result<Self, SimulationError> {
        let progress = control.count(starts.len());
        let control = &control.quiet();
        let patience = self.settings.duration;
        let settled = |state: &[f64; 7]| -> Result<Option<(Attractor, Course<'_>)>, SimulationError> {
            let [u, q, psi, speed, _, yaw, _] = *state;
            let course = match &self.follower {
                Follower::Hybrid(sliding) => Course::hybrid(sliding, sliding.slipping_state(state)),
                Follower::Rolling => Course::rolling(&self.wheel, [u, q, psi, speed, yaw])?,
                Follower::Swinging(wheel) => self.swinging_course(wheel, state),
                // Many at once are as fast without.
                Follower::Ensemble(_) => return Ok(None),
            };
            let watch = Watch::new(&self.target, &self.settings, &course.state());
            let mut lasting = Lasting::new(course, 0.0, &[]);
            lasting.until_the_end(&self.target, watch, control)?;
            progress.advance(1);
            Ok(lasting.found())
        };
        let settled = parallel::try_map(starts, settled)?;
        let mut distinct: Vec<(Attractor, Course<'_>)> = Vec::new();
        for (attractor, course) in settled.into_iter().flatten() {
            if !distinct.iter().any(|(known, _)| attractor.is(known, &self.target)) {
                distinct.push((attractor, course));
            }
        }
        parallel::try_change(&mut distinct, |(attractor, course)| {
            attractor.explore(course, patience, &self.target, control)
        })?;
        let attractors: Vec<Attractor> = distinct.into_iter().map(|(attractor, _)| attractor).collect();
        self.attractors.extend(attractors);
        Ok(self)
    }

    /// One motion by itself.
    fn of_course(&self, course: Course<'_>, control: &Control<'_>) -> Result<Fate, SimulationError> {
        if self.attracts() != Some(true)
            && self.target.separation(&course.state(), self.target.state()) == 0.0
        {
            // Undisturbed, it stays at a uniform motion from which the least disturbance leads away.
            return Ok(Fate::Undecided);
        }
        let watch = Watch::new(&self.target, &self.settings, &course.state());
        let mut lasting = Lasting::new(course, 0.0, &self.attractors);
        lasting.until_the_end(&self.target, watch, &control.quiet())
    }

    /// Many motions at once. Those that swing to and fro at the end of the duration are looked at one by one, in passing;
    /// those that do not repeat themselves then go on together to the end of the patience.
    fn of_ensemble(
        &self,
        ensemble: &Ensemble,
        initial: &[[f64; 5]],
        control: &Control<'_>,
    ) -> Result<Vec<Fate>, SimulationError> {
        let control = &control.quiet();
        let mut motions: Vec<Followed> = initial
            .iter()
            .map(|state| Followed {
                time: 0.0,
                state: *state,
                watch: Watch::new(&self.target, &self.settings, state),
                fate: None,
            })
            .collect();
        let duration = self.settings.duration;
        self.go_on(ensemble, &mut motions, duration, control)?;
        let periods = if self.target.attracts() == Some(false) { THOROUGH } else { BRIEF };
        let look = periods * self.target.natural_period;
        self.look_at(&mut motions, (duration + look).min(PATIENCE * duration), control)?;
        let thorough = (THOROUGH * self.target.natural_period).min(0.5 * PATIENCE * duration);
        self.go_on(ensemble, &mut motions, PATIENCE * duration - thorough, control)?;
        let fate = |motion: &Followed| match motion.fate {
            Some(fate) => Ok(fate),
            None => {
                let course = Course::rolling(&self.wheel, motion.state)?;
                Lasting::new(course, motion.time, &[]).until_the_end(
                    &self.target,
                    motion.watch.clone(),
                    control,
                )
            }
        };
        parallel::try_map(&motions, fate)
    }

    /// Follows all motions whose fates are not known to a time.
    fn go_on(
        &self,
        ensemble: &Ensemble,
        motions: &mut [Followed],
        until: f64,
        control: &Control<'_>,
    ) -> Result<(), SimulationError> {
        let mut open: Vec<&mut Followed> =
            motions.iter_mut().filter(|motion| motion.fate.is_none()).collect();
        // All have come to the same time.
        let Some(start) = open.first().map(|motion| motion.time) else { return Ok(()) };
        if start >= until {
            return Ok(());
        }
        let states: Vec<[f64; 5]> = open.iter().map(|motion| motion.state).collect();
        let watches: Vec<Mutex<&mut Watch>> =
            open.iter_mut().map(|motion| Mutex::new(&mut motion.watch)).collect();
        let monitor = |trajectory: usize| {
            let watch = &watches[trajectory];
            move |progress: Progress<'_>| -> ControlFlow<()> {
                let mut watch = watch.lock().unwrap_or_else(PoisonError::into_inner);
                watch.observe(start + progress.time, &progress.state())
            }
        };
        let outcomes = ensemble.integrate_watched(&states, until - start, control, monitor)?;
        drop(watches);
        for (motion, Outcome { state, ending, .. }) in open.into_iter().zip(outcomes) {
            motion.state = state;
            motion.time = until;
            motion.fate = match ending {
                Ending::NotFinite => Some(Fate::Escape),
                Ending::TooManySteps => Some(motion.watch.fate_when_cut_short()),
                Ending::Completed | Ending::Stopped => motion.watch.fate(),
            };
        }
        Ok(())
    }

    /// Looks at all motions whose fates are not known, to a time.
    fn look_at(
        &self,
        motions: &mut [Followed],
        until: f64,
        control: &Control<'_>,
    ) -> Result<(), SimulationError> {
        parallel::try_change(motions, |motion| {
            if motion.fate.is_some() {
                return Ok(());
            }
            let mut lasting = Lasting::new(Course::rolling(&self.wheel, motion.state)?, motion.time, &[]);
            motion.fate = match lasting.follow(until, &self.target, &mut motion.watch, control)? {
                Seen::Ends(fate) => Some(fate),
                Seen::Swings => lasting.is_irregular_for_good(&self.target).then_some(Fate::Irregular),
            };
            (motion.state, motion.time) = (lasting.state(), lasting.time());
            Ok(())
        })
    }
}

/// A motion that is followed with others.
struct Followed {
    time: f64,
    state: [f64; 5],
    watch: Watch,
    fate: Option<Fate>,
}
