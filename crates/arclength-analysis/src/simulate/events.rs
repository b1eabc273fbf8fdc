//! The events of a model along a motion: on which side of zero their conditions are, and what happens where one passes it.
//!
//! An event happens where its condition comes from one side of zero and goes on to the other in the direction of the event. A motion
//! that an event has left where its condition is zero is on the side to which it then moves, so that the event does not happen again
//! before the condition has come back. Events that happen together follow each other in the order of the model, each once; one whose
//! condition is taken to the other side by another event follows, too.

use super::condition::{Condition, ROUNDING};
use super::flow::Flow;
use arclength_ode::{Event, Outcome};

/// Events that may follow each other without time passing, for every event of the model, and some more.
const EVENTS_AT_ONCE: usize = 4;

/// The events of a model along a motion.
#[derive(Clone, Debug)]
pub(super) struct Events<'a> {
    events: &'a [Event],
    /// For every event the sign of its condition, or 0 where that is not known.
    sides: Vec<f64>,
    /// When each happened last, and how many have happened one after the other since time passed and conditions left zero.
    last: Vec<Option<f64>>,
    at_once: usize,
}

/// What has happened at a time.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Happening {
    /// The event that ends the motion, if one does.
    pub stopped_by: Option<usize>,
    /// The event that happens again and again while no time passes, if one does.
    pub accumulates: Option<usize>,
    /// Whether a state was set or put out.
    pub is_seen: bool,
}

impl<'a> Events<'a> {
    /// At the start of a motion.
    pub(super) fn new(events: &'a [Event], flow: &Flow<'_>, time: f64, state: &[f64]) -> Self {
        let sizes: Vec<f64> = state.iter().map(|value| value.abs()).collect();
        let sides = events.iter().map(|event| {
            let condition = flow.condition(event, time, state, &sizes);
            if condition.side() == 0.0 { condition.course() } else { condition.side() }
        });
        Self { events, sides: sides.collect(), last: vec![None; events.len()], at_once: 0 }
    }

    pub(super) fn sides(&self) -> &[f64] {
        &self.sides
    }

    /// Takes note of the sides at the end of a step in which nothing has happened.
    pub(super) fn note(&mut self, sides: &[f64]) {
        self.sides.copy_from_slice(sides);
    }

    /// Lets happen what passes zero where the field, or a condition, switches in time.
    pub(super) fn switch<'f>(
        &mut self,
        flow: impl Fn(&[f64]) -> Flow<'f>,
        time: f64,
        state: &mut [f64],
        sizes: &[f64],
    ) -> Happening {
        let here = flow(state);
        let due = self.events.iter().zip(&self.sides).map(|(event, side)| {
            let value = here.condition_value(event, time, state);
            event.direction().counts(*side, value)
        });
        let due: Vec<bool> = due.collect();
        self.count(&due, |_, last| time - last <= ROUNDING * time.abs());
        self.follow(due, &self.sides.clone(), flow, time, state, sizes)
    }

    /// Lets an event happen, with those that happen together with it.
    pub(super) fn happen<'f>(
        &mut self,
        event: usize,
        arriving: &Flow<'_>,
        flow: impl Fn(&[f64]) -> Flow<'f>,
        time: f64,
        state: &mut [f64],
        sizes: &[f64],
    ) -> Happening {
        let conditions = self.events.iter().map(|event| arriving.condition(event, time, state, sizes));
        let conditions: Vec<Condition> = conditions.collect();
        let due = conditions.iter().zip(self.events).enumerate().map(|(index, (condition, other))| {
            let passes = condition.side() == 0.0
                && other.direction().counts(condition.origin(0.0), -condition.origin(0.0));
            index == event || passes
        });
        let due: Vec<bool> = due.collect();
        // Between two passages through zero the condition gets about as far as its rate takes it.
        self.count(&due, |index, last| {
            let condition = arriving.condition(&self.events[index], time, state, &[]);
            condition.rate.abs() * (time - last) <= ROUNDING * condition.value_noise
        });
        let origins = conditions.iter().zip(&self.sides).map(|(condition, side)| condition.origin(*side));
        let origins: Vec<f64> = origins.collect();
        self.follow(due, &origins, flow, time, state, sizes)
    }

    /// Counts how many events in turn have happened again before their conditions have left zero beyond rounding.
    fn count(&mut self, due: &[bool], is_at_once: impl Fn(usize, f64) -> bool) {
        let mut due = due.iter().zip(&self.last).enumerate().filter(|(_, (due, _))| **due).peekable();
        if due.peek().is_some() {
            let again = due.all(|(index, (_, last))| last.is_some_and(|last| is_at_once(index, last)));
            self.at_once = if again { self.at_once + 1 } else { 0 };
        }
    }

    /// Lets those that are due happen, then those whose conditions are taken to the other side by that.
    fn follow<'f>(
        &mut self,
        mut due: Vec<bool>,
        origins: &[f64],
        flow: impl Fn(&[f64]) -> Flow<'f>,
        time: f64,
        state: &mut [f64],
        sizes: &[f64],
    ) -> Happening {
        let mut happening = Happening::default();
        let mut has_happened = vec![false; due.len()];
        let mut first = None;
        while due.contains(&true) {
            let here = flow(state);
            for (index, event) in self.events.iter().enumerate().filter(|(index, _)| due[*index]) {
                let before = state.to_vec();
                let Outcome { stops, is_put_out } = here.apply(event, time, state);
                happening.is_seen |= is_put_out || state != before;
                if stops {
                    happening.stopped_by.get_or_insert(index);
                }
                has_happened[index] = true;
                self.last[index] = Some(time);
                first.get_or_insert(index);
            }
            let here = flow(state);
            due = self
                .events
                .iter()
                .enumerate()
                .map(|(index, event)| {
                    let side = here.condition(event, time, state, sizes).side();
                    !has_happened[index] && event.direction().counts(origins[index], side)
                })
                .collect();
        }
        let here = flow(state);
        for (index, event) in self.events.iter().enumerate() {
            let condition = here.condition(event, time, state, sizes);
            let [side, course] = [condition.side(), condition.course()];
            self.sides[index] = if side != 0.0 {
                // One that has happened where its condition jumps is beyond the jump already.
                if has_happened[index] { here.side_ahead(event, time, state).unwrap_or(side) } else { side }
            } else if has_happened[index] && course != 0.0 {
                course
            } else {
                origins[index]
            };
        }
        if self.at_once > EVENTS_AT_ONCE * (self.events.len() + 1) {
            happening.accumulates = first;
        }
        happening
    }
}
