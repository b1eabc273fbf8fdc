//! The engine against closed forms, published values and independent integration, in folders named as those of the sources.
//!
//! One program for all of them: to build one for each would take longer than to run them.

#[macro_use]
mod field;
mod algebraic;
mod collocation;
mod common;
mod continuation;
mod cycle;
mod equilibrium;
mod integration;
mod linear;
mod locus;
