//! From expressions to a graph of operations without names.

mod graph;
mod guards;
mod lower;
mod norms;
mod regions;
mod removable;

pub(crate) use graph::{Graph, NodeId, Operation};
pub(crate) use guards::Unguarded;
pub(crate) use lower::{
    FunctionDefinition, Lowering, QuantityDefinition, Scope, Symbol, Symbols, TableDefinition,
};
pub(crate) use regions::Regions;
