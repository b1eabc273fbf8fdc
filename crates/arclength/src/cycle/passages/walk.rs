//! The walk along a stretch on which the state does not jump: which border, condition or end of a slide comes next, and what is behind it.

use super::{AWAY, Along, MOST_BORDERS, NEAR, Passage, ROUNDING, Stretch, Touch, crossing, end_of};
use crate::cycle::gate::{Course, Gate, GateFunction};
use crate::error::Error;

/// Where the walk is.
#[derive(Clone)]
pub(super) struct Standing {
    pub course: Course,
    /// Signs of the conditions of the events; zero where a condition is not looked at.
    pub sides: Vec<f64>,
    /// The switch whose slide has just been left.
    pub left: Option<usize>,
}

/// Where a course ends.
struct Exit {
    time: f64,
    function: GateFunction,
    /// Whether the function that is zero there grows.
    upwards: bool,
}

/// A function at whose value a course would end.
struct PossibleGate {
    /// Its index among all functions of the course.
    index: usize,
    value: f64,
    upwards: bool,
    function: GateFunction,
}

impl Along<'_> {
    /// Where a stretch begins; what is at zero there but for rounding is where it is a little later.
    pub(super) fn start(&self, stretch: &Stretch) -> Standing {
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

    /// What is passed on a stretch.
    pub(super) fn walk(
        &self,
        stretch: &Stretch,
        standing: &mut Standing,
        found: &mut Vec<Passage>,
        touched: &mut Option<Touch>,
    ) -> Result<(), Error> {
        let end = end_of(stretch);
        let switches = self.pieces.thresholds().len();
        let (first, known) = (standing.course.clone(), found.len());
        let mut resumed = f64::NEG_INFINITY;
        for (index, pair) in stretch.times.windows(2).enumerate() {
            let [mut from, until] = [pair[0].max(resumed), pair[1]];
            if from >= until {
                continue;
            }
            let spacing = 0.5 * (until - pair[0]);
            while let Some(Exit { time, function, upwards }) = self.exit(standing, from, until, end) {
                let state = self.state(time, end);
                from = time;
                if let GateFunction::Condition { event } = function {
                    let side = standing.sides[event];
                    let counts = self.directions[event].counts(side, -side);
                    let ends_here = stretch.end.as_ref().is_some_and(|(_, gate)| {
                        gate.events.contains(&event) || gate.function == GateFunction::Condition { event }
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
                            *touched = Some(Touch { function, side, time: time - time.floor() });
                        }
                        standing.sides[event] = -side;
                    }
                    continue;
                }
                let turns_back = |last: &mut Passage| {
                    last.time == time && last.gate.function == function && last.gate.upwards != upwards
                };
                if found.len() > known && found.pop_if(turns_back).is_some() {
                    // A visit of no length is rounding, and there might be no end of them.
                    standing.course =
                        found[known..].last().map_or_else(|| first.clone(), |last| last.course.clone());
                    from = 0.5 * (time + until);
                    continue;
                }
                let (next, left) = self.behind(&standing.course, function, upwards, &state);
                let jumps = self.rate_jumps(&standing.course, &next, function, &state);
                let gate = Gate { function, upwards, events: Vec::new() };
                let ends_slide = matches!(function, GateFunction::Pull { .. });
                let flies = next.slide.is_none()
                    && (jumps || ends_slide)
                    && self.stays_on(function, time, until - pair[0], stretch);
                let leads_away = jumps && next.slide.is_none() && !flies;
                let back = if flies { self.flight(&standing.course, &next, function, &state) } else { None };
                found.push(Passage { time, gate, course: next.clone(), leads_away });
                let bounces = standing.course.slide.is_none()
                    && next.slide.is_some()
                    && self.turns_back(&standing.course, (function, upwards), time + spacing, end);
                if bounces && let Some((duration, passage)) = self.slide(&next, &state) {
                    // The polynomials are those of a cycle that does not slide yet: they are on their way again where they are on the side
                    // on which the slide ends.
                    let ahead = self.back_on_side(&passage.course, function, time, stretch);
                    resumed = ahead.unwrap_or(time).max(time + duration);
                    (standing.course, standing.left) = (passage.course.clone(), None);
                    found.push(Passage { time: time + duration, ..passage });
                    from = resumed;
                    if from >= until {
                        break;
                    }
                    continue;
                }
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

    /// The first function that passes its border between two times, and when: between them it is taken for a parabola, whose turn
    /// is looked at too.
    fn exit(&self, standing: &Standing, from: f64, until: f64, end: Option<(f64, usize)>) -> Option<Exit> {
        let course = &standing.course;
        let switches = self.pieces.thresholds().len();
        let functions = |time: f64| self.functions(course, &self.state(time, end));
        let middle = 0.5 * (from + until);
        let [start, half, last] = [from, middle, until].map(functions);
        let [below, _] = course.cells(switches);
        let slide = course.slide.as_ref().map(|slide| slide.switch);
        let mut gates: Vec<PossibleGate> = Vec::new();
        for (switch, threshold) in self.pieces.thresholds().iter().enumerate() {
            let [lower, upper] = threshold.borders(below[switch]);
            for (value, upwards) in [(lower, false), (upper, true)] {
                if value.is_finite() && slide != Some(switch) {
                    let function = GateFunction::Border { switch, value };
                    gates.push(PossibleGate { index: switch, value, upwards, function });
                }
            }
        }
        for (event, side) in standing.sides.iter().enumerate() {
            if *side != 0.0 {
                let function = GateFunction::Condition { event };
                gates.push(PossibleGate {
                    index: switches + event,
                    value: 0.0,
                    upwards: *side < 0.0,
                    function,
                });
            }
        }
        if let Some(switch) = slide {
            let first = switches + self.directions.len();
            for (index, above) in [(first, false), (first + 1, true)] {
                let function = GateFunction::Pull { switch, above };
                gates.push(PossibleGate { index, value: 0.0, upwards: above, function });
            }
        }
        let mut first: Option<Exit> = None;
        for PossibleGate { index, value, upwards, function } in gates {
            let sign = if upwards { 1.0 } else { -1.0 };
            let beyond = |values: &[f64]| sign * (values[index] - value);
            let is_left =
                matches!(function, GateFunction::Border { switch, .. } if standing.left == Some(switch));
            let margin = ROUNDING * start[index].abs().max(last[index].abs());
            let margin = if is_left { margin.max(NEAR * self.sizes[index]) } else { margin };
            let [a, b, c] = [&start, &half, &last].map(|values| beyond(values));
            // What comes to a switch and stays there slides, whatever rounding makes of its side.
            let lands = |value: f64| value.abs() < NEAR * self.sizes[index];
            // What comes to a switch from which both sides lead back slides, too, where the polynomials turn there.
            if matches!(function, GateFunction::Border { .. })
                && !is_left
                && lands(c)
                && !lands(b)
                && first.as_ref().is_none_or(|first| until < first.time)
                && self.turns_back(course, (function, upwards), until + middle - from, end)
                && self.behind(course, function, upwards, &self.state(until, end)).0.slide.is_some()
            {
                first = Some(Exit { time: until, function, upwards });
                continue;
            }
            if matches!(function, GateFunction::Border { .. })
                && !is_left
                && lands(b)
                && lands(c)
                && first.as_ref().is_none_or(|first| from < first.time)
                && self.behind(course, function, upwards, &self.state(until, end)).0.slide.is_some()
            {
                let near = -NEAR * self.sizes[index];
                let landing = if a > near {
                    from
                } else {
                    crossing((from, middle), |time| beyond(&functions(time)) - near)
                };
                first = Some(Exit { time: landing, function, upwards });
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
            if first.as_ref().is_none_or(|first| crossing < first.time) {
                first = Some(Exit { time: crossing, function, upwards });
            }
        }
        first
    }
}
