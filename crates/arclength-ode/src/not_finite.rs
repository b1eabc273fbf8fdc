//! Why a right-hand side has no value: which equation it is, and in which quantity the first number that is none comes up.

use crate::compile::{Graph, Lowering, NodeId, Operation, Scope};
use crate::declarations::Declarations;
use crate::error::Place;
use crate::expression::{BinaryOperation, UnaryOperation};
use crate::model::Model;
use crate::name::Name;
use crate::source::physical_lines;
use crate::tape::{apply_binary, apply_unary};
use std::fmt;

/// A right-hand side that is not finite, and why.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct NotFinite {
    /// The state whose right-hand side it is.
    pub state: String,
    /// The quantity `k=..` in which it comes up, or the state.
    pub name: String,
    /// Where that is defined.
    pub place: Place,
    /// What comes up: "a division by zero", for example.
    pub cause: &'static str,
}

impl fmt::Display for NotFinite {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { state, name, place, cause } = self;
        write!(formatter, "the right-hand side of {state} is not finite: {cause}")?;
        let of = if name == state { String::new() } else { format!(" in {name}") };
        write!(formatter, "{of} (line {})", place.line)
    }
}

impl Model {
    /// The first right-hand side that is not finite at a time, state and parameters, and why; nothing where all are finite.
    pub fn not_finite(&self, time: f64, state: &[f64], parameters: &[f64]) -> Option<NotFinite> {
        let source = self.source();
        // A model that was read is read once more, for what its tape has no names of.
        let declarations = Declarations::read(source).ok()?;
        let mut lowering = Lowering::new(&declarations.symbols);
        let mut definitions: Vec<(NodeId, &Name)> = Vec::new();
        for (index, quantity) in declarations.symbols.fixed.iter().enumerate() {
            if let Some(node) = lowering.fixed_quantity(index).ok()? {
                definitions.push((node, &quantity.name));
            }
        }
        let equations = declarations.equations.iter();
        let results = equations.map(|equation| lowering.lower(equation, Scope::Field));
        let results = results.collect::<Result<Vec<_>, _>>().ok()?;
        let values = values(&lowering.graph, time, state, parameters);
        let equation = results.iter().position(|&result| !values[result as usize].is_finite())?;
        let needed = lowering.graph.needed_for([results[equation]]);
        // A value that is none comes from the first that is none; else from the first infinite one.
        let first =
            |is_it: fn(f64) -> bool| (0..needed.len()).find(|&node| needed[node] && is_it(values[node]));
        let found = if values[results[equation] as usize].is_nan() { first(f64::is_nan) } else { None };
        let found = found.or_else(|| first(|value| !value.is_finite()))?;
        // What makes infinite numbers that make none of one another is told in place of that.
        let operands: Vec<usize> =
            lowering.graph.operations()[found].operands().map(|node| node as usize).collect();
        let before = operands.into_iter().find(|&node| !values[node].is_finite()).and_then(|operand| {
            let behind = lowering.graph.needed_for([operand as NodeId]);
            (0..behind.len()).find(|&node| behind[node] && !values[node].is_finite())
        });
        let culprit = before.unwrap_or(found);
        let within = |node: NodeId| needed[node as usize] && lowering.graph.needed_for([node])[culprit];
        let state_name = &declarations.symbols.states[equation];
        let quantity = definitions.iter().filter(|(node, _)| within(*node)).min_by_key(|(node, _)| *node);
        let name = quantity.map_or(state_name, |(_, name)| *name);
        let mut place: Place = name.span.into();
        place.fill(&physical_lines(source).collect::<Vec<_>>());
        let cause = cause(lowering.graph.operations()[culprit], &values);
        Some(NotFinite { state: state_name.text.clone(), name: name.text.clone(), place, cause })
    }
}

fn values(graph: &Graph, time: f64, state: &[f64], parameters: &[f64]) -> Vec<f64> {
    let mut values: Vec<f64> = Vec::with_capacity(graph.operations().len());
    for operation in graph.operations() {
        let value = |node: NodeId| values[node as usize];
        let next = match *operation {
            Operation::Constant(bits) => f64::from_bits(bits),
            Operation::Time => time,
            Operation::State(index) => state[index as usize],
            Operation::Parameter(index) => parameters[index as usize],
            Operation::Unary(of, a) => apply_unary(of, value(a)),
            Operation::Binary(of, a, b) => apply_binary(of, value(a), value(b)),
            Operation::WholePower(a, exponent) => value(a).powi(exponent),
            Operation::Select(condition, yes, no) => value(if value(condition) != 0.0 { yes } else { no }),
        };
        values.push(next);
    }
    values
}

fn cause(operation: Operation, values: &[f64]) -> &'static str {
    use BinaryOperation as B;
    use UnaryOperation as U;
    let is_zero = |node: NodeId| values[node as usize] == 0.0;
    match operation {
        Operation::Parameter(_) => "a parameter is infinite",
        Operation::Unary(U::Reciprocal, a) if is_zero(a) => "a division by zero",
        Operation::Binary(B::Divide | B::Modulo, _, b) if is_zero(b) => "a division by zero",
        Operation::WholePower(a, ..0) if is_zero(a) => "a division by zero",
        Operation::Unary(U::Logarithm | U::DecimalLogarithm | U::BinaryLogarithm, _) => {
            "the logarithm of a number that is not positive"
        }
        Operation::Unary(U::SquareRoot, _) => "the root of a negative number",
        Operation::Unary(U::InverseSine | U::InverseCosine, _) => {
            "the inverse sine or cosine of a number beyond 1"
        }
        Operation::Binary(B::Power, a, _) if values[a as usize] < 0.0 => "a power of a negative number",
        Operation::Binary(B::Power, a, _) if is_zero(a) => "a negative power of zero",
        Operation::Constant(_) => "a constant that is not finite",
        _ => "a number too large",
    }
}
