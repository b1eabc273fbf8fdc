//! Forward-mode automatic differentiation.
//!
//! A vector field is written once, generic over [`Scalar`]. Evaluated with `f64` it gives values;
//! with [`Dual<f64, N>`] it gives values and derivatives in `N` directions; with nested duals
//! (`Dual<Dual<f64, 1>, N>` and so on) derivatives of higher order. Source: Griewank and Walther,
//! *Evaluating Derivatives*, 2nd edition (2008), chapters 3 and 13.

mod dual;
mod scalar;

pub use dual::Dual;
pub use scalar::Scalar;
