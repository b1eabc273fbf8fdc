//! Expressions as they are written: a list of nodes in evaluation order, operands before operators.
//!
//! The list, rather than a tree of boxes, keeps every later pass a loop: a sum of a thousand terms
//! is not a thousand stack frames.

mod functions;
mod parser;
mod token;

pub(crate) use functions::{
    BUILTIN_NAMES, BinaryOperation, Builtin, UnaryOperation, lookup_builtin, reserved,
};
pub(crate) use parser::parse_expression;
pub(crate) use token::parse_number;

use crate::error::{OdeError, Span};

/// An expression; its value is that of the last node.
#[derive(Clone, Debug)]
pub(crate) struct Expression {
    pub nodes: Vec<(Node, Span)>,
}

/// One step of an expression. Operands are the values of earlier nodes, by index.
#[derive(Clone, Debug)]
pub(crate) enum Node {
    Number(f64),
    /// A state, parameter, quantity or argument, in lower case.
    Name(String),
    /// The index `i'` of a sum.
    SumIndex,
    Unary(UnaryOperation, usize),
    Binary(BinaryOperation, usize, usize),
    /// A call of a function of the model, or of one of the built-in functions that are not an operation.
    Call(String, Vec<usize>),
    /// `if(condition)then(yes)else(no)`; the branches are expressions of their own.
    If(usize, Box<Expression>, Box<Expression>),
    /// `sum(low, high)of(term)`
    Sum(usize, usize, Box<Expression>),
    /// `shift(name, offset)`
    Shift(String, usize),
    /// What is refused where the equations depend on it.
    Refused(Box<OdeError>),
}
