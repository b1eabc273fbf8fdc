//! The run itself: step, search for special points, locate what was asked for, recognise the end, repeat.

use super::advance::{STEP_REDUCTION, advance, converge, keep, return_to, stopped};
use super::closure::Closure;
use super::corrector::between;
use super::curve::{Curve, Ending, EventOf};
use super::events::{EventSearch, Events, Unlocated};
use super::metric::along;
use super::requested::{
    Between, ON_END, Origin, Purpose, Target, first_exit, fix, insert_targets, insert_values,
};
use super::settings::Settings;
use super::solution::{Bound, Solution};
use super::stop::Stop;
use crate::error::Error;
use std::ops::ControlFlow;

/// What is asked of a run.
#[derive(Debug)]
pub struct Request<'f, P> {
    /// Ranges of the parameters; the run ends where the curve leaves one of them.
    pub bounds: Vec<Bound>,
    /// Values of the first bounded parameter at which a solution is wanted exactly.
    pub values: Vec<f64>,
    /// Values of monitors at which a solution is wanted.
    pub targets: Vec<Target<'f, P>>,
    /// Settings.
    pub settings: Settings,
}

impl<P> Request<'_, P> {
    /// The curve within ranges of its parameters, nothing else.
    pub fn within(bounds: &[Bound], settings: Settings) -> Self {
        Self { bounds: bounds.to_vec(), values: Vec::new(), targets: Vec::new(), settings }
    }
}

/// What a run found.
#[derive(Debug)]
pub struct Followed<P, K, R> {
    /// The solutions in the order of the curve, special and requested ones among them.
    pub solutions: Vec<(Solution<P>, Origin<K>)>,
    /// Why the run ended.
    pub stop: Stop<R>,
    /// What was noticed and could not be located.
    pub unlocated: Vec<Unlocated<K>>,
    /// The unknowns, next to the start, from which on the curve was searched for special points.
    pub(crate) first: Option<Vec<f64>>,
}

impl<P, K, R> Followed<P, K, R> {
    /// A curve that was not followed, for a reason.
    pub(crate) fn nothing(stop: Stop<R>) -> Self {
        Self { solutions: Vec::new(), stop, unlocated: Vec::new(), first: None }
    }
}

/// What was found along a curve `C`.
pub type FollowedCurve<C> = Followed<<C as Curve>::Point, <C as Curve>::Kind, <C as Curve>::Reason>;

/// Somebody who is told every solution that becomes part of a run, special ones too, and may end it.
pub type Observer<'o, P, K> = dyn FnMut(&Solution<P>, Origin<K>) -> ControlFlow<()> + 'o;

/// Steps in a row, each shorter than this part of the initial one, after which a curve does not get on. Behind a narrow feature they would
/// have grown a thousand times.
const CREEPING_STEPS: usize = 20;
const CREEPING: f64 = 1e-4;
/// Special points this close to the start, in the metric, to which a closed curve comes back are that start.
const AT_START: f64 = 1e-8;
/// Part of its range by which a parameter of the start may move by rounding.
const START_ROUNDING: f64 = 1e-13;
/// The last stretch to an end inside a step is searched up to the step's length divided by two to this power before it: closer to
/// it, where parameters often stand still, signs are rounding. Where a solution next to the end is wanted, it is this close.
const LAST_STRETCH_HALVINGS: usize = 6;
const APPROACH_HALVINGS: usize = 10;

/// Follows the curve from `start` (not necessarily converged) in the direction of `tangent`.
///
/// # Errors
/// When no solution is found from the start. Failures later end the run with a [`Stop`].
pub fn follow<C: Curve>(
    curve: &mut C,
    start: Vec<f64>,
    tangent: Vec<f64>,
    request: &Request<'_, C::Point>,
    observer: &mut Observer<'_, C::Point, C::Kind>,
) -> Result<FollowedCurve<C>, Error> {
    let start = exact_start(curve, start, tangent, request)?;
    let closure = Closure::at(curve, &start, &request.bounds);
    let search = EventSearch::new(&request.bounds);
    let mut run =
        Run { curve, request, observer, search, closure, solutions: Vec::new(), unlocated: Vec::new() };
    let stop = run.from(start);
    let first = run.search.into_first();
    Ok(Followed { solutions: run.solutions, stop, unlocated: run.unlocated, first })
}

/// The converged start; one on the curve stays exactly at its parameter values.
pub(crate) fn exact_start<C: Curve>(
    curve: &mut C,
    start: Vec<f64>,
    tangent: Vec<f64>,
    request: &Request<'_, C::Point>,
) -> Result<Solution<C::Point>, Error> {
    let asked: Vec<f64> = request.bounds.iter().map(|bound| bound.value(&start)).collect();
    let mut converged = converge(curve, start, tangent, &request.settings)?;
    for (bound, value) in request.bounds.iter().zip(asked) {
        let place = converged.unknown.len() - bound.from_end;
        if (converged.unknown[place] - value).abs() <= START_ROUNDING * bound.width() {
            converged.unknown[place] = value;
        }
    }
    Ok(converged)
}

