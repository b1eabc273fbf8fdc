//! Replaces names by what they stand for: functions are inlined, sums unrolled, branches that cannot
//! be taken dropped.

use super::graph::{Graph, NodeId, Operation};
use crate::error::{OdeError, Span, Warning, nearest};
use crate::expression::{BUILTIN_NAMES, BinaryOperation, Expression, Node, UnaryOperation};
use crate::name::Name;
use crate::statement::TableRange;
use std::collections::HashMap;

/// Largest number of operations that a model may expand to, functions inlined and sums unrolled.
const MAXIMUM_WORK: usize = 1_000_000;
/// Deepest nesting of functions, quantities, branches and sums.
const MAXIMUM_DEPTH: usize = 200;
/// Largest order of a Bessel function.
const MAXIMUM_BESSEL_ORDER: f64 = 1000.0;

/// What a declared name stands for.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Symbol {
    State(usize),
    Parameter(usize),
    Number(f64),
    Derived(usize),
    Fixed(usize),
    Function(usize),
    Table(usize),
    /// What is not supported, where something depends on it.
    Refused(usize),
}

impl Symbol {
    /// What the symbol is, for messages.
    pub(crate) fn kind(self) -> &'static str {
        match self {
            Self::State(_) => "a state",
            Self::Parameter(_) => "a parameter",
            Self::Number(_) => "a number",
            Self::Derived(_) => "a derived parameter",
            Self::Fixed(_) => "a quantity",
            Self::Function(_) => "a function",
            Self::Table(_) => "a table",
            Self::Refused(_) => "a name of what is not supported",
        }
    }
}

/// `name = expression` or `!name = expression`
#[derive(Debug)]
pub(crate) struct QuantityDefinition {
    pub name: Name,
    pub expression: Expression,
}

/// `name(arguments) = expression`
#[derive(Debug)]
pub(crate) struct FunctionDefinition {
    pub name: Name,
    pub arguments: Vec<Name>,
    pub expression: Expression,
}

/// `table name % points low high expression`, where the argument is `t`.
#[derive(Debug)]
pub(crate) struct TableDefinition {
    pub name: Name,
    pub range: TableRange,
    pub expression: Expression,
}

/// Everything that names can refer to.
#[derive(Debug, Default)]
pub(crate) struct Symbols {
    pub names: HashMap<String, Symbol>,
    /// States, then fixed quantities, in the order in which `shift` counts.
    pub states: Vec<Name>,
    /// Parameters and numbers, by name in lower case, in the order in which `shift` counts.
    pub constants: Vec<(String, Symbol)>,
    pub derived: Vec<QuantityDefinition>,
    pub fixed: Vec<QuantityDefinition>,
    pub functions: Vec<FunctionDefinition>,
    pub tables: Vec<TableDefinition>,
    /// Why what is not supported is refused.
    pub refused: Vec<OdeError>,
}

impl FunctionDefinition {
    /// The function as it is called.
    pub(crate) fn signature(&self) -> String {
        let arguments: Vec<&str> = self.arguments.iter().map(|argument| argument.text.as_str()).collect();
        format!("{}({})", self.name.text, arguments.join(","))
    }
}

/// What an expression may depend on.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Scope {
    /// States, parameters and time.
    Field,
    /// Parameters only.
    Parameters,
    /// Parameters and time, which is 0: an initial value.
    Initial,
    /// Nothing: the expression is a number.
    Nothing,
}

#[derive(Clone, Copy, Debug, PartialEq)]
enum Progress {
    NotStarted,
    Started,
    Done(NodeId),
}

/// Builds the graph of a model.
pub(crate) struct Lowering<'a> {
    pub graph: Graph,
    pub warnings: Vec<Warning>,
    /// First place where an equation uses the time.
    pub time: Option<Span>,
    symbols: &'a Symbols,
    derived: Vec<Progress>,
    fixed: Vec<Progress>,
    functions_entered: Vec<bool>,
    tables_entered: Vec<bool>,
    work: usize,
    depth: usize,
}

/// Arguments of the function being inlined, and the index of the sum being unrolled.
#[derive(Clone, Copy)]
struct Environment<'a> {
    scope: Scope,
    arguments: &'a [(&'a str, NodeId)],
    sum_index: Option<NodeId>,
    /// The fixed quantity being defined, to notice uses before definition.
    fixed: Option<usize>,
}

