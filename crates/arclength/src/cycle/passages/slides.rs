//! What lies behind a border: the field beyond it, or a slide along it where both fields push towards it; how a slide is left, and flights
//! off a switch that are too short for the polynomials to show.

use super::{
    Along, FLIGHT_STEPS, HALVINGS, LONGEST_FLIGHT, LONGEST_SLIDE, NEAR, PUSH, PUSHES_BACK, Passage,
    RATE_JUMP, ROUNDING, SHORTEST_VISIT, SLIDE_STEP, Stretch, crossing, end_of,
};
use crate::cycle::gate::{Course, Gate, GateFunction, Slide};
use crate::pieces::Border;
use crate::threshold::Threshold;

impl Along<'_> {
    /// The course at a border between two regions, and whether it slides there: along the border where both fields push towards it,
    /// else beyond it in the direction in which it is passed or, without one, on the side to which they push.
    pub(super) fn at_border(
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

    /// The course behind a border or the end of a slide, and the switch that is left there.
    pub(super) fn behind(
        &self,
        course: &Course,
        function: GateFunction,
        upwards: bool,
        state: &[f64],
    ) -> (Course, Option<usize>) {
        let [below, above] = course.cells(self.pieces.thresholds().len());
        match function {
            GateFunction::Pull { switch, above: is_above } => {
                (Course::within(self.parameters, if is_above { above } else { below }), Some(switch))
            }
            GateFunction::Border { switch, value } => {
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
            GateFunction::Condition { .. } => (course.clone(), None),
        }
    }

    /// Whether the polynomials stay on the switch of a gate for a while, `spacing` being that of the times at which they are looked at:
    /// they are those of a cycle that slides there.
    pub(super) fn stays_on(
        &self,
        function: GateFunction,
        time: f64,
        spacing: f64,
        stretch: &Stretch,
    ) -> bool {
        let (switch, border) = match function {
            GateFunction::Border { switch, value } => (switch, value),
            GateFunction::Pull { switch, .. } => (switch, 0.0),
            GateFunction::Condition { .. } => return false,
        };
        let last = stretch.times.last().copied().unwrap_or(time);
        let state = self.state((time + spacing).min(last), end_of(stretch));
        let cells = self.pieces.region_at(&state, self.parameters);
        let value = self.functions(&Course::within(self.parameters, &cells), &state)[switch];
        let distance = match (function, self.pieces.thresholds()[switch]) {
            (GateFunction::Pull { .. }, Threshold::Whole) => value - value.round(),
            _ => value - border,
        };
        distance.abs() < NEAR * self.sizes[switch]
    }

    /// Whether the polynomials are before a border, to which they came along a course, and away from it at a time soon after that: they solve
    /// the equations of a cycle that crosses it, with a field beyond that leads back.
    pub(super) fn turns_back(
        &self,
        course: &Course,
        (function, upwards): (GateFunction, bool),
        later: f64,
        end: Option<(f64, usize)>,
    ) -> bool {
        let GateFunction::Border { switch, value } = function else { return false };
        let is_followed = end.is_none_or(|(end, _)| later < end);
        let there = self.functions(course, &self.state(later, end))[switch] - value;
        let margin = NEAR * self.sizes[switch];
        is_followed && if upwards { there < -margin } else { there > margin }
    }

    /// The first time from a time on at which the polynomials are beyond a border, or before it, as a course is; `None` where they are not.
    pub(super) fn back_on_side(
        &self,
        course: &Course,
        function: GateFunction,
        time: f64,
        stretch: &Stretch,
    ) -> Option<f64> {
        let GateFunction::Border { switch, value } = function else { return None };
        let cell = course.cells(self.pieces.thresholds().len())[0][switch];
        // What is on the lower border of its cell is above it.
        let is_above = self.pieces.thresholds()[switch].borders(cell)[0] == value;
        let sign = if is_above { 1.0 } else { -1.0 };
        let end = end_of(stretch);
        let inside = |time: f64| sign * (self.functions(course, &self.state(time, end))[switch] - value);
        let after = stretch.times.iter().filter(|other| **other > time);
        let mut before = time;
        for later in after {
            if inside(*later) > NEAR * self.sizes[switch] {
                return Some(crossing((before, *later), inside));
            }
            before = *later;
        }
        None
    }

    /// How long a cycle slides from a state on a switch, in unit time, and what ends that.
    pub(super) fn slide(&self, course: &Course, state: &[f64]) -> Option<(f64, Passage)> {
        let slide = course.slide.as_ref()?;
        let period = self.period();
        let pulls = |state: &[f64]| self.pulls(slide.switch, state, [&course.parameters, &slide.above]);
        let ends = |state: &[f64]| {
            let [from_below, from_above] = pulls(state);
            from_below <= 0.0 || from_above >= 0.0
        };
        let step = period * SLIDE_STEP;
        let mut here = state.to_vec();
        for count in 0..(LONGEST_SLIDE / SLIDE_STEP) as usize {
            let next = course.flow(self.field, &here, &[], step, 1);
            if !ends(&next) {
                here = next;
                continue;
            }
            let (mut low, mut high) = (0.0, step);
            for _ in 0..HALVINGS {
                let middle = 0.5 * (low + high);
                if ends(&course.flow(self.field, &here, &[], middle, 1)) {
                    high = middle;
                } else {
                    low = middle;
                }
            }
            let there = course.flow(self.field, &here, &[], high, 1);
            let above = pulls(&there)[0] > 0.0;
            let function = GateFunction::Pull { switch: slide.switch, above };
            let (next, _) = self.behind(course, function, above, &there);
            let gate = Gate { function, upwards: above, events: Vec::new() };
            let duration = count as f64 * SLIDE_STEP + high / period;
            return Some((duration, Passage { time: 0.0, gate, course: next, leads_away: false }));
        }
        None
    }

    /// Whether both fields push towards a border at a time at which a cycle crosses it, from one course to the next, so that it slides.
    pub(in crate::cycle) fn would_slide(
        &self,
        time: f64,
        switch: usize,
        [before, behind]: [&Course; 2],
        upwards: bool,
    ) -> bool {
        let switches = self.pieces.thresholds().len();
        let [low, high] = if upwards { [before, behind] } else { [behind, before] };
        // The courses may be those of other values of the parameters.
        let sides = [low, high].map(|course| Course::within(self.parameters, course.cells(switches)[0]));
        let pulls = self.pulls(switch, &self.state(time, None), [&sides[0].parameters, &sides[1].parameters]);
        let least = PUSHES_BACK * self.sizes[switch] / self.period();
        pulls[0] > least && pulls[1] < -least
    }

    /// A short way off a switch, which begins at a state on it and follows a course: its duration in unit time and the passage back.
    pub(super) fn flight(
        &self,
        from: &Course,
        course: &Course,
        function: GateFunction,
        state: &[f64],
    ) -> Option<(f64, Passage)> {
        let switches = self.pieces.thresholds().len();
        let (switch, is_above) = match function {
            GateFunction::Border { switch, .. } => {
                let [before, behind] = [from, course].map(|course| course.cells(switches)[0][switch]);
                (switch, behind > before)
            }
            GateFunction::Pull { switch, above } => (switch, above),
            GateFunction::Condition { .. } => return None,
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
        let back = GateFunction::Border { switch, value };
        let (next, _) = self.behind(course, back, !is_above, &there);
        let gate = Gate { function: back, upwards: !is_above, events: Vec::new() };
        Some((now / period, Passage { time: 0.0, gate, course: next, leads_away: false }))
    }

    /// Whether the rate of the switch function at a border jumps from one course to another.
    pub(super) fn rate_jumps(
        &self,
        one: &Course,
        other: &Course,
        function: GateFunction,
        state: &[f64],
    ) -> bool {
        let GateFunction::Border { switch, .. } = function else { return false };
        let [here, there] = self.pulls(switch, state, [&one.parameters, &other.parameters]);
        (here - there).abs() > RATE_JUMP * self.sizes[switch] / self.period()
    }
}