struct Run<'r, 'o, C: Curve> {
    curve: &'r mut C,
    request: &'r Request<'r, C::Point>,
    observer: &'r mut Observer<'o, C::Point, C::Kind>,
    search: EventSearch,
    closure: Closure,
    solutions: Between<C>,
    unlocated: Vec<Unlocated<C::Kind>>,
}

/// What became of a step.
enum Step<P, R> {
    /// The curve goes on from here.
    To(Solution<P>),
    /// The curve goes on from here in another piece.
    Into(Solution<P>),
    /// The step led to another branch and is made anew with this length.
    Again(f64),
    End(Stop<R>),
}

type StepOf<C> = Step<<C as Curve>::Point, <C as Curve>::Reason>;

impl<C: Curve> Run<'_, '_, C> {
    fn from(&mut self, start: Solution<C::Point>) -> Stop<C::Reason> {
        let settings = &self.request.settings;
        let mut current = start.clone();
        if self.accept(vec![(start, Origin::Step)]).is_break() {
            return Stop::Interrupted;
        }
        let mut previous: Option<(Vec<f64>, f64)> = None;
        let mut length = settings.initial_step;
        let (mut creeping, mut known) = (0, 0);
        for _ in 0..settings.most_steps {
            let bounds = &self.request.bounds;
            let kept = keep(self.curve, &current, &previous);
            let advanced =
                match advance(self.curve, &mut current, &mut previous, &mut length, bounds, settings) {
                    Ok(next) => next,
                    Err(Stop::StepTooSmall { .. }) if self.curve.give_up_piece() => {
                        (length, previous) = (settings.initial_step, None);
                        continue;
                    }
                    Err(stop) => return stop,
                };
            match self.step(&current, advanced) {
                Step::To(next) => {
                    let way = along(self.curve, &current, &next.unknown).abs();
                    current = next;
                    creeping = if way < CREEPING * settings.initial_step { creeping + 1 } else { 0 };
                    if creeping == 0 {
                        known = self.unlocated.len();
                    }
                    if creeping == CREEPING_STEPS {
                        // Signs that changed on such a way are rounding.
                        self.unlocated.truncate(known);
                        let hindrance = self.curve.hindrance(&current);
                        return hindrance.map_or(Stop::Creeping { steps: CREEPING_STEPS }, Stop::Problem);
                    }
                }
                Step::Into(next) => {
                    // Nothing of the piece before says anything about this one.
                    self.search.restart();
                    (current, previous) = (next, None);
                    length = length.min(settings.initial_step);
                }
                Step::Again(shorter) => {
                    length = shorter;
                    previous = None;
                    let here = (&mut current, &mut previous);
                    if let Err(error) = return_to(self.curve, here, kept.as_ref(), settings) {
                        return stopped(error);
                    }
                }
                Step::End(stop) => return stop,
            }
        }
        Stop::MostSteps
    }

    /// Adds solutions to the run, telling the observer. Those that lie on an end of a range but for rounding are told there.
    fn accept(&mut self, solutions: Between<C>) -> ControlFlow<()> {
        let mut flow = ControlFlow::Continue(());
        for (mut solution, origin) in solutions {
            for bound in &self.request.bounds {
                bound.keep_within(&mut solution.unknown);
            }
            if flow.is_continue() {
                flow = (self.observer)(&solution, origin);
            }
            self.solutions.push((solution, origin));
        }
        flow
    }

