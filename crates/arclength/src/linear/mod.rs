//! Linear algebra of small dense matrices.

mod balancing;
mod complex_lu;
pub mod eigenvalues;
pub mod eigenvectors;
pub(crate) mod lanes;
pub mod lu;
pub mod multiplier;
mod periodic_block;
pub mod periodic_schur;
mod periodic_sweep;
pub mod product_eigenvectors;
mod reflector;
mod wide_range;
