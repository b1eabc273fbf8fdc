//! Events of a model: `global sign condition {name=expression; ...}`.
//!
//! An event happens where its condition passes zero in the direction of its sign. Its assignments follow each other as they are
//! written, each with the values that those before it have left, as in XPPAUT; so do the events that happen at the same time.

use crate::error::Place;
use crate::tape::Tape;
use arclength::{Direction, Scalar};

/// An event of a model.
#[derive(Clone, Debug)]
pub struct Event {
    pub(crate) place: Place,
    pub(crate) direction: Direction,
    pub(crate) condition: Tape,
    pub(crate) actions: Vec<(Action, Tape)>,
}

/// What is done with the value of an expression of an event.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Action {
    /// The state of this index gets it.
    Assign(usize),
    /// If it is positive the motion ends (`arret`).
    Stop,
    /// If it is positive the state is put out (`out_put`).
    PutOut,
}

/// What an event asks for besides the state that it leads to.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Outcome {
    /// The motion ends.
    pub stops: bool,
    /// The state is put out.
    pub is_put_out: bool,
}

impl Event {
    /// Where it stands in the text.
    pub fn place(&self) -> &Place {
        &self.place
    }

    /// In which direction the condition passes zero where it happens.
    pub fn direction(&self) -> Direction {
        self.direction
    }

    /// Whether the condition or an assignment depends on the time.
    pub fn uses_time(&self) -> bool {
        self.condition.uses_time() || self.actions.iter().any(|(_, value)| value.uses_time())
    }

    /// The condition at a time, a state and the parameters of the model.
    pub fn condition<T: Scalar>(&self, time: T, state: &[T], parameters: &[T]) -> T {
        let mut value = [T::zero()];
        self.condition.evaluate(time, state, parameters, &mut value);
        value[0]
    }

    /// Takes a state to that behind the event.
    pub fn apply<T: Scalar>(&self, time: T, state: &mut [T], parameters: &[T]) -> Outcome {
        let mut outcome = Outcome::default();
        for (action, expression) in &self.actions {
            let mut value = [T::zero()];
            expression.evaluate(time, state, parameters, &mut value);
            let is_positive = value[0].value() > 0.0;
            match *action {
                Action::Assign(index) => state[index] = value[0],
                Action::Stop => outcome.stops |= is_positive,
                Action::PutOut => outcome.is_put_out |= is_positive,
            }
        }
        outcome
    }
}
