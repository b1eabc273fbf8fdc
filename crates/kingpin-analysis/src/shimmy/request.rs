//! What shimmy is asked for by, and how its branches are followed.

use super::point::{covers, what};
use super::result::{ShimmyBranch, ShimmyResult};
use super::search::{Attempt, PARTS, same_period, settled_cycles, sliding_motion, value_at};
use crate::along::along;
use crate::description;
use crate::error::{Error, unless_stopped};
use crate::wheel_request::WheelRequest;
use arclength::continuation::Settings;
use arclength::cycle::{CyclePoint, CycleStart};
use arclength_analysis::{Control, Interval};
use kingpin::branches::{Along, CycleOptions};
use kingpin::shimmy::{PeriodicSliding, ShimmyError, SlidingBranchOptions};
use kingpin::{KingpinError, Tyre, Wheel};
use kingpin_report::numbers::readable;
use serde::{Deserialize, Serialize};
use std::ops::ControlFlow;

/// Where a grazing is, is found to this part of the size of the motion.
const SMALLEST_STEP: f64 = 3e-5;
/// Most points in one direction, unless another number is asked for.
const STEPS: u32 = 500;

/// Shimmy along a parameter.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct ShimmyRequest {
    /// Which wheel.
    #[serde(flatten)]
    pub wheel: WheelRequest,
    /// Parameter and its interval; r may reach infinity.
    pub along: Interval,
    /// Values of the parameter at which motions are wanted exactly.
    #[serde(default)]
    pub at: Vec<f64>,
    /// Most steps in one direction.
    #[serde(default = "default_steps")]
    pub steps: u32,
}

fn default_steps() -> u32 {
    STEPS
}

/// A request that makes sense, with its wheel.
#[derive(Clone, Debug)]
pub struct ShimmyAnalysis {
    wheel: Wheel,
    along: Along,
    options: SlidingBranchOptions,
}

impl ShimmyRequest {
    /// A request for the paper's wheel.
    pub fn new(along: Interval) -> Self {
        Self { wheel: WheelRequest::default(), along, at: Vec::new(), steps: STEPS }
    }

    /// Reads the wheel and checks every field.
    ///
    /// # Errors
    /// What is wrong with the wheel or the interval; a rigid wheel with `k_u = inf`, which cannot slide in this program; dry friction about
    /// the king pin of one with a tyre.
    pub fn validate(&self) -> Result<ShimmyAnalysis, Error> {
        let along = along(&self.along)?;
        self.along.check_values(&self.at)?;
        if self.steps == 0 {
            return Err(Error::invalid(&["steps"], "0", "no step is taken", "at least 1"));
        }
        let wheel = self.wheel.read()?;
        wheel.check_shimmy()?;
        let mut options = SlidingBranchOptions::default().at(&self.at).through_grazings(true);
        options.settings.smallest_step = SMALLEST_STEP;
        options.settings.most_steps = self.steps as usize;
        Ok(ShimmyAnalysis { wheel, along, options })
    }
}

impl ShimmyAnalysis {
    /// Kicks the wheel at values over the interval until it shimmies, and follows what it finds both ways; values that no branch
    /// reaches are tried too. Where the control stops it the result is what there is up to there.
    ///
    /// # Errors
    /// [`Error::NothingFound`] with what was tried, [`Error::Stopped`] where there is nothing yet, [`Error::Shimmy`].
    pub fn run(&self, control: &Control<'_>) -> Result<ShimmyResult, Error> {
        let key = self.along.key();
        let mut branches: Vec<ShimmyBranch> = Vec::new();
        let mut attempts: Vec<Attempt> = Vec::new();
        for part in PARTS {
            let value = value_at(&self.along, part);
            if branches.iter().any(|branch| covers(&branch.points, value)) {
                continue;
            }
            control.at(&format!("kicked motions, {key} = {}", readable(value)));
            match self.branches(value, &mut attempts, control) {
                Err(Error::Stopped) => break,
                found => branches.extend(found?),
            }
            if control.is_stopped() {
                break;
            }
        }
        if branches.is_empty() {
            unless_stopped(control)?;
            return Err(Error::NothingFound(nothing_found(&self.wheel, &self.along, &attempts)));
        }
        Ok(ShimmyResult::new(self.wheel, self.along, branches, attempts, &self.options.at))
    }

