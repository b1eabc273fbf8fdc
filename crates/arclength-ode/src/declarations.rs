//! Collects the statements of a model into one table of names.

use crate::assignments::{Assignment, assignments};
use crate::compile::{FunctionDefinition, Lowering, QuantityDefinition, Symbol, Symbols, TableDefinition};
use crate::error::{OdeError, Span, Warning, nearest};
use crate::event::Action;
use crate::expand::expanded_lines;
use crate::expression::{Expression, Node, parse_expression, parse_number, reserved};
use crate::name::Name;
use crate::options::Options;
use crate::source::Text;
use crate::statement::{EventStatement, Statement, TableRange, classify};
use arclength::Direction;
use std::collections::HashMap;

/// A name with the number it is given.
#[derive(Debug)]
pub(crate) struct Value {
    pub name: Name,
    pub value: f64,
}

/// What a state starts at.
#[derive(Debug)]
pub(crate) enum InitialValue {
    /// `init x=1`
    Number(f64),
    /// `x(0)=2*a`
    Formula(Expression),
}

/// What a list of names with values declares.
#[derive(Clone, Copy, Debug)]
enum Declares {
    Parameter,
    Initial,
}

/// `set name {...}` with its values not yet looked up.
#[derive(Debug)]
pub(crate) struct SetDefinition {
    pub name: Name,
    pub entries: Vec<(Name, String, Span)>,
}

/// `global sign condition {name=expression; ...}`
#[derive(Debug)]
pub(crate) struct EventDefinition {
    pub span: Span,
    pub direction: Direction,
    pub condition: Expression,
    pub assignments: Vec<QuantityDefinition>,
}

/// Everything that a model declares.
#[derive(Debug, Default)]
pub(crate) struct Declarations {
    pub symbols: Symbols,
    pub equations: Vec<Expression>,
    pub parameters: Vec<Value>,
    pub auxiliaries: Vec<QuantityDefinition>,
    /// In the order of the text: the last one of a state counts.
    pub initial: Vec<(Name, InitialValue)>,
    pub events: Vec<EventDefinition>,
    pub sets: Vec<SetDefinition>,
    pub options: Options,
    pub warnings: Vec<Warning>,
    declared: HashMap<String, Span>,
}

impl Declarations {
    /// Reads the text of a model.
    pub(crate) fn read(source: &str) -> Result<Self, OdeError> {
        let mut declarations = Self::default();
        let mut of_matrix = 0;
        for line in &expanded_lines(source, &mut declarations.warnings)? {
            if line.skip_blanks(0) == line.len() {
                continue;
            }
            if of_matrix > 0 {
                of_matrix -= 1;
                continue;
            }
            match classify(line)? {
                Statement::Refused(names, error, lines) => {
                    of_matrix = lines;
                    declarations.refused(names, &error)?;
                }
                statement => declarations.statement(line, statement)?,
            }
        }
        Ok(declarations)
    }

    fn statement(&mut self, line: &Text, statement: Statement) -> Result<(), OdeError> {
        match statement {
            Statement::Equation(name, right) => {
                self.declare(&name, Symbol::State(self.symbols.states.len()))?;
                self.symbols.states.push(name);
                let expression = self.expression(line, right)?;
                self.equations.push(expression);
            }
            Statement::Fixed(name, right) => {
                self.declare(&name, Symbol::Fixed(self.symbols.fixed.len()))?;
                let expression = self.perhaps_unused(line, right)?;
                self.symbols.fixed.push(QuantityDefinition { name, expression });
            }
            Statement::Derived(name, right) => {
                self.declare(&name, Symbol::Derived(self.symbols.derived.len()))?;
                let expression = self.expression(line, right)?;
                self.symbols.derived.push(QuantityDefinition { name, expression });
            }
            Statement::Function(name, arguments, right) => {
                self.declare(&name, Symbol::Function(self.symbols.functions.len()))?;
                let expression = self.perhaps_unused(line, right)?;
                self.symbols.functions.push(FunctionDefinition { name, arguments, expression });
            }
            Statement::Table(name, range, right) => self.table(line, name, range, right)?,
            Statement::Auxiliary(name, right) => {
                let expression = self.perhaps_unused(line, right)?;
                self.auxiliaries.push(QuantityDefinition { name, expression });
            }
            Statement::InitialFormula(name, right) => {
                self.warn_of_leading_number(line, right);
                let expression = self.expression(line, right)?;
                self.initial.push((name, InitialValue::Formula(expression)));
            }
            Statement::Event(event) => self.event(line, event)?,
            Statement::Parameters(rest) => self.parameters(line, rest)?,
            Statement::Numbers(rest) => self.numbers(line, rest)?,
            Statement::Initial(rest) => {
                for assignment in assignments(line, rest, line.len())? {
                    let value = self.value(line, &assignment, Declares::Initial)?;
                    self.initial.push((assignment.name, InitialValue::Number(value)));
                }
            }
            Statement::Set(name, start, end) => self.set(line, name, (start, end))?,
            Statement::Options(rest) => self.options.read(line, rest, &mut self.warnings)?,
            Statement::Refused(names, error, _) => self.refused(names, &error)?,
            Statement::Ignored(span, message) => self.warnings.push(Warning::new(span, message)),
        }
        Ok(())
    }

