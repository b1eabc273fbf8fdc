//! Tapes with registers on a small and a large stack and on the heap, over numbers and over duals: all ways through unsafe code, small
//! enough for Miri.

use super::{FEW_REGISTERS, Program, STACK_REGISTERS, Tape, schedule};
use crate::compile::{Graph, NodeId, Operation};
use crate::expression::BinaryOperation::{Add, Divide, Multiply};
use arclength::Dual;

/// The sum of `states` states, times a parameter, plus a half; and the first state over the last.
fn tape(states: usize) -> Tape {
    let mut graph = Graph::default();
    let all: Vec<NodeId> = (0..states).map(|index| graph.insert(Operation::State(index as u32))).collect();
    let sum = all[1..].iter().fold(all[0], |sum, &state| graph.binary(Add, sum, state));
    let parameter = graph.insert(Operation::Parameter(0));
    let half = graph.constant(0.5);
    let product = graph.binary(Multiply, sum, parameter);
    let results = [graph.binary(Add, product, half), graph.binary(Divide, all[0], all[states - 1])];
    schedule(&graph, &results, states, 1).expect("few enough registers")
}

fn check(states: usize, is_here: impl Fn(&Tape) -> bool) {
    let tape = tape(states);
    assert!(is_here(&tape), "{} registers", tape.registers());
    let state: Vec<f64> = (1..=states).map(|index| index as f64).collect();
    let (sum, last) = (state.iter().sum::<f64>(), states as f64);
    let mut values = [0.0; 2];
    tape.evaluate(0.0, &state, &[2.0], &mut values);
    assert_eq!(values, [2.0 * sum + 0.5, 1.0 / last]);
    // With respect to the first state and the parameter.
    let mut duals: Vec<Dual<f64, 2>> = state.iter().map(|value| Dual::constant(*value)).collect();
    duals[0] = Dual::variable(1.0, 0);
    let mut values = [Dual::constant(0.0); 2];
    tape.evaluate(Dual::constant(0.0), &duals, &[Dual::variable(2.0, 1)], &mut values);
    assert_eq!(values[0], Dual { value: 2.0 * sum + 0.5, derivatives: [2.0, sum] });
    assert_eq!(values[1], Dual { value: 1.0 / last, derivatives: [1.0 / last, 0.0] });
}

#[test]
fn few_registers() {
    check(3, |tape| tape.registers() <= FEW_REGISTERS);
}

#[test]
fn registers_that_fill_the_stack() {
    check(60, |tape| tape.registers() > FEW_REGISTERS && matches!(tape.program, Program::OnStack(_)));
}

#[test]
fn registers_on_the_heap() {
    check(STACK_REGISTERS + 1, |tape| matches!(tape.program, Program::OnHeap(_)));
}
