//! Reads an expression, with XPPAUT's precedence.
//!
//! From loose to tight: `+ - |`, then `* / &` with negation and `not`, then `^ ** > < == >= <= !=`;
//! every operator associates to the left. So `-x^2` is `-(x^2)`, `2^3^2` is 64, and `a+b>3` is
//! `a+(b>3)`, which is rarely what was meant and earns a warning.

use super::functions::{BinaryOperation, Builtin, UnaryOperation, lookup_builtin};
use super::token::{Token, tokenize};
use super::{Expression, Node};
use crate::error::{OdeError, Span, Warning};
use crate::source::Text;

/// Deepest nesting of parentheses, calls and unary operators.
const MAXIMUM_DEPTH: usize = 300;

/// Reads `line[start..end]` as one expression.
pub(crate) fn parse_expression(
    line: &Text,
    start: usize,
    end: usize,
    warnings: &mut Vec<Warning>,
) -> Result<Expression, OdeError> {
    let tokens = tokenize(line, start, end)?;
    let mut parser = Parser { tokens, position: 0, depth: 0, nodes: Vec::new(), warnings };
    parser.expression(Tightness::Sum)?;
    match parser.peek() {
        Token::End => Ok(Expression { nodes: parser.nodes }),
        Token::Symbol(")") => Err(parser.error("this parenthesis ) was never opened")),
        Token::Symbol("=") => Err(parser.error("expected the end of the expression; equality is written ==")),
        Token::Symbol("'") => {
            Err(parser
                .error("derivatives can be used by name only: define the right-hand side as a quantity"))
        }
        Token::Name(_) | Token::Number(_) | Token::Symbol("(") => {
            Err(parser.error("expected an operator here; products are written with *"))
        }
        other => {
            let message = format!("expected an operator or the end, found {}", describe(other));
            Err(parser.error(message))
        }
    }
}

#[derive(Clone, Copy, PartialEq, PartialOrd)]
enum Tightness {
    Sum,
    Product,
    Power,
    Operand,
}

struct Parser<'a> {
    tokens: Vec<(Token, Span)>,
    position: usize,
    depth: usize,
    nodes: Vec<(Node, Span)>,
    warnings: &'a mut Vec<Warning>,
}

/// The value of a node, and what about its writing matters to its neighbours.
#[derive(Clone, Copy)]
struct Operand {
    node: usize,
    /// A comparison without parentheses around it.
    bare_comparison: Option<Span>,
}

