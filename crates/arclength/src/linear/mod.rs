//! Linear algebra of small dense matrices.

mod balancing;
pub(crate) mod complex_lu;
pub mod eigenvalues;
pub mod eigenvectors;
pub mod exponential;
pub(crate) mod lane_entry;
pub mod lu;
pub(crate) mod lu_in_lanes;
pub mod multiplier;
mod periodic_block;
pub mod periodic_schur;
mod periodic_sweep;
pub mod product_eigenvectors;
mod reflector;
pub(crate) mod strong_components;
mod wide_range;
