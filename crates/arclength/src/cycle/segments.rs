//! The segments of a cycle whose field is smooth only piece by piece, or whose state jumps.
//!
//! Between two gates (borders of regions, events, beginnings and ends of slides) the cycle follows the smooth field of one
//! [course](super::gate::Course). Mesh points are put at the gates, and there the solution of one segment is handed on to the next: it
//! is followed in the old course to the gate itself, for the short time by which the mesh point misses it, jumps there if an event
//! happens, and is followed from there back for the same time in the new course. This zero-time map (Nordmark 1991; di Bernardo, Budd,
//! Champneys and Kowalczyk, *Piecewise-smooth Dynamical Systems* (2008), section 2.5) makes the times of crossing unknowns that are
//! eliminated: its derivative is the saltation matrix, so that multipliers, defining systems and error estimates contain it.

use super::gate::{Course, Gate, GateFunction};
use super::passages::{Along, Passage, Touch, Way};
use crate::collocation::polynomials::Polynomials;
use crate::differentiation::{Dual, Scalar};
use crate::erased::{ErasedField, FieldScalar};
use crate::error::Error;

/// Iterations of Newton's method for the time to a border, and the change of it, as part of the period, at which it ends.
const MOST_ITERATIONS: usize = 30;
const CONVERGED: f64 = 1e-15;
/// Changes below this part of the period that do not get smaller are rounding.
const STAGNATION: f64 = 1e-9;
/// A mesh point misses its border by this part of the longer neighbouring segment at most.
const REACH: f64 = 0.5;
/// Updates of the time to a border in the scalar of the derivatives: one for every order that is taken.
const ORDERS: usize = 3;
/// Length of the steps to a border and back, as part of the period, and most of them.
const STEP: f64 = 2e-3;
const MOST_STEPS: f64 = 500.0;
/// A border this close to the origin of the unit time, as part of the distance that another origin would have, asks for that one.
const CLOSE_TO_ORIGIN: f64 = 0.1;

/// The segments that a cycle goes through in the unit time, and the gates between them.
#[derive(Clone, Debug)]
pub(crate) struct Segments {
    /// Number of switch functions.
    switches: usize,
    /// The courses of the segments.
    courses: Vec<Course>,
    /// Times of the gates between one segment and the next, which are points of the mesh.
    pub times: Vec<f64>,
    /// The gates.
    gates: Vec<Gate>,
    /// An event whose condition is passed without the jump.
    pub touched: Option<Touch>,
}

impl Segments {
    /// The segments of the cycle that polynomials describe; `None` where the field is smooth everywhere and has no events. The state
    /// jumps where it does in the segments that are `known`, or, if none are, where the polynomials do as an event does.
    ///
    /// # Errors
    /// [`Error::TooManyBorders`].
    pub(crate) fn of(
        field: ErasedField<'_>,
        cycle: Polynomials<'_>,
        parameters: &[f64],
        known: Option<&Self>,
    ) -> Result<Option<Self>, Error> {
        let Some(along) = Along::new(field, cycle, parameters) else { return Ok(None) };
        let jumps = match known {
            Some(known) => known.jumps_on(cycle.mesh),
            None => along.jumps(),
        };
        let Way { first, passages, mut touched } = along.way(&jumps)?;
        if let Some(known) = known
            && touched.is_none()
        {
            touched = known.new_border_that_leads_away(&passages);
        }
        let courses = std::iter::once(first).chain(passages.iter().map(|passage| passage.course.clone()));
        Ok(Some(Self {
            courses: courses.collect(),
            times: passages.iter().map(|passage| passage.time).collect(),
            gates: passages.into_iter().map(|passage| passage.gate).collect(),
            switches: field.thresholds().len(),
            touched,
        }))
    }

    /// A border among those that a cycle passes that was not passed before, where the field jumps and leads away: cycles like those of
    /// before only touch it. (Where the field beyond pushes back they slide, and branches go on.)
    fn new_border_that_leads_away(&self, passages: &[Passage]) -> Option<Touch> {
        passages.iter().find(|passage| passage.leads_away && !self.gates.contains(&passage.gate)).map(
            |passage| {
                let side = if passage.gate.upwards { -1.0 } else { 1.0 };
                Touch { function: passage.gate.function, side, time: passage.time }
            },
        )
    }

