//! The division of a step until it holds one special point at most.

use super::count::reachable;
use super::crossings::crossings;
use super::event::{Event, Unlocated};
use super::memory::Memory;
use super::node::Node;
use super::path::Suspicion;
use super::suspicion::suspicious;
use super::test_function::Location;
use crate::continuation::corrector::between;
use crate::continuation::metric::{cosine, distance};
use crate::continuation::solution::Bound;
use crate::continuation::{Curve, Settings, Solution};
use crate::error::Error;

/// Part of a step in which a test function may begin or cease to be defined without the step being divided.
const DEFINED: f64 = 1e-2;
/// A step is divided at these parts of the fraction where the fraction itself gives a special point.
const ASIDE: [f64; 3] = [0.8, 0.9, 0.7];
/// Part of a step below which it is not divided any further while two kinds that may be one point are not separated.
const COINCIDENT_PART: f64 = 0.02;
/// Part of a step in which a smooth quantity no longer looks as if it turned back at once.
const RESOLVING: f64 = 1e-3;
/// Smallest cosine of the angle between a part of a step and the tangents at its ends: shorter parts are straighter.
const LEAST_COSINE: f64 = 0.5;
/// Value of a test function at a point of another kind, relative to its values around, below which it vanishes there too: on
/// the branch that turns at a pitchfork the parameter turns, but that is no fold.
const VANISHING: f64 = 1e-3;

/// What lies between two solutions is no farther from either of them than this many times their distance and this far in the
/// metric, as solutions are known no better.
const BETWEEN: f64 = 1.2;
const LEAST_DISTANCE: f64 = 2e-6;
/// Part of that distance by which it may lie outside in the direction from one to the other: Newton's method may lead to a point of the
/// same kind that lies just before.
const OUTSIDE: f64 = 1e-3;

/// Changes in one step that are tried in vain before the others are only told.
const MOST_FAILURES: usize = 10;

/// The search in one step.
pub(super) struct Scan<'s, C: Curve> {
    pub curve: &'s mut C,
    pub memory: &'s Memory,
    pub bounds: &'s [Bound],
    pub settings: &'s Settings,
    pub unlocated: Vec<Unlocated<C::Kind>>,
    /// Solutions that may still be computed.
    pub trials: usize,
    /// Changes in this step behind which nothing was located.
    failures: usize,
    pub found: Vec<Event<C::Kind, C::Point>>,
}

impl<'s, C: Curve> Scan<'s, C> {
    pub(super) fn new(
        curve: &'s mut C,
        memory: &'s Memory,
        bounds: &'s [Bound],
        settings: &'s Settings,
    ) -> Self {
        Self {
            curve,
            memory,
            bounds,
            settings,
            unlocated: Vec::new(),
            trials: 0,
            failures: 0,
            found: Vec::new(),
        }
    }

    /// Places in the list of test functions of those that change their signs.
    fn changed(before: &Node<C>, after: &Node<C>) -> Vec<usize> {
        let pairs = before.readings.iter().zip(&after.readings).enumerate();
        pairs
            .filter(|(_, pair)| matches!(pair, (Some(one), Some(other)) if one.changes_to(*other)))
            .map(|(index, _)| index)
            .collect()
    }

    /// The change of the number of unstable directions; `None` where it is not decided.
    pub(super) fn change_of_count(before: &Node<C>, after: &Node<C>) -> Option<usize> {
        let decided = before.spectrum.decided && after.spectrum.decided;
        decided.then(|| before.spectrum.unstable.abs_diff(after.spectrum.unstable))
    }

    fn is_explained(&self, changed: &[usize], before: &Node<C>, after: &Node<C>) -> bool {
        let Some(change) = Self::change_of_count(before, after) else { return true };
        let tests = self.curve.test_functions();
        reachable(change, changed.iter().map(|&index| tests[index].changes))
    }

    /// Whether every change but the first is of a kind that the first absorbs: most likely they are one point.
    fn is_one_point(&self, changed: &[usize]) -> bool {
        let tests = self.curve.test_functions();
        match changed {
            [] | [_] => false,
            [first, rest @ ..] => {
                rest.iter().all(|&index| tests[*first].absorbs.contains(&tests[index].kind))
            }
        }
    }

