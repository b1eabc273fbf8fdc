//! Orders the operations and picks instructions.
//!
//! Constants go into operands, sines and cosines of the same angle together, and a product, sum or
//! difference that a single operation uses is computed by that operation's instruction: half as many
//! instructions are half the cost of interpreting them. The rounding of every operation stays.

use crate::compile::{Graph, NodeId, Operation};
use crate::expression::{BinaryOperation, UnaryOperation};
use std::collections::HashMap;

/// An instruction over nodes instead of registers.
pub(super) struct Step {
    pub kind: Kind,
    pub reads: Vec<NodeId>,
    pub writes: Vec<NodeId>,
}

/// The instructions of [`Instruction`](super::instruction::Instruction), without their registers.
#[derive(Clone, Copy)]
pub(super) enum Kind {
    Time,
    Unary(UnaryOperation),
    Binary(BinaryOperation),
    AddConstant(f64),
    MultiplyConstant(f64),
    DivideByConstant(f64),
    SubtractFromConstant(f64),
    MultiplyAdd,
    MultiplySubtract,
    SubtractProduct,
    SumOfProducts,
    DifferenceOfProducts,
    MultiplyAddAddProduct,
    MultiplyAddSubtractProduct,
    MultiplySubtractSubtractProduct,
    SubtractTwoProducts,
    SumAddProduct,
    SumSubtractProduct,
    DifferenceAddProduct,
    DifferenceSubtractProduct,
    SumOfProductsAddProduct,
    SumOfProductsSubtractProduct,
    DifferenceOfProductsAddProduct,
    DifferenceOfProductsSubtractProduct,
    MultiplyMultiply,
    AddMultiply,
    SubtractMultiply,
    MultiplyDivide,
    ScaleAdd(f64),
    ScaleSubtract(f64),
    SubtractScaled(f64),
    AddConstantMultiply(f64),
    SubtractFromConstantMultiply(f64),
    SineCosine,
    WholePower(i32),
    Select,
}

/// The instructions that compute the results, in order.
pub(super) fn select(graph: &Graph, results: &[NodeId]) -> Vec<Step> {
    let order = evaluation_order(graph.operations(), results);
    let mut selection = Selection::new(graph, results, &order);
    // Users before what they use, so that an operation knows whether it is absorbed before it absorbs.
    for &node in order.iter().rev() {
        if !selection.absorbed[node as usize]
            && let Some(fusion) = selection.fusion(node)
        {
            fusion.absorbed.iter().flatten().for_each(|&node| selection.absorbed[node as usize] = true);
            selection.fusions.insert(node, (fusion.kind, fusion.reads));
        }
    }
    for &node in &order {
        selection.select(node);
    }
    selection.steps
}

/// Operations that the results need, operands first, result after result.
fn evaluation_order(operations: &[Operation], results: &[NodeId]) -> Vec<NodeId> {
    let mut visited = vec![false; operations.len()];
    let mut order = Vec::new();
    // The second entry says that the operands are already done.
    let mut stack = Vec::new();
    for &result in results {
        stack.push((result, false));
        while let Some((node, ready)) = stack.pop() {
            if ready {
                order.push(node);
            } else if !std::mem::replace(&mut visited[node as usize], true) {
                stack.push((node, true));
                let first = stack.len();
                stack.extend(operations[node as usize].operands().map(|operand| (operand, false)));
                stack[first..].reverse();
            }
        }
    }
    order
}

/// One instruction for an operation and some of those that its operands come from.
struct Fusion {
    kind: Kind,
    reads: Vec<NodeId>,
    absorbed: [Option<NodeId>; 4],
}

impl Fusion {
    fn of_one(kind: Kind, reads: &[NodeId], absorbed: NodeId) -> Option<Self> {
        Some(Self { kind, reads: reads.to_vec(), absorbed: [Some(absorbed), None, None, None] })
    }
}

struct Selection<'a> {
    graph: &'a Graph,
    steps: Vec<Step>,
    uses: Vec<u32>,
    fusions: HashMap<NodeId, (Kind, Vec<NodeId>)>,
    /// Operations that the instruction of their user computes.
    absorbed: Vec<bool>,
    /// Nodes that a step already computes.
    computed: Vec<bool>,
    /// The sine and the cosine of an angle.
    angles: HashMap<NodeId, [Option<NodeId>; 2]>,
}

impl<'a> Selection<'a> {
    fn new(graph: &'a Graph, results: &[NodeId], order: &[NodeId]) -> Self {
        let operations = graph.operations();
        let mut uses = vec![0_u32; operations.len()];
        let mut angles: HashMap<NodeId, [Option<NodeId>; 2]> = HashMap::new();
        for &node in order {
            operations[node as usize].operands().for_each(|operand| uses[operand as usize] += 1);
            match operations[node as usize] {
                Operation::Unary(UnaryOperation::Sine, angle) => {
                    angles.entry(angle).or_default()[0] = Some(node);
                }
                Operation::Unary(UnaryOperation::Cosine, angle) => {
                    angles.entry(angle).or_default()[1] = Some(node);
                }
                _ => {}
            }
        }
        results.iter().for_each(|&result| uses[result as usize] += 1);
        Self {
            graph,
            steps: Vec::new(),
            uses,
            fusions: HashMap::new(),
            absorbed: vec![false; operations.len()],
            computed: vec![false; operations.len()],
            angles,
        }
    }

