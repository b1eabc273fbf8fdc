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
    let mut free: Vec<Register> =
        (0..inputs).filter(|&register| !occupied[register]).map(|register| register as Register).collect();
    // Constants keep their registers, which every evaluation begins with.
    let mut constants = Vec::new();
    for (node, operation) in operations.iter().enumerate() {
        if let (Operation::Constant(bits), Some(_)) = (*operation, last_use[node]) {
            register_of[node] = Register::try_from(inputs + constants.len()).ok()?;
            constants.push(f64::from_bits(bits));
            last_use[node] = Some(usize::MAX);
        }
    }
    let fixed = inputs + constants.len();
    let mut registers = fixed;
    let mut allotted = Vec::with_capacity(steps.len());
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
            register_of[node as usize] = match free.pop() {
                Some(register) => register,
                None if registers == MAXIMUM_REGISTERS => return None,
                None => {
                    registers += 1;
                    (registers - 1) as Register
                }
            };
        }
        let writes: Vec<Register> = step.writes.iter().map(|&node| register_of[node as usize]).collect();
        allotted.push((step.kind, reads, writes));
    }
    let results = results.iter().map(|&node| register_of[node as usize]);
    let program = if registers <= STACK_REGISTERS {
        let short = |registers: Vec<Register>| -> Vec<u8> {
            registers.into_iter().map(|register| register as u8).collect()
        };
        let instructions = allotted
            .into_iter()
            .map(|(kind, reads, writes)| instruction(kind, &short(reads), &short(writes)))
            .collect();
        Program::OnStack(Code { instructions, results: short(results.collect()) }.check(fixed, registers))
    } else {
        let instructions =
            allotted.into_iter().map(|(kind, reads, writes)| instruction(kind, &reads, &writes)).collect();
        Program::OnHeap(Code { instructions, results: results.collect() }.check(fixed, registers))
    };
    Some(Tape { program, states, parameters, constants, registers })
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
