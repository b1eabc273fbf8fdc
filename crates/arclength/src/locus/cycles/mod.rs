//! Curves of special cycles in two parameters, and of cycles on which a quantity keeps its value.
//!
//! The unknowns are those of the [defining system](crate::cycle) of a fold, a period doubling or a torus bifurcation with a
//! second parameter set free. Points of codimension two are zeros of test functions along the curve that are regular there,
//! located by a secant method to the accuracy of the curve itself.

mod branch;
mod curve;
mod end;
mod ends;
mod hold;
mod locating;
mod monitor;
mod run;

pub use branch::{CycleLocusBranch, CycleLocusPoint};
pub use end::CycleLocusEnd;
pub use run::{CycleLocus, CycleLocusProblem};