    fn table(&mut self, line: &Text, name: Name, range: TableRange, right: usize) -> Result<(), OdeError> {
        self.declare(&name, Symbol::Table(self.symbols.tables.len()))?;
        let expression = self.expression(line, right)?;
        self.warnings.push(Warning::new(
            name.span,
            format!(
                "the table `{}` is taken as its formula from {} to {}, where XPPAUT draws straight lines between {} points",
                name.text, range.low, range.high, range.points
            ),
        ));
        self.symbols.tables.push(TableDefinition { name, range, expression });
        Ok(())
    }

    fn event(&mut self, line: &Text, event: EventStatement) -> Result<(), OdeError> {
        let EventStatement { span, direction, condition: (start, end), assignments } = event;
        let condition = parse_expression(line, start, end, &mut self.warnings)?;
        let assignments = assignments
            .into_iter()
            .map(|(name, start, end)| {
                let expression = parse_expression(line, start, end, &mut self.warnings)?;
                Ok(QuantityDefinition { name, expression })
            })
            .collect::<Result<_, OdeError>>()?;
        self.events.push(EventDefinition { span, direction, condition, assignments });
        Ok(())
    }

    fn parameters(&mut self, line: &Text, start: usize) -> Result<(), OdeError> {
        for assignment in assignments(line, start, line.len())? {
            let value = self.value(line, &assignment, Declares::Parameter)?;
            let symbol = Symbol::Parameter(self.parameters.len());
            self.declare(&assignment.name, symbol)?;
            self.symbols.constants.push((assignment.name.key(), symbol));
            self.parameters.push(Value { name: assignment.name, value });
        }
        Ok(())
    }

    fn numbers(&mut self, line: &Text, start: usize) -> Result<(), OdeError> {
        for assignment in assignments(line, start, line.len())? {
            let symbol = Symbol::Number(self.value(line, &assignment, Declares::Parameter)?);
            self.declare(&assignment.name, symbol)?;
            self.symbols.constants.push((assignment.name.key(), symbol));
        }
        Ok(())
    }

    fn set(&mut self, line: &Text, name: Name, (start, end): (usize, usize)) -> Result<(), OdeError> {
        let entries = assignments(line, start, end)?
            .into_iter()
            .map(|assignment| {
                let value = assignment.value(line).into_owned();
                let span = line.span(assignment.value_start, assignment.value_end);
                (assignment.name, value, span)
            })
            .collect();
        self.sets.push(SetDefinition { name, entries });
        Ok(())
    }

    /// Declares what is refused where something depends on it. Where nothing does, the warning is what is told of it.
    fn refused(&mut self, names: Vec<Name>, error: &OdeError) -> Result<(), OdeError> {
        let OdeError::Unsupported { feature, .. } = error else { return Err(error.clone()) };
        for name in names {
            self.declare(&name, Symbol::Refused(self.symbols.refused.len()))?;
            self.warnings.push(Warning::new(
                name.span,
                format!(
                    "`{}` is left out: {feature} not supported, and no equation depends on it",
                    name.text
                ),
            ));
            self.symbols.refused.push(error.clone());
        }
        Ok(())
    }

    /// Whether a name stands for what is refused where something depends on it.
    pub(crate) fn is_refused(&self, name: &Name) -> bool {
        matches!(self.symbols.names.get(&name.key()), Some(Symbol::Refused(_)))
    }

    fn expression(&mut self, line: &Text, start: usize) -> Result<Expression, OdeError> {
        parse_expression(line, start, line.len(), &mut self.warnings)
    }

    /// An expression that the equations need not depend on: what is not supported in it is refused where they do.
    fn perhaps_unused(&mut self, line: &Text, start: usize) -> Result<Expression, OdeError> {
        match self.expression(line, start) {
            Err(error @ OdeError::Unsupported { .. }) => {
                let span = line.span(start, line.len());
                Ok(Expression { nodes: vec![(Node::Refused(Box::new(error)), span)] })
            }
            read => read,
        }
    }

