//! From expressions to a graph of operations without names.

mod graph;
mod lower;
mod removable;

pub(crate) use graph::{Graph, NodeId, Operation};
pub(crate) use lower::{
    FunctionDefinition, Lowering, QuantityDefinition, Scope, Symbol, Symbols, TableDefinition,
};