impl Parser<'_> {
    fn peek(&self) -> &Token {
        &self.tokens[self.position].0
    }

    fn span(&self) -> Span {
        self.tokens[self.position].1
    }

    /// Goes to the next token; the last, [`Token::End`], stays.
    fn advance(&mut self) {
        self.position = (self.position + 1).min(self.tokens.len() - 1);
    }

    fn take(&mut self, symbol: &'static str) -> bool {
        let found = *self.peek() == Token::Symbol(symbol);
        if found {
            self.advance();
        }
        found
    }

    fn error(&self, message: impl Into<String>) -> OdeError {
        OdeError::syntax(self.span(), message)
    }

    fn expect(&mut self, symbol: &'static str, context: &str) -> Result<(), OdeError> {
        if self.take(symbol) {
            return Ok(());
        }
        Err(self.error(format!("expected {symbol} {context}, found {}", describe(self.peek()))))
    }

    fn expect_word(&mut self, word: &'static str, context: &str) -> Result<(), OdeError> {
        if *self.peek() == Token::Name(word.to_owned()) {
            self.advance();
            return Ok(());
        }
        Err(self.error(format!("expected `{word}` {context}, found {}", describe(self.peek()))))
    }

    fn push(&mut self, node: Node, span: Span) -> Operand {
        self.nodes.push((node, span));
        Operand { node: self.nodes.len() - 1, bare_comparison: None }
    }

    fn descend<R>(&mut self, parse: impl FnOnce(&mut Self) -> Result<R, OdeError>) -> Result<R, OdeError> {
        self.depth += 1;
        if self.depth > MAXIMUM_DEPTH {
            let what = "the expression is nested too deeply".into();
            return Err(OdeError::TooLarge { place: self.span().into(), what, limit: MAXIMUM_DEPTH });
        }
        let result = parse(self);
        self.depth -= 1;
        result
    }

    /// A chain of operators no looser than `tightness`.
    fn expression(&mut self, tightness: Tightness) -> Result<Operand, OdeError> {
        let mut left = self.operand(tightness)?;
        while let Some((operation, of_operator)) = binary_operator(self.peek()) {
            if of_operator < tightness {
                break;
            }
            let span = self.span();
            self.advance();
            let right = match of_operator {
                Tightness::Sum => self.descend(|parser| parser.expression(Tightness::Product))?,
                Tightness::Product => self.descend(|parser| parser.expression(Tightness::Power))?,
                Tightness::Power | Tightness::Operand => self.operand(Tightness::Operand)?,
            };
            self.warn_about_comparison(operation, left, right);
            left = self.push(Node::Binary(operation, left.node, right.node), span);
            if operation.is_comparison() {
                left.bare_comparison = Some(span);
            }
        }
        Ok(left)
    }

    fn warn_about_comparison(&mut self, operation: BinaryOperation, left: Operand, right: Operand) {
        if !operation.is_arithmetic() {
            return;
        }
        if let Some(span) = left.bare_comparison.or(right.bare_comparison) {
            self.warnings.push(Warning::new(
                span,
                "a comparison binds more tightly than arithmetic, as in XPPAUT: `a+b>c` is `a+(b>c)`; \
                 put parentheses around both sides",
            ));
        }
    }

    /// A unary operator with its operand, or a primary expression.
    fn operand(&mut self, tightness: Tightness) -> Result<Operand, OdeError> {
        let span = self.span();
        let operation = match self.peek() {
            Token::Symbol("-") => Some(UnaryOperation::Negate),
            Token::Name(name) if name == "not" => Some(UnaryOperation::Not),
            Token::Symbol("+") => None,
            _ => return self.descend(Self::primary),
        };
        self.advance();
        // A unary operator takes a whole power, but after ^ or a comparison only the next operand.
        let inner = if tightness == Tightness::Operand { Tightness::Operand } else { Tightness::Power };
        let operand = self.descend(|parser| match inner {
            Tightness::Operand => parser.operand(Tightness::Operand),
            _ => parser.expression(Tightness::Power),
        })?;
        let Some(operation) = operation else { return Ok(operand) };
        if operation == UnaryOperation::Negate {
            self.warn_about_comparison(BinaryOperation::Subtract, operand, operand);
        }
        Ok(self.push(Node::Unary(operation, operand.node), span))
    }

    fn primary(&mut self) -> Result<Operand, OdeError> {
        let span = self.span();
        match self.peek().clone() {
            Token::Number(value) => {
                self.advance();
                Ok(self.push(Node::Number(value), span))
            }
            Token::Symbol("(") => {
                self.advance();
                let inner = self.expression(Tightness::Sum)?;
                self.expect(")", "to close the parenthesis")?;
                Ok(Operand { bare_comparison: None, ..inner })
            }
            Token::Name(name) => {
                self.advance();
                self.name(name, span)
            }
            Token::End => Err(self.error("the expression ends where a number or name was expected")),
            other => Err(self.error(format!("expected a number or name, found {}", describe(&other)))),
        }
    }

    fn name(&mut self, name: String, span: Span) -> Result<Operand, OdeError> {
        match name.as_str() {
            "i" if *self.peek() == Token::Symbol("'") => {
                self.advance();
                return Ok(self.push(Node::SumIndex, span));
            }
            "if" => return self.conditional(span),
            "sum" => return self.sum(span),
            "shift" => return self.shift(span),
            "int" if matches!(self.peek(), Token::Symbol("{" | "[")) => {
                return Err(OdeError::unsupported(
                    span,
                    "integrals over the past (int) are",
                    "replace an exponential kernel by a differential equation (the linear chain trick)",
                ));
            }
            _ => {}
        }
        let builtin = lookup_builtin(&name);
        if let Some(Builtin::Unsupported(feature, remedy)) = builtin {
            return Err(OdeError::unsupported(span, feature, remedy));
        }
        if *self.peek() != Token::Symbol("(") {
            if builtin.is_some() {
                return Err(self.error(format!("expected ( after the function `{name}`")));
            }
            return Ok(self.push(Node::Name(name), span));
        }
        self.advance();
        let mut arguments = Vec::new();
        loop {
            arguments.push(self.expression(Tightness::Sum)?.node);
            if !self.take(",") {
                break;
            }
        }
        self.expect(")", &format!("after the arguments of `{name}`"))?;
        let wrong_number = |expected: usize| OdeError::WrongNumberOfArguments {
            place: span.into(),
            function: name.clone(),
            expected,
            found: arguments.len(),
        };
        let node = match (builtin, arguments.as_slice()) {
            (Some(Builtin::Unary(operation)), &[argument]) => Node::Unary(operation, argument),
            (Some(Builtin::Binary(operation)), &[first, second]) => Node::Binary(operation, first, second),
            (Some(Builtin::Unary(_)), _) => return Err(wrong_number(1)),
            (Some(Builtin::Binary(_)), _) => return Err(wrong_number(2)),
            (Some(Builtin::BesselJ | Builtin::BesselY), list) if list.len() != 2 => {
                return Err(wrong_number(2));
            }
            _ => Node::Call(name, arguments),
        };
        Ok(self.push(node, span))
    }

    fn conditional(&mut self, span: Span) -> Result<Operand, OdeError> {
        self.expect("(", "after `if`")?;
        let condition = self.expression(Tightness::Sum)?.node;
        self.expect(")", "after the condition of `if`")?;
        self.expect_word("then", "after if(...)")?;
        self.expect("(", "after `then`")?;
        let yes = self.separate()?;
        self.expect(")", "after the expression of `then`")?;
        self.expect_word("else", "after if(...)then(...)")?;
        self.expect("(", "after `else`")?;
        let no = self.separate()?;
        self.expect(")", "after the expression of `else`")?;
        Ok(self.push(Node::If(condition, Box::new(yes), Box::new(no)), span))
    }

    fn sum(&mut self, span: Span) -> Result<Operand, OdeError> {
        self.expect("(", "after `sum`")?;
        let low = self.expression(Tightness::Sum)?.node;
        self.expect(",", "between the limits of `sum`")?;
        let high = self.expression(Tightness::Sum)?.node;
        self.expect(")", "after the limits of `sum`")?;
        self.expect_word("of", "after sum(low,high)")?;
        self.expect("(", "after `of`")?;
        let term = self.separate()?;
        self.expect(")", "after the terms of `sum`")?;
        Ok(self.push(Node::Sum(low, high, Box::new(term)), span))
    }

    fn shift(&mut self, span: Span) -> Result<Operand, OdeError> {
        self.expect("(", "after `shift`")?;
        let Token::Name(name) = self.peek().clone() else {
            return Err(self.error("the first argument of `shift` must be the name of a state or parameter"));
        };
        self.advance();
        self.expect(",", "after the name in `shift`")?;
        let offset = self.expression(Tightness::Sum)?.node;
        self.expect(")", "after the arguments of `shift`")?;
        Ok(self.push(Node::Shift(name, offset), span))
    }

    /// An expression with nodes of its own.
    fn separate(&mut self) -> Result<Expression, OdeError> {
        let outer = std::mem::take(&mut self.nodes);
        let result = self.expression(Tightness::Sum);
        let nodes = std::mem::replace(&mut self.nodes, outer);
        result.map(|_| Expression { nodes })
    }
}

