//! Where a cycle jumps: the events at whose conditions its state is another behind a mesh point, and what happens there together.

use super::{ABOUT_JUMP, ABOUT_ZERO, Along, GAP, NEAR};
use crate::cycle::gate::{Course, Gate, GateFunction};
use crate::differentiation::{Dual, Scalar};

/// Range of a state, as part of its size, up to which it rests.
const RESTING: f64 = 1e-12;

impl Along<'_> {
    /// The gates at which the state jumps from one mesh point to the next, with the numbers of the mesh points.
    pub(in crate::cycle) fn jumps(&self) -> Vec<(usize, Gate)> {
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
                // What is left of a state that rests is rounding.
                let rests = high - low <= RESTING * low.abs().max(high.abs());
                if rests { 0.0 } else { high - low }
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

    pub(super) fn apply(&self, events: &[usize], state: &mut [f64]) {
        let mut values = vec![0.0; state.len() + 1];
        for event in events {
            self.field.evaluate_event(*event, state, self.parameters, &mut values);
            state.copy_from_slice(&values[1..]);
        }
    }

    /// The gate of the events that happen at a state: of the one with this index, or of that whose condition is nearest to zero, of
    /// those that happen with it, and of those whose conditions these take to the other side.
    pub(in crate::cycle) fn event_at(&self, state: &[f64], first: Option<usize>) -> Option<Gate> {
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
        let function = GateFunction::Condition { event: primary };
        Some(Gate { function, upwards: rates[primary] > 0.0, events })
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
}
