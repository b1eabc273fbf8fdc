//! Event functions and their zeros along a solution.

use super::chebyshev::ChebyshevPartition;
use super::{Stepper, System};
use crate::direction::Direction;

/// Relative resolution of the time of an event: four units in the last place.
const TIME_RESOLUTION: f64 = 4.0 * f64::EPSILON;
/// Iterations of root finding; each one at least halves the bracket every second time.
const MAXIMUM_ITERATIONS: usize = 200;

/// A function of time and state.
type EventFunction<'a> = dyn FnMut(f64, &[f64]) -> f64 + 'a;

/// A function of time and state whose zeros along the solution are located.
///
/// The function is resolved inside every step by Chebyshev interpolation, so that
/// crossings faster than the steps are found, pairs included. A zero at which the function does not change
/// its sign is no crossing. A zero at the very start does not count.
pub struct Event<'a> {
    pub(super) function: Box<EventFunction<'a>>,
    direction: Direction,
    pub(super) is_terminal: bool,
    is_before: bool,
}

impl<'a> Event<'a> {
    /// An event at the zeros of `function(time, state)`, in either direction, that does not end the integration.
    pub fn new(function: impl FnMut(f64, &[f64]) -> f64 + 'a) -> Self {
        Self {
            function: Box::new(function),
            direction: Direction::Either,
            is_terminal: false,
            is_before: false,
        }
    }

    /// Counts crossings in these directions only.
    pub fn direction(mut self, direction: Direction) -> Self {
        self.direction = direction;
        self
    }

    /// Counts crossings from negative to positive only.
    pub fn rising(mut self) -> Self {
        self.direction = Direction::Rising;
        self
    }

    /// Counts crossings from positive to negative only.
    pub fn falling(mut self) -> Self {
        self.direction = Direction::Falling;
        self
    }

    /// Locates crossings at the last time before the zero, not at the first one behind it.
    pub fn before(mut self) -> Self {
        self.is_before = true;
        self
    }

    /// Ends the integration at the first crossing that counts.
    pub fn terminal(mut self) -> Self {
        self.is_terminal = true;
        self
    }
}

impl std::fmt::Debug for Event<'_> {
    fn fmt(&self, formatter: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let Self { direction, is_terminal, is_before, .. } = self;
        formatter
            .debug_struct("Event")
            .field("direction", direction)
            .field("is_terminal", is_terminal)
            .field("is_before", is_before)
            .finish()
    }
}

/// A zero of an event function.
#[derive(Clone, Debug, PartialEq)]
pub struct Crossing {
    /// Index of the event function.
    pub event: usize,
    /// Time of the crossing, within rounding: on the far side of the zero, or on the near one for an event that asks for that.
    pub time: f64,
    /// State at that time.
    pub state: Vec<f64>,
    /// [`Direction::Rising`] or [`Direction::Falling`], in the direction of integration.
    pub direction: Direction,
}

/// Follows the signs of event functions along an integration that is advanced step by step.
#[derive(Debug)]
pub struct EventLocator {
    partition: ChebyshevPartition,
    /// Last sign that was not zero of each function.
    signs: Vec<f64>,
    scratch: Vec<f64>,
}

impl EventLocator {
    /// At the start of an integration.
    pub fn new(events: &mut [Event], time: f64, state: &[f64]) -> Self {
        let signs = events.iter_mut().map(|event| sign((event.function)(time, state))).collect();
        Self { partition: ChebyshevPartition::new(), signs, scratch: vec![0.0; state.len()] }
    }

    /// At the start of an integration of a state of `dimension` numbers from where the event functions count as having these signs,
    /// even if they are zero or, by rounding, have others.
    pub fn from_signs(signs: Vec<f64>, dimension: usize) -> Self {
        Self { partition: ChebyshevPartition::new(), signs, scratch: vec![0.0; dimension] }
    }

    /// The last sign that was not zero of each event function, at the end of the last step without a terminal crossing.
    pub fn signs(&self) -> &[f64] {
        &self.signs
    }

