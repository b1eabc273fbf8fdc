//! What a cycle passes on its way around, found on its polynomials: borders of regions, events at which its state jumps, beginnings
//! and ends of slides.
//!
//! Where the state jumps the polynomials do, at a mesh point. The way around is divided there into stretches on which it is
//! continuous; on each the regions are walked through as they follow each other. The condition of an event that is passed on the way
//! without a jump is noted: beyond a grazing cycles of before go on to solve the equations, but are none of the model any more.

use super::gate::{Course, Gate, Place, Slide};
use crate::collocation::polynomials::Polynomials;
use crate::differentiation::{Dual, Scalar};
use crate::direction::Direction;
use crate::erased::ErasedField;
use crate::error::Error;
use crate::pieces::{Border, Pieces};
use crate::threshold::Threshold;

/// Most borders that a cycle passes.
const MOST_BORDERS: usize = 64;
/// A visit beyond a border that is shorter than this part of the period is not seen: where the field has a kink it changes the
/// cycle by its third power.
const SHORTEST_VISIT: f64 = 2e-5;
/// Halvings to locate a crossing of the polynomials.
const HALVINGS: usize = 60;
/// Part of the size of a switch function by which it may be beyond a border without crossing it.
const ROUNDING: f64 = 1e-10;
/// Part of the range of a function within which it counts as zero where a cycle jumps or leaves a slide.
const NEAR: f64 = 1e-7;
/// The same, beyond which it has left zero.
const AWAY: f64 = 1e-6;
/// Parts of its range by which the polynomials jump where the state does.
const GAP: f64 = 1e-8;
/// Part of its range within which the condition of an event is zero where the state jumps, on a cycle that is not solved for yet.
const ABOUT_ZERO: f64 = 0.05;
/// Part of a jump by which that of the events may differ from it on such a cycle.
const ABOUT_JUMP: f64 = 0.3;
/// Steps of the flow on a short way off a switch, and the longest one, as part of the period.
const FLIGHT_STEPS: usize = 8;
const LONGEST_FLIGHT: f64 = 0.1;
/// Both sides push towards a switch along which a cycle slides at this part at least of what takes it over its range in a period.
const PUSH: f64 = 1e-9;
/// The rate of a switch function jumps at a border by this part at least of what takes it over its range in a period.
const RATE_JUMP: f64 = 1e-6;

/// A gate that a cycle passes at a time, and the course behind it.
#[derive(Clone, Debug)]
pub(super) struct Passage {
    pub time: f64,
    pub gate: Gate,
    pub course: Course,
    /// Whether the rate of the switch function jumps here, and the cycle goes on to the other side at once.
    pub leads_away: bool,
}

/// A condition of an event that a cycle passes, in unit time, without the jump, or a border without changing over to the field beyond.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Touch {
    pub place: Place,
    /// Sign before it of the function that is zero there.
    pub side: f64,
    pub time: f64,
}

/// What a cycle passes.
#[derive(Clone, Debug)]
pub(super) struct Way {
    /// The course where the unit time begins.
    pub first: Course,
    /// In the order of their times in the unit interval.
    pub passages: Vec<Passage>,
    pub touched: Option<Touch>,
}

/// A cycle as polynomials, with the field that it follows.
pub(super) struct Along<'a> {
    field: ErasedField<'a>,
    pieces: Pieces<'a>,
    directions: Vec<Direction>,
    cycle: Polynomials<'a>,
    parameters: &'a [f64],
    samples: Vec<f64>,
    /// How far each switch function and then each condition varies.
    sizes: Vec<f64>,
}

/// A part of the way around on which the state does not jump.
struct Stretch {
    /// Times at which it is looked at, the first its start and the last its end.
    times: Vec<f64>,
    /// The interval at whose end the state jumps, and the gate there.
    end: Option<(usize, Gate)>,
}

/// Where the walk is.
#[derive(Clone)]
struct Standing {
    course: Course,
    /// Signs of the conditions of the events; zero where a condition is not looked at.
    sides: Vec<f64>,
    /// The switch whose slide has just been left.
    left: Option<usize>,
}

