//! The compiled form of a model: a straight list of instructions over registers.
//!
//! Registers hold, in this order, the states, the parameters, constants and then intermediate results,
//! which are reused as soon as they are dead. Nearly every model gets by with 256 registers: a workspace
//! of fixed size on the stack, with indices of one byte that need no check. Others allocate theirs.

mod instruction;
mod registers;
mod schedule;
mod selection;
mod special;
#[cfg(test)]
mod tests;

pub(crate) use instruction::{apply_binary, apply_unary};
pub(crate) use schedule::{MAXIMUM_REGISTERS, schedule};

use arclength::Scalar;
use instruction::{Instruction, execute};
use registers::{Registers, STACK_REGISTERS, Stack, for_few};

/// A compiled list of quantities.
#[derive(Clone, Debug)]
pub(crate) struct Tape {
    program: Program,
    states: usize,
    parameters: usize,
    constants: Vec<f64>,
    registers: usize,
}

/// Registers of a workspace that is small enough for the stack not to be probed page by page.
const FEW_REGISTERS: usize = 32;

/// Whether a scalar is longer than a number. Its arithmetic takes longer than the instructions around it: what saves some of these
/// is not compiled once more for every such scalar.
const fn is_long<T>() -> bool {
    size_of::<T>() > size_of::<f64>()
}

/// Invariant: every register that an instruction or a result reads is below the number of registers
/// and holds a state, a parameter or a constant, or was written by an earlier instruction.
#[derive(Clone, Debug)]
enum Program {
    OnStack(Code<u8>),
    OnHeap(Code<u16>),
}

#[derive(Clone, Debug)]
struct Code<R> {
    instructions: Vec<Instruction<R>>,
    /// Where the results are at the end.
    results: Vec<R>,
}

impl<R: Copy + Into<usize>> Code<R> {
    /// # Panics
    ///
    /// If the invariant of [`Program`] does not hold, which no model can bring about.
    fn check(self, inputs: usize, registers: usize) -> Self {
        let mut written = vec![false; registers];
        written[..inputs].fill(true);
        for instruction in &self.instructions {
            let (reads, writes) = instruction.registers();
            assert!(reads.into_iter().all(|register| written[register.into()]), "read before written");
            writes.into_iter().for_each(|register| written[register.into()] = true);
        }
        assert!(self.results.iter().all(|&register| written[register.into()]), "result never written");
        self
    }

    #[inline(always)]
    fn run<T: Scalar>(&self, registers: &mut impl Registers<T, R>, time: T, results: &mut [T]) {
        if const { is_long::<T>() } {
            for instruction in &self.instructions {
                execute(instruction, time, registers);
            }
        } else {
            // Two at a time: less counting, and two indirect jumps are easier to predict than one.
            let (pairs, last) = self.instructions.as_chunks::<2>();
            for [first, second] in pairs {
                execute(first, time, registers);
                execute(second, time, registers);
            }
            if let [last] = last {
                execute(last, time, registers);
            }
        }
        let count = results.len().min(self.results.len());
        let (results, sources) = (&mut results[..count], &self.results[..count]);
        for_few!(count, index => results[index] = registers.read(sources[index]));
    }

    fn uses_time(&self) -> bool {
        self.instructions.iter().any(|instruction| matches!(instruction, Instruction::Time(_)))
    }
}

impl Tape {
    /// Number of instructions.
    pub(crate) fn instructions(&self) -> usize {
        match &self.program {
            Program::OnStack(code) => code.instructions.len(),
            Program::OnHeap(code) => code.instructions.len(),
        }
    }

    /// Number of registers, states and parameters included.
    pub(crate) fn registers(&self) -> usize {
        self.registers
    }

    /// Whether the results depend on the time.
    pub(crate) fn uses_time(&self) -> bool {
        match &self.program {
            Program::OnStack(code) => code.uses_time(),
            Program::OnHeap(code) => code.uses_time(),
        }
    }

    /// Evaluates the results at a time, state and parameters.
    pub(crate) fn evaluate<T: Scalar>(&self, time: T, state: &[T], parameters: &[T], results: &mut [T]) {
        // The same operations, so the same results, but on longer vectors: worth it for dual numbers.
        #[cfg(target_arch = "x86_64")]
        if const { is_long::<T>() } && is_x86_feature_detected!("avx2") {
            // SAFETY: the processor has these instructions.
            return unsafe { self.evaluate_vectorized(time, state, parameters, results) };
        }
        self.evaluate_kernel(time, state, parameters, results);
    }

    #[cfg(target_arch = "x86_64")]
    #[target_feature(enable = "avx2")]
    fn evaluate_vectorized<T: Scalar>(&self, time: T, state: &[T], parameters: &[T], results: &mut [T]) {
        self.evaluate_kernel(time, state, parameters, results);
    }

    #[inline(always)]
    fn run_on_stack<T: Scalar, const N: usize>(
        &self,
        code: &Code<u8>,
        time: T,
        state: &[T],
        parameters: &[T],
        results: &mut [T],
    ) {
        // SAFETY: the invariant of `Program`, with no more registers than `N`; states, parameters and constants are written first.
        let mut registers = unsafe { Stack::<T, N>::new() };
        registers.load(0, state, |value| value);
        registers.load(self.states, parameters, |value| value);
        registers.load(self.states + self.parameters, &self.constants, T::from);
        code.run(&mut registers, time, results);
    }

    #[inline(always)]
    fn evaluate_kernel<T: Scalar>(&self, time: T, state: &[T], parameters: &[T], results: &mut [T]) {
        let state = &state[..self.states];
        let parameters = &parameters[..self.parameters];
        match &self.program {
            Program::OnStack(code) => {
                if const { !is_long::<T>() } && self.registers <= FEW_REGISTERS {
                    self.run_on_stack::<T, FEW_REGISTERS>(code, time, state, parameters, results);
                } else {
                    self.run_on_stack::<T, STACK_REGISTERS>(code, time, state, parameters, results);
                }
            }
            Program::OnHeap(code) => {
                let mut registers = vec![T::zero(); self.registers];
                registers.load(0, state, |value| value);
                registers.load(self.states, parameters, |value| value);
                registers.load(self.states + self.parameters, &self.constants, T::from);
                code.run(&mut registers, time, results);
            }
        }
    }
}
