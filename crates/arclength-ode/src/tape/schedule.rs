//! Allots registers to the selected instructions.

use super::instruction::Instruction;
use super::selection::{Kind, Step, select};
use super::{Code, Program, STACK_REGISTERS, Tape};
use crate::compile::{Graph, NodeId, Operation};
use crate::expression::{BinaryOperation, UnaryOperation};

/// Largest number of registers that an instruction can name.
pub(crate) const MAXIMUM_REGISTERS: usize = u16::MAX as usize + 1;

/// Index of a register before it is known how many there are.
type Register = u16;

/// Compiles the results of a graph to a tape; what they do not use is left out.
///
/// `None` when the results need more than [`MAXIMUM_REGISTERS`].
pub(crate) fn schedule(graph: &Graph, results: &[NodeId], states: usize, parameters: usize) -> Option<Tape> {
    allot_registers(&select(graph, results), graph.operations(), results, states, parameters)
}

/// Gives every node a register from its computation to its last use.
fn allot_registers(
    steps: &[Step],
    operations: &[Operation],
    results: &[NodeId],
    states: usize,
    parameters: usize,
) -> Option<Tape> {
    let mut allotment = Allotment::of_inputs(steps, operations, results, states, parameters)?;
    let constants = allotment.hold_constants(operations)?;
    let fixed = allotment.count;
    let mut allotted = Vec::with_capacity(steps.len());
    for (index, step) in steps.iter().enumerate() {
        let reads = allotment.registers_of(&step.reads);
        allotment.release(index, step);
        allotment.allot(step)?;
        allotted.push((step.kind, reads, allotment.registers_of(&step.writes)));
    }
    let (registers, results) = (allotment.count, allotment.registers_of(results));
    let program = if registers <= STACK_REGISTERS {
        let short = |registers: Vec<Register>| -> Vec<u8> {
            registers.into_iter().map(|register| register as u8).collect()
        };
        let instructions = allotted
            .into_iter()
            .map(|(kind, reads, writes)| instruction(kind, &short(reads), &short(writes)))
            .collect();
        Program::OnStack(Code { instructions, results: short(results) }.check(fixed, registers))
    } else {
        let instructions =
            allotted.into_iter().map(|(kind, reads, writes)| instruction(kind, &reads, &writes)).collect();
        Program::OnHeap(Code { instructions, results }.check(fixed, registers))
    };
    Some(Tape { program, states, parameters, constants, registers })
}

/// Which node is where.
struct Allotment {
    /// The step that reads a node last, by the node; of results and constants none does.
    last_use: Vec<Option<usize>>,
    register_of: Vec<Register>,
    free: Vec<Register>,
    /// Number of registers so far.
    count: usize,
}

impl Allotment {
    /// States and parameters have the first registers; those that nothing reads are free.
    fn of_inputs(
        steps: &[Step],
        operations: &[Operation],
        results: &[NodeId],
        states: usize,
        parameters: usize,
    ) -> Option<Self> {
        let inputs = states + parameters;
        if inputs > MAXIMUM_REGISTERS {
            return None;
        }
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
        let free = (0..inputs).filter(|&register| !occupied[register]).map(|register| register as Register);
        Some(Self { free: free.collect(), last_use, register_of, count: inputs })
    }

    /// Constants keep their registers, which every evaluation begins with. Their values, in order.
    fn hold_constants(&mut self, operations: &[Operation]) -> Option<Vec<f64>> {
        let mut constants = Vec::new();
        for (node, operation) in operations.iter().enumerate() {
            if let (Operation::Constant(bits), Some(_)) = (*operation, self.last_use[node]) {
                self.register_of[node] = Register::try_from(self.count).ok()?;
                self.count += 1;
                constants.push(f64::from_bits(bits));
                self.last_use[node] = Some(usize::MAX);
            }
        }
        Some(constants)
    }

    fn registers_of(&self, nodes: &[NodeId]) -> Vec<Register> {
        nodes.iter().map(|&node| self.register_of[node as usize]).collect()
    }

    /// Frees the registers of what the step of that index reads for the last time.
    fn release(&mut self, index: usize, step: &Step) {
        let mut released = step.reads.clone();
        released.sort_unstable();
        released.dedup();
        for node in released {
            if self.last_use[node as usize] == Some(index) {
                self.free.push(self.register_of[node as usize]);
            }
        }
    }

    /// Gives registers to what a step writes; `None` where there are no more.
    fn allot(&mut self, step: &Step) -> Option<()> {
        for &node in &step.writes {
            self.register_of[node as usize] = match self.free.pop() {
                Some(register) => register,
                None if self.count == MAXIMUM_REGISTERS => return None,
                None => {
                    self.count += 1;
                    (self.count - 1) as Register
                }
            };
        }
        Some(())
    }
}