    /// The gates at which the state jumps, with the numbers of their mesh points.
    fn jumps_on(&self, mesh: &[f64]) -> Vec<(usize, Gate)> {
        let all = self.times.iter().zip(&self.gates).filter(|(_, gate)| !gate.events.is_empty());
        all.map(|(time, gate)| (mesh.partition_point(|point| point < time), gate.clone())).collect()
    }

    /// The numbers of the gates at which an event is the one that is passed.
    pub(crate) fn jumps_of(&self, event: usize) -> impl Iterator<Item = usize> {
        let function = GateFunction::Condition { event };
        self.gates
            .iter()
            .enumerate()
            .filter(move |(_, gate)| gate.function == function)
            .map(|(index, _)| index)
    }

    /// The times of all gates, what is zero there, and the courses that lead to them.
    pub(crate) fn gates(&self) -> impl Iterator<Item = (f64, GateFunction, &Course)> {
        let gates = self.times.iter().zip(&self.gates).zip(&self.courses);
        gates.map(|((time, gate), course)| (*time, gate.function, course))
    }

    /// The event at a gate at which the state jumps.
    pub(crate) fn event_of(&self, index: usize) -> Option<usize> {
        match self.gates[index].function {
            GateFunction::Condition { event } => Some(event),
            _ => None,
        }
    }

    /// Whether the cycle slides somewhere.
    pub(crate) fn has_slides(&self) -> bool {
        self.courses.iter().any(|course| course.slide.is_some())
    }

    /// Whether the state jumps somewhere.
    pub(crate) fn has_jumps(&self) -> bool {
        self.gates.iter().any(|gate| !gate.events.is_empty())
    }

    /// Whether at every jump of a cycle, whose mesh points are the gates, the events happen that are known to.
    pub(crate) fn jumps_hold(
        &self,
        field: ErasedField<'_>,
        cycle: Polynomials<'_>,
        parameters: &[f64],
    ) -> bool {
        let Some(along) = Along::new(field, cycle, parameters) else { return true };
        self.jumps_on(cycle.mesh).into_iter().all(|(point, gate)| {
            let GateFunction::Condition { event } = gate.function else { return true };
            let mut before = vec![0.0; cycle.n];
            cycle.state_within(point - 1..point, cycle.mesh[point], &mut before);
            along.event_at(&before, Some(event)).is_some_and(|now| now.events == gate.events)
        })
    }

    /// Whether two gates have the same nearest point of a mesh.
    pub(crate) fn crowd_on(&self, mesh: &[f64]) -> bool {
        let points: Vec<usize> = self.times.iter().map(|time| nearest_inside(mesh, *time)).collect();
        points.windows(2).any(|pair| pair[0] >= pair[1])
    }

    /// Moves the gates to the nearest points of a mesh, each to another one inside it, those where the state jumps to their own; where
    /// there are too few points, a visit beyond a border is left out.
    pub(crate) fn snap_to(&mut self, mesh: &[f64]) {
        let mut points: Vec<usize> = self.times.iter().map(|time| nearest_inside(mesh, *time)).collect();
        let jumps = |gate: &Gate| !gate.events.is_empty();
        for index in 1..points.len() {
            // Beside a jump there is another point.
            if points[index] <= points[index - 1] {
                match [index - 1, index].map(|index| jumps(&self.gates[index])) {
                    [true, false] => points[index] = points[index - 1] + 1,
                    [false, true] => points[index - 1] = points[index].saturating_sub(1).max(1),
                    _ => {}
                }
            }
        }
        while let Some(index) = points.windows(2).position(|pair| pair[0] >= pair[1]) {
            points.drain(index..index + 2);
            self.gates.drain(index..index + 2);
            self.courses.drain(index + 1..index + 3);
        }
        self.times = points.into_iter().map(|point| mesh[point]).collect();
    }