impl<'a> Along<'a> {
    /// `None` for a field that is smooth everywhere and has no events.
    pub(super) fn new(field: ErasedField<'a>, cycle: Polynomials<'a>, parameters: &'a [f64]) -> Option<Self> {
        let (pieces, directions) = (Pieces::of_hybrid(field), field.events());
        if pieces.thresholds().is_empty() && directions.is_empty() {
            return None;
        }
        let samples = samples(cycle);
        let mut along = Self { field, pieces, directions, cycle, parameters, samples, sizes: Vec::new() };
        along.sizes = along.measured_sizes();
        Some(along)
    }

    fn measured_sizes(&self) -> Vec<f64> {
        let values: Vec<Vec<f64>> = self
            .samples
            .iter()
            .map(|&time| {
                let state = self.state(time, None);
                let region = self.pieces.region_at(&state, self.parameters);
                self.functions(&Course::within(self.parameters, &region), &state)
            })
            .collect();
        (0..self.pieces.thresholds().len() + self.directions.len())
            .map(|index| {
                let all = values.iter().map(|values| values[index]);
                let (low, high) = all.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), value| {
                    (low.min(value), high.max(value))
                });
                (high - low).max(f64::MIN_POSITIVE)
            })
            .collect()
    }

    /// The state at a time of any turn; at the end of a stretch that before the jump.
    fn state(&self, time: f64, end: Option<(f64, usize)>) -> Vec<f64> {
        let mut state = vec![0.0; self.cycle.n];
        let phase = time - time.floor();
        match end {
            Some((end, interval)) if time >= end => {
                self.cycle.state_within(interval..interval + 1, phase, &mut state);
            }
            _ => self.cycle.state(phase, &mut state),
        }
        state
    }

    /// The switch functions by the field of a course, the conditions of the events and, along a switch, its rates by the fields below
    /// and above.
    fn functions(&self, course: &Course, state: &[f64]) -> Vec<f64> {
        let switches = self.pieces.thresholds().len();
        let n = state.len();
        let mut values = vec![0.0; n + switches];
        if switches > 0 {
            self.field.evaluate(state, &course.parameters, &mut values);
        }
        let mut values = values.split_off(n);
        values.extend((0..self.directions.len()).map(|event| {
            let mut value = [0.0];
            self.field.evaluate_event(event, state, self.parameters, &mut value);
            value[0]
        }));
        if let Some(slide) = &course.slide {
            values.extend(self.pulls(slide.switch, state, [&course.parameters, &slide.above]));
        }
        values
    }

    /// The rates of a switch function by the fields below and above it.
    fn pulls(&self, switch: usize, state: &[f64], sides: [&Vec<f64>; 2]) -> [f64; 2] {
        sides.map(|parameters| {
            let mut velocity = vec![0.0; state.len()];
            self.field.evaluate(state, parameters, &mut velocity);
            self.field.rate_along(switch, state, &velocity, sides[0])
        })
    }

    /// The gates at which the state jumps from one mesh point to the next, with the numbers of the mesh points.
    pub(super) fn jumps(&self) -> Vec<(usize, Gate)> {
        if self.directions.is_empty() {
            return Vec::new();
        }
        let nodes = self.cycle.gauss.degree() + 1;
        let n = self.cycle.n;
        let intervals = self.cycle.mesh.len() - 1;
        let states = &self.cycle.states[..intervals * nodes * n];
        let ranges: Vec<f64> = (0..n)
            .map(|component| {
                let values = states.iter().skip(component).step_by(n);
                let (low, high) = values.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), value| {
                    (low.min(*value), high.max(*value))
                });
                high - low
            })
            .collect();
        let distance = |a: &[f64], b: &[f64]| {
            let parts = a.iter().zip(b).zip(&ranges).filter(|(_, range)| **range > 0.0);
            parts.map(|((a, b), range)| ((a - b) / range).abs()).fold(0.0, f64::max)
        };
        (1..intervals)
            .filter_map(|point| {
                let time = self.cycle.mesh[point];
                let before = self.state(time, Some((time, point - 1)));
                let after = &states[point * nodes * n..][..n];
                let gap = distance(&before, after);
                if gap <= GAP {
                    return None;
                }
                let gate = self.event_at(&before, None)?;
                let mut reset = before;
                self.apply(&gate.events, &mut reset);
                (distance(&reset, after) < ABOUT_JUMP * gap).then_some((point, gate))
            })
            .collect()
    }

    fn apply(&self, events: &[usize], state: &mut [f64]) {
        let mut values = vec![0.0; state.len() + 1];
        for event in events {
            self.field.evaluate_event(*event, state, self.parameters, &mut values);
            state.copy_from_slice(&values[1..]);
        }
    }

    /// The gate of the events that happen at a state: of the one with this index, or of that whose condition is nearest to zero, of
    /// those that happen with it, and of those whose conditions these take to the other side.
    pub(super) fn event_at(&self, state: &[f64], first: Option<usize>) -> Option<Gate> {
        let region = self.pieces.region_at(state, self.parameters);
        let course = Course::within(self.parameters, &region);
        let switches = self.pieces.thresholds().len();
        let values = self.functions(&course, state).split_off(switches);
        let rates = self.condition_rates(&course, state);
        let distance = |event: usize| (values[event] / self.sizes[switches + event]).abs();
        let passes = |event: usize| self.directions[event].counts(-rates[event], rates[event]);
        let candidates = (0..values.len()).filter(|event| passes(*event));
        let nearest = candidates.min_by(|a, b| distance(*a).total_cmp(&distance(*b)));
        let primary = first.or(nearest.filter(|event| distance(*event) < ABOUT_ZERO))?;
        let together = NEAR.max(2.0 * distance(primary));
        let mut due: Vec<usize> = (0..values.len())
            .filter(|event| *event == primary || (passes(*event) && distance(*event) < together))
            .collect();
        let mut events = Vec::new();
        let mut state = state.to_vec();
        while !due.is_empty() {
            self.apply(&due, &mut state);
            events.append(&mut due);
            let now = self.functions(&course, &state).split_off(switches);
            due = (0..values.len())
                .filter(|event| {
                    let is_away = |value: f64| (value / self.sizes[switches + event]).abs() > NEAR;
                    !events.contains(event)
                        && is_away(values[*event])
                        && is_away(now[*event])
                        && self.directions[*event].counts(values[*event], now[*event])
                })
                .collect();
        }
        let place = Place::Condition { event: primary };
        Some(Gate { place, upwards: rates[primary] > 0.0, events })
    }

    /// Rates of the conditions of the events along the field of a course.
    fn condition_rates(&self, course: &Course, state: &[f64]) -> Vec<f64> {
        let mut velocity = vec![0.0; state.len()];
        course.velocity(self.field, state, &[], &mut velocity);
        let along = state.iter().zip(&velocity);
        let along: Vec<Dual<f64, 1>> =
            along.map(|(value, slope)| Dual { value: *value, derivatives: [*slope] }).collect();
        let parameters: Vec<Dual<f64, 1>> = self.parameters.iter().copied().map(Dual::constant).collect();
        (0..self.directions.len())
            .map(|event| {
                let mut value = [Dual::zero()];
                self.field.evaluate_event(event, &along, &parameters, &mut value);
                value[0].derivatives[0]
            })
            .collect()
    }

    /// The way around, with jumps at mesh points.
    ///
    /// # Errors
    /// [`Error::TooManyBorders`].
    pub(super) fn way(&self, jumps: &[(usize, Gate)]) -> Result<Way, Error> {
        let stretches = self.stretches(jumps);
        let mut passages: Vec<Passage> = Vec::new();
        let mut touched = None;
        let start = self.start(&stretches[0]);
        let mut standing = start.clone();
        for (index, stretch) in stretches.iter().enumerate() {
            let from = passages.len();
            self.walk(stretch, &mut standing, &mut passages, &mut touched)?;
            let first = if from == 0 { &start.course } else { &passages[from - 1].course }.clone();
            remove_short_visits(&mut passages, from, &first);
            if let (Some((point, gate)), Some(end)) = (&stretch.end, stretch.times.last()) {
                while passages.len() > from
                    && passages.last().is_some_and(|last| end - last.time < SHORTEST_VISIT)
                {
                    passages.pop();
                }
                standing = if index + 1 < stretches.len() {
                    self.start(&stretches[index + 1])
                } else {
                    start.clone()
                };
                let time = end.floor() + self.cycle.mesh[*point + 1];
                let course = standing.course.clone();
                passages.push(Passage { time, gate: gate.clone(), course, leads_away: false });
            }
            if passages.len() > MOST_BORDERS {
                return Err(Error::TooManyBorders { limit: MOST_BORDERS });
            }
        }
        let at_zero = passages.iter().rev().find(|passage| passage.time <= 1.0);
        let first = at_zero.map_or(start.course, |passage| passage.course.clone());
        for passage in &mut passages {
            passage.time -= passage.time.floor();
        }
        passages.sort_by(|a, b| a.time.total_cmp(&b.time));
        Ok(Way { first, passages, touched })
    }

    /// The parts of the way around: from a jump to the next, or once around from a place where nothing switches.
    fn stretches(&self, jumps: &[(usize, Gate)]) -> Vec<Stretch> {
        let count = self.samples.len();
        if jumps.is_empty() {
            let origin = self.farthest_from_borders();
            let times = (0..=count)
                .map(|index| self.samples[(origin + index) % count] + ((origin + index) / count) as f64);
            return vec![Stretch { times: times.collect(), end: None }];
        }
        (0..jumps.len())
            .map(|index| {
                let next = (index + 1) % jumps.len();
                let start = self.cycle.mesh[jumps[index].0];
                let turns = if next <= index { 1.0 } else { 0.0 };
                let end = self.cycle.mesh[jumps[next].0] + turns;
                let inside = |time: &f64| start < *time && *time < end;
                let mut times = vec![start];
                times.extend(self.samples.iter().copied().filter(inside));
                times.extend(self.samples.iter().map(|time| time + 1.0).filter(inside));
                times.push(end);
                Stretch { times, end: Some((jumps[next].0 - 1, jumps[next].1.clone())) }
            })
            .collect()
    }

    /// The sample at which all switch functions and conditions are farthest from their borders, in units of how far they vary.
    fn farthest_from_borders(&self) -> usize {
        let switches = self.pieces.thresholds().len();
        let distance = |time: &f64| {
            let state = self.state(*time, None);
            let region = self.pieces.region_at(&state, self.parameters);
            let values = self.functions(&Course::within(self.parameters, &region), &state);
            (0..values.len())
                .map(|index| match region.get(index) {
                    Some(cell) => {
                        let [lower, upper] = self.pieces.thresholds()[index].borders(*cell);
                        (values[index] - lower).min(upper - values[index]) / self.sizes[index]
                    }
                    None => values[index].abs() / self.sizes[index],
                })
                .take(switches.max(values.len()))
                .fold(f64::INFINITY, f64::min)
        };
        let distances: Vec<f64> = self.samples.iter().map(distance).collect();
        (0..self.samples.len()).max_by(|a, b| distances[*a].total_cmp(&distances[*b])).unwrap_or(0)
    }

    /// Where a stretch begins; what is at zero there but for rounding is where it is a little later.
    fn start(&self, stretch: &Stretch) -> Standing {
        let [here, later] = [0, 1].map(|index| self.state(stretch.times[index], end_of(stretch)));
        let mut region = self.pieces.region_at(&here, self.parameters);
        let switches = region.len();
        let values = self.functions(&Course::within(self.parameters, &region), &here);
        let near = |value: f64, switch: usize, cell: f64| {
            let borders = self.pieces.thresholds()[switch].borders(cell);
            borders.into_iter().find(|border| (value - border).abs() < NEAR * self.sizes[switch])
        };
        let near: Vec<Option<f64>> =
            (0..switches).map(|switch| near(values[switch], switch, region[switch])).collect();
        if near.iter().any(Option::is_some) {
            region = self.pieces.region_at(&later, self.parameters);
        }
        let mut course = Course::within(self.parameters, &region);
        let values_later = self.functions(&course, &later);
        for (switch, border) in near.iter().enumerate() {
            let Some(border) = border else { continue };
            if (values_later[switch] - border).abs() < NEAR * self.sizes[switch] {
                let threshold = self.pieces.thresholds()[switch];
                let cell = region[switch];
                let is_upper = threshold.borders(cell)[0] == *border;
                let mut other = region.clone();
                other[switch] = threshold.next(cell, !is_upper);
                let [below, above] = if is_upper { [other, region.clone()] } else { [region.clone(), other] };
                if let (next, true) = self.at_border(switch, [&below, &above], None, &here) {
                    course = next;
                }
            }
        }
        let sides = (0..self.directions.len()).map(|event| {
            let [now, then] = [&values, &values_later].map(|values| values[switches + event]);
            if now.abs() > NEAR * self.sizes[switches + event] { now.signum() } else { then.signum() }
        });
        Standing { course, sides: sides.collect(), left: None }
    }

    /// The course at a border between two regions, and whether it slides there: along the border where both fields push towards it,
    /// else beyond it in the direction in which it is passed or, without one, on the side to which they push.
    fn at_border(
        &self,
        switch: usize,
        [below, above]: [&[f64]; 2],
        upwards: Option<bool>,
        state: &[f64],
    ) -> (Course, bool) {
        let [mut low, high] = [below, above].map(|cells| Course::within(self.parameters, cells));
        let [from_below, from_above] = self.pulls(switch, state, [&low.parameters, &high.parameters]);
        // Rates are in the time of the field, of which the cycle's polynomials know the period.
        let least = PUSH * self.sizes[switch] / self.period();
        if from_below > least && from_above < -least {
            low.slide = Some(Slide { switch, above: high.parameters });
            return (low, true);
        }
        let goes_up = upwards.unwrap_or(from_below > 0.0 || from_above > 0.0);
        (if goes_up { high } else { low }, false)
    }

    fn period(&self) -> f64 {
        let nodes = (self.cycle.mesh.len() - 1) * (self.cycle.gauss.degree() + 1);
        self.cycle.states.get(nodes * self.cycle.n).copied().unwrap_or(1.0).abs()
    }

    /// What is passed on a stretch.
    fn walk(
        &self,
        stretch: &Stretch,
        standing: &mut Standing,
        found: &mut Vec<Passage>,
        touched: &mut Option<Touch>,
    ) -> Result<(), Error> {
        let end = end_of(stretch);
        let switches = self.pieces.thresholds().len();
        for (index, pair) in stretch.times.windows(2).enumerate() {
            let [mut from, until] = [pair[0], pair[1]];
            while let Some((time, place, upwards)) = self.exit(standing, from, until, end) {
                let state = self.state(time, end);
                from = time;
                if let Place::Condition { event } = place {
                    let side = standing.sides[event];
                    let counts = self.directions[event].counts(side, -side);
                    let ends_here = stretch.end.as_ref().is_some_and(|(_, gate)| {
                        gate.events.contains(&event) || gate.place == Place::Condition { event }
                    });
                    let stays = || {
                        stretch.times[index + 1..].iter().all(|time| {
                            let state = self.state(*time, end);
                            let value = self.functions(&standing.course, &state)[switches + event];
                            value * side <= NEAR * self.sizes[switches + event]
                        })
                    };
                    if counts && ends_here && stays() {
                        standing.sides[event] = 0.0;
                    } else {
                        if counts && touched.is_none() {
                            *touched = Some(Touch { place, side, time: time - time.floor() });
                        }
                        standing.sides[event] = -side;
                    }
                    continue;
                }
                let (next, left) = self.behind(&standing.course, place, upwards, &state);
                let jumps = self.rate_jumps(&standing.course, &next, place, &state);
                let gate = Gate { place, upwards, events: Vec::new() };
                let ends_slide = matches!(place, Place::Pull { .. });
                let flies = next.slide.is_none()
                    && (jumps || ends_slide)
                    && self.stays_on(place, time, until - pair[0], stretch);
                let leads_away = jumps && next.slide.is_none() && !flies;
                let back = if flies { self.flight(&standing.course, &next, place, &state) } else { None };
                found.push(Passage { time, gate, course: next.clone(), leads_away });
                (standing.course, standing.left) = (next, left);
                if let Some((duration, passage)) = back {
                    // The polynomials do not leave the switch yet: the cycle does, and comes back soon.
                    standing.course = passage.course.clone();
                    standing.left = None;
                    found.push(Passage { time: time + duration, ..passage });
                    from = (time + duration).min(until);
                }
                if found.len() > MOST_BORDERS {
                    return Err(Error::TooManyBorders { limit: MOST_BORDERS });
                }
            }
            if let Some(switch) = standing.left {
                let value = self.functions(&standing.course, &self.state(until, end))[switch];
                let cell = standing.course.cells(switches)[0][switch];
                let borders = self.pieces.thresholds()[switch].borders(cell);
                let is_away = |border: f64| (value - border).abs() > AWAY * self.sizes[switch];
                standing.left = Some(switch).filter(|_| !borders.into_iter().all(is_away));
            }
        }
        Ok(())
    }

    /// The course behind a border or the end of a slide, and the switch that is left there.
    fn behind(&self, course: &Course, place: Place, upwards: bool, state: &[f64]) -> (Course, Option<usize>) {
        let [below, above] = course.cells(self.pieces.thresholds().len());
        match place {
            Place::Pull { switch, above: is_above } => {
                (Course::within(self.parameters, if is_above { above } else { below }), Some(switch))
            }
            Place::Border { switch, value } => {
                let border = Border { switch, value, upwards };
                let beyond = |cells: &[f64]| self.pieces.beyond(cells, border, state, self.parameters);
                match &course.slide {
                    None => {
                        let next = beyond(below);
                        let sides = if upwards { [below, &next] } else { [&next[..], below] };
                        (self.at_border(switch, sides, Some(upwards), state).0, None)
                    }
                    Some(slide) => {
                        let [below, above] = [below, above].map(beyond);
                        let (next, slides) = self.at_border(slide.switch, [&below, &above], None, state);
                        (next, (!slides).then_some(slide.switch))
                    }
                }
            }
            Place::Condition { .. } => (course.clone(), None),
        }
    }

    /// Whether the polynomials stay on the switch of a place for a while, `spacing` being that of the times at which they are looked at:
    /// they are those of a cycle that slides there.
    fn stays_on(&self, place: Place, time: f64, spacing: f64, stretch: &Stretch) -> bool {
        let (switch, border) = match place {
            Place::Border { switch, value } => (switch, value),
            Place::Pull { switch, .. } => (switch, 0.0),
            Place::Condition { .. } => return false,
        };
        let last = stretch.times.last().copied().unwrap_or(time);
        let state = self.state((time + spacing).min(last), end_of(stretch));
        let cells = self.pieces.region_at(&state, self.parameters);
        let value = self.functions(&Course::within(self.parameters, &cells), &state)[switch];
        let distance = match (place, self.pieces.thresholds()[switch]) {
            (Place::Pull { .. }, Threshold::Whole) => value - value.round(),
            _ => value - border,
        };
        distance.abs() < NEAR * self.sizes[switch]
    }

    /// A short way off a switch, which begins at a state on it and follows a course: its duration in unit time and the passage back.
    fn flight(&self, from: &Course, course: &Course, place: Place, state: &[f64]) -> Option<(f64, Passage)> {
        let switches = self.pieces.thresholds().len();
        let (switch, is_above) = match place {
            Place::Border { switch, .. } => {
                let [before, behind] = [from, course].map(|course| course.cells(switches)[0][switch]);
                (switch, behind > before)
            }
            Place::Pull { switch, above } => (switch, above),
            Place::Condition { .. } => return None,
        };
        let cell = course.cells(switches)[0][switch];
        let value = self.pieces.thresholds()[switch].borders(cell)[usize::from(!is_above)];
        let period = self.period();
        let height = |time: f64| {
            let there = course.flow(self.field, state, &[], time, FLIGHT_STEPS);
            let mut results = vec![0.0; there.len() + switches];
            self.field.evaluate(&there, &course.parameters, &mut results);
            (results[there.len() + switch] - value, there)
        };
        let rate = |state: &[f64]| {
            let mut velocity = vec![0.0; state.len()];
            self.field.evaluate(state, &course.parameters, &mut velocity);
            self.field.rate_along(switch, state, &velocity, &course.parameters)
        };
        let short = SHORTEST_VISIT * period;
        let start = rate(state);
        let bend = (rate(&height(short).1) - start) / short;
        // The way off the switch is a parabola as long as it is short; the mean slope from the start is zero at its end.
        let mut now = -2.0 * start / bend;
        let mut before = 0.5 * now;
        let mean = |time: f64| height(time).0 / time;
        let mut mean_before = mean(before);
        for _ in 0..HALVINGS {
            if !(now > 0.0 && now < LONGEST_FLIGHT * period) {
                return None;
            }
            let mean_now = mean(now);
            let change = mean_now * (now - before) / (mean_now - mean_before);
            (before, mean_before) = (now, mean_now);
            if change.abs() <= ROUNDING * now || mean_now == mean_before {
                break;
            }
            now -= change;
        }
        if now < short {
            return None;
        }
        let there = height(now).1;
        let back = Place::Border { switch, value };
        let (next, _) = self.behind(course, back, !is_above, &there);
        let gate = Gate { place: back, upwards: !is_above, events: Vec::new() };
        Some((now / period, Passage { time: 0.0, gate, course: next, leads_away: false }))
    }

    /// Whether the rate of the switch function at a border jumps from one course to another.
    fn rate_jumps(&self, one: &Course, other: &Course, place: Place, state: &[f64]) -> bool {
        let Place::Border { switch, .. } = place else { return false };
        let [here, there] = self.pulls(switch, state, [&one.parameters, &other.parameters]);
        (here - there).abs() > RATE_JUMP * self.sizes[switch] / self.period()
    }

    /// The first function that passes its border between two times, and when: between them it is taken for a parabola, whose turn
    /// is looked at too.
    fn exit(
        &self,
        standing: &Standing,
        from: f64,
        until: f64,
        end: Option<(f64, usize)>,
    ) -> Option<(f64, Place, bool)> {
        let course = &standing.course;
        let switches = self.pieces.thresholds().len();
        let functions = |time: f64| self.functions(course, &self.state(time, end));
        let middle = 0.5 * (from + until);
        let [start, half, last] = [from, middle, until].map(functions);
        let [below, _] = course.cells(switches);
        let slide = course.slide.as_ref().map(|slide| slide.switch);
        let mut exits: Vec<(usize, f64, bool, Place)> = Vec::new();
        for (switch, threshold) in self.pieces.thresholds().iter().enumerate() {
            let [lower, upper] = threshold.borders(below[switch]);
            for (value, upwards) in [(lower, false), (upper, true)] {
                if value.is_finite() && slide != Some(switch) {
                    exits.push((switch, value, upwards, Place::Border { switch, value }));
                }
            }
        }
        for (event, side) in standing.sides.iter().enumerate() {
            if *side != 0.0 {
                exits.push((switches + event, 0.0, *side < 0.0, Place::Condition { event }));
            }
        }
        if let Some(switch) = slide {
            let first = switches + self.directions.len();
            exits.push((first, 0.0, false, Place::Pull { switch, above: false }));
            exits.push((first + 1, 0.0, true, Place::Pull { switch, above: true }));
        }
        let mut first: Option<(f64, Place, bool)> = None;
        for (index, value, upwards, place) in exits {
            let sign = if upwards { 1.0 } else { -1.0 };
            let beyond = |values: &[f64]| sign * (values[index] - value);
            let is_left = matches!(place, Place::Border { switch, .. } if standing.left == Some(switch));
            let margin = ROUNDING * start[index].abs().max(last[index].abs());
            let margin = if is_left { margin.max(NEAR * self.sizes[index]) } else { margin };
            let [a, b, c] = [&start, &half, &last].map(|values| beyond(values));
            // What comes to a switch and stays there slides, whatever rounding makes of its side.
            let lands = |value: f64| value.abs() < NEAR * self.sizes[index];
            if matches!(place, Place::Border { .. })
                && !is_left
                && lands(b)
                && lands(c)
                && first.is_none_or(|(time, ..)| from < time)
                && self.behind(course, place, upwards, &self.state(until, end)).0.slide.is_some()
            {
                let near = -NEAR * self.sizes[index];
                let landing = if a > near {
                    from
                } else {
                    crossing((from, middle), |time| beyond(&functions(time)) - near)
                };
                first = Some((landing, place, upwards));
                continue;
            }
            let place_of_turn = 0.5 - 0.25 * (c - a) / (a - 2.0 * b + c);
            let turn = from + place_of_turn * (until - from);
            let mut candidates = vec![middle, until];
            if from < turn && turn < until {
                candidates.push(turn);
                candidates.sort_by(f64::total_cmp);
            }
            let is_beyond = |time: &f64| beyond(&functions(*time)) > margin;
            let Some(far) = candidates.into_iter().find(is_beyond) else { continue };
            let crossing =
                if a > 0.0 { from } else { crossing((from, far), |time| beyond(&functions(time))) };
            if first.is_none_or(|(time, ..)| crossing < time) {
                first = Some((crossing, place, upwards));
            }
        }
        first
    }
}

