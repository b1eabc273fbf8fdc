//! Branches of cycles as they are followed, each with what it starts from.

use crate::description;
use crate::error::Error;
use crate::hopf::search::{label, same_value};
use arclength::continuation::Stop;
use arclength::cycle::{CycleEnd, CyclePoint};
use kingpin::KingpinError;
use kingpin::branches::{Along, CycleOptions, HopfPoint, WheelCycles};
use serde::{Deserialize, Serialize};
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

/// A Hopf point from which no branch could be followed.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct NotFollowed {
    /// Its label.
    pub from: String,
    /// Value of the parameter.
    #[serde(with = "kingpin_report::number")]
    pub value: f64,
    /// Why.
    pub reason: String,
}

/// The branches that could be followed, and the Hopf points from which none could.
#[derive(Debug)]
pub(crate) struct Followed {
    /// The branches.
    pub branches: Vec<FollowedBranch>,
    /// The Hopf points without.
    pub not_followed: Vec<NotFollowed>,
}

impl NotFollowed {
    /// Of a Hopf point at which the first cycle was not found; other errors are handed back.
    fn of(from: String, value: f64, error: KingpinError) -> Result<Self, Error> {
        match error {
            KingpinError::Continuation(arclength::Error::NotFound { cause, .. }) => {
                Ok(Self { from, value, reason: format!("no cycle was found beside it: {cause}") })
            }
            error => Err(error.into()),
        }
    }

    /// In words.
    pub(super) fn text(&self, along: &Along) -> String {
        let place = description::quantity(along.key(), self.value);
        format!("no branch from {} at {place}: {}", self.from, self.reason)
    }
}

/// The branches from Hopf points, or from one `only`, every branch once: one that ends at another of the Hopf points is not followed
/// again from there.
///
/// # Errors
/// [`Error::NoBranch`] where there are Hopf points and none has a branch, [`Error::Wheel`].
pub(crate) fn from_hopf_points(
    points: &[HopfPoint],
    only: Option<usize>,
    along: Along,
    options: &CycleOptions,
    mut observer: impl FnMut(&CyclePoint) -> ControlFlow<()>,
) -> Result<Followed, Error> {
    let mut branches: Vec<FollowedBranch> = Vec::new();
    let mut not_followed = Vec::new();
    for (index, hopf) in points.iter().enumerate().filter(|(index, _)| only.is_none_or(|only| only == *index))
    {
        let origin = label(index);
        if branches.iter().any(|branch| branch.reached.as_ref().is_some_and(|(label, _)| *label == origin)) {
            continue;
        }
        let cycles = match hopf.cycles(along, options, &mut observer) {
            Ok(cycles) => cycles,
            Err(error) => {
                not_followed.push(NotFollowed::of(origin, hopf.value, error)?);
                continue;
            }
        };
        let reached = points.iter().enumerate().find(|(_, other)| match cycles.stops[1] {
            Some(Stop::Problem(CycleEnd::HopfPoint { parameter, .. })) => same_value(other.value, parameter),
            _ => false,
        });
        let reached = reached.map(|(index, other)| (label(index), other.clone()));
        branches.push(FollowedBranch { origin, hopf: Some(hopf.clone()), reached, cycles });
    }
    if branches.is_empty() && !not_followed.is_empty() {
        let reasons: Vec<String> = not_followed.iter().map(|missing| missing.text(&along)).collect();
        return Err(Error::NoBranch(reasons.join("; ")));
    }
    Ok(Followed { branches, not_followed })
}