impl<'a> Lowering<'a> {
    pub(crate) fn new(symbols: &'a Symbols) -> Self {
        Self {
            graph: Graph::default(),
            warnings: Vec::new(),
            time: None,
            symbols,
            derived: vec![Progress::NotStarted; symbols.derived.len()],
            fixed: vec![Progress::NotStarted; symbols.fixed.len()],
            functions_entered: vec![false; symbols.functions.len()],
            tables_entered: vec![false; symbols.tables.len()],
            work: 0,
            depth: 0,
        }
    }

    /// Adds an expression to the graph and returns its value.
    pub(crate) fn lower(&mut self, expression: &Expression, scope: Scope) -> Result<NodeId, OdeError> {
        self.expression(expression, Environment { scope, arguments: &[], sum_index: None, fixed: None })
    }

    /// The number that an expression without states, parameters and time stands for.
    pub(crate) fn lower_constant(&mut self, expression: &Expression, what: &str) -> Result<f64, OdeError> {
        let node = self.lower(expression, Scope::Nothing)?;
        let span = expression.nodes.last().map_or(Span { line: 1, column: 1, length: 1 }, |node| node.1);
        self.constant(node, span, what)
    }

    /// Lowers fixed quantity number `index`, whether or not an equation uses it; nothing if it is refused, which an equation that
    /// uses it then is too.
    pub(crate) fn fixed_quantity(&mut self, index: usize) -> Result<Option<NodeId>, OdeError> {
        let span = self.symbols.fixed[index].name.span;
        self.unless_refused(|lowering| lowering.fixed(index, span, None)).map(Result::ok)
    }

    /// Adds an output, on which no equation depends, to the graph; or why it is refused, with a warning that it is left out.
    pub(crate) fn output(
        &mut self,
        definition: &QuantityDefinition,
    ) -> Result<Result<NodeId, OdeError>, OdeError> {
        let result = self.unless_refused(|lowering| lowering.lower(&definition.expression, Scope::Field))?;
        if let Err(OdeError::Unsupported { feature, remedy, .. }) = &result {
            let name = &definition.name;
            let message =
                format!("the quantity `{}` is left out: {feature} not supported; {remedy}", name.text);
            self.warnings.push(Warning::new(name.span, message));
        }
        Ok(result)
    }

    /// The value of what is lowered, or why it is refused as not supported.
    fn unless_refused(
        &mut self,
        lower: impl FnOnce(&mut Self) -> Result<NodeId, OdeError>,
    ) -> Result<Result<NodeId, OdeError>, OdeError> {
        match lower(self) {
            Err(error @ OdeError::Unsupported { .. }) => {
                // What was entered is left.
                self.depth = 0;
                self.functions_entered.fill(false);
                self.tables_entered.fill(false);
                let left = self.fixed.iter_mut().chain(&mut self.derived);
                left.filter(|progress| **progress == Progress::Started)
                    .for_each(|progress| *progress = Progress::NotStarted);
                Ok(Err(error))
            }
            lowered => lowered.map(Ok),
        }
    }

    /// Lowers derived parameter number `index`.
    pub(crate) fn derived_parameter(&mut self, index: usize) -> Result<NodeId, OdeError> {
        let span = self.symbols.derived[index].name.span;
        self.derived(index, span)
    }

    fn expression(&mut self, expression: &Expression, within: Environment) -> Result<NodeId, OdeError> {
        self.depth += 1;
        let mut values: Vec<NodeId> = Vec::with_capacity(expression.nodes.len());
        for (node, span) in &expression.nodes {
            self.work += 1;
            self.check_limits(*span)?;
            let value = self.node(node, *span, &values, within)?;
            values.push(value);
        }
        self.depth -= 1;
        let last = values.last().copied();
        Ok(last.unwrap_or_else(|| self.graph.constant(f64::NAN)))
    }

    fn check_limits(&self, span: Span) -> Result<(), OdeError> {
        if self.work > MAXIMUM_WORK {
            let what = "the model expands to too many operations".into();
            return Err(OdeError::TooLarge { place: span.into(), what, limit: MAXIMUM_WORK });
        }
        if self.depth > MAXIMUM_DEPTH {
            let what = "functions and quantities are nested too deeply".into();
            return Err(OdeError::TooLarge { place: span.into(), what, limit: MAXIMUM_DEPTH });
        }
        Ok(())
    }

