//! The event engine: which special points lie between two neighbouring solutions of any curve, one by one and in order.
//!
//! A [`Curve`](super::Curve) names its test functions as values, a [`TestFunction`] each: the kind of point at which it changes
//! its sign, how the number of unstable directions may change there, and which other test functions vanish at such a point
//! without a point of their own (the singularity matrix of MatCont: Dhooge, Govaerts and Kuznetsov, ACM TOMS 29 (2003)). It
//! locates a point of a kind between two solutions by Newton's method on the defining system. The engine does the rest: it
//! divides a step until the changes of sign explain the change of the number of unstable directions and single out one point,
//! and until every growth exponent can be followed from one solution to the next without a doubt about how often it crosses the
//! axis of neutral stability. Afterwards the number of unstable directions beside every located point has to change as that
//! point says; where it does not, the surroundings are searched again. What could not be located is kept.
//!
//! A solution that happens to be a special point itself decides nothing: the one a little further along stands for it.

mod count;
mod crossings;
mod event;
mod found;
mod memory;
mod neighbour;
mod node;
mod path;
mod scan;
mod search;
mod spectrum;
mod start;
mod suspicion;
mod test_function;
mod verification;

pub use event::{Event, Unlocated};
pub(crate) use found::Events;
pub(crate) use path::nearest_partners as partners;
pub(crate) use search::EventSearch;
pub use spectrum::Spectrum;
pub(crate) use start::around_start;
pub use test_function::{Location, Reading, TestFunction};
