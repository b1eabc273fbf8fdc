//! Boundary value problems.

mod boundary_values;