fn binary_operator(token: &Token) -> Option<(BinaryOperation, Tightness)> {
    use BinaryOperation as B;
    let Token::Symbol(symbol) = token else { return None };
    Some(match *symbol {
        "+" => (B::Add, Tightness::Sum),
        "-" => (B::Subtract, Tightness::Sum),
        "|" | "||" => (B::Or, Tightness::Sum),
        "*" => (B::Multiply, Tightness::Product),
        "/" => (B::Divide, Tightness::Product),
        "&" | "&&" => (B::And, Tightness::Product),
        "^" | "**" => (B::Power, Tightness::Power),
        ">" => (B::Greater, Tightness::Power),
        "<" => (B::Less, Tightness::Power),
        "==" => (B::Equal, Tightness::Power),
        ">=" => (B::GreaterOrEqual, Tightness::Power),
        "<=" => (B::LessOrEqual, Tightness::Power),
        "!=" | "<>" => (B::NotEqual, Tightness::Power),
        _ => return None,
    })
}

fn describe(token: &Token) -> String {
    match token {
        Token::Number(value) => format!("the number {value}"),
        Token::Name(name) => format!("`{name}`"),
        Token::Symbol(symbol) => format!("`{symbol}`"),
        Token::End => "the end of the line".to_owned(),
    }
}
