//! Orders the operations, picks instructions and allots registers.

use super::Tape;
use super::instruction::{Instruction, Register};
use crate::compile::{Graph, NodeId, Operation};
use crate::expression::{BinaryOperation, UnaryOperation};
use std::collections::HashMap;

/// Compiles the results of a graph to a tape; what they do not use is left out.
pub(crate) fn schedule(graph: &Graph, results: &[NodeId], states: usize, parameters: usize) -> Tape {
    let mut selection = Selection::new(graph, results);
    let order = evaluation_order(graph.operations(), results);
    for &node in &order {
        selection.select(node);
    }
    for &result in results {
        selection.materialize(result);
    }
    allot_registers(&selection.steps, graph.operations(), results, states, parameters)
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

/// An instruction over nodes instead of registers. What it reads and computes follows from the kind.
struct Step {
    kind: Kind,
    reads: Vec<NodeId>,
    writes: Vec<NodeId>,
}

enum Kind {
    Constant(f64),
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
    SineCosine,
    WholePower(i32),
    Select,
}

/// Picks instructions: constants go into operands, products into the sums that alone use them, and
/// sines and cosines of the same angle together.
struct Selection<'a> {
    graph: &'a Graph,
    steps: Vec<Step>,
    uses: Vec<u32>,
    /// Products that the sum using them computes itself.
    absorbed: Vec<bool>,
    /// Nodes that a step already computes.
    computed: Vec<bool>,
    /// The sine and the cosine of an angle.
    angles: HashMap<NodeId, [Option<NodeId>; 2]>,
}

impl<'a> Selection<'a> {
    fn new(graph: &'a Graph, results: &[NodeId]) -> Self {
        let operations = graph.operations();
        let order = evaluation_order(operations, results);
        let mut uses = vec![0_u32; operations.len()];
        let mut angles: HashMap<NodeId, [Option<NodeId>; 2]> = HashMap::new();
        for &node in &order {
            operations[node as usize].operands().for_each(|operand| uses[operand as usize] += 1);
            match operations[node as usize] {
                Operation::Unary(UnaryOperation::Sine, angle) => {
                    angles.entry(angle).or_default()[0] = Some(node)
                }
                Operation::Unary(UnaryOperation::Cosine, angle) => {
                    angles.entry(angle).or_default()[1] = Some(node);
                }
                _ => {}
            }
        }
        results.iter().for_each(|&result| uses[result as usize] += 1);
        let mut selection = Self {
            graph,
            steps: Vec::new(),
            uses,
            absorbed: vec![false; operations.len()],
            computed: vec![false; operations.len()],
            angles,
        };
        for &node in &order {
            if let Some((_, _, product)) = selection.fusion(node) {
                selection.absorbed[product as usize] = true;
            }
        }
        selection
    }

    /// For a sum or difference with a product that nothing else uses: the instruction, what it reads,
    /// and the product.
    fn fusion(&self, node: NodeId) -> Option<(Kind, [NodeId; 3], NodeId)> {
        use BinaryOperation::{Add, Multiply, Subtract};
        let constant = |node: NodeId| self.graph.constant_value(node).is_some();
        let factors = |node: NodeId| match self.graph.operations()[node as usize] {
            Operation::Binary(Multiply, a, b)
                if self.uses[node as usize] == 1 && !constant(a) && !constant(b) =>
            {
                Some((a, b))
            }
            _ => None,
        };
        let Operation::Binary(operation @ (Add | Subtract), left, right) =
            self.graph.operations()[node as usize]
        else {
            return None;
        };
        if constant(left) || constant(right) {
            return None;
        }
        if let Some((a, b)) = factors(left) {
            let kind = if operation == Add { Kind::MultiplyAdd } else { Kind::MultiplySubtract };
            return Some((kind, [a, b, right], left));
        }
        let (a, b) = factors(right)?;
        let kind = if operation == Add { Kind::MultiplyAdd } else { Kind::SubtractProduct };
        Some((kind, [a, b, left], right))
    }

