//! The graph of operations: every distinct operation once, constants folded.
//!
//! Equal subexpressions get the same node (hash consing), so what two equations have in common is
//! computed once. Rewrites are limited to those that are exact in floating-point arithmetic, except
//! that multiplication by a literal zero gives zero, that `0/0` which is none is removed (`removable`) and that powers of roots of
//! squares are powers of these (`norms`).

use crate::expression::{BinaryOperation, UnaryOperation};
use crate::tape::{apply_binary, apply_unary};
use std::collections::HashMap;

/// Index of a node in its graph; operands come before what uses them.
pub(crate) type NodeId = u32;

/// One operation of the graph.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(crate) enum Operation {
    /// A number, by its bits.
    Constant(u64),
    Time,
    State(u32),
    Parameter(u32),
    Unary(UnaryOperation, NodeId),
    Binary(BinaryOperation, NodeId, NodeId),
    /// A whole power other than those written as products.
    WholePower(NodeId, i32),
    /// The second if the first is not zero, else the third.
    Select(NodeId, NodeId, NodeId),
}

impl Operation {
    pub(crate) fn operands(self) -> impl Iterator<Item = NodeId> {
        let list = match self {
            Self::Constant(_) | Self::Time | Self::State(_) | Self::Parameter(_) => [None; 3],
            Self::Unary(_, a) | Self::WholePower(a, _) => [Some(a), None, None],
            Self::Binary(_, a, b) => [Some(a), Some(b), None],
            Self::Select(a, b, c) => [Some(a), Some(b), Some(c)],
        };
        list.into_iter().flatten()
    }

    /// Whether it has a kink or jumps where something passes a value.
    pub(crate) fn switches(self) -> bool {
        use BinaryOperation as B;
        use UnaryOperation as U;
        match self {
            Self::Unary(operation, _) => {
                matches!(operation, U::AbsoluteValue | U::Sign | U::Heaviside | U::Floor | U::Ceiling)
            }
            Self::Binary(B::Modulo | B::Maximum | B::Minimum, ..) => true,
            Self::Binary(operation, ..) => operation.is_comparison(),
            _ => false,
        }
    }
}

/// A set of operations without duplicates.
#[derive(Debug, Default)]
pub(crate) struct Graph {
    operations: Vec<Operation>,
    known: HashMap<Operation, NodeId>,
}

impl Graph {
    pub(crate) fn operations(&self) -> &[Operation] {
        &self.operations
    }

    /// Which nodes some are computed from, they themselves included.
    pub(crate) fn needed_for(&self, nodes: impl IntoIterator<Item = NodeId>) -> Vec<bool> {
        let mut needed = vec![false; self.operations.len()];
        nodes.into_iter().for_each(|node| needed[node as usize] = true);
        // Operands come before what uses them.
        for index in (0..needed.len()).rev() {
            if needed[index] {
                self.operations[index].operands().for_each(|operand| needed[operand as usize] = true);
            }
        }
        needed
    }

    /// Whether something that some nodes are computed from switches.
    pub(crate) fn any_switches(&self, nodes: &[NodeId]) -> bool {
        let needed = self.needed_for(nodes.iter().copied());
        self.operations.iter().zip(needed).any(|(operation, needed)| needed && operation.switches())
    }

    pub(crate) fn insert(&mut self, operation: Operation) -> NodeId {
        *self.known.entry(operation).or_insert_with(|| {
            self.operations.push(operation);
            (self.operations.len() - 1) as NodeId
        })
    }

    pub(crate) fn constant(&mut self, value: f64) -> NodeId {
        // One zero and one NaN, so that equal values are equal nodes.
        let value = if value == 0.0 { 0.0 } else { value };
        self.insert(Operation::Constant(if value.is_nan() { f64::NAN.to_bits() } else { value.to_bits() }))
    }

    pub(super) fn operation(&self, node: NodeId) -> Operation {
        self.operations[node as usize]
    }

    /// The value of a node that does not vary.
    pub(crate) fn constant_value(&self, node: NodeId) -> Option<f64> {
        match self.operations[node as usize] {
            Operation::Constant(bits) => Some(f64::from_bits(bits)),
            _ => None,
        }
    }

    pub(crate) fn unary(&mut self, operation: UnaryOperation, operand: NodeId) -> NodeId {
        if let Some(value) = self.constant_value(operand) {
            return self.constant(apply_unary(operation, value));
        }
        if operation == UnaryOperation::Negate {
            match self.operations[operand as usize] {
                Operation::Unary(UnaryOperation::Negate, inner) => return inner,
                Operation::Binary(BinaryOperation::Subtract, a, b) => {
                    return self.insert(Operation::Binary(BinaryOperation::Subtract, b, a));
                }
                Operation::Binary(scaling @ (BinaryOperation::Multiply | BinaryOperation::Divide), a, b) => {
                    // The sign goes into a constant factor or divisor.
                    for (constant, other, constant_first) in [(a, b, true), (b, a, false)] {
                        if let Some(value) = self.constant_value(constant) {
                            let constant = self.constant(-value);
                            let (a, b) = if constant_first { (constant, other) } else { (other, constant) };
                            return self.binary(scaling, a, b);
                        }
                    }
                }
                _ => {}
            }
        }
        if operation == UnaryOperation::SquareRoot
            && let Some(node) = self.root(operand)
        {
            return node;
        }
        self.insert(Operation::Unary(operation, operand))
    }

