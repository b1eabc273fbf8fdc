//! Pseudo-arclength continuation of curves of solutions: the same for every problem.
//!
//! A [`Curve`] supplies one equation fewer than it has unknowns, linear solves with its Jacobian
//! bordered by one row, and what there is to know about a solution. [`follow`] supplies predictor,
//! corrector, step control, requested parameter values, ends of ranges and the recognition of closed
//! curves. Source: Keller, "Numerical solution of bifurcation and nonlinear eigenvalue problems"
//! (1977); Allgower and Georg, *Numerical Continuation Methods* (1990); Govaerts, *Numerical Methods
//! for Bifurcations of Dynamical Equilibria* (2000).

mod bracket;
mod closure;
mod corrector;
mod curve;
mod follow;
mod settings;
mod stop;

pub(crate) use bracket::Bracket;
pub use bracket::locate;
pub use corrector::{Correction, CorrectionFailure, correct};
pub use curve::{Adaptation, Curve, Ending, Solution};
pub use follow::{Bound, Followed, Origin, Request, follow};
pub(crate) use follow::{along, finish};
pub use settings::Settings;
pub use stop::Stop;
