//! Curves of special cycles in two parameters against systems in which they are known.

#[macro_use]
mod fields;
mod doublings;
mod folds;
mod tori;
