//! Guards of removable `0/0`: `if(abs(v+40)<1e-3)then(1)else(.1*(v+40)/(1-exp(-(v+40)/10)))`.
//!
//! Their authors did not want to divide zero by zero. Taken literally the field jumps twice on every passage, by next to nothing within
//! next to no time, and branches get stuck at these borders. The quotient is computed without `0/0` here, so that the guard can be
//! left out: where the value that it gives is that of the quotient, and the quotient differs from it by little where the guard holds.

use super::graph::{Graph, NodeId, Operation};
use crate::expression::{BinaryOperation, UnaryOperation};
use crate::tape::{apply_binary, apply_unary};
use std::collections::{BTreeSet, HashMap};

/// Relative difference, where the guard holds, between the value that it gives and the quotient up to which it is one.
const LARGEST_CHANGE: f64 = 1e-2;
/// Values of what else is in the quotient at which both are compared.
const OTHERS: [f64; 3] = [0.7, 1.3, -0.9];

/// A field without guards.
pub(crate) struct Unguarded {
    pub graph: Graph,
    pub field: Vec<NodeId>,
    /// The largest relative change of a quotient where its guard held.
    pub change: f64,
}

/// What a guard compares: the quantity next to zero and how near it has to be.
struct Guard {
    quantity: NodeId,
    width: NodeId,
}

impl Unguarded {
    /// The field, given by its nodes, without its guards at these parameters; `None` where it has none.
    pub(crate) fn of(graph: &Graph, field: &[NodeId], parameters: &[f64]) -> Option<Self> {
        let all = graph.operations();
        let used = graph.needed_for(field.iter().copied());
        let mut rewritten = Graph::default();
        let mut image = vec![0; all.len()];
        let mut change: Option<f64> = None;
        for (index, operation) in all.iter().enumerate().filter(|(index, _)| used[*index]) {
            let of = |node: NodeId| image[node as usize];
            image[index] = match *operation {
                Operation::Select(condition, yes, no) => {
                    match graph.guarded(condition, yes, no, parameters) {
                        Some((quotient, by)) => {
                            change = Some(change.unwrap_or(0.0).max(by));
                            of(quotient)
                        }
                        None => rewritten.select(of(condition), of(yes), of(no)),
                    }
                }
                Operation::Unary(operation, a) => rewritten.unary(operation, of(a)),
                Operation::Binary(operation, a, b) => rewritten.binary(operation, of(a), of(b)),
                Operation::WholePower(a, exponent) => {
                    rewritten.insert(Operation::WholePower(of(a), exponent))
                }
                leaf => rewritten.insert(leaf),
            };
        }
        let field = field.iter().map(|&node| image[node as usize]).collect();
        change.map(|change| Self { graph: rewritten, field, change })
    }
}

impl Graph {
    /// The quotient of which one of two alternatives is the value next to its `0/0`, with the relative change where the guard held.
    fn guarded(
        &self,
        condition: NodeId,
        yes: NodeId,
        no: NodeId,
        parameters: &[f64],
    ) -> Option<(NodeId, f64)> {
        let (guard, holds) = self.guard(condition)?;
        let (value, quotient) = if holds { (yes, no) } else { (no, yes) };
        if !self.is_removable_at(quotient, guard.quantity) {
            return None;
        }
        // What is moved so that the quantity is zero.
        let (moved, factor) = self.sum(guard.quantity).into_iter().find_map(|(node, factor)| {
            let varies = |node: &NodeId| !matches!(self.operation(*node), Operation::Parameter(_));
            Some((node.filter(varies)?, factor))
        })?;
        let compared = [value, quotient, guard.quantity, guard.width];
        let mut change = 0.0_f64;
        for others in OTHERS {
            let at = |start: f64| self.values(compared, parameters, others, (moved, start));
            let [_, _, quantity, width] = at(others);
            let zero = others - quantity / factor;
            let difference = |place: f64| {
                let [value, quotient, ..] = at(place);
                (value - quotient).abs() / value.abs().max(quotient.abs())
            };
            for side in [0.0, -1.0, 1.0] {
                let there = difference(zero + side * width / factor);
                // A number that does not exist is no small one.
                if there.is_nan() || there > LARGEST_CHANGE {
                    return None;
                }
                change = change.max(there);
            }
        }
        Some((quotient, change))
    }

    /// What a condition compares, if it is that of a guard, and whether the guard holds where the condition does.
    fn guard(&self, condition: NodeId) -> Option<(Guard, bool)> {
        use BinaryOperation::{Greater, GreaterOrEqual, Less, LessOrEqual};
        let Operation::Binary(comparison, a, b) = self.operation(condition) else { return None };
        let (smaller, larger) = match comparison {
            Less | LessOrEqual => (a, b),
            Greater | GreaterOrEqual => (b, a),
            _ => return None,
        };
        let quantity = |modulus: NodeId| match self.operation(modulus) {
            Operation::Unary(UnaryOperation::AbsoluteValue, quantity) => Some(quantity),
            _ => None,
        };
        match (quantity(smaller), quantity(larger)) {
            (Some(quantity), None) => Some((Guard { quantity, width: larger }, true)),
            (None, Some(quantity)) => Some((Guard { quantity, width: smaller }, false)),
            _ => None,
        }
    }

    /// Whether a node is computed from a removable `0/0` where a quantity is zero.
    fn is_removable_at(&self, node: NodeId, quantity: NodeId) -> bool {
        self.needed_nodes([node]).into_iter().any(|needed| match self.operation(needed) {
            Operation::Unary(UnaryOperation::RelativeExponential, exponent) => {
                self.multiple(quantity, exponent).is_some()
            }
            _ => false,
        })
    }

    /// The nodes that some are computed from, they themselves included, operands before what uses them.
    fn needed_nodes(&self, nodes: impl IntoIterator<Item = NodeId>) -> BTreeSet<NodeId> {
        let mut waiting: Vec<NodeId> = nodes.into_iter().collect();
        let mut needed = BTreeSet::new();
        while let Some(node) = waiting.pop() {
            if needed.insert(node) {
                waiting.extend(self.operation(node).operands());
            }
        }
        needed
    }

    /// Values of nodes at these parameters, where one node is moved to a value and all states are `others`.
    fn values<const N: usize>(
        &self,
        nodes: [NodeId; N],
        parameters: &[f64],
        others: f64,
        (moved, place): (NodeId, f64),
    ) -> [f64; N] {
        let mut values: HashMap<NodeId, f64> = HashMap::new();
        for node in self.needed_nodes(nodes) {
            let of = |operand: NodeId| values[&operand];
            let value = match self.operation(node) {
                _ if node == moved => place,
                Operation::Constant(bits) => f64::from_bits(bits),
                Operation::Time | Operation::State(_) => others,
                Operation::Parameter(parameter) => {
                    parameters.get(parameter as usize).copied().unwrap_or(others)
                }
                Operation::Unary(operation, a) => apply_unary(operation, of(a)),
                Operation::Binary(operation, a, b) => apply_binary(operation, of(a), of(b)),
                Operation::WholePower(a, exponent) => of(a).powi(exponent),
                Operation::Select(condition, yes, no) => {
                    if of(condition) == 0.0 {
                        of(no)
                    } else {
                        of(yes)
                    }
                }
            };
            values.insert(node, value);
        }
        nodes.map(|node| values[&node])
    }
}