    /// What lies between two consecutive solutions, and whether the curve goes on behind the second.
    fn step(&mut self, current: &Solution<C::Point>, advanced: Solution<C::Point>) -> StepOf<C> {
        let (advanced, passage) = match self.curve.passage(current, &advanced) {
            Ok(Some(passage)) => (passage.arrival, Some((passage.special, passage.onward))),
            Ok(None) => (advanced, None),
            Err(Error::OtherBranch) => {
                return Step::Again(STEP_REDUCTION * along(self.curve, current, &advanced.unknown));
            }
            Err(error) => return Step::End(Stop::Failed(error)),
        };
        let (advanced, ending) = match self.curve.ending(current, &advanced) {
            Some(Ending::Between(stop)) => return self.last_stretch(current, &advanced, stop, false),
            Some(Ending::Approached(stop)) => return self.last_stretch(current, &advanced, stop, true),
            Some(Ending::After(stop)) => (advanced, Some(stop)),
            None => (advanced, None),
        };
        let (mut between, leaves) = match self.between(current, &advanced) {
            Ok(found) => found,
            Err(end) => return end,
        };
        if let Some((bound, value)) = leaves {
            return match self.leave(current, &mut between, &advanced, bound, value) {
                Ok(stop) => Step::End(self.ended(between, stop)),
                Err(again) => again,
            };
        }
        if let Some(end) = self.closed(current, &advanced) {
            let reached = along(self.curve, current, &end.unknown);
            // A special start is found again.
            between
                .retain(|(solution, _)| along(self.curve, current, &solution.unknown) < reached - AT_START);
            between.push((self.solutions[0].0.clone(), Origin::End));
            return Step::End(self.ended(between, Stop::Closed));
        }
        if let Some(stop) = self.stopping_target(&mut between) {
            return Step::End(self.ended(between, stop));
        }
        let (special, onward) =
            passage.map_or((Vec::new(), None), |(special, onward)| (special, Some(onward)));
        if special.is_empty() {
            between.push((advanced.clone(), Origin::Step));
        }
        between.extend(special.into_iter().map(|(kind, solution)| (solution, Origin::Special(kind))));
        if self.accept(between).is_break() {
            return Step::End(Stop::Interrupted);
        }
        match (ending, onward) {
            (Some(stop), _) | (None, Some(Err(stop))) => Step::End(stop),
            (None, Some(Ok(onward))) => {
                self.curve.enter(&onward);
                Step::Into(onward)
            }
            (None, None) => {
                self.curve.enter(&advanced);
                Step::To(advanced)
            }
        }
    }

    fn ended(&mut self, solutions: Between<C>, stop: Stop<C::Reason>) -> Stop<C::Reason> {
        if self.accept(solutions).is_break() { Stop::Interrupted } else { stop }
    }

    /// Special points, requested values and targets between two solutions, and the first bound that is violated on the way.
    #[allow(clippy::type_complexity)]
    fn between(
        &mut self,
        current: &Solution<C::Point>,
        advanced: &Solution<C::Point>,
    ) -> Result<(Between<C>, Option<(usize, f64)>), StepOf<C>> {
        let Request { bounds, values, targets, settings } = self.request;
        let failed = |error| Step::End(Stop::Failed(error));
        let Events { found, unlocated } =
            self.search.between(self.curve, current, advanced, settings).map_err(|error| match error {
                Error::OtherBranch => {
                    Step::Again(STEP_REDUCTION * along(self.curve, current, &advanced.unknown))
                }
                error => failed(error),
            })?;
        let mut between: Between<C> = found
            .into_iter()
            .filter(|event| !self.is_known(event))
            .map(|event| (event.solution, Origin::Special(event.kind)))
            .collect();
        let passed = between.iter().map(|(solution, _)| solution);
        let leaves = passed.chain([advanced]).find_map(|solution| first_exit(&solution.unknown, bounds));
        if let Some(&bound) = bounds.first() {
            let all_found =
                insert_values(self.curve, current, &mut between, advanced, (bound, values), settings)
                    .map_err(failed)?;
            let length = along(self.curve, current, &advanced.unknown);
            if !all_found && length.abs() > settings.shortest_jump {
                self.search.restart();
                return Err(Step::Again(STEP_REDUCTION * length));
            }
        }
        self.note(unlocated);
        let mut steps = self.solutions.iter().rev().filter(|(_, origin)| *origin == Origin::Step);
        let earlier = steps.nth(1).map(|(solution, _)| solution);
        insert_targets(self.curve, earlier, current, &mut between, advanced, targets, settings)
            .map_err(failed)?;
        Ok((between, leaves))
    }

    /// Whether a special point is one of the step before, found once more: next to it signs are rounding.
    fn is_known(&self, event: &EventOf<C>) -> bool {
        let mut steps = 0;
        let last_step = self.solutions.iter().rev().take_while(|(_, origin)| {
            steps += usize::from(*origin == Origin::Step);
            steps < 2
        });
        let mut same = last_step.filter(|(_, origin)| *origin == Origin::Special(event.kind));
        same.any(|(solution, _)| self.curve.are_same(&solution.point, &event.solution.point))
    }

    /// Keeps what could not be located; changes that follow each other are one.
    fn note(&mut self, unlocated: Vec<Unlocated<C::Kind>>) {
        for change in unlocated {
            // Rounding may change a sign in step after step.
            let last = self.unlocated.iter_mut().rev().find(|known| known.kind == change.kind);
            match last {
                Some(last) if last.between[1] == change.between[0] => {
                    let [_, end] = change.between;
                    last.between[1] = end;
                }
                _ => self.unlocated.push(change),
            }
        }
    }

