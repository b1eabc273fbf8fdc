//! What a cycle passes on its way around, found on its polynomials: borders of regions, events at which its state jumps, beginnings
//! and ends of slides.
//!
//! Where the state jumps the polynomials do, at a mesh point. The way around is divided there into stretches on which it is
//! continuous; on each the regions are walked through as they follow each other. The condition of an event that is passed on the way
//! without a jump is noted: beyond a grazing cycles of before go on to solve the equations, but are none of the model any more.

mod jumps;
mod slides;
mod walk;

use super::gate::{Course, Gate, GateFunction};
use crate::collocation::polynomials::Polynomials;
use crate::direction::Direction;
use crate::erased::ErasedField;
use crate::error::Error;
use crate::pieces::Pieces;

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
/// The same where a cycle that crosses a border is none of the model: less makes it slide for a time that is not seen.
const PUSHES_BACK: f64 = 1e-4;
/// Steps in which a slide that begins is followed, and the longest one, as parts of the period.
const SLIDE_STEP: f64 = 2e-3;
const LONGEST_SLIDE: f64 = 0.5;
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
    pub function: GateFunction,
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

    fn period(&self) -> f64 {
        let nodes = (self.cycle.mesh.len() - 1) * (self.cycle.gauss.degree() + 1);
        self.cycle.states.get(nodes * self.cycle.n).copied().unwrap_or(1.0).abs()
    }
}

/// How far the function of a gate that is touched gets.
pub(super) struct Reach {
    /// Its largest value beyond zero; not a number where it is not known.
    pub beyond: f64,
    /// Whether it turns there; otherwise it is largest where the course changes.
    pub turns: bool,
}

impl Along<'_> {
    /// How far the function of a gate gets beyond zero next to where it is touched, between two of the times at which the course
    /// changes.
    pub(super) fn reach(&self, touch: Touch, course: &Course, jumps: &[f64]) -> Reach {
        let from = jumps.iter().copied().filter(|time| *time <= touch.time).fold(0.0, f64::max);
        let until = jumps.iter().copied().filter(|time| *time > touch.time).fold(1.0, f64::min);
        let gate = Gate { function: touch.function, upwards: touch.side < 0.0, events: Vec::new() };
        let switches = self.pieces.thresholds().len();
        // The course may be one of other values of the parameters.
        let now: Vec<(usize, f64)> = self.parameters.iter().copied().enumerate().collect();
        // The state before the jump at the end belongs to this part, too.
        let interval = self.cycle.mesh.partition_point(|point| *point < until).saturating_sub(1);
        let end = (until < 1.0).then_some((until, interval));
        let value =
            |time: f64| -touch.side * gate.value(self.field, course, &self.state(time, end), &now, switches);
        let inside = self.samples.iter().copied().filter(|time| from <= *time && *time < until);
        let times: Vec<f64> = inside.chain(end.map(|(until, _)| until)).collect();
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
        let Some(middle) = times.get(top) else { return Reach { beyond: f64::NAN, turns: false } };
        let is_first = top == 0 && from > 0.0;
        if is_first || end.is_some_and(|(until, _)| until == *middle) {
            return Reach { beyond: values[top], turns: false };
        }
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
        Reach { beyond: value(0.5 * (low + high)), turns: true }
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
