//! Branches of equilibria, and how the first is found.

mod branches;
mod corners;
mod ends;
mod first;
mod robustness;
mod start;