    /// The end of a range: what lies outside is dropped, the solution at the end is solved for, by a shorter step if need be.
    fn leave(
        &mut self,
        current: &Solution<C::Point>,
        between: &mut Between<C>,
        advanced: &Solution<C::Point>,
        bound: usize,
        value: f64,
    ) -> Result<Stop<C::Reason>, StepOf<C>> {
        let bounds = &self.request.bounds;
        // Past a fold outside the range the curve comes back: the end lies before it.
        let outside = |solution: &Solution<C::Point>| first_exit(&solution.unknown, bounds).is_some();
        let first_outside = between.iter().position(|(solution, _)| outside(solution));
        let beyond = first_outside.map_or(advanced, |index| &between[index].0).clone();
        between.truncate(first_outside.unwrap_or(between.len()));
        if let Some(stop) = self.stopping_target(between) {
            return Ok(stop);
        }
        let length = along(self.curve, current, &advanced.unknown);
        let near = between.last().map_or(current, |(solution, _)| solution).clone();
        let from_end = bounds[bound].from_end;
        match fix(self.curve, &near, &beyond, from_end, value, &self.request.settings) {
            Ok(end) => {
                // A value asked for at the end of the range has been found already.
                let is_known = between.last().is_some_and(|(last, origin)| {
                    *origin == Origin::Requested && bounds[bound].value(&last.unknown) == value
                });
                if !is_known {
                    between.push((end, Origin::End));
                }
                Ok(Stop::RangeEnd { bound, value })
            }
            // A special point at which the equations are singular may lie on the end itself.
            Err(Error::NotFound { .. })
                if matches!(between.last(), Some((_, Origin::Special(_))))
                    && (bounds[bound].value(&near.unknown) - value).abs()
                        <= ON_END * bounds[bound].width() =>
            {
                between.push((near, Origin::End));
                Ok(Stop::RangeEnd { bound, value })
            }
            Err(Error::NotFound { .. }) if length.abs() > self.request.settings.shortest_jump => {
                Err(Step::Again(STEP_REDUCTION * length.abs()))
            }
            Err(Error::NotFound { cause, .. }) => Ok(Stop::StepTooSmall { cause }),
            Err(error) => Ok(Stop::Failed(error)),
        }
    }

    /// The solution at which the curve comes back to its start between two others.
    fn closed(
        &mut self,
        current: &Solution<C::Point>,
        advanced: &Solution<C::Point>,
    ) -> Option<Solution<C::Point>> {
        if self.solutions.len() <= 1 {
            return None;
        }
        self.closure.reached(self.curve, current, advanced, &self.request.settings)
    }

    /// Drops what follows the first target at which the run is to end.
    fn stopping_target(&self, between: &mut Between<C>) -> Option<Stop<C::Reason>> {
        let targets = &self.request.targets;
        let (place, target) = between.iter().enumerate().find_map(|(place, (_, origin))| match origin {
            Origin::Target(index) => targets
                .get(*index)
                .filter(|target| target.purpose == Purpose::End)
                .map(|found| (place, found)),
            _ => None,
        })?;
        between.truncate(place + 1);
        Some(Stop::Monitor { index: target.monitor, value: target.value })
    }

    /// The stretch from the last solution to an end inside the step: it is searched like any other step, up to close before
    /// that end. Where the curve is told to approach the end the solution there becomes part of it.
    fn last_stretch(
        &mut self,
        current: &Solution<C::Point>,
        advanced: &Solution<C::Point>,
        stop: Stop<C::Reason>,
        approached: bool,
    ) -> StepOf<C> {
        let settings = &self.request.settings;
        let (mut inside, mut outside) = (0.0, 1.0);
        let mut last = None;
        for _ in 0..if approached { APPROACH_HALVINGS } else { LAST_STRETCH_HALVINGS } {
            let fraction = 0.5 * (inside + outside);
            let Ok(trial) = between(self.curve, current, advanced, fraction, settings) else { break };
            // Beyond the end the equations may have solutions that mean nothing.
            if !self.curve.holds(&trial.unknown) {
                outside = fraction;
                continue;
            }
            match self.curve.ending(current, &trial) {
                Some(Ending::Between(_) | Ending::Approached(_)) => outside = fraction,
                _ => (inside, last) = (fraction, Some(trial)),
            }
        }
        let Some(last) = last else { return Step::End(stop) };
        let (mut between, leaves) = match self.between(current, &last) {
            Ok(found) => found,
            // Next to the end the curve may be too short to tell where it leads.
            Err(Step::Again(_)) => return Step::End(stop),
            Err(end) => return end,
        };
        if let Some((bound, value)) = leaves {
            let stop = match self.leave(current, &mut between, &last, bound, value) {
                Ok(stop) | Err(Step::End(stop)) => stop,
                Err(_) => stop,
            };
            return Step::End(self.ended(between, stop));
        }
        if let Some(stop) = self.stopping_target(&mut between) {
            return Step::End(self.ended(between, stop));
        }
        if approached {
            between.push((last, Origin::Step));
        }
        Step::End(self.ended(between, stop))
    }
}