impl Along<'_> {
    /// How far the function at a place gets beyond zero at its turn next to where it is touched, between two of the times at which the
    /// course changes.
    pub(super) fn reach(&self, touch: Touch, course: &Course, jumps: &[f64]) -> f64 {
        let from = jumps.iter().copied().filter(|time| *time <= touch.time).fold(0.0, f64::max);
        let until = jumps.iter().copied().filter(|time| *time > touch.time).fold(1.0, f64::min);
        let gate = Gate { place: touch.place, upwards: touch.side < 0.0, events: Vec::new() };
        let switches = self.pieces.thresholds().len();
        // The course may be one of other values of the parameters.
        let now: Vec<(usize, f64)> = self.parameters.iter().copied().enumerate().collect();
        let value =
            |time: f64| -touch.side * gate.value(self.field, course, &self.state(time, None), &now, switches);
        let times: Vec<f64> =
            self.samples.iter().copied().filter(|time| from <= *time && *time < until).collect();
        let values: Vec<f64> = times.iter().map(|time| value(*time)).collect();
        let mut top = times.partition_point(|time| *time < touch.time).min(times.len().saturating_sub(1));
        // Uphill from sample to sample, then between the neighbours of the highest.
        while let Some(higher) = [top.checked_sub(1), Some(top + 1)]
            .into_iter()
            .flatten()
            .filter(|next| values.get(*next).is_some_and(|value| *value > values[top]))
            .max_by(|a, b| values[*a].total_cmp(&values[*b]))
        {
            top = higher;
        }
        let Some(middle) = times.get(top) else { return f64::NAN };
        let mut low = if top == 0 { *middle } else { times[top - 1] };
        let mut high = times.get(top + 1).copied().unwrap_or(*middle);
        for _ in 0..HALVINGS {
            let [one, other] = [1.0 / 3.0, 2.0 / 3.0].map(|part| low + part * (high - low));
            if value(one) < value(other) {
                low = one;
            } else {
                high = other;
            }
        }
        value(0.5 * (low + high))
    }
}