    /// A time from which the unit time is counted better, where a border comes close to where it is counted from now, or lies beyond: one
    /// in the middle half of the longest segment, a mesh point if there is one. `passed` are the times at which the cycle passes the
    /// borders, which mesh points may miss; what lies between a mesh point and its border belongs to no segment.
    pub(crate) fn better_origin(&self, mesh: &[f64], passed: &[f64]) -> Option<f64> {
        let spans: Vec<[f64; 2]> =
            self.times.iter().zip(passed).map(|(one, other)| [one.min(*other), one.max(*other)]).collect();
        let (first, last) = (spans.first()?, spans.last()?);
        let around = [last[1] - 1.0, first[0]];
        let between = spans.windows(2).map(|pair| [pair[0][1], pair[1][0]]);
        let [start, end] = between
            .chain([around])
            .max_by(|one, other| (one[1] - one[0]).total_cmp(&(other[1] - other[0])))?;
        let half = 0.5 * (end - start);
        let is_close = around[1].min(-around[0]) < CLOSE_TO_ORIGIN * half;
        if !is_close {
            return None;
        }
        let middle = 0.5 * (start + end);
        let distance = |time: f64| {
            let gap = (time - middle).rem_euclid(1.0);
            gap.min(1.0 - gap)
        };
        let inner = mesh[1..mesh.len() - 1].iter().copied();
        let nearest = inner.min_by(|one, other| distance(*one).total_cmp(&distance(*other)));
        Some(nearest.filter(|time| distance(*time) < 0.5 * half).unwrap_or(middle.rem_euclid(1.0)))
    }

    /// Counts the unit time from a mesh point on; `mesh` is the new mesh, as many points of which lie before the old origin as the
    /// old one had behind that point.
    pub(crate) fn count_from(&mut self, origin: f64, behind: usize, points: &[usize], mesh: &[f64]) {
        let before = self.times.partition_point(|time| *time < origin);
        let count = mesh.len() - 1;
        self.times = points.iter().map(|point| mesh[(point + behind) % count]).collect();
        self.times.rotate_left(before);
        self.gates.rotate_left(before);
        // The segment around the old origin is one, the one around the new origin is divided.
        self.courses.pop();
        self.courses.rotate_left(before);
        let first = self.courses[0].clone();
        self.courses.push(first);
    }

    /// Whether the cycle passes the same gates in the same order from the origin of the unit time on.
    pub(crate) fn are_like(&self, other: &Self) -> bool {
        let cells = |segments: &Self| -> Vec<[Vec<f64>; 2]> {
            segments.courses.iter().map(|course| course.cells(self.switches).map(<[f64]>::to_vec)).collect()
        };
        self.gates == other.gates && cells(self) == cells(other)
    }

    /// Whether the fields beside the borders that a cycle crosses, at the mesh points there, let it cross them: where both push towards a
    /// border it slides.
    pub(crate) fn crossings_hold(
        &self,
        field: ErasedField<'_>,
        cycle: Polynomials<'_>,
        parameters: &[f64],
    ) -> bool {
        let Some(along) = Along::new(field, cycle, parameters) else { return true };
        let gates = self.times.iter().zip(&self.gates).zip(self.courses.windows(2));
        !gates.into_iter().any(|((time, gate), courses)| match gate.function {
            GateFunction::Border { switch, .. } => {
                gate.events.is_empty()
                    && courses.iter().all(|course| course.slide.is_none())
                    && along.would_slide(*time, switch, [&courses[0], &courses[1]], gate.upwards)
            }
            GateFunction::Condition { .. } | GateFunction::Pull { .. } => false,
        })
    }

    /// The course at a time; at a gate that behind it.
    #[inline]
    pub(crate) fn course_at(&self, time: f64) -> &Course {
        &self.courses[self.times.partition_point(|gate| *gate <= time)]
    }

