//! When a field switches: the times at which `heav`, `if`, `sign`, `mod`, `abs`, `min`, `max` and their like jump or have a kink, where
//! what they switch on depends on the time alone.
//!
//! The operations are evaluated with intervals of time, so that a time at which something switches cannot be missed, however
//! close others are.

use crate::compile::{Graph, NodeId, Operation};
use crate::expression::{BinaryOperation, UnaryOperation};
use crate::interval::Interval;
use crate::tape::apply_binary;

/// Most intervals that are looked at for one switch: then it is given up.
const MOST_INTERVALS: usize = 100_000;

/// Part of the time that is looked at below which two times are not told apart.
const FINEST: f64 = 1e-22;

/// A time at which the field switches, between two times that belong to either side.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Switch {
    /// The last time before it.
    pub before: f64,
    /// The first time after it.
    pub after: f64,
}

/// What switches when something becomes zero, or a whole number.
#[derive(Clone, Copy, Debug)]
enum Trigger {
    Zero(NodeId),
    Equal(NodeId, NodeId),
    Whole(NodeId),
    WholeQuotient(NodeId, NodeId),
}

/// Everything of a field that depends on the time alone, as far as it switches.
#[derive(Clone, Debug, Default)]
pub(crate) struct TimeSwitches {
    /// What the triggers need, operands before what uses them.
    operations: Vec<(NodeId, Operation)>,
    /// Number of nodes of the graph.
    nodes: usize,
    triggers: Vec<Trigger>,
}

impl TimeSwitches {
    /// The switches of a field, given by its nodes, and of the conditions of events, which switch at zero, too.
    pub(crate) fn of(graph: &Graph, field: &[NodeId], conditions: &[NodeId]) -> Self {
        let all = graph.operations();
        let used = graph.needed_for(field.iter().chain(conditions).copied());
        let mut of_time = vec![false; all.len()];
        let mut of_state = vec![false; all.len()];
        for (index, operation) in all.iter().enumerate() {
            of_time[index] = matches!(operation, Operation::Time)
                || operation.operands().any(|operand| of_time[operand as usize]);
            of_state[index] = matches!(operation, Operation::State(_))
                || operation.operands().any(|operand| of_state[operand as usize]);
        }
        let alone = |node: NodeId| !of_state[node as usize];
        let varies = |node: NodeId| alone(node) && of_time[node as usize];
        let triggers: Vec<Trigger> = all
            .iter()
            .zip(&used)
            .filter(|(_, used)| **used)
            .filter_map(|(operation, _)| trigger(*operation))
            .chain(conditions.iter().map(|condition| Trigger::Zero(*condition)))
            .filter(|trigger| match *trigger {
                Trigger::Zero(a) | Trigger::Whole(a) => varies(a),
                Trigger::Equal(a, b) | Trigger::WholeQuotient(a, b) => {
                    alone(a) && alone(b) && (varies(a) || varies(b))
                }
            })
            .collect();
        if triggers.is_empty() {
            return Self::default();
        }
        let needed = graph.needed_for(triggers.iter().flat_map(|trigger| trigger.nodes()));
        let operations = (0..).zip(all).filter(|(node, _)| needed[*node as usize]);
        Self {
            operations: operations.map(|(node, operation)| (node, *operation)).collect(),
            nodes: all.len(),
            triggers,
        }
    }

    /// The first time in `from..=until` at which something may switch; one that lies at `from` counts.
    pub(crate) fn next(&self, from: f64, until: f64, parameters: &[f64]) -> Result<Option<Switch>, GivenUp> {
        if self.triggers.is_empty() || from >= until {
            return Ok(None);
        }
        let finest = FINEST * (until - from);
        let mut looked_at = 0;
        let mut values = vec![Interval::point(0.0); self.nodes];
        let mut may_switch = |low: f64, high: f64| {
            looked_at += 1;
            if looked_at > MOST_INTERVALS {
                return Err(GivenUp { time: low });
            }
            self.evaluate(Interval { low, high }, parameters, &mut values);
            Ok(self.triggers.iter().any(|trigger| trigger.may_switch(&values)))
        };
        let mut waiting = vec![(from, until)];
        while let Some((low, high)) = waiting.pop() {
            if !may_switch(low, high)? {
                continue;
            }
            let middle = low + 0.5 * (high - low);
            if middle > low && middle < high && high - low > finest {
                waiting.push((middle, high));
                waiting.push((low, middle));
                continue;
            }
            // Rounding may make the switch wider. How far is asked of single spacings of numbers only: over longer intervals those of
            // several terms overlap without a switch.
            let mut after = high;
            let mut step = 0.0;
            while after < until && may_switch(after, after.next_up())? {
                let end = (after + step).max(after.next_up()).min(until);
                if may_switch(end, end.next_up())? {
                    step = 2.0 * (end - after);
                    after = end;
                } else {
                    step = 0.0;
                    after = after.next_up();
                }
            }
            return Ok(Some(Switch { before: low, after }));
        }
        Ok(None)
    }

