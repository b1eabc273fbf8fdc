//! Whether the points that were found explain how the number of unstable directions changes; where they do not, the surroundings
//! are searched again.

use super::count::reachable;
use super::event::{Event, Unlocated};
use super::node::Node;
use super::scan::Scan;
use crate::continuation::corrector::across;
use crate::continuation::metric::along;
use crate::continuation::{Curve, EventOf, Solution};
use crate::error::Error;

/// Times that the surroundings of a located point are searched again, and the part of them that is set aside around the
/// point itself.
const MOST_SEARCHES: usize = 4;
const SURROUNDINGS: f64 = 0.02;
/// Distance, in the metric, from one located point to the next between which there is nothing to count.
const COINCIDENT: f64 = 1e-8;
/// Distance, in the metric, within which two points of one kind are one that was found twice.
const SAME_PLACE: f64 = 1e-7;
/// The same for what was only bracketed beside a point that was located: next to a branch point what the Jacobian decides is rounding.
const SHADOW: f64 = 1e-5;

impl<C: Curve> Scan<'_, C> {
    /// Special points between two solutions, each with the change in the number of unstable directions that belongs to it.
    ///
    /// # Errors
    /// As [`part`](Self::part).
    pub(super) fn verified(&mut self, ends: [&mut Node<C>; 2]) -> Result<Vec<EventOf<C>>, Error> {
        self.search(ends, MOST_SEARCHES)
    }

    fn search(
        &mut self,
        [before, after]: [&mut Node<C>; 2],
        searches: usize,
    ) -> Result<Vec<EventOf<C>>, Error> {
        self.trials = self.settings.most_trials;
        let missed = self.unlocated.len();
        self.part([before, after], 1.0)?;
        let found = std::mem::take(&mut self.found);
        if found.is_empty() {
            return self.checked(Vec::new(), before, after, before, 0);
        }
        let origin = before.solution.clone();
        let mut placed = self.in_order(found, &origin);
        self.drop_invented_turns(&mut placed, missed, [before, after]);
        let mut checked = Vec::new();
        let mut group = Vec::new();
        let mut left = Node::new(self.curve, origin);
        let mut rest = placed.into_iter().peekable();
        while let Some((place, event)) = rest.next() {
            let right = match rest.peek() {
                None => Some(after.solution.clone()),
                Some((next_place, next)) if next_place - place > COINCIDENT => {
                    let ends = event.solution.unknown.iter().zip(&next.solution.unknown);
                    let middle = ends.map(|(one, other)| 0.5 * (one + other)).collect();
                    across(self.curve, &before.solution, middle, self.settings).ok()
                }
                Some(_) => None,
            };
            group.push(event);
            if let Some(right) = right {
                let right = Node::new(self.curve, right);
                checked.extend(self.checked(std::mem::take(&mut group), &left, &right, before, searches)?);
                left = right;
            }
        }
        // What follows a last middle that could not be computed is taken as it is.
        checked.extend(group);
        Ok(self.in_order(checked, &before.solution).into_iter().map(|(_, event)| event).collect())
    }

    /// Points in the order of the curve with their places along the tangent at `origin`, each once.
    fn in_order(&self, found: Vec<EventOf<C>>, origin: &Solution<C::Point>) -> Vec<(f64, EventOf<C>)> {
        let mut placed: Vec<(f64, EventOf<C>)> = found
            .into_iter()
            .map(|event| (along(self.curve, origin, &event.solution.unknown), event))
            .collect();
        placed.sort_by(|one, other| one.0.total_cmp(&other.0));
        drop_shadows(&mut placed);
        let mut placed = self.join_shadows(placed);
        placed.dedup_by(|next, previous| self.is_repeated(next, previous));
        let mut each: Vec<(f64, EventOf<C>)> = Vec::with_capacity(placed.len());
        for (place, event) in placed {
            let is_same = |(_, other): &(f64, EventOf<C>)| {
                other.kind == event.kind && self.curve.are_same(&other.solution.point, &event.solution.point)
            };
            if !each.iter().any(is_same) {
                each.push((place, event));
            }
        }
        each
    }

    /// Makes one of what was only bracketed at one place: where several exponents come to zero together solutions are known to the root of
    /// rounding only, and all signs around are rounding. It has the first kind in the list of test functions, and reaches as far as they.
    fn join_shadows(&self, placed: Vec<(f64, EventOf<C>)>) -> Vec<(f64, EventOf<C>)> {
        let tests = self.curve.test_functions();
        let rank = |kind: C::Kind| tests.iter().position(|test| test.kind == kind);
        let mut joined: Vec<(f64, EventOf<C>)> = Vec::with_capacity(placed.len());
        let mut last = f64::NEG_INFINITY;
        for (place, event) in placed {
            match joined.last_mut() {
                Some((first, known)) if !event.is_located && !known.is_located && place - last <= SHADOW => {
                    let reach = place - *first;
                    if rank(event.kind) < rank(known.kind) {
                        *known = event;
                    }
                    self.curve.widen(&mut known.solution.point, reach);
                }
                _ => joined.push((place, event)),
            }
            last = place;
        }
        joined
    }

    /// Drops what was taken for a fold and is the turn of the parameter at a branch point.
    ///
    /// The branch that leaves a pitchfork to one side turns there. Discretised it is a perturbed one: the orientation changes at the
    /// branch point, and the parameter may turn beside it, at a fold that satisfies its defining system and does not exist, or
    /// where no fold can be located. The number of turns tells: folds and branch points at which the parameter turns are
    /// together odd where its direction differs between both ends, and even where it does not. `missed` are the changes noted
    /// before this search.
    fn drop_invented_turns(
        &mut self,
        placed: &mut Vec<(f64, EventOf<C>)>,
        missed: usize,
        [before, after]: [&Node<C>; 2],
    ) {
        let tests = self.curve.test_functions();
        let Some(index) = tests.iter().position(|test| test.is_turn) else { return };
        let (Some(here), Some(there)) = (before.readings[index], after.readings[index]) else { return };
        let turning: Vec<f64> = placed
            .iter()
            .filter(|(_, event)| self.curve.turns_at(&event.solution.point) == Some(true))
            .map(|(place, _)| *place)
            .collect();
        if turning.is_empty() || !here.is_decided() || !there.is_decided() {
            return;
        }
        let fold = tests[index].kind;
        let is_odd = (here.value > 0.0) != (there.value > 0.0);
        let folds = placed.iter().enumerate().filter(|(_, (_, event))| event.kind == fold);
        let is_explained = (folds.clone().count() + turning.len()) % 2 == usize::from(is_odd);
        let is_missed = |change: &Unlocated<C::Kind>| change.kind == Some(fold);
        if is_explained {
            let notes = self.unlocated.split_off(missed);
            self.unlocated.extend(notes.into_iter().filter(|change| !is_missed(change)));
        } else if !self.unlocated[missed..].iter().any(is_missed) {
            let distance =
                |place: f64| turning.iter().map(|turn| (turn - place).abs()).fold(f64::INFINITY, f64::min);
            let invented = folds.min_by(|(_, one), (_, other)| distance(one.0).total_cmp(&distance(other.0)));
            if let Some(index) = invented.map(|(index, _)| index) {
                placed.remove(index);
            }
        }
    }

    /// Whether two neighbours are one point found twice.
    fn is_repeated(
        &self,
        (next_place, next): &(f64, EventOf<C>),
        (place, event): &(f64, EventOf<C>),
    ) -> bool {
        next.kind == event.kind
            && next_place - place <= SAME_PLACE
            && next.is_located == event.is_located
            && !(next.is_located && self.curve.are_distinct(&event.solution.point, &next.solution.point))
    }

    /// By how much the number of unstable directions may change at each of some points; `None` where that is not known.
    fn changes_at<'p>(&'p self, points: &'p [EventOf<C>]) -> Option<Vec<&'p [usize]>> {
        let tests = self.curve.test_functions();
        let of_kind = |kind: C::Kind| Some(tests.iter().find(|test| test.kind == kind)?.changes);
        let known = |event: &'p EventOf<C>| {
            let known = self.curve.changes_at(&event.solution.point).or_else(|| of_kind(event.kind));
            known.filter(|_| event.is_located)
        };
        points.iter().map(known).collect()
    }

    /// Whether the points between two solutions may explain how the number of unstable directions changes.
    pub(super) fn explain(&self, points: &[EventOf<C>], before: &Node<C>, after: &Node<C>) -> bool {
        match (Self::change_of_count(before, after), self.changes_at(points)) {
            (Some(change), Some(lists)) => reachable(change, lists.into_iter()),
            _ => true,
        }
    }

    /// Whether the change of the number of unstable directions is one that the points between explain; where it is not, whether
    /// it is larger.
    fn surplus(&self, points: &[EventOf<C>], before: &Node<C>, after: &Node<C>) -> Option<bool> {
        let change = Self::change_of_count(before, after)?;
        let lists = self.changes_at(points)?;
        let most: usize = lists.iter().filter_map(|list| list.iter().max()).sum();
        (!reachable(change, lists.into_iter())).then_some(change > most)
    }

    /// The points between two solutions, or what a closer search finds where they do not explain the change in the number of
    /// unstable directions.
    fn checked(
        &mut self,
        mut group: Vec<EventOf<C>>,
        left: &Node<C>,
        right: &Node<C>,
        origin: &Node<C>,
        searches: usize,
    ) -> Result<Vec<EventOf<C>>, Error> {
        if let [event] = &group[..]
            && !event.is_located
            && Self::change_of_count(left, right) == Some(0)
            && self
                .curve
                .test_functions()
                .iter()
                .any(|test| test.kind == event.kind && test.changes.contains(&2))
        {
            // Where symmetry makes exponents equal, the signs of test functions are rounding.
            group.clear();
        }
        let Some(larger) = self.surplus(&group, left, right) else { return Ok(group) };
        if searches > 0
            && let Some((mut low, mut high)) = self.surroundings(&group, left, right, origin)
        {
            let mut left = Node::new(self.curve, left.solution.clone());
            let mut right = Node::new(self.curve, right.solution.clone());
            let mut found = self.search([&mut left, &mut low], searches - 1)?;
            if self.surplus(&group, &low, &high).is_some() {
                found.extend(self.search([&mut low, &mut high], searches - 1)?);
            }
            found.extend(self.search([&mut high, &mut right], searches - 1)?);
            // What satisfies its defining system stays, whether it is found again or not.
            found.extend(group.into_iter().filter(|event| event.is_located));
            return Ok(self.in_order(found, &origin.solution).into_iter().map(|(_, event)| event).collect());
        }
        if larger {
            self.locate_by_count(left, right)?;
            return Ok(std::mem::take(&mut self.found));
        }
        self.miss(None, &left.solution, &right.solution);
        Ok(group)
    }

    /// Solutions close to the first and the last point of a group, on both sides of it.
    fn surroundings(
        &mut self,
        group: &[EventOf<C>],
        left: &Node<C>,
        right: &Node<C>,
        origin: &Node<C>,
    ) -> Option<(Node<C>, Node<C>)> {
        let origin = &origin.solution;
        let places = [left, right].map(|node| along(self.curve, origin, &node.solution.unknown));
        let aside = SURROUNDINGS * (places[1] - places[0]);
        let shifted = |event: &EventOf<C>, shift: f64| -> Vec<f64> {
            let entries = event.solution.unknown.iter().zip(&origin.tangent);
            entries.map(|(value, slope)| value + shift * slope).collect()
        };
        let (low, high) = (shifted(group.first()?, -aside), shifted(group.last()?, aside));
        let inside = |unknown: &[f64]| {
            let place = along(self.curve, origin, unknown);
            place > places[0] && place < places[1]
        };
        if !inside(&low) || !inside(&high) {
            return None;
        }
        let low = across(self.curve, origin, low, self.settings).ok()?;
        let high = across(self.curve, origin, high, self.settings).ok()?;
        Some((Node::new(self.curve, low), Node::new(self.curve, high)))
    }
}

/// Drops what was only bracketed at the place of a point that satisfies its defining system: what makes the test function vanish, and
/// its own defining system singular, is that point. Two eigenvalues that come to zero together at a branch point have the sum zero there.
fn drop_shadows<K, P>(placed: &mut Vec<(f64, Event<K, P>)>) {
    let located: Vec<f64> =
        placed.iter().filter(|(_, event)| event.is_located).map(|(place, _)| *place).collect();
    placed.retain(|(place, event)| {
        event.is_located || located.iter().all(|other| (other - place).abs() > SHADOW)
    });
}
