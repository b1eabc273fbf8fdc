//! The search for special points along a curve, step by step.

use super::node::{Node, Spectrum, undecided};
use super::scan::Scan;
use super::start::beyond;
use crate::continuation::solution::{Bound, distance};
use crate::continuation::{Curve, Settings, Solution};
use crate::error::Error;

/// A special point that was found between two solutions.
#[derive(Clone, Debug)]
pub struct Event<K, P> {
    /// What it is.
    pub kind: K,
    /// Whether it satisfies its defining system; otherwise it was bracketed.
    pub is_located: bool,
    /// The point.
    pub solution: Solution<P>,
}

/// A change of sign, or of the number of unstable directions, behind which no special point could be located.
#[derive(Clone, Debug, PartialEq)]
pub struct Unlocated<K> {
    /// The kind whose test function changed its sign; `None` where only the number of unstable directions changed.
    pub kind: Option<K>,
    /// Values of the bounded parameters between which it changed.
    pub between: [Vec<f64>; 2],
}

/// Special points between two solutions, in the order of the curve, and what could not be located.
pub(crate) struct Events<C: Curve + ?Sized> {
    pub found: Vec<Event<C::Kind, C::Point>>,
    pub unlocated: Vec<Unlocated<C::Kind>>,
}

impl<C: Curve> Default for Events<C> {
    fn default() -> Self {
        Self { found: Vec::new(), unlocated: Vec::new() }
    }
}

/// Values and exponents at the solution before the last: how much they change from step to step.
#[derive(Debug, Default)]
pub(super) struct Memory {
    readings: Vec<Option<f64>>,
    spectrum: Option<Spectrum>,
}

impl Memory {
    fn of<C: Curve>(curve: &C, solution: &Solution<C::Point>) -> Self {
        let readings = curve.test_functions().iter().map(|test| Some(curve.test(test.kind, solution)?.value));
        Self { readings: readings.collect(), spectrum: Some(curve.spectrum(solution)) }
    }

    /// Change of the real part of an exponent; infinite where there is nothing to compare with.
    pub fn change_of_exponent(&self, spectrum: &Spectrum, index: usize) -> f64 {
        let Some(previous) = &self.spectrum else { return f64::INFINITY };
        let here = spectrum.exponents[index];
        let nearest = previous.exponents.iter().min_by(|one, other| {
            previous.separation(here, **one).total_cmp(&previous.separation(here, **other))
        });
        nearest.map_or(f64::INFINITY, |value| (value.re - here.re).abs())
    }

    /// Change of a test function.
    pub fn change_of_reading(&self, index: usize, value: f64) -> f64 {
        self.readings.get(index).map_or(f64::INFINITY, |previous| {
            previous.map_or(f64::INFINITY, |previous| (value - previous).abs())
        })
    }
}

/// What a run remembers from step to step.
pub(crate) struct EventSearch {
    memory: Memory,
    /// The unknowns, next to the start, from which on the curve was searched.
    first: Option<Vec<f64>>,
    bounds: Vec<Bound>,
}

impl EventSearch {
    /// Along a curve whose parameters are bounded.
    pub fn new(bounds: &[Bound]) -> Self {
        Self { memory: Memory::default(), first: None, bounds: bounds.to_vec() }
    }

    /// The unknowns, next to the start, from which on the curve was searched; `None` before the first step.
    pub fn into_first(self) -> Option<Vec<f64>> {
        self.first
    }

    /// Special points between two consecutive solutions; those at the start itself belong to
    /// [`around_start`](super::around_start).
    ///
    /// # Errors
    /// [`Error::OtherBranch`] if the step led to another branch and has to be made anew and shorter.
    pub fn between<C: Curve>(
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
        let events = search(curve, [&mut left, &mut right], &self.memory, &self.bounds, settings)?;
        // A first step that led to another branch is made anew.
        if first_step {
            self.first = Some(left.solution.unknown);
        }
        self.memory = Memory::of(curve, before);
        Ok(events)
    }
}

/// Special points between two solutions, in order.
pub(super) fn search<C: Curve>(
    curve: &mut C,
    ends: [&mut Node<C>; 2],
    memory: &Memory,
    bounds: &[Bound],
    settings: &Settings,
) -> Result<Events<C>, Error> {
    let mut scan = Scan::new(curve, memory, bounds, settings);
    let found = scan.verified(ends)?;
    let unlocated = scan.unlocated;
    Ok(Events { found, unlocated })
}
