//! The search for special points along a curve, step by step.

use super::found::{Events, search};
use super::memory::Memory;
use super::neighbour::beyond;
use super::node::{Known, Node, undecided};
use crate::continuation::metric::distance;
use crate::continuation::solution::Bound;
use crate::continuation::{Curve, Settings, Solution};
use crate::error::Error;

/// What a run remembers from step to step.
pub(crate) struct EventSearch {
    memory: Memory,
    /// The unknowns, next to the start, from which on the curve was searched.
    first: Option<Vec<f64>>,
    bounds: Vec<Bound>,
    /// Rates at the end of the step before.
    known: Option<Known>,
}

impl EventSearch {
    /// Along a curve whose parameters are bounded.
    pub(crate) fn new(bounds: &[Bound]) -> Self {
        Self { memory: Memory::default(), first: None, bounds: bounds.to_vec(), known: None }
    }

    /// The unknowns, next to the start, from which on the curve was searched; `None` before the first step.
    pub(crate) fn into_first(self) -> Option<Vec<f64>> {
        self.first
    }

    /// Forgets the step before: the curve goes on in another piece.
    pub(crate) fn restart(&mut self) {
        self.memory = Memory::default();
        self.known = None;
    }

    /// Special points between two consecutive solutions; those at the start itself belong to
    /// [`around_start`](super::around_start).
    ///
    /// # Errors
    /// [`Error::OtherBranch`] if the step led to another branch and has to be made anew and shorter.
    pub(crate) fn between<C: Curve>(
        &mut self,
        curve: &mut C,
        before: &Solution<C::Point>,
        after: &Solution<C::Point>,
        settings: &Settings,
    ) -> Result<Events<C>, Error> {
        if curve.test_functions().is_empty() {
            return Ok(Events::default());
        }
        let reach = distance(curve, &before.unknown, &after.unknown);
        let undecided = [before, after].map(|solution| undecided(curve, solution));
        let least = undecided[0].min(undecided[1]);
        let first_step = self.first.is_none();
        let from = if first_step || undecided[0] > least {
            beyond(curve, before, least, reach, settings)
        } else {
            None
        };
        let to = if undecided[1] > least { beyond(curve, after, least, reach, settings) } else { None };
        let mut left = Node::new(curve, from.unwrap_or_else(|| before.clone()));
        let mut right = Node::new(curve, to.unwrap_or_else(|| after.clone()));
        left.recall(self.known.take(), curve);
        let events = search(curve, [&mut left, &mut right], &self.memory, &self.bounds, settings)?;
        if reach > settings.shortest_jump && !is_oriented(curve, [&left, &right], &events) {
            return Err(Error::OtherBranch);
        }
        // A first step that led to another branch is made anew.
        if first_step {
            self.first = Some(left.solution.unknown);
        }
        self.memory = Memory::of(curve, before);
        self.known = right.into_known(curve);
        Ok(events)
    }
}

/// Whether the branch points between two solutions explain how the orientation changes (Keller, "Numerical solution of bifurcation and
/// nonlinear eigenvalue problems" (1977)): next to a branch point a step may lead to the other branch through it.
fn is_oriented<C: Curve>(curve: &C, [left, right]: [&Node<C>; 2], events: &Events<C>) -> bool {
    let tests = curve.test_functions();
    tests.iter().enumerate().filter(|(_, test)| test.is_orientation).all(|(index, test)| {
        let (Some(here), Some(there)) = (left.readings[index], right.readings[index]) else { return true };
        let points = events.found.iter().filter(|event| event.kind == test.kind);
        let is_known = points.clone().all(|event| event.is_located)
            && events.unlocated.iter().all(|change| change.kind.is_some_and(|kind| kind != test.kind));
        !is_known || here.class != there.class || (points.count() % 2 == 1) == here.changes_to(there)
    })
}