    fn evaluate(&self, time: Interval, parameters: &[f64], values: &mut [Interval]) {
        for &(node, operation) in &self.operations {
            let value = |node: NodeId| values[node as usize];
            values[node as usize] = match operation {
                Operation::Constant(bits) => Interval::point(f64::from_bits(bits)),
                Operation::Time => time,
                Operation::Parameter(parameter) => Interval::point(parameters[parameter as usize]),
                Operation::Unary(operation, a) => value(a).unary(operation),
                Operation::Binary(operation, a, b) => value(a).binary(operation, value(b)),
                Operation::WholePower(a, exponent) => value(a).whole_power(exponent),
                Operation::Select(condition, yes, no) => match value(condition).truth() {
                    Some(true) => value(yes),
                    Some(false) => value(no),
                    None => value(yes).hull(value(no)),
                },
                // No trigger depends on a state.
                Operation::State(_) => Interval::ALL,
            };
        }
    }
}

/// A search for switches that came to no end.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GivenUp {
    /// From this time on switches are not known.
    pub time: f64,
}

fn trigger(operation: Operation) -> Option<Trigger> {
    use BinaryOperation as B;
    use UnaryOperation as U;
    match operation {
        Operation::Unary(U::Heaviside | U::Sign | U::AbsoluteValue | U::Not, a) => Some(Trigger::Zero(a)),
        Operation::Unary(U::Floor | U::Ceiling, a) => Some(Trigger::Whole(a)),
        Operation::Binary(B::Modulo, a, b) => Some(Trigger::WholeQuotient(a, b)),
        Operation::Binary(B::Maximum | B::Minimum, a, b) => Some(Trigger::Equal(a, b)),
        Operation::Binary(operation, a, b) if operation.is_comparison() => Some(Trigger::Equal(a, b)),
        Operation::Select(condition, ..) => Some(Trigger::Zero(condition)),
        _ => None,
    }
}

impl Trigger {
    /// What it depends on.
    fn nodes(self) -> impl Iterator<Item = NodeId> {
        let (first, second) = match self {
            Self::Zero(a) | Self::Whole(a) => (a, None),
            Self::Equal(a, b) | Self::WholeQuotient(a, b) => (a, Some(b)),
        };
        std::iter::once(first).chain(second)
    }

    fn may_switch(self, values: &[Interval]) -> bool {
        let value = |node: NodeId| values[node as usize];
        let varying = |interval: Interval| !interval.is_point();
        match self {
            Self::Zero(a) => varying(value(a)) && value(a).contains(0.0),
            Self::Equal(a, b) => {
                let (a, b) = (value(a), value(b));
                (varying(a) || varying(b)) && a.low <= b.high && b.low <= a.high
            }
            Self::Whole(a) => varying(value(a)) && holds_whole(value(a)),
            Self::WholeQuotient(a, b) => {
                let (a, b) = (value(a), value(b));
                let quotient = a.binary(BinaryOperation::Divide, b);
                // A remainder is exact, and its quotient may pass a whole number where the rounded one stands at it.
                let passes = || whole_quotient(a.low, b.low) != whole_quotient(a.high, b.high);
                varying(quotient) && holds_whole(quotient) || (varying(a) || varying(b)) && passes()
            }
        }
    }
}

/// How often the second number goes into the first, as `mod` has it.
fn whole_quotient(dividend: f64, divisor: f64) -> f64 {
    ((dividend - apply_binary(BinaryOperation::Modulo, dividend, divisor)) / divisor).round()
}

/// Whether a whole number lies in the interval.
fn holds_whole(interval: Interval) -> bool {
    interval.low.ceil() <= interval.high
}
