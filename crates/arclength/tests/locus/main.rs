//! Curves of special points in two parameters: of equilibria and of cycles.

#[macro_use]
#[path = "../common/field.rs"]
mod field;
#[path = "../common/mod.rs"]
mod common;
mod cycles;
mod equilibria;
