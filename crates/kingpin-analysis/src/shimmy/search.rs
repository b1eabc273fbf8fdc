//! Finding shimmy of any wheel: kicked motions are left to settle, from the strongest kick to weaker ones, at values of the parameter
//! spread over its interval.

use crate::error::Error;
use arclength::cycle::Orbit;
use arclength::integration::IntegrationError;
use arclength_analysis::Control;
use kingpin::Wheel;
use kingpin::branches::Along;
use kingpin::parallel;
use kingpin::shimmy::{Kick, PeriodicSliding, ShimmyError, SlidingMotionSearch};
use kingpin::simulation::SimulationError;
use kingpin::sliding::Contact;
use kingpin_report::numbers::readable;
use serde::Serialize;
use std::fmt::Display;

/// Parts of the interval at which shimmy is sought, in this order.
pub(super) const PARTS: [f64; 5] = [0.5, 1.0, 0.75, 0.25, 0.0];

/// By how much longer motions that have not settled are given to do so.
const LONGER: f64 = 4.0;

/// Periods that differ by less than this part are those of one cycle.
const SAME_PERIOD: f64 = 1e-4;

/// A kick that was tried.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Attempt {
    /// Value of the parameter.
    #[serde(with = "kingpin_report::number")]
    pub value: f64,
    /// The state that was changed, `psi` or `Omega`.
    pub state: String,
    /// By how much.
    pub change: f64,
    /// What became of the motion.
    pub outcome: String,
}

impl Attempt {
    fn new(value: f64, kick: Kick, outcome: String) -> Self {
        Self { value, state: kick.state.to_owned(), change: kick.change, outcome }
    }

    fn is_of(&self, kick: Kick) -> bool {
        self.state == kick.state && self.change == kick.change
    }

    /// The same where the motion that was found cannot be followed.
    pub(super) fn not_followed(self, what: &str, error: &impl Display) -> Self {
        Self { outcome: format!("{what} that cannot be followed: {error}"), ..self }
    }

    /// The kick in words.
    pub(super) fn kick(&self) -> String {
        match self.state.as_str() {
            "psi" => format!("a release at {} rad", readable(self.change)),
            state => format!("a blow that changes {state} by {} rad/s", readable(self.change)),
        }
    }
}

/// A periodic motion, and the kick from which it was reached.
pub(super) struct Found<M> {
    pub motion: M,
    pub attempt: Attempt,
}

/// The parameter at a part of its interval; an interval that reaches infinity is divided in the reciprocal.
pub(super) fn value_at(along: &Along, part: f64) -> f64 {
    let (start, end) = along.ends();
    if end.is_infinite() {
        return ((1.0 - part) / start).recip();
    }
    start + part * (end - start)
}

/// Kicks a wheel that may slide, and takes the first motion that ends in shimmy with sliding.
///
/// # Errors
/// An interruption.
pub(super) fn sliding_motion(
    wheel: &Wheel,
    value: f64,
    attempts: &mut Vec<Attempt>,
    control: &Control<'_>,
) -> Result<Option<Found<PeriodicSliding>>, Error> {
    let settle = |kick: &Kick, search: &SlidingMotionSearch| {
        let start = wheel.perturbed_uniform_motion(&[(kick.state, kick.change)])?;
        wheel.sliding_motion(&start, search, &control.quiet())
    };
    let told = |motion: &PeriodicSliding| match slides(motion) {
        true => Ok("shimmy with sliding"),
        false => Err("a cycle that rolls all along"),
    };
    Ok(kick(wheel, value, attempts, settle, told)?.into_iter().next())
}

/// Kicks a wheel with a tyre, and takes the different cycles on which it settles.
///
/// # Errors
/// An interruption.
pub(super) fn settled_cycles(
    wheel: &Wheel,
    value: f64,
    attempts: &mut Vec<Attempt>,
    control: &Control<'_>,
) -> Result<Vec<Found<Orbit>>, Error> {
    let settle =
        |kick: &Kick, search: &SlidingMotionSearch| wheel.settled_cycle(*kick, search, &control.quiet());
    let mut found = kick(wheel, value, attempts, settle, |_| Ok("shimmy"))?;
    found.dedup_by(|one, other| same_period(one.motion.period, other.motion.period));
    Ok(found)
}

