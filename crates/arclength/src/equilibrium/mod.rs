//! Equilibria: finding one, following branches of them, their bifurcations with normal forms.
//!
//! [`Equilibria`] follows a branch in one parameter and locates folds (LP), branch points (BP) and Hopf points (HB) by
//! Newton's method on their defining systems. Source: Kuznetsov, *Elements of Applied Bifurcation Theory*, 3rd edition
//! (2004), chapters 5 and 10; Govaerts, *Numerical Methods for Bifurcations of Dynamical Equilibria* (2000).

pub(crate) mod bordered_jacobian;
mod branch;
mod branch_point;
mod branching_equation;
pub(crate) mod coefficient_error;
mod conservation;
mod contract;
mod corner;
mod curve;
pub(crate) mod defining;
mod departure;
mod end;
mod first;
mod fold;
pub(crate) mod hopf;
pub(crate) mod locating;
pub(crate) mod multilinear;
pub(crate) mod newton;
pub(crate) mod problem;
mod run;
mod second_lyapunov;
mod special;
pub(crate) mod spectrum;

pub use branch::{EquilibriumBranch, EquilibriumPoint};
pub use branch_point::{BranchPoint, Crossing};
pub use conservation::{ConservedTotal, WithTotals, conserved_totals};
pub use end::EquilibriumEnd;
pub use first::{FoundBy, FoundEquilibrium, seek_equilibrium};
pub use fold::FoldPoint;
pub use hopf::HopfPoint;
pub use newton::find_equilibrium;
pub use run::{Equilibria, EquilibriumStart, equilibrium_settings};
pub use special::{NeutralSaddle, SpecialPoint};
