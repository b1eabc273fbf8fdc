//! Numerical continuation of ordinary differential equations `x' = f(x, p)`.
//!
//! A model is a [`VectorField`], written once over any [`Scalar`], so that all derivatives come
//! from forward-mode automatic differentiation ([`Dual`]).

pub mod algebraic;
pub mod branch;
pub mod collocation;
pub mod continuation;
pub mod control;
pub mod cycle;
pub mod differentiation;
mod direction;
pub mod equilibrium;
mod erased;
pub mod error;
pub mod field;
pub mod integration;
pub mod lanes;
pub mod linear;
pub mod locus;
mod parameters;
pub mod pieces;
mod random;
mod threshold;

pub use arclength_numbers as numbers;
pub use differentiation::{Dual, Scalar};
pub use direction::Direction;
pub use erased::ErasedField;
pub use error::Error;
pub use field::VectorField;
pub use threshold::Threshold;

/// The code of the README, which is tested.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;