    /// The operands of an operation of that kind which nothing else uses.
    fn operands_of(&self, node: NodeId, wanted: BinaryOperation) -> Option<(NodeId, NodeId)> {
        match self.graph.operations()[node as usize] {
            Operation::Binary(operation, a, b) if operation == wanted && self.uses[node as usize] == 1 => {
                Some((a, b))
            }
            _ => None,
        }
    }

    /// As [`operands_of`](Self::operands_of), if neither operand is constant.
    fn varying(&self, node: NodeId, wanted: BinaryOperation) -> Option<(NodeId, NodeId)> {
        self.operands_of(node, wanted).filter(|&(a, b)| !self.is_constant(a) && !self.is_constant(b))
    }

    /// The varying factor and the constant one of a product that nothing else uses.
    fn scaled(&self, node: NodeId) -> Option<(NodeId, f64)> {
        let (a, b) = self.operands_of(node, BinaryOperation::Multiply)?;
        match (self.graph.constant_value(a), self.graph.constant_value(b)) {
            (Some(value), None) => Some((b, value)),
            (None, Some(value)) => Some((a, value)),
            _ => None,
        }
    }

    fn is_constant(&self, node: NodeId) -> bool {
        self.graph.constant_value(node).is_some()
    }

    fn fusion(&self, node: NodeId) -> Option<Fusion> {
        let Operation::Binary(operation, left, right) = self.graph.operations()[node as usize] else {
            return None;
        };
        if self.is_constant(left) || self.is_constant(right) {
            return None;
        }
        match operation {
            BinaryOperation::Add | BinaryOperation::Subtract => self.fused_sum(operation, left, right),
            BinaryOperation::Multiply => {
                self.fused_product(left, right).or_else(|| self.fused_product(right, left))
            }
            BinaryOperation::Divide => {
                let (a, b) = self.varying(left, BinaryOperation::Multiply)?;
                Fusion::of_one(Kind::MultiplyDivide, &[a, b, right], left)
            }
            _ => None,
        }
    }

    /// A sum or difference with products.
    fn fused_sum(&self, operation: BinaryOperation, left: NodeId, right: NodeId) -> Option<Fusion> {
        let is_sum = operation == BinaryOperation::Add;
        let products = [left, right].map(|node| self.operands_of(node, BinaryOperation::Multiply));
        let varying = [left, right].map(|node| self.varying(node, BinaryOperation::Multiply));
        // A constant factor stays within the instruction, unless there are two products.
        let products = if products.iter().all(Option::is_some) && varying.iter().any(Option::is_some) {
            products
        } else {
            varying
        };
        match products.into() {
            (Some((a, b)), Some((c, d))) => {
                let kind = if is_sum { Kind::SumOfProducts } else { Kind::DifferenceOfProducts };
                let absorbed = [Some(left), (left != right).then_some(right), None, None];
                return Some(Fusion { kind, reads: vec![a, b, c, d], absorbed });
            }
            (Some((a, b)), None) => {
                let kind = if is_sum { Kind::MultiplyAdd } else { Kind::MultiplySubtract };
                return Fusion::of_one(kind, &[a, b, right], left);
            }
            (None, Some((a, b))) => {
                if let Some(fusion) = self.fused_sum_of_three(is_sum, left, right, (a, b)) {
                    return Some(fusion);
                }
                let kind = if is_sum { Kind::MultiplyAdd } else { Kind::SubtractProduct };
                return Fusion::of_one(kind, &[a, b, left], right);
            }
            (None, None) => {}
        }
        if let Some((a, value)) = self.scaled(left) {
            let kind = if is_sum { Kind::ScaleAdd(value) } else { Kind::ScaleSubtract(value) };
            return Fusion::of_one(kind, &[a, right], left);
        }
        let (a, value) = self.scaled(right)?;
        let kind = if is_sum { Kind::ScaleAdd(value) } else { Kind::SubtractScaled(value) };
        Fusion::of_one(kind, &[a, left], right)
    }

