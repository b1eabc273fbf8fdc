//! Limit cycles from the Hopf points of an interval, from a labelled point of an earlier result or from samples of an orbit.

mod followed;
mod picture;
mod point;
mod request;
mod result;

pub use followed::NotFollowed;
pub(crate) use followed::{Followed, from_hopf_points};
pub(crate) use picture::{bifurcation_diagram, needs_more_friction, stability};
pub use point::CyclePointResult;
pub(crate) use point::{ROLLING_LIMIT, ROLLING_LIMIT_NAME, at_cycle};
pub use request::{CyclesAnalysis, CyclesRequest};
pub use result::{BranchResult, CyclesResult};