fn instruction<R: Copy>(kind: Kind, reads: &[R], writes: &[R]) -> Instruction<R> {
    use Instruction as I;
    let to = writes[0];
    match (kind, reads) {
        (Kind::Unary(UnaryOperation::Negate), &[a]) => I::Negate(a, to),
        (Kind::Unary(UnaryOperation::Reciprocal), &[a]) => I::Reciprocal(a, to),
        (Kind::Unary(UnaryOperation::Exponential), &[a]) => I::Exponential(a, to),
        (Kind::Unary(operation), &[a]) => I::Unary(operation, a, to),
        (Kind::Binary(BinaryOperation::Add), &[a, b]) => I::Add(a, b, to),
        (Kind::Binary(BinaryOperation::Subtract), &[a, b]) => I::Subtract(a, b, to),
        (Kind::Binary(BinaryOperation::Multiply), &[a, b]) => I::Multiply(a, b, to),
        (Kind::Binary(BinaryOperation::Divide), &[a, b]) => I::Divide(a, b, to),
        (Kind::Binary(operation), &[a, b]) => I::Binary(operation, a, b, to),
        (Kind::AddConstant(value), &[a]) => I::AddConstant(a, value, to),
        (Kind::MultiplyConstant(value), &[a]) => I::MultiplyConstant(a, value, to),
        (Kind::DivideByConstant(value), &[a]) => I::DivideByConstant(a, value, to),
        (Kind::SubtractFromConstant(value), &[a]) => I::SubtractFromConstant(a, value, to),
        (Kind::MultiplyAdd, &[a, b, c]) => I::MultiplyAdd(a, b, c, to),
        (Kind::MultiplySubtract, &[a, b, c]) => I::MultiplySubtract(a, b, c, to),
        (Kind::SubtractProduct, &[a, b, c]) => I::SubtractProduct(a, b, c, to),
        (Kind::SumOfProducts, &[a, b, c, d]) => I::SumOfProducts([a, b, c, d], to),
        (Kind::DifferenceOfProducts, &[a, b, c, d]) => I::DifferenceOfProducts([a, b, c, d], to),
        (Kind::MultiplyAddAddProduct, &[a, b, c, d, e]) => I::MultiplyAddAddProduct([a, b, c, d, e], to),
        (Kind::MultiplyAddSubtractProduct, &[a, b, c, d, e]) => {
            I::MultiplyAddSubtractProduct([a, b, c, d, e], to)
        }
        (Kind::MultiplySubtractSubtractProduct, &[a, b, c, d, e]) => {
            I::MultiplySubtractSubtractProduct([a, b, c, d, e], to)
        }
        (Kind::SubtractTwoProducts, &[a, b, c, d, e]) => I::SubtractTwoProducts([a, b, c, d, e], to),
        (Kind::SumAddProduct, &[a, b, c, d]) => I::SumAddProduct([a, b, c, d], to),
        (Kind::SumSubtractProduct, &[a, b, c, d]) => I::SumSubtractProduct([a, b, c, d], to),
        (Kind::DifferenceAddProduct, &[a, b, c, d]) => I::DifferenceAddProduct([a, b, c, d], to),
        (Kind::DifferenceSubtractProduct, &[a, b, c, d]) => I::DifferenceSubtractProduct([a, b, c, d], to),
        (Kind::SumOfProductsAddProduct, &[a, b, c, d, e, f]) => {
            I::SumOfProductsAddProduct([a, b, c, d, e, f], to)
        }
        (Kind::SumOfProductsSubtractProduct, &[a, b, c, d, e, f]) => {
            I::SumOfProductsSubtractProduct([a, b, c, d, e, f], to)
        }
        (Kind::DifferenceOfProductsAddProduct, &[a, b, c, d, e, f]) => {
            I::DifferenceOfProductsAddProduct([a, b, c, d, e, f], to)
        }
        (Kind::DifferenceOfProductsSubtractProduct, &[a, b, c, d, e, f]) => {
            I::DifferenceOfProductsSubtractProduct([a, b, c, d, e, f], to)
        }
        (Kind::MultiplyMultiply, &[a, b, c]) => I::MultiplyMultiply(a, b, c, to),
        (Kind::AddMultiply, &[a, b, c]) => I::AddMultiply(a, b, c, to),
        (Kind::SubtractMultiply, &[a, b, c]) => I::SubtractMultiply(a, b, c, to),
        (Kind::MultiplyDivide, &[a, b, c]) => I::MultiplyDivide(a, b, c, to),
        (Kind::ScaleAdd(value), &[a, b]) => I::ScaleAdd(a, b, value, to),
        (Kind::ScaleSubtract(value), &[a, b]) => I::ScaleSubtract(a, b, value, to),
        (Kind::SubtractScaled(value), &[a, b]) => I::SubtractScaled(a, b, value, to),
        (Kind::AddConstantMultiply(value), &[a, b]) => I::AddConstantMultiply(a, b, value, to),
        (Kind::SubtractFromConstantMultiply(value), &[a, b]) => {
            I::SubtractFromConstantMultiply(a, b, value, to)
        }
        (Kind::SineCosine, &[a]) => I::SineCosine(a, to, writes[1]),
        (Kind::WholePower(exponent), &[a]) => I::WholePower(a, exponent, to),
        (Kind::Select, &[condition, yes, no]) => I::Select(condition, yes, no, to),
        // Of the kinds only the time reads nothing.
        _ => I::Time(to),
    }
}