    /// Special points in a part of the step.
    ///
    /// # Errors
    /// [`Error::OtherBranch`] if the ends lie beside each other and not behind each other, or the step led over to another branch.
    pub(super) fn part(&mut self, [before, after]: [&mut Node<C>; 2], share: f64) -> Result<(), Error> {
        let changed = Self::changed(before, after);
        let (one, other) = (&before.solution, &after.solution);
        let length = distance(self.curve, &one.unknown, &other.unknown);
        let straightness = cosine(self.curve, one, &other.unknown, length).min(cosine(
            self.curve,
            other,
            &one.unknown,
            length,
        ));
        if length > self.settings.shortest_jump && straightness < LEAST_COSINE {
            return Err(Error::OtherBranch);
        }
        let divide = if changed.len() > 1 || !self.is_explained(&changed, before, after) {
            Some(Suspicion::at(0.5))
        } else {
            let tests = self.curve.test_functions();
            let largest = changed.iter().filter_map(|&index| tests[index].changes.iter().max());
            let (pairs, single): (Vec<usize>, Vec<usize>) = largest.partition(|change| **change > 1);
            let most = [single.iter().sum(), pairs.iter().sum()];
            suspicious(self.curve, [before, after], length, self.memory, (most, self.settings))
        };
        let divide = divide.or_else(|| {
            (share > DEFINED && self.begins_or_ceases([before, after])).then(|| Suspicion::at(0.5))
        });
        let smallest =
            if self.is_one_point(&changed) { COINCIDENT_PART } else { self.settings.smallest_part };
        if let Some(Suspicion { place, is_kink }) = divide {
            let known = self.found.len() + self.unlocated.len();
            let is_divided = self.divide([before, after], share, (place, smallest))?;
            let is_unexplained = self.found.len() + self.unlocated.len() == known;
            if is_kink && is_unexplained && self.leads_over(length, share) {
                return Err(Error::OtherBranch);
            }
            if is_divided {
                return Ok(());
            }
        }
        if changed.is_empty() && !self.is_explained(&changed, before, after) {
            // Symmetry makes several exponents cross at once.
            return self.locate_by_count(before, after);
        }
        let known = (self.found.len(), self.unlocated.len());
        for index in changed {
            self.locate(index, before, after)?;
        }
        // What changes its sign may be something else, such as a pair of real exponents with the sum zero, and hide what crosses.
        let (_, new) = self.found.split_at(known.0);
        if !self.explain(new, before, after) {
            let is_silent = new.is_empty();
            let unlocated = self.unlocated.split_off(known.1);
            // Points that are found again are told by their places.
            if !self.divide([before, after], share, (0.5, self.settings.smallest_part))? {
                if is_silent && unlocated.is_empty() {
                    // What changes the test function is something else, and the count changes all the same.
                    return self.locate_by_count(before, after);
                }
                self.unlocated.extend(unlocated);
            }
        }
        Ok(())
    }

    /// Whether a test function is defined at one of two solutions only.
    fn begins_or_ceases(&self, [before, after]: [&Node<C>; 2]) -> bool {
        let tests = self.curve.test_functions();
        let mut pairs = tests.iter().zip(before.readings.iter().zip(&after.readings));
        pairs.any(|(test, (one, other))| test.is_partial && one.is_some() != other.is_some())
    }

    /// Whether a quantity that comes to zero and turns back at once, still in this `share` of a step, shows that the step led over to
    /// another branch: the minimum of a smooth quantity is resolved by then.
    fn leads_over(&self, length: f64, share: f64) -> bool {
        let can_branch = self.curve.test_functions().iter().any(|test| test.is_orientation);
        can_branch && share < RESOLVING && length > share * self.settings.shortest_jump && self.trials > 0
    }

    /// Searches both sides of a fraction of a part of the step, which is this `share` of the whole; whether it is large enough.
    fn divide(
        &mut self,
        [before, after]: [&mut Node<C>; 2],
        share: f64,
        (fraction, smallest): (f64, f64),
    ) -> Result<bool, Error> {
        if share <= smallest || self.trials == 0 {
            return Ok(false);
        }
        self.trials -= 1;
        // Where all trials fail (next to a branch point, where the equations are singular) the division ends: the point is
        // located from the ends.
        let Some((fraction, mut middle)) = self.divided(before, after, fraction) else { return Ok(false) };
        self.part([before, &mut middle], share * fraction)?;
        self.part([&mut middle, after], share * (1.0 - fraction))?;
        Ok(true)
    }

    /// A solution between two others, near a fraction of the way, that is no special point itself.
    fn divided(&mut self, before: &Node<C>, after: &Node<C>, fraction: f64) -> Option<(f64, Node<C>)> {
        let least = before.undecided.max(after.undecided);
        let mut middle = None;
        for fraction in std::iter::once(1.0).chain(ASIDE).map(|part| part * fraction) {
            let trial = between(self.curve, &before.solution, &after.solution, fraction, self.settings);
            let Ok(trial) = trial else { continue };
            // Newton's method may have left for another part of the curve.
            if !self.lies_between(&trial, &before.solution, &after.solution) {
                continue;
            }
            let trial = Node::new(self.curve, trial);
            let decided = trial.undecided <= least;
            middle = Some((fraction, trial));
            // A trial that happens to be a special point itself explains nothing.
            if decided {
                break;
            }
        }
        middle
    }