/// The end of a stretch behind which the state jumps, with the interval that ends there.
fn end_of(stretch: &Stretch) -> Option<(f64, usize)> {
    stretch.end.as_ref().zip(stretch.times.last()).map(|((interval, _), end)| (*end, *interval))
}

/// The time of a crossing between two.
fn crossing((mut inside, mut outside): (f64, f64), beyond: impl Fn(f64) -> f64) -> f64 {
    for _ in 0..HALVINGS {
        let middle = 0.5 * (inside + outside);
        if beyond(middle) > 0.0 {
            outside = middle;
        } else {
            inside = middle;
        }
    }
    outside
}

/// Times at which the polynomials are looked at: twice as many in every interval as it has nodes.
fn samples(cycle: Polynomials<'_>) -> Vec<f64> {
    let count = 2 * (cycle.gauss.degree() + 1);
    cycle
        .mesh
        .windows(2)
        .flat_map(|pair| {
            (0..count).map(move |index| pair[0] + (pair[1] - pair[0]) * index as f64 / count as f64)
        })
        .collect()
}

/// Drops visits beyond a border, from one of the passages on, that are too short to be followed; `first` is the course before that.
fn remove_short_visits(passages: &mut Vec<Passage>, from: usize, first: &Course) {
    let mut index = from;
    while index + 1 < passages.len() {
        let course = if index == from { first } else { &passages[index - 1].course };
        let [out, back] = [&passages[index], &passages[index + 1]];
        if back.time - out.time < SHORTEST_VISIT && back.course == *course {
            passages.drain(index..index + 2);
            index = index.saturating_sub(1).max(from);
        } else {
            index += 1;
        }
    }
}
