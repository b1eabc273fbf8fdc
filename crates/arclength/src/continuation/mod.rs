//! Pseudo-arclength continuation of curves of solutions: the same for every problem.
//!
//! A [`Curve`] supplies one equation fewer than it has unknowns, linear solves with its Jacobian
//! bordered by one row, test functions and what there is to know about a solution. [`follow`] supplies predictor,
//! corrector, step control, the search for special points ([`events`]), requested values, ends of ranges and the recognition of
//! closed curves. Source: Keller, "Numerical solution of bifurcation and nonlinear eigenvalue problems"
//! (1977); Allgower and Georg, *Numerical Continuation Methods* (1990); Govaerts, *Numerical Methods
//! for Bifurcations of Dynamical Equilibria* (2000).

mod advance;
mod both_ways;
mod bracket;
mod closure;
mod corrector;
mod curve;
pub mod events;
mod follow;
mod metric;
mod requested;
mod settings;
mod solution;
mod stop;

pub use crate::error::CorrectionFailure;
pub(crate) use both_ways::{BothWays, BothWaysOf, both_ways};
pub(crate) use bracket::{Bracket, locate_value};
pub use bracket::{locate, locate_by_defining_system};
pub use corrector::{Correction, correct};
pub(crate) use corrector::{finish, rounding_updates};
pub use curve::{Adaptation, Curve, Discretised, Ending, Equations, EventOf, Passage, PassageOf};
pub(crate) use follow::exact_start;
pub use follow::{Followed, FollowedCurve, Observer, Request, follow};
pub(crate) use metric::{along, distance, metric_image, norm};
pub(crate) use requested::fix;
pub use requested::{Origin, Purpose, Target};
pub use settings::Settings;
pub(crate) use solution::START_ROUNDING;
pub use solution::{Bound, Solution};
pub use stop::{Explanation, Reason, Stop, Wording};