    pub(crate) fn binary(&mut self, operation: BinaryOperation, a: NodeId, b: NodeId) -> NodeId {
        use BinaryOperation::{Add, Divide, Multiply, Power, Subtract};
        let values = (self.constant_value(a), self.constant_value(b));
        if let (Some(a), Some(b)) = values {
            return self.constant(apply_binary(operation, a, b));
        }
        match (operation, values) {
            (Add, (Some(0.0), _)) | (Multiply, (Some(1.0), _)) => return b,
            (Add | Subtract, (_, Some(0.0))) | (Multiply | Divide, (_, Some(1.0))) => return a,
            (Multiply, (Some(0.0), _) | (_, Some(0.0))) => return self.constant(0.0),
            (Multiply, (Some(-1.0), _)) | (Subtract, (Some(0.0), _)) => {
                return self.unary(UnaryOperation::Negate, b);
            }
            (Multiply | Divide, (_, Some(-1.0))) => return self.unary(UnaryOperation::Negate, a),
            (Divide, (Some(1.0), _)) => return self.unary(UnaryOperation::Reciprocal, b),
            // Dividing by a power of two is multiplying by its reciprocal, exactly.
            (Divide, (_, Some(divisor))) if is_power_of_two(divisor) => {
                let reciprocal = self.constant(divisor.recip());
                return self.binary(Multiply, a, reciprocal);
            }
            (Power, (_, Some(exponent))) => return self.constant_power(a, b, exponent),
            _ => {}
        }
        if let (Add | Subtract | Multiply | Divide, Some(node)) =
            (operation, self.without_signs(operation, a, b))
        {
            return node;
        }
        if operation == Divide
            && let Some(node) = self.removable_quotient(a, b)
        {
            return node;
        }
        if operation == Multiply
            && let Some(node) = self.product_of_roots(a, b)
        {
            return node;
        }
        // Sums and products have one spelling.
        let (a, b) = if matches!(operation, Add | Multiply) { (a.min(b), a.max(b)) } else { (a, b) };
        self.insert(Operation::Binary(operation, a, b))
    }

    /// Moves negations of operands outwards or into a subtraction.
    fn without_signs(&mut self, operation: BinaryOperation, a: NodeId, b: NodeId) -> Option<NodeId> {
        use BinaryOperation::{Add, Divide, Multiply, Subtract};
        let negated = |graph: &Self, node: NodeId| match graph.operations[node as usize] {
            Operation::Unary(UnaryOperation::Negate, inner) => Some(inner),
            _ => None,
        };
        match (operation, negated(self, a), negated(self, b)) {
            (Add, _, Some(b)) => Some(self.binary(Subtract, a, b)),
            (Add, Some(a), None) => Some(self.binary(Subtract, b, a)),
            (Subtract, _, Some(b)) => Some(self.binary(Add, a, b)),
            (Subtract, Some(a), None) if self.constant_value(b).is_none() => {
                let sum = self.binary(Add, a, b);
                Some(self.unary(UnaryOperation::Negate, sum))
            }
            (Multiply | Divide, Some(a), Some(b)) => Some(self.binary(operation, a, b)),
            (Multiply | Divide, Some(a), None) => {
                let product = self.binary(operation, a, b);
                Some(self.unary(UnaryOperation::Negate, product))
            }
            (Multiply | Divide, None, Some(b)) => {
                let product = self.binary(operation, a, b);
                Some(self.unary(UnaryOperation::Negate, product))
            }
            _ => None,
        }
    }

    fn constant_power(&mut self, base: NodeId, exponent_node: NodeId, exponent: f64) -> NodeId {
        use BinaryOperation::Multiply;
        if exponent == 0.5 {
            return self.unary(UnaryOperation::SquareRoot, base);
        }
        if let Some(node) = self.power_of_root(base, exponent) {
            return node;
        }
        if exponent.fract() != 0.0 || exponent.abs() > f64::from(i32::MAX) {
            return self.insert(Operation::Binary(BinaryOperation::Power, base, exponent_node));
        }
        match exponent as i32 {
            0 => self.constant(1.0),
            1 => base,
            2 => self.binary(Multiply, base, base),
            3 => {
                let square = self.binary(Multiply, base, base);
                self.binary(Multiply, square, base)
            }
            4 => {
                let square = self.binary(Multiply, base, base);
                self.binary(Multiply, square, square)
            }
            -1 => self.unary(UnaryOperation::Reciprocal, base),
            power => self.insert(Operation::WholePower(base, power)),
        }
    }

    pub(crate) fn select(&mut self, condition: NodeId, yes: NodeId, no: NodeId) -> NodeId {
        match self.constant_value(condition) {
            Some(value) => {
                if value != 0.0 {
                    yes
                } else {
                    no
                }
            }
            None if yes == no => yes,
            None => self.insert(Operation::Select(condition, yes, no)),
        }
    }
}

fn is_power_of_two(value: f64) -> bool {
    /// Bits of the mantissa of a double.
    const MANTISSA: u64 = (1 << 52) - 1;
    value.is_normal() && value.recip().is_normal() && value.to_bits() & MANTISSA == 0
}