    /// Locates the point at which a test function changes its sign.
    fn locate(&mut self, index: usize, before: &Node<C>, after: &Node<C>) -> Result<(), Error> {
        let test = self.curve.test_functions()[index];
        let (Some(here), Some(there)) = (before.readings[index], after.readings[index]) else {
            return Ok(());
        };
        // Where signs are rounding there is no end to what changes.
        if !here.resolved || !there.resolved || self.failures > MOST_FAILURES {
            self.miss(Some(test.kind), &before.solution, &after.solution);
            return Ok(());
        }
        let around = here.value.abs().max(there.value.abs());
        let absorbing = self.absorbing(test.kind, &before.solution, &after.solution);
        let vanishes = absorbing.as_ref().is_some_and(|solution| {
            self.curve
                .test(test.kind, solution)
                .is_some_and(|reading| reading.value.abs() < VANISHING * around)
        });
        if vanishes {
            return Ok(());
        }
        let location = match self.curve.locate(test.kind, [&before.solution, &after.solution])? {
            Location::At(solution) | Location::Bracketed(solution)
                if !self.lies_between(&solution, &before.solution, &after.solution) =>
            {
                Location::Missed
            }
            location => location,
        };
        match location {
            Location::At(solution) => {
                let kind = self.curve.kind_at(&solution.point).unwrap_or(test.kind);
                self.found.push(Event { kind, is_located: true, solution });
            }
            Location::Bracketed(solution) => {
                // Exponents that symmetry takes through zero together change the test function too.
                let crosses = Self::change_of_count(before, after).is_some_and(|change| change > 0);
                if crosses && test.changes.contains(&2) {
                    self.locate_by_count(before, after)?;
                } else {
                    self.found.push(Event { kind: test.kind, is_located: false, solution });
                }
            }
            Location::Nothing => {}
            Location::Missed if absorbing.is_some() => {}
            Location::Missed => {
                self.failures += 1;
                self.miss(Some(test.kind), &before.solution, &after.solution);
            }
        }
        Ok(())
    }

    /// Whether a solution lies between two others, give or take a margin.
    fn lies_between(
        &self,
        solution: &Solution<C::Point>,
        before: &Solution<C::Point>,
        after: &Solution<C::Point>,
    ) -> bool {
        let length = distance(self.curve, &before.unknown, &after.unknown);
        let ends = [before, after].map(|end| distance(self.curve, &end.unknown, &solution.unknown));
        let from_middle =
            (ends[0] * ends[0] - ends[1] * ends[1]).abs() / (2.0 * length.max(f64::MIN_POSITIVE));
        ends[0].max(ends[1]) <= BETWEEN * length + LEAST_DISTANCE
            && from_middle <= (0.5 + OUTSIDE) * length + LEAST_DISTANCE
    }

    /// A point between two solutions that has been found and at which the test function of `kind` may vanish too.
    fn absorbing(
        &self,
        kind: C::Kind,
        before: &Solution<C::Point>,
        after: &Solution<C::Point>,
    ) -> Option<Solution<C::Point>> {
        let tests = self.curve.test_functions();
        let absorbs =
            |found: C::Kind| tests.iter().any(|test| test.kind == found && test.absorbs.contains(&kind));
        let event = self
            .found
            .iter()
            .rev()
            .find(|event| absorbs(event.kind) && self.lies_between(&event.solution, before, after))?;
        Some(event.solution.clone())
    }

    /// Locates what crosses between two solutions by the number of unstable directions alone.
    pub(super) fn locate_by_count(&mut self, before: &Node<C>, after: &Node<C>) -> Result<(), Error> {
        let crossings = crossings(self.curve, before, after, self.settings)?;
        for [from, to] in crossings.unlocated {
            self.miss(None, &from, &to);
        }
        self.found.extend(crossings.found);
        Ok(())
    }

    /// Notes that no point was located behind a change.
    pub(super) fn miss(&mut self, kind: Option<C::Kind>, from: &Solution<C::Point>, to: &Solution<C::Point>) {
        let values = |solution: &Solution<C::Point>| {
            self.bounds.iter().map(|bound| bound.value(&solution.unknown)).collect()
        };
        self.unlocated.push(Unlocated { kind, between: [values(from), values(to)] });
    }
}
