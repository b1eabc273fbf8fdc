//! Cycles on both sides of a given one, which may be known roughly only, or traversed several times.

use super::asked::{Asked, FollowedCycles};
use super::borders::tell_borders_apart;
use super::curve::{Birth, CycleInspection};
use super::end::CycleEnd;
use super::orbit::Orbit;
use super::switching::Departure;
use crate::branch::SpecialKind;
use crate::collocation::equations::Collocation;
use crate::continuation::events::around_start;
use crate::continuation::{BothWays, Observer, Request, START_ROUNDING, both_ways, exact_start};
use crate::error::{CorrectionFailure, Error};

/// Turns of a cycle agree where they differ by less than this many errors of it, at least and at most by these parts of its size; those of
/// an orbit that is only near to one may where they differ by less than the last.
const AGREE_WITHIN: f64 = 10.0;
const TURNS_AGREE: [f64; 2] = [1e-7, 1e-3];
const TURNS_MAY_AGREE: f64 = 0.3;
/// Distance from one of multipliers of an orbit near a cycle that may be one of a family.
const OF_A_FAMILY: f64 = 1e-2;
/// Part of the range of the parameter by which the first cycle may lie from a given one that is a fold.
const AT_FOLD: f64 = 1e-3;

impl Asked<'_> {
    /// The cycle of an orbit that turns out to be one traversed several times: the turns of the cycle that is found from it agree
    /// within its error, and the cycle that is found from the first of them is the same.
    pub(super) fn traversed_once(
        &self,
        orbit: &Orbit,
        request: &Request<'_, CycleInspection>,
    ) -> Option<Orbit> {
        let solved = |orbit: &Orbit| {
            let start = self.through(orbit);
            let mut curve = self.curve(&start);
            let found = exact_start(&mut curve, start.unknown, start.tangent, request).ok()?;
            let closeness = (AGREE_WITHIN * found.point.error_estimate).clamp(TURNS_AGREE[0], TURNS_AGREE[1]);
            let end = found.unknown.len() - 2;
            let orbit = Orbit {
                mesh: curve.collocation.mesh().to_vec(),
                degree: start.degree,
                dimension: self.field.dimension(),
                states: found.unknown[..end].to_vec(),
                period: found.unknown[end],
            };
            Some((orbit, closeness))
        };
        // To solve for it twice is for those that may be.
        orbit.traversed_once(TURNS_MAY_AGREE)?;
        let (several, closeness) = solved(orbit)?;
        let first = several.traversed_once(closeness)?;
        let (once, _) = solved(&first)?;
        let turns = (several.period / first.period).round();
        ((once.period * turns - several.period).abs() < closeness * several.period).then_some(once)
    }

    /// Follows the branch through a cycle both ways.
    pub(super) fn pass_through(
        &self,
        orbit: &Orbit,
        request: &Request<'_, CycleInspection>,
        observer: &mut Observer<'_, CycleInspection, SpecialKind>,
    ) -> Result<BothWays<CycleInspection, SpecialKind, CycleEnd>, Error> {
        let mut start = self.through(orbit);
        let given = self.parameters[self.active];
        let directions = both_ways(|sign| {
            if sign < 0.0 {
                start.tangent.iter_mut().for_each(|entry| *entry = -*entry);
                return self.follow(&start, Birth::Unknown, request, observer);
            }
            match self.follow(&start, Birth::Unknown, request, observer) {
                // At a fold the parameter stands still: the size of the cycle changes.
                Err(Error::NotFound { sought, cause }) => {
                    let end = start.unknown.len() - 2;
                    let states = start.unknown[..end].to_vec();
                    start.tangent = Orbit { mesh: start.mesh.clone(), states, ..orbit.clone() }.deviation();
                    start.tangent.extend([0.0, 0.0]);
                    // A cycle elsewhere is not the one that was given.
                    let is_there = |followed: &FollowedCycles| {
                        let first =
                            followed.solutions.first().map(|(first, _)| self.bound.value(&first.unknown));
                        first.is_some_and(|value| {
                            (value - given).abs() <= AT_FOLD * self.bound.width()
                                && self.bound.holds(value, START_ROUNDING)
                        })
                    };
                    match self.follow(&start, Birth::Unknown, request, observer) {
                        Ok(followed) if is_there(&followed) => Ok(followed),
                        _ => Err(Error::NotFound { sought, cause }),
                    }
                }
                result => result,
            }
        })?;
        let first = [0, 1].map(|side: usize| directions[side].first.clone());
        let mut followed = BothWays::join(directions, None);
        // The mesh has moved on: the start once more, on its own.
        let mut curve = self.curve(&start);
        let forward: Vec<f64> =
            followed.solutions.get(followed.start).map_or(Vec::new(), |(start, _)| start.tangent.clone());
        let there = exact_start(&mut curve, start.unknown, start.tangent, request)?;
        let points_forward = there.tangent.len() == forward.len()
            && there.tangent.last().zip(forward.last()).is_some_and(|(a, b)| a * b >= 0.0);
        let there = if points_forward { there } else { there.reversed() };
        let events = around_start(&mut curve, &there, first, &request.bounds, &self.settings)?;
        followed.insert_at_start(&curve, events);
        Ok(followed)
    }

    /// Why no cycle is found from an orbit: cycles of a family, of which more than one multiplier is one, are not alone.
    pub(super) fn in_a_family(&self, orbit: &Orbit, sought: &'static str, cause: CorrectionFailure) -> Error {
        let near_one = self.unsolved(&self.through(orbit)).map_or(0, |solution| {
            let multipliers = solution.point.floquet.nontrivial.iter();
            multipliers.filter(|multiplier| (multiplier.to_complex() - 1.0).norm() < OF_A_FAMILY).count()
        });
        match near_one {
            0 => Error::NotFound { sought, cause },
            count => Error::FamilyOfCycles { cause, count, distance: OF_A_FAMILY },
        }
    }

    /// Departure from an orbit along the parameter.
    fn through(&self, orbit: &Orbit) -> Departure {
        let mut unknown = orbit.states.clone();
        unknown.extend([orbit.period, self.parameters[self.active]]);
        let mut tangent = vec![0.0; unknown.len()];
        tangent[unknown.len() - 1] = self.bound.width();
        let mut collocation = Collocation::new(self.problem(), orbit.mesh.clone(), orbit.degree);
        // Where that fails the search for segments fails again, and says why.
        let mesh = match tell_borders_apart(&mut collocation, &mut unknown, &mut tangent) {
            Ok(()) => collocation.mesh().to_vec(),
            Err(_) => orbit.mesh.clone(),
        };
        Departure { unknown, tangent, mesh, degree: orbit.degree }
    }
}