    /// Adds the step that computes a node, unless another step does.
    fn select(&mut self, node: NodeId) {
        use BinaryOperation::{Add, Divide, Multiply, Subtract};
        if self.absorbed[node as usize] || self.computed[node as usize] {
            return;
        }
        if let Some((kind, reads, _)) = self.fusion(node) {
            return self.push(kind, &reads, &[node]);
        }
        match self.graph.operations()[node as usize] {
            Operation::State(_) | Operation::Parameter(_) | Operation::Constant(_) => {}
            Operation::Time => self.push(Kind::Time, &[], &[node]),
            Operation::WholePower(a, exponent) => self.push(Kind::WholePower(exponent), &[a], &[node]),
            Operation::Select(condition, yes, no) => self.push(Kind::Select, &[condition, yes, no], &[node]),
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
        reads.iter().for_each(|&read| self.materialize(read));
        writes.iter().for_each(|&node| self.computed[node as usize] = true);
        self.steps.push(Step { kind, reads: reads.to_vec(), writes: writes.to_vec() });
    }

    /// Puts a constant into a register if it is not there yet.
    fn materialize(&mut self, node: NodeId) {
        if let Some(value) = self.graph.constant_value(node)
            && !self.computed[node as usize]
        {
            self.computed[node as usize] = true;
            self.steps.push(Step { kind: Kind::Constant(value), reads: Vec::new(), writes: vec![node] });
        }
    }
}

/// Gives every node a register from its computation to its last use.
fn allot_registers(
    steps: &[Step],
    operations: &[Operation],
    results: &[NodeId],
    states: usize,
    parameters: usize,
) -> Tape {
    let inputs = states + parameters;
    let mut last_use: Vec<Option<usize>> = vec![None; operations.len()];
    for (index, step) in steps.iter().enumerate() {
        step.reads.iter().for_each(|&node| last_use[node as usize] = Some(index));
    }
    results.iter().for_each(|&node| last_use[node as usize] = Some(usize::MAX));

    let mut register_of: Vec<Register> = vec![0; operations.len()];
    let mut occupied = vec![false; inputs];
    for (node, operation) in operations.iter().enumerate() {
        let register = match *operation {
            _ if last_use[node].is_none() => continue,
            Operation::State(index) => index as usize,
            Operation::Parameter(index) => states + index as usize,
            _ => continue,
        };
        register_of[node] = register as Register;
        occupied[register] = true;
    }
    let mut free: Vec<Register> =
        (0..inputs as Register).filter(|&register| !occupied[register as usize]).collect();
    let mut registers = inputs as Register;
    let mut instructions = Vec::with_capacity(steps.len());
    for (index, step) in steps.iter().enumerate() {
        let reads: Vec<Register> = step.reads.iter().map(|&node| register_of[node as usize]).collect();
        let mut released: Vec<NodeId> = step.reads.clone();
        released.sort_unstable();
        released.dedup();
        for node in released {
            if last_use[node as usize] == Some(index) {
                free.push(register_of[node as usize]);
            }
        }
        for &node in &step.writes {
            register_of[node as usize] = free.pop().unwrap_or_else(|| {
                registers += 1;
                registers - 1
            });
        }
        let writes: Vec<Register> = step.writes.iter().map(|&node| register_of[node as usize]).collect();
        instructions.push(instruction(&step.kind, &reads, &writes));
    }
    Tape {
        instructions,
        results: results.iter().map(|&node| register_of[node as usize]).collect(),
        states,
        parameters,
        registers: registers as usize,
    }
}

fn instruction(kind: &Kind, reads: &[Register], writes: &[Register]) -> Instruction {
    use Instruction as I;
    let read = |index: usize| reads[index];
    let to = writes[0];
    match *kind {
        Kind::Constant(value) => I::Constant(value, to),
        Kind::Time => I::Time(to),
        Kind::Unary(UnaryOperation::Negate) => I::Negate(read(0), to),
        Kind::Unary(operation) => I::Unary(operation, read(0), to),
        Kind::Binary(BinaryOperation::Add) => I::Add(read(0), read(1), to),
        Kind::Binary(BinaryOperation::Subtract) => I::Subtract(read(0), read(1), to),
        Kind::Binary(BinaryOperation::Multiply) => I::Multiply(read(0), read(1), to),
        Kind::Binary(BinaryOperation::Divide) => I::Divide(read(0), read(1), to),
        Kind::Binary(operation) => I::Binary(operation, read(0), read(1), to),
        Kind::AddConstant(value) => I::AddConstant(read(0), value, to),
        Kind::MultiplyConstant(value) => I::MultiplyConstant(read(0), value, to),
        Kind::DivideByConstant(value) => I::DivideByConstant(read(0), value, to),
        Kind::SubtractFromConstant(value) => I::SubtractFromConstant(read(0), value, to),
        Kind::MultiplyAdd => I::MultiplyAdd(read(0), read(1), read(2), to),
        Kind::MultiplySubtract => I::MultiplySubtract(read(0), read(1), read(2), to),
        Kind::SubtractProduct => I::SubtractProduct(read(0), read(1), read(2), to),
        Kind::SineCosine => I::SineCosine(read(0), to, writes[1]),
        Kind::WholePower(exponent) => I::WholePower(read(0), exponent, to),
        Kind::Select => I::Select(read(0), read(1), read(2), to),
    }
}
