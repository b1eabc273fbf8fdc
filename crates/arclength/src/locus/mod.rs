//! Curves of special points in two parameters.
//!
//! [`EquilibriumLocus`] follows folds, Hopf points and branch points of equilibria while two parameters vary, by the
//! extended systems that define them, and locates the points of codimension two on the way: cusps, Bogdanov-Takens,
//! generalised Hopf (Bautin), zero-Hopf and Hopf-Hopf points. [`CycleLocus`] does the same for folds, period doublings and
//! torus bifurcations of cycles: cusps of cycles, strong resonances, fold-flips and so on. Both also follow any equilibria or cycles on
//! which a quantity keeps its value ([`Held`]). The metric is dimensionless, so that the steps depend on
//! neither the units of states and parameters nor the scaling of eigenvectors. Source: Kuznetsov, *Elements of Applied
//! Bifurcation Theory*, 3rd edition (2004), chapters 8 and 10.

mod branch;
mod codimension_two;
mod contract;
mod curve;
mod cycles;
mod gauge;
mod held;
mod held_equilibria;
mod kind;
mod locating;
mod newton;
mod normal_form;
mod request;
mod run;
mod system;

pub use branch::{EquilibriumLocusBranch, LocusPoint};
pub use codimension_two::CodimensionTwoPoint;
pub use cycles::{CycleLocus, CycleLocusBranch, CycleLocusEnd, CycleLocusPoint, CycleLocusProblem};
pub use held::Held;
pub use run::{EquilibriumLocus, EquilibriumLocusStart};