    /// The number that an assignment gives. XPPAUT reads it up to the first character that does not
    /// belong to a number; here `1/3` is a third, with a warning that says both.
    fn value(&mut self, line: &Text, assignment: &Assignment, declares: Declares) -> Result<f64, OdeError> {
        if !assignment.has_value() {
            let message = format!("`{}` is given no value: it is 0", assignment.name.text);
            self.warnings.push(Warning::new(assignment.name.span, message));
            return Ok(0.0);
        }
        let text = assignment.value(line);
        if let Some(number) = parse_number(&text) {
            return Ok(number);
        }
        let (start, end) = (assignment.value_start, assignment.value_end);
        let expression = parse_expression(line, start, end, &mut self.warnings)?;
        let leading = leading_number(&text);
        let value = Lowering::new(&self.symbols).lower_constant(&expression, "the value");
        let value = value.map_err(|error| match error {
            OdeError::NotConstant { .. } => {
                let name = &assignment.name.text;
                let instead = match declares {
                    Declares::Parameter => format!("`!{name}={text}` for what follows other parameters"),
                    Declares::Initial => format!("`{name}(0)={text}` for what follows parameters"),
                };
                let message = format!(
                    "`{text}` is no constant, and XPPAUT reads only the number at its beginning, {leading}; write that number, or \
                     {instead}"
                );
                OdeError::syntax(line.span(start, end), message)
            }
            other => other,
        })?;
        let message = if leading == value {
            format!("`{text}` is a formula; it is taken as {value}, as XPPAUT reads it")
        } else {
            format!(
                "`{text}` is a formula: it is taken as {value}, but XPPAUT reads only the number at its beginning, {leading}; \
                 write the number that is meant"
            )
        };
        self.warnings.push(Warning::new(line.span(start, end), message));
        Ok(value)
    }

    /// Warns where XPPAUT takes only the number at the beginning of the formula of an initial value, as it does where that begins with a
    /// digit, not with a bracket or a name.
    fn warn_of_leading_number(&mut self, line: &Text, start: usize) {
        let start = line.skip_blanks(start);
        let text = line.string(start, line.len());
        let text = text.trim_end();
        let digits = text.strip_prefix('-').unwrap_or(text);
        if parse_number(text).is_none()
            && digits.starts_with(|first: char| first.is_ascii_digit() || first == '.')
        {
            let leading = leading_number(text);
            let message = format!(
                "the formula `{text}` is taken as it stands, but XPPAUT reads only the number at its beginning, {leading}; write \
                 (..) around the formula"
            );
            self.warnings.push(Warning::new(line.span(start, line.len()), message));
        }
    }

    fn declare(&mut self, name: &Name, symbol: Symbol) -> Result<(), OdeError> {
        let key = name.key();
        let taken = |as_what: String| OdeError::NameTaken {
            place: name.span.into(),
            name: name.text.clone(),
            as_what,
        };
        if !name.text.chars().all(crate::source::is_identifier_part) {
            let message = format!("`{}` is not a name; names hold letters, digits and _", name.text);
            return Err(OdeError::syntax(name.span, message));
        }
        if name.text.starts_with(|first: char| first.is_ascii_digit()) && parse_number(&name.text).is_some() {
            let message = format!("`{}` is a number, not a name", name.text);
            return Err(OdeError::syntax(name.span, message));
        }
        if reserved(&key) {
            return Err(taken("a word of the language".into()));
        }
        if let Some(earlier) = self.symbols.names.get(&key) {
            let line = self.declared.get(&key).map_or(0, |span| span.line);
            return Err(taken(format!("{} (line {line})", earlier.kind())));
        }
        self.declared.insert(key.clone(), name.span);
        self.symbols.names.insert(key, symbol);
        Ok(())
    }

    /// What an event does with the value that it gives to a name; nothing for a word that has no meaning here.
    pub(crate) fn action(&self, name: &Name) -> Result<Option<Action>, OdeError> {
        match (self.symbols.names.get(&name.key()), name.key().as_str()) {
            (Some(&Symbol::State(index)), _) => Ok(Some(Action::Assign(index))),
            (Some(Symbol::Parameter(_)), _) => Err(OdeError::unsupported(
                name.span,
                format!("an event that changes the parameter `{}` is", name.text),
                format!(
                    "make it a state that rests: in place of its par write {0}'=0 and init {0}=..",
                    name.text
                ),
            )),
            (None, "arret") => Ok(Some(Action::Stop)),
            (None, "out_put") => Ok(Some(Action::PutOut)),
            (None, "no_interp") => Ok(None),
            _ => self.state(name).map(|index| Some(Action::Assign(index))),
        }
    }

    /// Index of the state of that name.
    pub(crate) fn state(&self, name: &Name) -> Result<usize, OdeError> {
        match self.symbols.names.get(&name.key()) {
            Some(&Symbol::State(index)) => Ok(index),
            _ => Err(OdeError::UnknownName {
                place: name.span.into(),
                kind: "state",
                name: name.text.clone(),
                nearest: nearest(&name.text, self.symbols.states.iter().map(|state| state.text.as_str())),
            }),
        }
    }
}

/// What XPPAUT reads of a value: the longest beginning that is a number, or 0.
fn leading_number(text: &str) -> f64 {
    let ends = text.char_indices().map(|(index, character)| index + character.len_utf8());
    ends.rev().find_map(|end| parse_number(&text[..end])).unwrap_or(0.0)
}
