//! Models built node by node: what a program that has its equations as operations, not as text, makes a [`Model`] of.
//!
//! The model is one of `.ode` text like any other: [`ModelBuilder::build`] writes the nodes as text and reads that, so that result
//! files hold it, expressions can be monitored on it and the programs go on from it. What is used more than once is written once, as a
//! quantity of its own, and numbers are written so that they are read back as the same.

use crate::error::OdeError;
use crate::expression::{Builtin, lookup_builtin, reserved};
use crate::model::Model;
use crate::source::{is_identifier_part, is_identifier_start};
use std::fmt::Write;

/// Operations that are nested in one expression at most; deeper ones get quantities of their own.
const DEEPEST: u32 = 24;

/// A value in a [`ModelBuilder`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct BuiltNode(usize);

/// An operation between two values, as the language writes it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[allow(missing_docs)] // the names say it
pub enum Operator {
    Add,
    Subtract,
    Multiply,
    Divide,
    Power,
    Greater,
    Less,
    GreaterOrEqual,
    LessOrEqual,
    Equal,
    NotEqual,
    And,
    Or,
}

impl Operator {
    const fn symbol(self) -> &'static str {
        match self {
            Self::Add => "+",
            Self::Subtract => "-",
            Self::Multiply => "*",
            Self::Divide => "/",
            Self::Power => "^",
            Self::Greater => ">",
            Self::Less => "<",
            Self::GreaterOrEqual => ">=",
            Self::LessOrEqual => "<=",
            Self::Equal => "==",
            Self::NotEqual => "!=",
            Self::And => "&",
            Self::Or => "|",
        }
    }
}

#[derive(Clone, Debug)]
enum Kind {
    Constant(f64),
    Name(String),
    Negate(BuiltNode),
    Binary(Operator, BuiltNode, BuiltNode),
    Call(String, Vec<BuiltNode>),
    Select(BuiltNode, BuiltNode, BuiltNode),
}

impl Kind {
    fn operands(&self) -> Vec<BuiltNode> {
        match self {
            Self::Constant(_) | Self::Name(_) => Vec::new(),
            Self::Negate(a) => vec![*a],
            Self::Binary(_, a, b) => vec![*a, *b],
            Self::Call(_, arguments) => arguments.clone(),
            Self::Select(condition, yes, no) => vec![*condition, *yes, *no],
        }
    }
}

/// Builds a model node by node.
///
/// ```
/// use arclength::VectorField;
/// use arclength_ode::{ModelBuilder, Operator};
///
/// let mut builder = ModelBuilder::new();
/// let mu = builder.parameter("mu", 1.0)?;
/// let x = builder.state("x", 2.0)?;
/// let decay = builder.binary(Operator::Multiply, mu, x);
/// let slope = builder.negate(decay);
/// builder.equation(x, slope)?;
/// let model = builder.build()?;
/// let mut derivative = [0.0];
/// model.evaluate(&[2.0], &[3.0], &mut derivative);
/// assert_eq!(derivative, [-6.0]);
/// # Ok::<(), arclength_ode::OdeError>(())
/// ```
#[derive(Clone, Debug, Default)]
pub struct ModelBuilder {
    nodes: Vec<Kind>,
    parameters: Vec<(String, f64)>,
    /// Name, initial value, node, right-hand side.
    states: Vec<(String, f64, BuiltNode, Option<BuiltNode>)>,
}

impl ModelBuilder {
    /// A model with nothing in it.
    pub fn new() -> Self {
        Self::default()
    }

    fn push(&mut self, kind: Kind) -> BuiltNode {
        self.nodes.push(kind);
        BuiltNode(self.nodes.len() - 1)
    }

    /// That a name can be declared.
    fn check(&self, name: &str) -> Result<(), OdeError> {
        let refuse =
            |problem: &str| Err(OdeError::Name { name: name.to_owned(), problem: problem.to_owned() });
        if !name.starts_with(is_identifier_start) || !name.chars().all(is_identifier_part) {
            return refuse(
                "names consist of the letters a to z and A to Z, digits and underscores, and begin with no digit",
            );
        }
        if reserved(&name.to_ascii_lowercase()) {
            return refuse("the language of models has it for something else");
        }
        let parameters = self.parameters.iter().map(|(name, _)| name);
        if parameters
            .chain(self.states.iter().map(|state| &state.0))
            .any(|other| other.eq_ignore_ascii_case(name))
        {
            return refuse("there is one already, perhaps written with other capital letters");
        }
        Ok(())
    }

    /// Declares a parameter with its default value.
    ///
    /// # Errors
    /// [`OdeError::Name`]: a name that cannot be declared, or a value that is not finite.
    pub fn parameter(&mut self, name: &str, value: f64) -> Result<BuiltNode, OdeError> {
        self.check(name)?;
        finite(name, value)?;
        self.parameters.push((name.to_owned(), value));
        Ok(self.push(Kind::Name(name.to_owned())))
    }