    fn node(
        &mut self,
        node: &Node,
        span: Span,
        values: &[NodeId],
        within: Environment,
    ) -> Result<NodeId, OdeError> {
        match node {
            Node::Number(value) => Ok(self.graph.constant(*value)),
            Node::Name(name) => self.name(name, span, within),
            Node::SumIndex => within
                .sum_index
                .ok_or_else(|| OdeError::syntax(span, "i' has a meaning only inside sum(low,high)of(...)")),
            Node::Unary(operation, a) => Ok(self.graph.unary(*operation, values[*a])),
            Node::Binary(operation, a, b) => Ok(self.graph.binary(*operation, values[*a], values[*b])),
            Node::Call(name, arguments) => {
                let arguments: Vec<NodeId> = arguments.iter().map(|&argument| values[argument]).collect();
                self.call(name, span, &arguments, within)
            }
            Node::If(condition, yes, no) => {
                let condition = values[*condition];
                // Only the branch that is taken has to make sense, as for the neighbours of the last
                // element of an array.
                match self.graph.constant_value(condition) {
                    Some(value) => self.expression(if value != 0.0 { yes } else { no }, within),
                    None => {
                        let yes = self.expression(yes, within)?;
                        let no = self.expression(no, within)?;
                        Ok(self.graph.select(condition, yes, no))
                    }
                }
            }
            Node::Sum(low, high, term) => self.sum(values[*low], values[*high], term, span, within),
            Node::Shift(name, offset) => {
                let what = "the second argument of `shift`";
                let offset = self.constant(values[*offset], span, what)?;
                self.shift(name, offset.trunc(), span, within)
            }
            Node::Refused(error) => Err((**error).clone()),
        }
    }

    fn name(&mut self, name: &str, span: Span, within: Environment) -> Result<NodeId, OdeError> {
        if let Some((_, value)) = within.arguments.iter().find(|(argument, _)| *argument == name) {
            return Ok(*value);
        }
        if name == "pi" {
            return Ok(self.graph.constant(std::f64::consts::PI));
        }
        if name == "t" {
            match within.scope {
                Scope::Field => {}
                Scope::Initial => return Ok(self.graph.constant(0.0)),
                Scope::Parameters | Scope::Nothing => {
                    return Err(self.out_of_scope(name, span, within.scope));
                }
            }
            self.time.get_or_insert(span);
            return Ok(self.graph.insert(Operation::Time));
        }
        match self.symbols.names.get(name) {
            Some(&symbol) => self.symbol(symbol, name, span, within),
            None => {
                number_with_name(name, span)?;
                let arguments = within.arguments.iter().map(|(argument, _)| *argument);
                let declared = self.symbols.names.keys().map(String::as_str);
                Err(OdeError::UnknownName {
                    place: span.into(),
                    kind: "name",
                    name: name.to_owned(),
                    nearest: nearest(name, arguments.chain(declared)),
                })
            }
        }
    }

    fn symbol(
        &mut self,
        symbol: Symbol,
        name: &str,
        span: Span,
        within: Environment,
    ) -> Result<NodeId, OdeError> {
        match (symbol, within.scope) {
            (Symbol::Refused(index), _) => Err(self.symbols.refused[index].clone()),
            (Symbol::Number(value), _) => Ok(self.graph.constant(value)),
            (Symbol::State(index), Scope::Field) => Ok(self.graph.insert(Operation::State(index as u32))),
            (Symbol::Fixed(index), Scope::Field) => self.fixed(index, span, within.fixed),
            (Symbol::Parameter(index), Scope::Field | Scope::Parameters | Scope::Initial) => {
                Ok(self.graph.insert(Operation::Parameter(index as u32)))
            }
            (Symbol::Derived(index), Scope::Field | Scope::Parameters | Scope::Initial) => {
                self.derived(index, span)
            }
            (Symbol::Function(_) | Symbol::Table(_), _) => {
                Err(OdeError::syntax(span, format!("`{name}` is a function: expected ( and its arguments")))
            }
            _ => Err(self.out_of_scope(name, span, within.scope)),
        }
    }

    fn out_of_scope(&self, name: &str, span: Span, scope: Scope) -> OdeError {
        let what = match scope {
            Scope::Parameters => "what depends on parameters only (!name=...)",
            Scope::Initial => "an initial value",
            Scope::Field | Scope::Nothing => "this value",
        };
        OdeError::NotConstant { place: span.into(), what: what.into(), variable: Some(name.to_owned()) }
    }

    fn fixed(&mut self, index: usize, span: Span, user: Option<usize>) -> Result<NodeId, OdeError> {
        let definition = &self.symbols.fixed[index];
        if user.is_some_and(|user| user < index) {
            self.warnings.push(Warning::new(
                span,
                format!(
                    "`{}` is used before the line that defines it; XPPAUT would use its value of the step \
                     before, here the current one is used",
                    definition.name.text
                ),
            ));
        }
        match self.fixed[index] {
            Progress::Done(node) => Ok(node),
            Progress::Started => {
                Err(OdeError::Circular { place: span.into(), name: definition.name.text.clone() })
            }
            Progress::NotStarted => {
                self.fixed[index] = Progress::Started;
                let within =
                    Environment { scope: Scope::Field, arguments: &[], sum_index: None, fixed: Some(index) };
                let node = self.expression(&definition.expression, within)?;
                self.fixed[index] = Progress::Done(node);
                Ok(node)
            }
        }
    }

