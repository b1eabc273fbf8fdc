//! Cycles of the branch that leaves another one at a bifurcation: the doubled ones, or those behind a branch point.

use super::asked::{Asked, FollowedCycles};
use super::curve::{Birth, CycleInspection};
use super::switching::{Branching, Departure};
use crate::branch::SpecialKind;
use crate::continuation::{Curve, Observer, Request, Solution};
use crate::error::Error;

/// Distance of the first cycle of a new branch from the bifurcation, as part of the size of the cycle there, and its reduction where none is found.
const FIRST_DISTANCE: f64 = 0.02;
const DISTANCE_REDUCTION: f64 = 0.5;

impl Asked<'_> {
    /// Follows the branch that leaves another one at a bifurcation, in one of its two directions.
    pub(super) fn leave(
        &self,
        branching: &Branching,
        sign: f64,
        request: &Request<'_, CycleInspection>,
        observer: &mut Observer<'_, CycleInspection, SpecialKind>,
    ) -> Result<FollowedCycles, Error> {
        let mut start = self.departure(branching);
        let mut curve = self.curve(&start);
        curve.count_resting_states_fully();
        let mut image = vec![0.0; start.tangent.len()];
        curve.apply_metric(&start.tangent, &mut image);
        let size = start.tangent.iter().zip(&image).map(|(a, b)| a * b).sum::<f64>().sqrt();
        start.tangent.iter_mut().for_each(|entry| *entry *= sign / size);
        let origin = start.unknown.clone();
        let birth = if branching.doubled { Birth::Doubled } else { Birth::Unknown };
        self.first_of(FIRST_DISTANCE, DISTANCE_REDUCTION, |distance| {
            let ahead = origin.iter().zip(&start.tangent).map(|(value, slope)| value + distance * slope);
            start.unknown = ahead.collect();
            self.follow(&start, birth, request, observer)
        })
    }

    /// The branch point as a cycle of the branch that leaves there.
    pub(super) fn branch_point(&self, branching: &Branching) -> Result<Solution<CycleInspection>, Error> {
        let start = self.departure(branching);
        let mut solution = self.unsolved(&start)?;
        solution.point.branching = branching.known_branch();
        Ok(solution)
    }

    /// The bifurcation itself and the direction of the new branch.
    fn departure(&self, branching: &Branching) -> Departure {
        let Branching { orbit, direction, .. } = branching;
        let mut start = Departure {
            unknown: orbit.states.clone(),
            tangent: direction.clone(),
            mesh: orbit.mesh.clone(),
            degree: orbit.degree,
        };
        start.unknown.extend([orbit.period, self.parameters[self.active]]);
        start.tangent.extend([branching.period, branching.parameter]);
        start
    }
}