    /// Declares a state with its initial value.
    ///
    /// # Errors
    /// [`OdeError::Name`]: a name that cannot be declared, or a value that is not finite.
    pub fn state(&mut self, name: &str, initial: f64) -> Result<BuiltNode, OdeError> {
        self.check(name)?;
        finite(name, initial)?;
        let node = self.push(Kind::Name(name.to_owned()));
        self.states.push((name.to_owned(), initial, node, None));
        Ok(node)
    }

    /// A number.
    ///
    /// # Errors
    /// [`OdeError::Name`] where it is not finite.
    pub fn constant(&mut self, value: f64) -> Result<BuiltNode, OdeError> {
        finite("constant", value)?;
        Ok(self.push(Kind::Constant(value)))
    }

    /// The negative.
    pub fn negate(&mut self, operand: BuiltNode) -> BuiltNode {
        self.push(Kind::Negate(operand))
    }

    /// An operation between two values. Comparisons are 1 where they hold, else 0.
    pub fn binary(&mut self, operator: Operator, first: BuiltNode, second: BuiltNode) -> BuiltNode {
        self.push(Kind::Binary(operator, first, second))
    }

    /// A function of the language, such as `sin` or `atan2`.
    ///
    /// # Errors
    /// [`OdeError::Name`]: no such function, or another number of arguments.
    pub fn call(&mut self, function: &str, arguments: &[BuiltNode]) -> Result<BuiltNode, OdeError> {
        let taken = match lookup_builtin(function) {
            Some(Builtin::Unary(_)) => 1,
            Some(Builtin::Binary(_)) => 2,
            _ => {
                let problem = "there is no such function".to_owned();
                return Err(OdeError::Name { name: function.to_owned(), problem });
            }
        };
        if arguments.len() != taken {
            let problem = format!("it takes {taken} arguments, not {}", arguments.len());
            return Err(OdeError::Name { name: function.to_owned(), problem });
        }
        Ok(self.push(Kind::Call(function.to_owned(), arguments.to_vec())))
    }

    /// The second value where the first is not zero, else the third.
    pub fn select(&mut self, condition: BuiltNode, yes: BuiltNode, no: BuiltNode) -> BuiltNode {
        self.push(Kind::Select(condition, yes, no))
    }

    /// Sets the derivative of a state.
    ///
    /// # Errors
    /// [`OdeError::Name`] where the node is no state.
    pub fn equation(&mut self, state: BuiltNode, derivative: BuiltNode) -> Result<(), OdeError> {
        match self.states.iter_mut().find(|known| known.2 == state) {
            Some(known) => {
                known.3 = Some(derivative);
                Ok(())
            }
            None => Err(OdeError::Name { name: format!("{state:?}"), problem: "it is no state".to_owned() }),
        }
    }

    /// The model.
    ///
    /// # Errors
    /// [`OdeError::Name`]: a state without an equation; [`OdeError::TooLarge`], [`OdeError::NoEquations`].
    pub fn build(&self) -> Result<Model, OdeError> {
        Model::parse(&self.source()?)
    }

    /// The text of the model.
    fn source(&self) -> Result<String, OdeError> {
        let mut uses = vec![0_usize; self.nodes.len()];
        let mut derivatives = Vec::with_capacity(self.states.len());
        for (name, _, _, derivative) in &self.states {
            let missing = || OdeError::Name { name: name.clone(), problem: "it has no equation".to_owned() };
            derivatives.push(derivative.ok_or_else(missing)?);
        }
        derivatives.iter().for_each(|node| uses[node.0] += 1);
        // Operands come before what uses them; what nothing uses is not written.
        for index in (0..self.nodes.len()).rev() {
            if uses[index] > 0 {
                self.nodes[index].operands().iter().for_each(|operand| uses[operand.0] += 1);
            }
        }
        let prefix = self.prefix();
        let mut source = String::from("# built node by node\n");
        let mut line = |text: std::fmt::Arguments<'_>| {
            // Writing to a string does not fail.
            let _ = source.write_fmt(text);
            source.push('\n');
        };
        for (name, value) in &self.parameters {
            line(format_args!("par {name}={value:?}"));
        }
        let mut written: Vec<(String, u32)> = Vec::with_capacity(self.nodes.len());
        let mut quantities = 0;
        for (index, kind) in self.nodes.iter().enumerate() {
            if uses[index] == 0 {
                written.push((String::new(), 0));
                continue;
            }
            let text = |node: &BuiltNode| written[node.0].0.as_str();
            let depth = kind.operands().iter().map(|node| written[node.0].1).max().unwrap_or(0) + 1;
            let (expression, is_leaf) = match kind {
                Kind::Constant(value) if value.is_sign_negative() => (format!("({value:?})"), true),
                Kind::Constant(value) => (format!("{value:?}"), true),
                Kind::Name(name) => (name.clone(), true),
                Kind::Negate(a) => (format!("(-{})", text(a)), false),
                Kind::Binary(operator, a, b) => {
                    (format!("({}{}{})", text(a), operator.symbol(), text(b)), false)
                }
                Kind::Call(function, arguments) => {
                    let arguments: Vec<&str> = arguments.iter().map(text).collect();
                    (format!("{function}({})", arguments.join(",")), false)
                }
                Kind::Select(condition, yes, no) => {
                    (format!("(if({})then({})else({}))", text(condition), text(yes), text(no)), false)
                }
            };
            if !is_leaf && (uses[index] > 1 || depth >= DEEPEST) {
                quantities += 1;
                line(format_args!("{prefix}{quantities}={expression}"));
                written.push((format!("{prefix}{quantities}"), 0));
            } else {
                written.push((expression, if is_leaf { 0 } else { depth }));
            }
        }
        for ((name, ..), derivative) in self.states.iter().zip(&derivatives) {
            line(format_args!("{name}'={}", written[derivative.0].0));
        }
        for (name, initial, ..) in self.states.iter().filter(|state| state.1 != 0.0) {
            line(format_args!("init {name}={initial:?}"));
        }
        line(format_args!("done"));
        Ok(source)
    }

    /// What the names of quantities begin with: no declared name does.
    fn prefix(&self) -> String {
        let mut prefix = "node".to_owned();
        let declared =
            || self.parameters.iter().map(|(name, _)| name).chain(self.states.iter().map(|state| &state.0));
        while declared().any(|name| name.to_ascii_lowercase().starts_with(&prefix)) {
            prefix.push('_');
        }
        prefix
    }
}