    fn derived(&mut self, index: usize, span: Span) -> Result<NodeId, OdeError> {
        let definition = &self.symbols.derived[index];
        match self.derived[index] {
            Progress::Done(node) => Ok(node),
            Progress::Started => {
                Err(OdeError::Circular { place: span.into(), name: definition.name.text.clone() })
            }
            Progress::NotStarted => {
                self.derived[index] = Progress::Started;
                let node = self.lower(&definition.expression, Scope::Parameters)?;
                self.derived[index] = Progress::Done(node);
                Ok(node)
            }
        }
    }

    fn call(
        &mut self,
        name: &str,
        span: Span,
        arguments: &[NodeId],
        within: Environment,
    ) -> Result<NodeId, OdeError> {
        if matches!(name, "besselj" | "bessely") {
            return self.bessel(name, span, arguments);
        }
        if let Some(&Symbol::Table(index)) = self.symbols.names.get(name) {
            return self.table(index, span, arguments, within);
        }
        if let Some(&Symbol::Refused(index)) = self.symbols.names.get(name) {
            return Err(self.symbols.refused[index].clone());
        }
        let Some(&Symbol::Function(index)) = self.symbols.names.get(name) else {
            if self.symbols.names.contains_key(name) {
                let message = format!("`{name}` is not a function; products are written with *");
                return Err(OdeError::syntax(span, message));
            }
            number_with_name(name, span)?;
            let functions = self.symbols.functions.iter().map(|function| function.name.text.as_str());
            return Err(OdeError::UnknownName {
                place: span.into(),
                kind: "function",
                name: name.to_owned(),
                nearest: nearest(name, functions.chain(BUILTIN_NAMES)),
            });
        };
        let function = &self.symbols.functions[index];
        if function.arguments.len() != arguments.len() {
            return Err(OdeError::WrongNumberOfArguments {
                place: span.into(),
                function: function.name.text.clone(),
                expected: function.arguments.len(),
                found: arguments.len(),
            });
        }
        if std::mem::replace(&mut self.functions_entered[index], true) {
            return Err(OdeError::Circular { place: span.into(), name: function.name.text.clone() });
        }
        let names: Vec<String> = function.arguments.iter().map(Name::key).collect();
        let bound: Vec<(&str, NodeId)> =
            names.iter().map(String::as_str).zip(arguments.iter().copied()).collect();
        let value = self.expression(&function.expression, Environment { arguments: &bound, ..within })?;
        self.functions_entered[index] = false;
        Ok(value)
    }

    /// A table at an argument: its formula, and beyond its ends the straight line through the last two points.
    fn table(
        &mut self,
        index: usize,
        span: Span,
        arguments: &[NodeId],
        within: Environment,
    ) -> Result<NodeId, OdeError> {
        let table = &self.symbols.tables[index];
        let &[argument] = arguments else {
            return Err(OdeError::WrongNumberOfArguments {
                place: span.into(),
                function: table.name.text.clone(),
                expected: 1,
                found: arguments.len(),
            });
        };
        if std::mem::replace(&mut self.tables_entered[index], true) {
            return Err(OdeError::Circular { place: span.into(), name: table.name.text.clone() });
        }
        let TableRange { points, low, high } = table.range;
        let distance = (high - low) / f64::from(points - 1);
        let scope = if within.scope == Scope::Field { Scope::Parameters } else { within.scope };
        let formula = |lowering: &mut Self, node: NodeId| {
            let bound = [("t", node)];
            let within = Environment { scope, arguments: &bound, sum_index: None, fixed: None };
            lowering.expression(&table.expression, within)
        };
        let inside = formula(self, argument)?;
        let mut value = inside;
        for (end, next, beyond) in
            [(low, low + distance, BinaryOperation::Less), (high, high - distance, BinaryOperation::Greater)]
        {
            let [end_node, next_node] = [end, next].map(|place| self.graph.constant(place));
            let (at_end, at_next) = (formula(self, end_node)?, formula(self, next_node)?);
            let width = self.graph.constant(next - end);
            let rise = self.graph.binary(BinaryOperation::Subtract, at_next, at_end);
            let slope = self.graph.binary(BinaryOperation::Divide, rise, width);
            let way = self.graph.binary(BinaryOperation::Subtract, argument, end_node);
            let change = self.graph.binary(BinaryOperation::Multiply, slope, way);
            let line = self.graph.binary(BinaryOperation::Add, at_end, change);
            let condition = self.graph.binary(beyond, argument, end_node);
            value = self.graph.select(condition, line, value);
        }
        self.tables_entered[index] = false;
        Ok(value)
    }

