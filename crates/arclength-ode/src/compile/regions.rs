//! The field of a model in a region: everything that switches on a state, replaced by what it is on one side.
//!
//! `abs`, `max`, `heav`, comparisons and their like become functions of the *cell* of a switch function: on which side of zero, or
//! between which whole numbers, it lies. The cells go in as parameters behind those of the model, so that what is left is smooth and
//! can be evaluated beyond the region's borders. What switches on parameters or the time alone stays as it is.

use super::graph::{Graph, NodeId, Operation};
use crate::expression::{BinaryOperation, UnaryOperation};
use crate::tape::apply_binary;
use arclength::Threshold;

/// The field in a region.
pub(crate) struct Regions {
    pub graph: Graph,
    /// The derivatives and then the switch functions.
    pub results: Vec<NodeId>,
    pub thresholds: Vec<Threshold>,
}

impl Regions {
    /// Of a field, given by its nodes, with this many parameters; `None` where nothing switches on a state, nor on the parameter that
    /// varies, given by its number.
    pub(crate) fn of(
        graph: &Graph,
        field: &[NodeId],
        parameters: usize,
        varying: Option<usize>,
    ) -> Option<Self> {
        let all = graph.operations();
        let used = graph.needed_for(field.iter().copied());
        let mut rewriting = Rewriting {
            graph: Graph::default(),
            parameters,
            switches: Vec::new(),
            varies: vec![false; all.len()],
            image: vec![0; all.len()],
        };
        for (index, operation) in all.iter().enumerate() {
            rewriting.varies[index] = match operation {
                Operation::State(_) => true,
                Operation::Parameter(parameter) => varying == Some(*parameter as usize),
                _ => operation.operands().any(|operand| rewriting.varies[operand as usize]),
            };
            if used[index] {
                rewriting.image[index] = rewriting.rewritten(*operation);
            }
        }
        let Rewriting { graph, switches, image, .. } = rewriting;
        let (functions, thresholds): (Vec<_>, Vec<_>) = switches.into_iter().unzip();
        let field = field.iter().map(|&node| image[node as usize]);
        let results = field.chain(functions).collect();
        (!thresholds.is_empty()).then_some(Self { graph, results, thresholds })
    }
}

struct Rewriting {
    graph: Graph,
    parameters: usize,
    switches: Vec<(NodeId, Threshold)>,
    /// Whether a node depends on a state, or on the parameter that varies.
    varies: Vec<bool>,
    /// What every node has become.
    image: Vec<NodeId>,
}

impl Rewriting {
    fn rewritten(&mut self, operation: Operation) -> NodeId {
        use BinaryOperation as B;
        use UnaryOperation as U;
        let image = |node: NodeId| self.image[node as usize];
        let depends = operation.operands().any(|operand| self.varies[operand as usize]);
        match operation {
            Operation::Unary(U::AbsoluteValue, a) if depends => {
                let a = image(a);
                let sign = self.cell(a, Threshold::Zero);
                self.graph.binary(B::Multiply, sign, a)
            }
            Operation::Unary(U::Sign, a) if depends => self.cell(image(a), Threshold::Zero),
            Operation::Unary(U::Heaviside, a) if depends => self.is_above(image(a)),
            Operation::Unary(U::Floor, a) if depends => self.cell(image(a), Threshold::Whole),
            Operation::Unary(U::Ceiling, a) if depends => {
                let floor = self.cell(image(a), Threshold::Whole);
                let one = self.graph.constant(1.0);
                self.graph.binary(B::Add, floor, one)
            }
            Operation::Binary(B::Modulo, a, b) if depends => {
                let (a, b) = (image(a), image(b));
                let quotient = self.graph.binary(B::Divide, a, b);
                let floor = self.cell(quotient, Threshold::Whole);
                let multiple = self.graph.binary(B::Multiply, floor, b);
                self.graph.binary(B::Subtract, a, multiple)
            }
            Operation::Binary(B::Maximum, a, b) if depends => {
                let (a, b) = (image(a), image(b));
                let is_first = self.exceeds(a, b);
                self.graph.select(is_first, a, b)
            }
            Operation::Binary(B::Minimum, a, b) if depends => {
                let (a, b) = (image(a), image(b));
                let is_second = self.exceeds(a, b);
                self.graph.select(is_second, b, a)
            }
            Operation::Binary(comparison, a, b) if depends && comparison.is_comparison() => {
                let (a, b) = (image(a), image(b));
                match comparison {
                    _ if a == b => self.graph.constant(apply_binary(comparison, 0.0, 0.0)),
                    B::Greater | B::GreaterOrEqual => self.exceeds(a, b),
                    B::Less | B::LessOrEqual => self.exceeds(b, a),
                    // Two quantities are equal on borders only.
                    _ => self.graph.constant(apply_binary(comparison, 0.0, 1.0)),
                }
            }
            Operation::Unary(operation, a) => self.graph.unary(operation, image(a)),
            Operation::Binary(operation, a, b) => self.graph.binary(operation, image(a), image(b)),
            Operation::WholePower(a, exponent) => {
                let operation = Operation::WholePower(image(a), exponent);
                self.graph.insert(operation)
            }
            Operation::Select(condition, yes, no) => {
                self.graph.select(image(condition), image(yes), image(no))
            }
            Operation::Constant(_) | Operation::Time | Operation::State(_) | Operation::Parameter(_) => {
                self.graph.insert(operation)
            }
        }
    }

    /// The cell of a switch function, as a parameter.
    fn cell(&mut self, function: NodeId, threshold: Threshold) -> NodeId {
        if let Some(value) = self.graph.constant_value(function) {
            return self.graph.constant(threshold.cell(value));
        }
        let switch = (function, threshold);
        let index = self.switches.iter().position(|known| *known == switch).unwrap_or_else(|| {
            self.switches.push(switch);
            self.switches.len() - 1
        });
        self.graph.insert(Operation::Parameter((self.parameters + index) as u32))
    }

    /// One above zero, zero below it.
    fn is_above(&mut self, function: NodeId) -> NodeId {
        let sign = self.cell(function, Threshold::Zero);
        self.half_of_one_more(sign)
    }

    /// One where the first is larger than the second, zero where it is smaller.
    fn exceeds(&mut self, a: NodeId, b: NodeId) -> NodeId {
        if a == b {
            return self.graph.constant(0.0);
        }
        // One switch for both orders.
        let difference = self.graph.binary(BinaryOperation::Subtract, a.min(b), a.max(b));
        let mut sign = self.cell(difference, Threshold::Zero);
        if b < a {
            sign = self.graph.unary(UnaryOperation::Negate, sign);
        }
        self.half_of_one_more(sign)
    }

    fn half_of_one_more(&mut self, sign: NodeId) -> NodeId {
        let half = self.graph.constant(0.5);
        let product = self.graph.binary(BinaryOperation::Multiply, half, sign);
        self.graph.binary(BinaryOperation::Add, product, half)
    }
}