    /// Writes the state behind a gate at its mesh point, of period `period`, from the state before it; not numbers where the
    /// cycle does not pass the gate nearby. `replaced` are the parameters that vary.
    pub(crate) fn jump<T>(
        &self,
        field: ErasedField<'_>,
        index: usize,
        before: &[T],
        period: f64,
        replaced: &[(usize, T)],
        after: &mut [T],
    ) where
        T: FieldScalar,
    {
        let values: Vec<f64> = before.iter().map(Scalar::value).collect();
        let numbers: Vec<(usize, f64)> =
            replaced.iter().map(|(place, value)| (*place, value.value())).collect();
        let Some((delay, rate)) = self.delay(field, index, &values, period, &numbers) else {
            after.fill(T::from(f64::NAN));
            return;
        };
        let gate = &self.gates[index];
        let [old, new] = [&self.courses[index], &self.courses[index + 1]];
        let steps = steps_for(delay, period);
        let mut delay = T::from(delay);
        let mut at_gate = before.to_vec();
        for order in 0..=ORDERS {
            at_gate = old.flow(field, before, replaced, delay, steps);
            if order < ORDERS {
                delay -= gate.value(field, old, &at_gate, replaced, self.switches) / rate;
            }
        }
        gate.reset(field, old, &mut at_gate, replaced, self.switches);
        after.copy_from_slice(&new.flow(field, &at_gate, replaced, -delay, steps));
    }

    /// The states in which the cycle passes a gate, before and behind a jump there, from the state before it at its mesh point.
    pub(crate) fn at_gate(
        &self,
        field: ErasedField<'_>,
        index: usize,
        before: &[f64],
        period: f64,
        replaced: &[(usize, f64)],
    ) -> Option<[Vec<f64>; 2]> {
        let (delay, _) = self.delay(field, index, before, period, replaced)?;
        let course = &self.courses[index];
        let state = course.flow(field, before, replaced, delay, steps_for(delay, period));
        let mut behind = state.clone();
        self.gates[index].reset(field, course, &mut behind, replaced, self.switches);
        Some([state, behind])
    }

    /// How much later than its mesh point the cycle passes a gate, in time, and the rate of its function there.
    pub(crate) fn delay(
        &self,
        field: ErasedField<'_>,
        index: usize,
        before: &[f64],
        period: f64,
        replaced: &[(usize, f64)],
    ) -> Option<(f64, f64)> {
        let gate = &self.gates[index];
        let course = &self.courses[index];
        let count = self.times.len();
        // To the gate before and to that behind, around the period.
        let before_it = (self.times[index] - self.times[(index + count - 1) % count]).rem_euclid(1.0);
        let behind_it = (self.times[(index + 1) % count] - self.times[index]).rem_euclid(1.0);
        let longer = if count == 1 { 1.0 } else { before_it.max(behind_it) };
        let reach = REACH * longer * period;
        let lifted: Vec<(usize, Dual<f64, 1>)> =
            replaced.iter().map(|(place, value)| (*place, Dual::constant(*value))).collect();
        let mut slope = vec![0.0; before.len()];
        let (mut delay, mut last_change) = (0.0, f64::INFINITY);
        for _ in 0..MOST_ITERATIONS {
            let state = course.flow(field, before, replaced, delay, steps_for(delay, period));
            course.velocity(field, &state, replaced, &mut slope);
            let along: Vec<_> = state
                .iter()
                .zip(&slope)
                .map(|(value, slope)| Dual { value: *value, derivatives: [*slope] })
                .collect();
            let Dual { value, derivatives: [rate] } =
                gate.value(field, course, &along, &lifted, self.switches);
            let change = value / rate;
            delay -= change;
            let is_near = delay.abs() <= reach;
            if !is_near || (rate > 0.0) != gate.upwards {
                return None;
            }
            let is_rounding = change.abs() <= STAGNATION * period && change.abs() >= last_change;
            if change.abs() <= CONVERGED * period || is_rounding {
                return Some((delay, rate));
            }
            last_change = change.abs();
        }
        None
    }
}

/// The number of the point of a mesh that is nearest to a time, of those inside it.
fn nearest_inside(mesh: &[f64], time: f64) -> usize {
    let after = mesh.partition_point(|point| *point < time).clamp(1, mesh.len() - 1);
    let index = if mesh[after] - time < time - mesh[after - 1] { after } else { after - 1 };
    index.clamp(1, mesh.len() - 2)
}

/// Number of steps that are exact to rounding over a short time.
fn steps_for(delay: f64, period: f64) -> usize {
    1 + (delay.abs() / (STEP * period)).min(MOST_STEPS) as usize
}