/// Whether two periods are those of one cycle, as far as it has settled.
pub(super) fn same_period(one: f64, other: f64) -> bool {
    (one / other - 1.0).abs() < SAME_PERIOD
}

/// Kicks a wheel, all ways at once, and takes the motions on which they settle that are wanted, by what is told of them. Where there is
/// none, those that had not settled are given more time. All are added to `attempts`.
fn kick<M: Send>(
    wheel: &Wheel,
    value: f64,
    attempts: &mut Vec<Attempt>,
    settle: impl Fn(&Kick, &SlidingMotionSearch) -> Result<M, ShimmyError> + Sync,
    told: impl Fn(&M) -> Result<&'static str, &'static str>,
) -> Result<Vec<Found<M>>, Error> {
    let mut kicks = wheel.strong_kicks();
    let mut search = wheel.settling_search();
    let mut last = false;
    loop {
        let outcomes: Vec<Result<M, ShimmyError>> = parallel::map(&kicks, |kick| settle(kick, &search));
        let (mut found, mut undecided) = (Vec::new(), Vec::new());
        let mut added = Vec::new();
        for (kick, outcome) in kicks.into_iter().zip(outcomes) {
            let outcome = match outcome {
                Ok(motion) => match told(&motion) {
                    Ok(what) => {
                        let attempt = Attempt::new(value, kick, what.to_owned());
                        found.push(Found { motion, attempt });
                        what.to_owned()
                    }
                    Err(what) => what.to_owned(),
                },
                Err(ShimmyError::Interrupted(interrupted)) => return Err(interrupted.into()),
                Err(error) => {
                    if may_settle(&error) {
                        undecided.push(kick);
                    }
                    summary(&error, search.settling_time)
                }
            };
            added.push(Attempt::new(value, kick, outcome));
        }
        if !found.is_empty() || undecided.is_empty() || last {
            attempts.extend(added);
            return Ok(found);
        }
        // Those that are kicked again are told of once.
        added.retain(|attempt| !undecided.iter().any(|kick| attempt.is_of(*kick)));
        attempts.extend(added);
        (kicks, last) = (undecided, true);
        search.settling_time *= LONGER;
        search.longest_period *= LONGER;
    }
}

fn slides(motion: &PeriodicSliding) -> bool {
    motion.phases.iter().any(|phase| phase.contact == Contact::Sliding)
}

/// Whether a motion may come to rest or repeat itself later.
fn may_settle(error: &ShimmyError) -> bool {
    use ShimmyError::{Continuation, NotConverged, NotPeriodic, NotSettled};
    let no_return = |error: &arclength::Error| matches!(error, arclength::Error::NoReturn { .. });
    match error {
        NotPeriodic { .. } | NotSettled { .. } | NotConverged { .. } => true,
        Continuation(error) => no_return(error),
        _ => false,
    }
}

/// What became of a motion, in a few words.
fn summary(error: &ShimmyError, settling_time: f64) -> String {
    match error {
        ShimmyError::DiesOut { .. } | ShimmyError::Continuation(arclength::Error::Resting { .. }) => {
            "it dies out".to_owned()
        }
        error if may_settle(error) => {
            format!("it does not settle on a periodic motion within {} s", readable(settling_time))
        }
        // At what time, and by how short a step, differs from kick to kick: motions are counted by their reason.
        ShimmyError::Simulation(SimulationError::ModelEnds { what, .. }) => {
            format!("it comes to where the equations end: {what}")
        }
        ShimmyError::Simulation(SimulationError::Integration(IntegrationError::StepTooSmall { .. })) => {
            "it cannot be followed to its end: it is singular, or the tolerances are too small".to_owned()
        }
        ShimmyError::Simulation(SimulationError::Integration(IntegrationError::NotFinite { .. })) => {
            "it cannot be followed to its end: it grows beyond all bounds".to_owned()
        }
        ShimmyError::Simulation(SimulationError::Integration(IntegrationError::TooManySteps { .. })) => {
            "it cannot be followed to its end: it takes too many steps".to_owned()
        }
        error => error.to_string(),
    }
}