    /// The branches of the shimmy that kicks lead to at a value; where there is no uniform motion to kick there is none.
    fn branches(
        &self,
        value: f64,
        attempts: &mut Vec<Attempt>,
        control: &Control<'_>,
    ) -> Result<Vec<ShimmyBranch>, Error> {
        let wheel = self.wheel.with(self.along.key(), value)?;
        match wheel.uniform_motion() {
            Err(KingpinError::NoUniformMotion { .. }) => Ok(Vec::new()),
            _ if wheel.tyre() == Tyre::Rigid => {
                let branch = self.sliding_branch(&wheel, value, attempts, control)?;
                Ok(branch.into_iter().collect())
            }
            _ => self.smooth_branches(&wheel, value, attempts, control),
        }
    }

    fn sliding_branch(
        &self,
        wheel: &Wheel,
        value: f64,
        attempts: &mut Vec<Attempt>,
        control: &Control<'_>,
    ) -> Result<Option<ShimmyBranch>, Error> {
        let Some(found) = sliding_motion(wheel, value, attempts, control)? else { return Ok(None) };
        let mut count = 0;
        let observer =
            |value: f64, motion: &PeriodicSliding| self.tell(&mut count, [value, motion.period], control);
        match found.motion.along(self.along, &self.options, &control.quiet(), observer) {
            Ok(branch) => ShimmyBranch::of_sliding(found.attempt, &branch, &self.along, control).map(Some),
            Err(ShimmyError::Interrupted(_)) => Err(Error::Stopped),
            Err(error) => {
                attempts.push(found.attempt.not_followed(what(wheel), &error));
                Ok(None)
            }
        }
    }

    fn smooth_branches(
        &self,
        wheel: &Wheel,
        value: f64,
        attempts: &mut Vec<Attempt>,
        control: &Control<'_>,
    ) -> Result<Vec<ShimmyBranch>, Error> {
        let mut settings = Settings::default();
        settings.most_steps = self.options.settings.most_steps;
        let options = CycleOptions::default().at(&self.options.at).settings(settings);
        let mut branches: Vec<ShimmyBranch> = Vec::new();
        for found in settled_cycles(wheel, value, attempts, control)? {
            // The branch of one of them may pass the others.
            let is_known = |branch: &ShimmyBranch| {
                branch.periods_at(value).any(|period| same_period(period, found.motion.period))
            };
            if branches.iter().any(is_known) {
                continue;
            }
            let mut count = 0;
            let observer = |point: &CyclePoint| self.tell(&mut count, [point.value, point.period], control);
            match wheel.cycles_from(CycleStart::Orbit(found.motion), self.along, &options, observer) {
                Ok(cycles) => branches.push(ShimmyBranch::of_cycles(found.attempt, cycles, &self.along)?),
                Err(KingpinError::Interrupted(_)) => return Err(Error::Stopped),
                Err(error) => attempts.push(found.attempt.not_followed(what(wheel), &error)),
            }
        }
        Ok(branches)
    }

    fn tell(&self, count: &mut usize, motion: [f64; 2], control: &Control<'_>) -> ControlFlow<()> {
        *count += 1;
        let [value, period] = motion.map(readable);
        control.at(&format!("{count} motions, {} = {value}, period {period} s", self.along.key()));
        control.flow()
    }
}

/// That there is no shimmy, what was tried and what to try.
fn nothing_found(wheel: &Wheel, along: &Along, attempts: &[Attempt]) -> String {
    let key = along.key();
    let (start, end) = along.ends();
    let what = what(wheel);
    let simulate = match wheel.tyre() {
        Tyre::Rigid => "kingpin simulate --contact sliding",
        _ => "kingpin simulate",
    };
    let mut outcomes: Vec<(&str, usize)> = Vec::new();
    for attempt in attempts {
        match outcomes.iter_mut().find(|(outcome, _)| *outcome == attempt.outcome) {
            Some((_, count)) => *count += 1,
            None => outcomes.push((&attempt.outcome, 1)),
        }
    }
    let outcomes: Vec<String> =
        outcomes.into_iter().map(|(outcome, count)| format!("{outcome} ({count} of them)")).collect();
    let mut values: Vec<String> = attempts.iter().map(|attempt| readable(attempt.value)).collect();
    values.dedup();
    if values.is_empty() {
        return format!(
            "no {what} for {key} from {} to {} at {}: there is no uniform motion to kick; see with `kingpin steady` why",
            readable(start),
            readable(end),
            description::of(wheel, &[key])
        );
    }
    format!(
        "no {what} was found for {key} from {} to {} at {}: of {} kicked motions at {key} = {} what became was: {}; try \
         another interval, or see with `{simulate}` what a kick does",
        readable(start),
        readable(end),
        description::of(wheel, &[key]),
        attempts.len(),
        values.join(", "),
        outcomes.join("; ")
    )
}
