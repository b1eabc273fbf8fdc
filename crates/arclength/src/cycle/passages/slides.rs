//! What lies behind a border: the field beyond it, or a slide along it where both fields push towards it; how a slide is left, and flights
//! off a switch that are too short for the polynomials to show.

use super::{
    Along, FLIGHT_STEPS, HALVINGS, LONGEST_FLIGHT, NEAR, PUSH, Passage, RATE_JUMP, ROUNDING, SHORTEST_VISIT,
    Stretch, end_of,
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
