//! Eigenvalues, eigenvectors and Schur forms of matrices and of products of them.

mod eigenvalues;
mod periodic_schur;
mod product_eigenvectors;
