//! Branches of cycles as they are followed, each with what it starts from.

use crate::error::Error;
use crate::hopf::search::{label, same_value};
use arclength::continuation::Stop;
use arclength::cycle::{CycleEnd, CyclePoint};
use kingpin::branches::{Along, CycleOptions, HopfPoint, WheelCycles};
use std::ops::ControlFlow;

/// A branch with the label of what it starts from.
#[derive(Debug)]
pub(crate) struct FollowedBranch {
    /// The label of what it starts from, and what was done there.
    pub origin: String,
    /// The Hopf point that it starts from.
    pub hopf: Option<HopfPoint>,
    /// The Hopf point at which it ends.
    pub reached: Option<(String, HopfPoint)>,
    /// Its cycles.
    pub cycles: WheelCycles,
}

/// The branches from Hopf points, or from one `only`, every branch once: one that ends at another of the Hopf points is not followed
/// again from there.
///
/// # Errors
/// [`Error::Wheel`].
pub(crate) fn from_hopf_points(
    points: &[HopfPoint],
    only: Option<usize>,
    along: Along,
    options: &CycleOptions,
    mut observer: impl FnMut(&CyclePoint) -> ControlFlow<()>,
) -> Result<Vec<FollowedBranch>, Error> {
    let mut branches: Vec<FollowedBranch> = Vec::new();
    for (index, hopf) in points.iter().enumerate().filter(|(index, _)| only.is_none_or(|only| only == *index))
    {
        let origin = label(index);
        if branches.iter().any(|branch| branch.reached.as_ref().is_some_and(|(label, _)| *label == origin)) {
            continue;
        }
        let cycles = hopf.cycles(along, options, &mut observer)?;
        let reached = points.iter().enumerate().find(|(_, other)| match cycles.stops[1] {
            Some(Stop::Problem(CycleEnd::HopfPoint { parameter, .. })) => same_value(other.value, parameter),
            _ => false,
        });
        let reached = reached.map(|(index, other)| (label(index), other.clone()));
        branches.push(FollowedBranch { origin, hopf: Some(hopf.clone()), reached, cycles });
    }
    Ok(branches)
}
