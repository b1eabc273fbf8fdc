//! Finding shimmy of any wheel: kicked motions are left to settle, from the strongest kick to weaker ones, at values of the parameter
//! spread over its interval.

use crate::error::Error;
use arclength::integration::IntegrationError;
use arclength_analysis::Control;
use kingpin::Wheel;
use kingpin::branches::Along;
use kingpin::parallel;
use kingpin::shimmy::{Kick, PeriodicSliding, ShimmyError};
use kingpin::simulation::SimulationError;
use kingpin::sliding::Contact;
use kingpin_report::numbers::readable;
use serde::Serialize;

/// Parts of the interval at which shimmy is sought, in this order.
pub(super) const PARTS: [f64; 5] = [0.5, 1.0, 0.75, 0.25, 0.0];

/// By how much longer motions that have not settled are given to do so.
const LONGER: f64 = 4.0;

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

    /// The kick in words.
    pub(super) fn kick(&self) -> String {
        match self.state.as_str() {
            "psi" => format!("a release at {} rad", readable(self.change)),
            state => format!("a blow that changes {state} by {} rad/s", readable(self.change)),
        }
    }
}

/// A periodic motion with sliding phases, and the kick from which it was reached.
pub(super) struct Found {
    pub motion: PeriodicSliding,
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

/// Kicks a wheel, all ways at once, and takes the first that ends in shimmy with sliding. Where there is none, those that had not
/// settled are given more time. All are added to `attempts`.
///
/// # Errors
/// An interruption.
pub(super) fn kick(
    wheel: &Wheel,
    value: f64,
    attempts: &mut Vec<Attempt>,
    control: &Control<'_>,
) -> Result<Option<Found>, Error> {
    let mut kicks = wheel.strong_kicks();
    let mut search = wheel.settling_search();
    let mut last = false;
    loop {
        let outcomes: Vec<Result<PeriodicSliding, ShimmyError>> = parallel::map(&kicks, |kick| {
            let start = wheel.perturbed_uniform_motion(&[(kick.state, kick.change)])?;
            wheel.sliding_motion(&start, &search, &control.quiet())
        });
        let (mut found, mut undecided) = (None, Vec::new());
        let mut added = Vec::new();
        for (kick, outcome) in kicks.into_iter().zip(outcomes) {
            let outcome = match outcome {
                Ok(motion) if !slides(&motion) => "a cycle that rolls all along".to_owned(),
                Ok(motion) => {
                    let attempt = Attempt::new(value, kick, "shimmy with sliding".to_owned());
                    found.get_or_insert(Found { motion, attempt });
                    "shimmy with sliding".to_owned()
                }
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
        if found.is_some() || undecided.is_empty() || last {
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
    use ShimmyError::{NotConverged, NotPeriodic, NotSettled};
    matches!(error, NotPeriodic { .. } | NotSettled { .. } | NotConverged { .. })
}

/// What became of a motion, in a few words.
fn summary(error: &ShimmyError, settling_time: f64) -> String {
    match error {
        ShimmyError::DiesOut { .. } => "it dies out".to_owned(),
        error if may_settle(error) => {
            format!("it does not settle on a periodic motion within {} s", readable(settling_time))
        }
        // At what time, and by how short a step, differs from kick to kick: motions are counted by their reason.
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