fn finite(name: &str, value: f64) -> Result<(), OdeError> {
    if value.is_finite() {
        return Ok(());
    }
    Err(OdeError::Name { name: name.to_owned(), problem: format!("its value {value} is not finite") })
}

#[cfg(test)]
mod tests {
    use super::*;
    use arclength::VectorField;

    fn derivative(model: &Model, state: &[f64], parameters: &[f64]) -> Vec<f64> {
        let mut derivative = vec![0.0; state.len()];
        model.evaluate(state, parameters, &mut derivative);
        derivative
    }

    #[test]
    fn every_operation_is_read_back_as_itself() {
        let mut builder = ModelBuilder::new();
        let p = builder.parameter("node", -0.1).unwrap();
        let x = builder.state("x", 1e-300).unwrap();
        let y = builder.state("Y_1", 0.0).unwrap();
        let shared = builder.call("atan2", &[x, p]).unwrap();
        let power = builder.binary(Operator::Power, shared, x);
        let negative = builder.constant(-1.0 / 3.0).unwrap();
        let sum = builder.binary(Operator::Add, power, negative);
        let above = builder.binary(Operator::Greater, x, y);
        let chosen = builder.select(above, sum, shared);
        builder.equation(x, chosen).unwrap();
        let negated = builder.negate(shared);
        builder.equation(y, negated).unwrap();
        let model = builder.build().unwrap();
        assert_eq!(model.states(), ["x", "Y_1"]);
        assert_eq!(model.parameters(), ["node"]);
        assert_eq!(model.initial_state(&[-0.1]), [1e-300, 0.0]);
        for [x, y] in [[2.0_f64, 1.0], [0.5, 1.0]] {
            let shared = x.atan2(-0.1);
            let expected = if x > y { shared.powf(x) + -1.0 / 3.0 } else { shared };
            let found = derivative(&model, &[x, y], &[-0.1]);
            assert!((found[0] - expected).abs() <= 1e-15 * expected.abs(), "{found:?} {expected}");
            assert_eq!(found[1], -shared);
        }
        assert_eq!(Model::parse(model.source()).unwrap().source(), model.source());
    }

    #[test]
    fn deep_expressions_are_written_in_parts() {
        let mut builder = ModelBuilder::new();
        let x = builder.state("x", 0.0).unwrap();
        let one = builder.constant(1.0).unwrap();
        let sum = (0..5000).fold(x, |sum, _| builder.binary(Operator::Add, sum, one));
        builder.equation(x, sum).unwrap();
        assert_eq!(derivative(&builder.build().unwrap(), &[0.5], &[]), [5000.5]);
    }

    #[test]
    fn names_and_numbers_that_cannot_be_are_refused() {
        let mut builder = ModelBuilder::new();
        builder.state("x", 0.0).unwrap();
        for name in ["X", "x", "sin", "pi", "", "1x", "λ", "a b"] {
            let error = builder.parameter(name, 0.0).unwrap_err();
            assert!(matches!(error, OdeError::Name { .. }), "{name}: {error}");
        }
        assert!(builder.parameter("p", f64::NAN).is_err());
        assert!(builder.constant(f64::INFINITY).is_err());
        assert!(builder.call("gamma", &[]).is_err());
        assert!(builder.build().unwrap_err().to_string().contains("`x`"));
    }
}
