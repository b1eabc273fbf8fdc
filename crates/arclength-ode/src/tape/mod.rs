//! The compiled form of a model: a straight list of instructions over registers.
//!
//! Registers hold, in this order, the states, the parameters and then intermediate results, which
//! are reused as soon as they are dead. The number of registers is a power of two known to the
//! compiler ([`run`](Tape::run) picks the smallest that fits), so that the workspace lies on the
//! stack and an index masked by it needs no bounds check.

mod instruction;
mod schedule;
mod special;

pub(crate) use instruction::{apply_binary, apply_unary};
pub(crate) use schedule::schedule;

use arclength::Scalar;
use instruction::{Instruction, Register, execute};

/// A compiled list of quantities.
#[derive(Clone, Debug)]
pub(crate) struct Tape {
    instructions: Vec<Instruction>,
    /// Where the results are at the end.
    results: Vec<Register>,
    states: usize,
    parameters: usize,
    registers: usize,
}

impl Tape {
    /// Number of instructions.
    pub fn instructions(&self) -> usize {
        self.instructions.len()
    }

    /// Number of registers, states and parameters included.
    pub fn registers(&self) -> usize {
        self.registers
    }

    /// Whether the results depend on the time.
    pub fn uses_time(&self) -> bool {
        self.instructions.iter().any(|instruction| matches!(instruction, Instruction::Time(_)))
    }

    /// Evaluates the results at a time, state and parameters.
    pub fn evaluate<T: Scalar>(&self, time: T, state: &[T], parameters: &[T], results: &mut [T]) {
        match self.registers {
            0..=16 => self.run::<T, 16>(time, state, parameters, results),
            17..=32 => self.run::<T, 32>(time, state, parameters, results),
            33..=64 => self.run::<T, 64>(time, state, parameters, results),
            65..=128 => self.run::<T, 128>(time, state, parameters, results),
            129..=256 => self.run::<T, 256>(time, state, parameters, results),
            _ => self.run_on_heap(time, state, parameters, results),
        }
    }

    #[inline(never)]
    fn run<T: Scalar, const N: usize>(&self, time: T, state: &[T], parameters: &[T], results: &mut [T]) {
        let mut registers = [T::zero(); N];
        registers[..self.states].copy_from_slice(&state[..self.states]);
        registers[self.states..self.states + self.parameters].copy_from_slice(&parameters[..self.parameters]);
        for instruction in &self.instructions {
            execute(instruction, time, &mut registers);
        }
        for (result, register) in results.iter_mut().zip(&self.results) {
            *result = registers[*register as usize & (N - 1)];
        }
    }

    /// Models with more registers than the stack should hold pay for one allocation.
    #[inline(never)]
    fn run_on_heap<T: Scalar>(&self, time: T, state: &[T], parameters: &[T], results: &mut [T]) {
        let mut registers = vec![T::zero(); self.registers];
        registers[..self.states].copy_from_slice(&state[..self.states]);
        registers[self.states..self.states + self.parameters].copy_from_slice(&parameters[..self.parameters]);
        for instruction in &self.instructions {
            execute(instruction, time, registers.as_mut_slice());
        }
        for (result, register) in results.iter_mut().zip(&self.results) {
            *result = registers[*register as usize];
        }
    }
}