    /// A sum or difference `left`, to which the product `right` of `last` is added or from which it is subtracted.
    fn fused_sum_of_three(
        &self,
        is_sum: bool,
        left: NodeId,
        right: NodeId,
        last: (NodeId, NodeId),
    ) -> Option<Fusion> {
        use BinaryOperation::{Add, Multiply, Subtract};
        let sum = self.varying(left, Add);
        let (one, other) = sum.or_else(|| self.varying(left, Subtract))?;
        let signs = (sum.is_some(), is_sum);
        let products = (self.varying(one, Multiply), self.varying(other, Multiply));
        let (kind, mut reads) = match products {
            (None, None) => {
                let kind = match signs {
                    (true, true) => Kind::SumAddProduct,
                    (true, false) => Kind::SumSubtractProduct,
                    (false, true) => Kind::DifferenceAddProduct,
                    (false, false) => Kind::DifferenceSubtractProduct,
                };
                (kind, vec![one, other])
            }
            (Some((a, b)), Some((c, d))) => {
                let kind = match signs {
                    (true, true) => Kind::SumOfProductsAddProduct,
                    (true, false) => Kind::SumOfProductsSubtractProduct,
                    (false, true) => Kind::DifferenceOfProductsAddProduct,
                    (false, false) => Kind::DifferenceOfProductsSubtractProduct,
                };
                (kind, vec![a, b, c, d])
            }
            (Some((a, b)), None) | (None, Some((a, b))) => {
                let first = products.0.is_some();
                let kind = match signs {
                    (true, true) => Kind::MultiplyAddAddProduct,
                    (true, false) => Kind::MultiplyAddSubtractProduct,
                    (false, false) if first => Kind::MultiplySubtractSubtractProduct,
                    (false, false) => Kind::SubtractTwoProducts,
                    (false, true) => return None,
                };
                (kind, vec![a, b, if first { other } else { one }])
            }
        };
        reads.extend([last.0, last.1]);
        let absorbed = [Some(left), Some(right), products.0.map(|_| one), products.1.map(|_| other)];
        Some(Fusion { kind, reads, absorbed })
    }

    /// A product of a product, sum or difference.
    fn fused_product(&self, inner: NodeId, other: NodeId) -> Option<Fusion> {
        use BinaryOperation::{Add, Multiply, Subtract};
        if let Some((a, b)) = self.varying(inner, Multiply) {
            return Fusion::of_one(Kind::MultiplyMultiply, &[a, b, other], inner);
        }
        if let Some((a, b)) = self.operands_of(inner, Add) {
            return match (self.graph.constant_value(a), self.graph.constant_value(b)) {
                (Some(value), _) => Fusion::of_one(Kind::AddConstantMultiply(value), &[b, other], inner),
                (_, Some(value)) => Fusion::of_one(Kind::AddConstantMultiply(value), &[a, other], inner),
                _ => Fusion::of_one(Kind::AddMultiply, &[a, b, other], inner),
            };
        }
        let (a, b) = self.operands_of(inner, Subtract)?;
        match (self.graph.constant_value(a), self.graph.constant_value(b)) {
            (Some(value), _) => Fusion::of_one(Kind::SubtractFromConstantMultiply(value), &[b, other], inner),
            (_, Some(value)) => Fusion::of_one(Kind::AddConstantMultiply(-value), &[a, other], inner),
            _ => Fusion::of_one(Kind::SubtractMultiply, &[a, b, other], inner),
        }
    }

    /// Adds the step that computes a node, unless another step does.
    fn select(&mut self, node: NodeId) {
        use BinaryOperation::{Add, Divide, Multiply, Subtract};
        if self.absorbed[node as usize] || self.computed[node as usize] {
            return;
        }
        if let Some((kind, reads)) = self.fusions.remove(&node) {
            return self.push(kind, &reads, &[node]);
        }
        match self.graph.operations()[node as usize] {
            Operation::State(_) | Operation::Parameter(_) | Operation::Constant(_) => {}
            Operation::Time => self.push(Kind::Time, &[], &[node]),
            Operation::WholePower(a, exponent) => self.push(Kind::WholePower(exponent), &[a], &[node]),
            Operation::Select(condition, yes, no) => {
                self.push(Kind::Select, &[condition, yes, no], &[node]);
            }
            Operation::Unary(operation, a) => match self.angles.get(&a).copied() {
                Some([Some(sine), Some(cosine)]) if node == sine || node == cosine => {
                    self.push(Kind::SineCosine, &[a], &[sine, cosine]);
                }
                _ => self.push(Kind::Unary(operation), &[a], &[node]),
            },
            Operation::Binary(operation, a, b) => {
                let constants = (self.graph.constant_value(a), self.graph.constant_value(b));
                let (kind, read) = match (operation, constants) {
                    (Add, (Some(value), _)) => (Kind::AddConstant(value), b),
                    (Add, (_, Some(value))) => (Kind::AddConstant(value), a),
                    (Subtract, (_, Some(value))) => (Kind::AddConstant(-value), a),
                    (Subtract, (Some(value), _)) => (Kind::SubtractFromConstant(value), b),
                    (Multiply, (Some(value), _)) => (Kind::MultiplyConstant(value), b),
                    (Multiply, (_, Some(value))) => (Kind::MultiplyConstant(value), a),
                    (Divide, (_, Some(value))) => (Kind::DivideByConstant(value), a),
                    _ => return self.push(Kind::Binary(operation), &[a, b], &[node]),
                };
                self.push(kind, &[read], &[node]);
            }
        }
    }

    fn push(&mut self, kind: Kind, reads: &[NodeId], writes: &[NodeId]) {
        writes.iter().for_each(|&node| self.computed[node as usize] = true);
        self.steps.push(Step { kind, reads: reads.to_vec(), writes: writes.to_vec() });
    }
}