    /// Appends the crossings of the last step to `crossings`, in the order in which they are passed, up to
    /// the first terminal one; returns whether there was a terminal one.
    pub fn locate<S: System>(
        &mut self,
        stepper: &mut Stepper<S>,
        events: &mut [Event],
        crossings: &mut Vec<Crossing>,
    ) -> bool {
        stepper.prepare_dense_output();
        // On the clock of the stepper, whose steps may be shorter than what rounding leaves of the time.
        let ([start, end], resolved) = stepper.last_step_on_clock();
        let first = crossings.len();
        let scratch = &mut self.scratch;
        for (index, event) in events.iter_mut().enumerate() {
            let Event { function, direction, is_terminal, is_before } = event;
            let function = std::cell::RefCell::new((function, &mut *scratch));
            let evaluate = |time: f64| {
                let (function, scratch) = &mut *function.borrow_mut();
                stepper.interpolate_on_clock(time, scratch);
                function(stepper.absolute(time), scratch)
            };
            let at = |fraction: f64| if fraction == 1.0 { end } else { start + fraction * (end - start) };
            let last_sign = &mut self.signs[index];
            let mut last_time = start;
            self.partition.visit_pieces(
                |fraction| evaluate(at(fraction)),
                |fraction, value| {
                    let (time, new_sign) = (at(fraction), sign(value));
                    let mut keep_on = true;
                    if new_sign * *last_sign < 0.0 {
                        let passed = if new_sign > 0.0 { Direction::Rising } else { Direction::Falling };
                        if *direction == Direction::Either || *direction == passed {
                            let [before, behind] =
                                sides_of_zero(&evaluate, [last_time, time], value, resolved);
                            crossings.push(Crossing {
                                event: index,
                                time: if *is_before { before } else { behind },
                                state: Vec::new(),
                                direction: passed,
                            });
                            keep_on = !*is_terminal;
                        }
                    }
                    if new_sign != 0.0 {
                        *last_sign = new_sign;
                        last_time = time;
                    }
                    keep_on
                },
            );
        }
        let ordering = (end - start).signum();
        crossings[first..].sort_by(|a, b| (ordering * a.time).total_cmp(&(ordering * b.time)));
        let terminal = crossings[first..].iter().position(|crossing| events[crossing.event].is_terminal);
        if let Some(position) = terminal {
            crossings.truncate(first + position + 1);
        }
        for crossing in &mut crossings[first..] {
            crossing.state.resize(scratch.len(), 0.0);
            stepper.interpolate_on_clock(crossing.time, &mut crossing.state);
            crossing.time = stepper.absolute(crossing.time);
        }
        terminal.is_some()
    }
}

fn sign(value: f64) -> f64 {
    if value > 0.0 {
        1.0
    } else if value < 0.0 {
        -1.0
    } else {
        0.0
    }
}

/// Narrows a change of sign between `near` and `far` (Illinois variant of regula falsi, with a bisection
/// whenever that is slow) and returns the ends of the bracket, of which the second has the sign of the far end. Times are told apart
/// relative to their size and to `resolved`.
fn sides_of_zero(
    function: &impl Fn(f64) -> f64,
    [near, far]: [f64; 2],
    value_at_far: f64,
    resolved: f64,
) -> [f64; 2] {
    let far_sign = sign(value_at_far);
    let (mut a, mut b, mut value_a, mut value_b) = (near, far, function(near), value_at_far);
    if sign(value_a) == far_sign {
        return [near; 2];
    }
    for iteration in 0..MAXIMUM_ITERATIONS {
        let width = (b - a).abs();
        if width <= TIME_RESOLUTION * a.abs().max(b.abs()).max(resolved) {
            break;
        }
        let middle = 0.5 * (a + b);
        let secant = b - value_b * (b - a) / (value_b - value_a);
        let inside = (secant - a) * (b - secant) > 0.0;
        let candidate = if inside && iteration % 3 != 2 { secant } else { middle };
        if candidate == a || candidate == b {
            break;
        }
        let value = function(candidate);
        if sign(value) == far_sign {
            (b, value_b) = (candidate, value);
            value_a *= 0.5;
        } else {
            (a, value_a) = (candidate, value);
            value_b *= 0.5;
        }
    }
    [a, b]
}
