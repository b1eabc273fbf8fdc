//! Points of a branch as they are found, for a face that shows the branch while it grows.

use arclength::branch::Label;
use arclength::cycle::Orbit;

/// A point of a branch or curve, before the branch is finished.
#[derive(Clone, Copy, Debug)]
pub struct FoundPoint<'a> {
    /// The value of the parameter that varies, or of both.
    pub values: &'a [f64],
    /// The largest value of every state; at an equilibrium its value.
    pub max: &'a [f64],
    /// The smallest value of every state.
    pub min: &'a [f64],
    /// Nothing where that is not decided, or not asked.
    pub stable: Option<bool>,
    /// The label of a special point. Its number is not yet that of the result, where labels are numbered along the branch.
    pub label: Option<Label>,
    /// The cycle.
    pub orbit: Option<&'a Orbit>,
}
