//! Linear algebra of small dense matrices.

mod balancing;
mod complex_lu;
pub mod eigenvalues;
pub mod eigenvectors;
pub mod lu;
mod reflector;
