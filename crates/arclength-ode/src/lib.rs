//! Reads the `.ode` text models of XPPAUT and compiles them to vector fields.
//!
//! [`Model::parse`] reads the text, says with line and column what it cannot take, and compiles the
//! right-hand sides once to a short list of register instructions that is evaluated for any
//! [`arclength::Scalar`]: values, Jacobians and higher derivatives come from the same code.
//!
//! ```
//! use arclength::VectorField;
//! use arclength_ode::Model;
//!
//! let model = Model::parse(
//!     "# van der Pol's oscillator\n\
//!      par mu=1\n\
//!      x' = y\n\
//!      dy/dt = mu*(1 - x^2)*y - x\n\
//!      init x=2\n\
//!      aux energy = (x^2 + y^2)/2\n\
//!      done\n",
//! )?;
//! let mut derivative = [0.0; 2];
//! model.evaluate(&model.initial_state(&[1.0]), &[1.0], &mut derivative);
//! assert_eq!(derivative, [0.0, -2.0]);
//! assert!(model.is_autonomous());
//! # Ok::<(), arclength_ode::OdeError>(())
//! ```
//!
//! The language is that of B. Ermentrout, *Simulating, Analyzing, and Animating Dynamical Systems*
//! (2002), with the precedence of XPPAUT 6.11: `^` associates to the left, and comparisons bind as
//! tightly as `^`, more tightly than `*` and `+` (a [`Warning`] points at every place where that
//! matters). Directives are known by their first letters, names may begin with a digit, and a line that
//! begins with no directive is left out, all as in XPPAUT. A table of a formula is a function.
//!
//! Lines `global` are [events](Event), which set states where a condition passes zero.
//!
//! A program that has its equations as operations builds a model node by node, by [`ModelBuilder`].
//!
//! What makes a model something else than a smooth system of ordinary differential equations (delays,
//! algebraic equations, noise, tables from files, integral equations, Markov variables, boundary
//! conditions, maps, external libraries) is refused with an [`OdeError::Unsupported`] that says what to do.
//! Where only outputs (`aux`) depend on it, they are left out with a warning.

#![warn(unreachable_pub)]

mod assignments;
mod builder;
mod compile;
mod declarations;
mod error;
mod event;
mod expand;
mod expression;
mod interval;
mod look_alike;
mod model;
mod name;
mod not_finite;
mod options;
mod quantity;
mod source;
mod statement;
mod switches;
mod tape;
mod vanishing;

pub use builder::{BuiltNode, ModelBuilder, Operator};
pub use error::{OdeError, Place, Warning};
pub use event::{Event, Outcome};
pub use model::{Model, NamedSet};
pub use not_finite::NotFinite;
pub use options::{OptionEntry, Options};
pub use quantity::Quantity;
pub use switches::{GivenUp, Switch};
pub use vanishing::Vanishing;

/// The code of the README, which is tested.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;
