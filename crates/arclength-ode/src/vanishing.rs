//! States that stay zero once they are: every term of their right-hand sides has one of them as a factor.
//!
//! Populations, the infected of an epidemic, amplitudes: `x' = x*(1 - x)`. Such a state never passes zero, and its growth from a small value
//! depends on its own size only.

use crate::compile::{Graph, NodeId, Operation};
use crate::expression::{BinaryOperation, UnaryOperation};

/// The right-hand side of a model, to be asked which of its states stay zero.
#[derive(Debug)]
pub struct Vanishing {
    pub(crate) graph: Graph,
    pub(crate) field: Vec<NodeId>,
}

/// What is known of a quantity where some states are zero.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Value {
    Zero,
    /// A number that may be any.
    Any,
    /// Perhaps none: a quotient by zero, its logarithm, or what has no slope there.
    Pole,
}

impl Vanishing {
    /// Whether these states, given by their numbers, stay zero together once they are, whatever the others, the parameters and the time
    /// are.
    ///
    /// ```
    /// let model = arclength_ode::Model::parse("s'=-s*i\ne'=s*i-e\ni'=e-i\nr'=i\ndone\n")?;
    /// let vanishing = model.vanishing().unwrap();
    /// assert!(vanishing.stay_zero(&[0]) && vanishing.stay_zero(&[1, 2]));
    /// assert!(!vanishing.stay_zero(&[1]) && !vanishing.stay_zero(&[3]));
    /// # Ok::<(), arclength_ode::OdeError>(())
    /// ```
    pub fn stay_zero(&self, states: &[usize]) -> bool {
        let mut values: Vec<Value> = Vec::with_capacity(self.graph.operations().len());
        for operation in self.graph.operations() {
            let of = |node: NodeId| values[node as usize];
            values.push(match *operation {
                Operation::State(state) if states.contains(&(state as usize)) => Value::Zero,
                Operation::Constant(bits) if f64::from_bits(bits) == 0.0 => Value::Zero,
                Operation::Constant(_) | Operation::Time | Operation::State(_) | Operation::Parameter(_) => {
                    Value::Any
                }
                Operation::Unary(operation, a) => unary(operation, of(a)),
                Operation::Binary(operation, a, b) => {
                    binary(operation, [of(a), of(b)], self.graph.constant_value(b))
                }
                Operation::WholePower(a, exponent) => power(of(a), f64::from(exponent)),
                Operation::Select(condition, yes, no) => match [of(condition), of(yes), of(no)] {
                    [_, Value::Zero, Value::Zero] => Value::Zero,
                    values if values.contains(&Value::Pole) => Value::Pole,
                    _ => Value::Any,
                },
            });
        }
        states.iter().all(|&state| values[self.field[state] as usize] == Value::Zero)
    }
}

fn unary(operation: UnaryOperation, a: Value) -> Value {
    use UnaryOperation as U;
    match (operation, a) {
        (_, Value::Pole) => Value::Pole,
        (_, Value::Any) => Value::Any,
        (
            U::Negate
            | U::Sine
            | U::Tangent
            | U::InverseSine
            | U::InverseTangent
            | U::HyperbolicSine
            | U::HyperbolicTangent
            | U::AbsoluteValue
            | U::ErrorFunction,
            Value::Zero,
        ) => Value::Zero,
        (
            U::Reciprocal
            | U::SquareRoot
            | U::Logarithm
            | U::DecimalLogarithm
            | U::BinaryLogarithm
            | U::BesselY(_),
            Value::Zero,
        ) => Value::Pole,
        _ => Value::Any,
    }
}

fn binary(operation: BinaryOperation, values: [Value; 2], exponent: Option<f64>) -> Value {
    use BinaryOperation as B;
    let both_zero = values == [Value::Zero; 2];
    match operation {
        _ if values.contains(&Value::Pole) => Value::Pole,
        B::Multiply if values.contains(&Value::Zero) => Value::Zero,
        B::Divide => match values {
            [_, Value::Zero] => Value::Pole,
            [one, _] => one,
        },
        B::Power => exponent.map_or(Value::Pole, |exponent| power(values[0], exponent)),
        B::Add | B::Subtract | B::Maximum | B::Minimum if both_zero => Value::Zero,
        _ => Value::Any,
    }
}

/// A power of a constant exponent; below one it has no slope at zero.
fn power(base: Value, exponent: f64) -> Value {
    match base {
        Value::Zero if exponent >= 1.0 => Value::Zero,
        Value::Zero => Value::Pole,
        other => other,
    }
}