    fn bessel(&mut self, name: &str, span: Span, arguments: &[NodeId]) -> Result<NodeId, OdeError> {
        let order = self.constant(arguments[0], span, "the order of a Bessel function")?;
        if order.fract() != 0.0 || order.abs() > MAXIMUM_BESSEL_ORDER {
            let message = "the order of a Bessel function must be a whole number between -1000 and 1000";
            return Err(OdeError::syntax(span, message));
        }
        let order = order as i32;
        let operation = match name {
            "besselj" => UnaryOperation::BesselJ(order),
            _ => UnaryOperation::BesselY(order),
        };
        Ok(self.graph.unary(operation, arguments[1]))
    }

    fn sum(
        &mut self,
        low: NodeId,
        high: NodeId,
        term: &Expression,
        span: Span,
        within: Environment,
    ) -> Result<NodeId, OdeError> {
        let low = self.constant(low, span, "the lower limit of `sum`")?.trunc();
        let high = self.constant(high, span, "the upper limit of `sum`")?.trunc();
        // Neither limit may be infinite or no number.
        if (high - low).is_nan() || high - low >= MAXIMUM_WORK as f64 {
            let what = "the sum has too many terms".into();
            return Err(OdeError::TooLarge { place: span.into(), what, limit: MAXIMUM_WORK });
        }
        let mut total = self.graph.constant(0.0);
        let mut index = low;
        while index <= high {
            self.work += 1;
            self.check_limits(span)?;
            let sum_index = Some(self.graph.constant(index));
            let value = self.expression(term, Environment { sum_index, ..within })?;
            total = self.graph.binary(BinaryOperation::Add, total, value);
            index += 1.0;
        }
        Ok(total)
    }

    /// The quantity `offset` places after `name` in the order of declaration.
    fn shift(
        &mut self,
        name: &str,
        offset: f64,
        span: Span,
        within: Environment,
    ) -> Result<NodeId, OdeError> {
        let symbols = self.symbols;
        let states = symbols.states.len();
        let (position, length) = match symbols.names.get(name) {
            Some(&Symbol::State(index)) => (index, states + symbols.fixed.len()),
            Some(&Symbol::Fixed(index)) => (states + index, states + symbols.fixed.len()),
            Some(&Symbol::Parameter(_) | &Symbol::Number(_)) => {
                let position = symbols.constants.iter().position(|(constant, _)| constant == name);
                (position.unwrap_or(0), symbols.constants.len())
            }
            Some(&Symbol::Refused(index)) => return Err(symbols.refused[index].clone()),
            Some(_) => {
                let message = "the first argument of `shift` must be a state, quantity or parameter";
                return Err(OdeError::syntax(span, message));
            }
            None => return self.name(name, span, within),
        };
        let target = position as f64 + offset;
        if !(target >= 0.0 && target < length as f64) {
            let message = format!("`shift({name},{offset})` lies outside what is declared");
            return Err(OdeError::syntax(span, message));
        }
        let target = target as usize;
        let symbol = match symbols.names.get(name) {
            Some(Symbol::State(_) | Symbol::Fixed(_)) if target < states => Symbol::State(target),
            Some(Symbol::State(_) | Symbol::Fixed(_)) => Symbol::Fixed(target - states),
            _ => symbols.constants[target].1,
        };
        self.symbol(symbol, name, span, within)
    }

    fn constant(&self, node: NodeId, span: Span, what: &str) -> Result<f64, OdeError> {
        self.graph.constant_value(node).ok_or_else(|| OdeError::NotConstant {
            place: span.into(),
            what: what.to_owned(),
            variable: None,
        })
    }
}

/// Refuses an unknown name that is a number with a name behind it: a product without its sign.
fn number_with_name(name: &str, span: Span) -> Result<(), OdeError> {
    let digits = name.find(|character: char| !character.is_ascii_digit()).unwrap_or(0) as u32;
    if digits == 0 {
        return Ok(());
    }
    let rest =
        Span { column: span.column + digits, length: span.length.saturating_sub(digits).max(1), ..span };
    Err(OdeError::syntax(rest, "expected an operator here; products are written with *"))
}
