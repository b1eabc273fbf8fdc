//! The segments of a cycle whose field is smooth only piece by piece.
//!
//! Between two borders the cycle follows the smooth field of one region. Mesh points are put at the borders, and there the solution
//! of one segment is handed on to the next: it is followed in the old region to the border itself, for the short time by which the mesh
//! point misses it, and from there back for the same time in the new region. This zero-time map (Nordmark 1991; di Bernardo, Budd,
//! Champneys and Kowalczyk, *Piecewise-smooth Dynamical Systems* (2008), section 2.5) makes the times of crossing unknowns that are
//! eliminated: its derivative is the saltation matrix, so that multipliers, defining systems and error estimates contain it.

use crate::collocation::polynomials::Polynomials;
use crate::differentiation::{Dual, Scalar};
use crate::erased::{ErasedField, FieldScalar};
use crate::error::Error;
use crate::integration::equal_steps;
use crate::parameters::with_parameters;
use crate::pieces::{Border, Pieces};

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
/// Most borders that a cycle passes.
const MOST_BORDERS: usize = 64;
/// A visit beyond a border that is shorter than this part of the period is not seen: where the field has a kink it changes the
/// cycle by its third power.
const SHORTEST_VISIT: f64 = 2e-5;
/// A border this close to the origin of the unit time, as part of the distance that another origin would have, asks for that one.
const CLOSE_TO_ORIGIN: f64 = 0.1;
/// Halvings to locate a crossing of the polynomials.
const HALVINGS: usize = 60;
/// Part of the size of a switch function by which it may be beyond a border without crossing it.
const ROUNDING: f64 = 1e-10;

/// The segments that a cycle goes through in the unit time, and the borders between them.
#[derive(Clone, Debug)]
pub(crate) struct Segments {
    /// Number of switch functions.
    switches: usize,
    /// Parameters of the field in the region of every segment: those of the model and then the cells.
    parameters: Vec<Vec<f64>>,
    /// Times of the borders between one segment and the next, which are points of the mesh.
    pub times: Vec<f64>,
    /// The borders.
    pub borders: Vec<Border>,
}

/// A border that a cycle passes at a time, and the region behind it.
#[derive(Clone, Debug)]
struct Passage {
    time: f64,
    border: Border,
    region: Vec<f64>,
}

impl Segments {
    /// The segments of the cycle that polynomials describe; `None` where the field is smooth everywhere.
    ///
    /// # Errors
    /// [`Error::TooManyBorders`].
    pub(crate) fn of(
        field: ErasedField<'_>,
        cycle: Polynomials<'_>,
        parameters: &[f64],
    ) -> Result<Option<Self>, Error> {
        let Some(pieces) = Pieces::of_erased(field) else { return Ok(None) };
        let samples = samples(cycle);
        let state = |time: f64| {
            let mut state = vec![0.0; cycle.n];
            cycle.state(time - time.floor(), &mut state);
            state
        };
        let along = Along { pieces: &pieces, parameters, state: &state };
        let origin = along.farthest_from_borders(&samples);
        let from = samples[origin];
        let count = samples.len();
        // Once around, from a place where nothing switches.
        let around: Vec<f64> = (0..=count)
            .map(|index| samples[(origin + index) % count] + ((origin + index) / count) as f64)
            .collect();
        let first = pieces.region_at(&state(from), parameters);
        let mut passages = along.passages(&around, first.clone())?;
        remove_short_visits(&mut passages, &first);
        let region_at_zero = passages.iter().rev().find(|passage| passage.time <= 1.0);
        let region_at_zero = region_at_zero.map_or(first, |passage| passage.region.clone());
        for passage in &mut passages {
            passage.time -= passage.time.floor();
        }
        passages.sort_by(|a, b| a.time.total_cmp(&b.time));
        let regions =
            std::iter::once(region_at_zero).chain(passages.iter().map(|passage| passage.region.clone()));
        Ok(Some(Self {
            parameters: regions.map(|region| [parameters, &region[..]].concat()).collect(),
            times: passages.iter().map(|passage| passage.time).collect(),
            borders: passages.iter().map(|passage| passage.border).collect(),
            switches: pieces.thresholds().len(),
        }))
    }

    /// Moves the borders to the nearest points of a mesh, each to another one inside it; where there are too few points, a visit
    /// beyond a border is left out.
    pub(crate) fn snap_to(&mut self, mesh: &[f64]) {
        let nearest = |time: f64| {
            let after = mesh.partition_point(|point| *point < time).clamp(1, mesh.len() - 1);
            let index = if mesh[after] - time < time - mesh[after - 1] { after } else { after - 1 };
            index.clamp(1, mesh.len() - 2)
        };
        let mut points: Vec<usize> = self.times.iter().map(|time| nearest(*time)).collect();
        while let Some(index) = points.windows(2).position(|pair| pair[0] >= pair[1]) {
            points.drain(index..index + 2);
            self.borders.drain(index..index + 2);
            self.parameters.drain(index + 1..index + 3);
        }
        self.times = points.into_iter().map(|point| mesh[point]).collect();
    }

    /// The mesh point from which the unit time is counted better, where a border comes close to where it is counted from now: the one
    /// that is farthest from all borders.
    pub(crate) fn better_origin(&self, mesh: &[f64]) -> Option<usize> {
        let distance = |origin: f64| {
            let away = |time: &f64| {
                let gap = (time - origin).abs();
                gap.min(1.0 - gap)
            };
            self.times.iter().map(away).fold(f64::INFINITY, f64::min)
        };
        let farthest =
            (1..mesh.len() - 1).max_by(|&a, &b| distance(mesh[a]).total_cmp(&distance(mesh[b])))?;
        let is_close = distance(0.0) < CLOSE_TO_ORIGIN * distance(mesh[farthest]);
        is_close.then_some(farthest)
    }

    /// Counts the unit time from a mesh point on; `mesh` is the new mesh, as many points of which lie before the old origin as the
    /// old one had behind that point.
    pub(crate) fn count_from(&mut self, origin: f64, behind: usize, points: &[usize], mesh: &[f64]) {
        let before = self.times.partition_point(|time| *time < origin);
        let count = mesh.len() - 1;
        self.times = points.iter().map(|point| mesh[(point + behind) % count]).collect();
        self.times.rotate_left(before);
        self.borders.rotate_left(before);
        // The segment around the old origin is one, the one around the new origin is divided.
        self.parameters.pop();
        self.parameters.rotate_left(before);
        let first = self.parameters[0].clone();
        self.parameters.push(first);
    }

    /// Whether the cycle passes the same borders in the same order from the origin of the unit time on.
    pub(crate) fn are_like(&self, other: &Self) -> bool {
        let cells = |segments: &Self| -> Vec<Vec<f64>> {
            segments.parameters.iter().map(|all| all[all.len() - segments.switches..].to_vec()).collect()
        };
        self.borders == other.borders && cells(self) == cells(other)
    }

    /// Parameters of the field at a time, cells included; at a border those behind it.
    #[inline]
    pub(crate) fn parameters_at(&self, time: f64) -> &[f64] {
        &self.parameters[self.times.partition_point(|border| *border <= time)]
    }

    /// Writes the state behind a border at its mesh point, of period `period`, from the state before it; not numbers where the
    /// cycle does not pass the border nearby. `replaced` are the parameters that vary.
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
        let n = before.len();
        let border = self.borders[index];
        let steps = steps_for(delay, period);
        let mut delay = T::from(delay);
        let mut at_border = before.to_vec();
        with_parameters(&self.parameters[index], replaced.iter().copied(), |parameters: &[T]| {
            let mut results = vec![T::zero(); n + self.switches];
            for order in 0..=ORDERS {
                let flow = |state: &[T], slope: &mut [T]| field.evaluate(state, parameters, slope);
                at_border = equal_steps(flow, before, delay, steps);
                if order < ORDERS {
                    field.evaluate(&at_border, parameters, &mut results);
                    delay -= (results[n + border.switch] - border.value) / rate;
                }
            }
        });
        with_parameters(&self.parameters[index + 1], replaced.iter().copied(), |parameters: &[T]| {
            let flow = |state: &[T], slope: &mut [T]| field.evaluate(state, parameters, slope);
            after.copy_from_slice(&equal_steps(flow, &at_border, -delay, steps));
        });
    }

    /// How much later than its mesh point the cycle passes a border, in time, and the rate of the switch function there.
    pub(crate) fn delay(
        &self,
        field: ErasedField<'_>,
        index: usize,
        before: &[f64],
        period: f64,
        replaced: &[(usize, f64)],
    ) -> Option<(f64, f64)> {
        let n = before.len();
        let border = self.borders[index];
        let count = self.times.len();
        // To the border before and to that behind, around the period.
        let before_it = (self.times[index] - self.times[(index + count - 1) % count]).rem_euclid(1.0);
        let behind_it = (self.times[(index + 1) % count] - self.times[index]).rem_euclid(1.0);
        let longer = if count == 1 { 1.0 } else { before_it.max(behind_it) };
        let reach = REACH * longer * period;
        with_parameters(&self.parameters[index], replaced.iter().copied(), |parameters: &[f64]| {
            let lifted: Vec<Dual<f64, 1>> = parameters.iter().map(|value| Dual::constant(*value)).collect();
            let mut slope = vec![0.0; n];
            let mut results = vec![Dual::<f64, 1>::zero(); n + self.switches];
            let (mut delay, mut last_change) = (0.0, f64::INFINITY);
            for _ in 0..MOST_ITERATIONS {
                let flow = |state: &[f64], slope: &mut [f64]| field.evaluate(state, parameters, slope);
                let steps = steps_for(delay, period);
                let state = equal_steps(flow, before, delay, steps);
                field.evaluate(&state, parameters, &mut slope);
                let along = state.iter().zip(&slope);
                let along: Vec<_> =
                    along.map(|(value, slope)| Dual { value: *value, derivatives: [*slope] }).collect();
                field.evaluate(&along, &lifted, &mut results);
                let Dual { value, derivatives: [rate] } = results[n + border.switch];
                let change = (value - border.value) / rate;
                delay -= change;
                let is_near = delay.abs() <= reach;
                if !is_near || (rate > 0.0) != border.upwards {
                    return None;
                }
                let is_rounding = change.abs() <= STAGNATION * period && change.abs() >= last_change;
                if change.abs() <= CONVERGED * period || is_rounding {
                    return Some((delay, rate));
                }
                last_change = change.abs();
            }
            None
        })
    }
}

/// Number of steps that are exact to rounding over a short time.
fn steps_for(delay: f64, period: f64) -> usize {
    1 + (delay.abs() / (STEP * period)).min(MOST_STEPS) as usize
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

/// Drops visits beyond a border that are too short to be followed.
fn remove_short_visits(passages: &mut Vec<Passage>, first: &[f64]) {
    let mut index = 0;
    while index + 1 < passages.len() {
        let region = if index == 0 { first } else { &passages[index - 1].region };
        let [out, back] = [&passages[index], &passages[index + 1]];
        if back.time - out.time < SHORTEST_VISIT && back.region == region {
            passages.drain(index..index + 2);
            index = index.saturating_sub(1);
        } else {
            index += 1;
        }
    }
}

/// A cycle as a function of time.
struct Along<'a> {
    pieces: &'a Pieces<'a>,
    parameters: &'a [f64],
    state: &'a dyn Fn(f64) -> Vec<f64>,
}

impl Along<'_> {
    fn switches(&self, region: &[f64], time: f64) -> Vec<f64> {
        self.pieces.switches(region, &(self.state)(time), self.parameters)
    }

    /// The sample at which all switch functions are farthest from their borders, in units of how far they vary.
    fn farthest_from_borders(&self, samples: &[f64]) -> usize {
        let values: Vec<(Vec<f64>, Vec<f64>)> = samples
            .iter()
            .map(|&time| {
                let region = self.pieces.region_at(&(self.state)(time), self.parameters);
                let switches = self.switches(&region, time);
                (region, switches)
            })
            .collect();
        let switches = self.pieces.thresholds().len();
        let sizes: Vec<f64> = (0..switches)
            .map(|switch| {
                let all = values.iter().map(|(_, values)| values[switch]);
                let (low, high) = all.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), value| {
                    (low.min(value), high.max(value))
                });
                (high - low).max(f64::MIN_POSITIVE)
            })
            .collect();
        let distance = |(region, values): &(Vec<f64>, Vec<f64>)| {
            (0..switches)
                .map(|switch| {
                    let [lower, upper] = self.pieces.thresholds()[switch].borders(region[switch]);
                    (values[switch] - lower).min(upper - values[switch]) / sizes[switch]
                })
                .fold(f64::INFINITY, f64::min)
        };
        let distances: Vec<f64> = values.iter().map(distance).collect();
        (0..samples.len()).max_by(|a, b| distances[*a].total_cmp(&distances[*b])).unwrap_or(0)
    }

    /// The borders that are passed between times in order, from a region.
    fn passages(&self, times: &[f64], mut region: Vec<f64>) -> Result<Vec<Passage>, Error> {
        let mut found: Vec<Passage> = Vec::new();
        for pair in times.windows(2) {
            let [mut from, until] = [pair[0], pair[1]];
            while let Some((time, border)) = self.exit(&region, from, until) {
                region = self.pieces.beyond(&region, border, &(self.state)(time), self.parameters);
                found.push(Passage { time, border, region: region.clone() });
                if found.len() > MOST_BORDERS {
                    return Err(Error::TooManyBorders { limit: MOST_BORDERS });
                }
                from = time;
            }
        }
        Ok(found)
    }

    /// The first border of a region that is passed between two times, and when: between them a switch function is taken for a
    /// parabola, whose turn is looked at too.
    fn exit(&self, region: &[f64], from: f64, until: f64) -> Option<(f64, Border)> {
        let middle = 0.5 * (from + until);
        let [start, half, end] = [from, middle, until].map(|time| self.switches(region, time));
        let mut first: Option<(f64, Border)> = None;
        for (switch, threshold) in self.pieces.thresholds().iter().enumerate() {
            let [lower, upper] = threshold.borders(region[switch]);
            for (value, upwards) in [(lower, false), (upper, true)] {
                if value.is_infinite() {
                    continue;
                }
                let sign = if upwards { 1.0 } else { -1.0 };
                let beyond = |values: &[f64]| sign * (values[switch] - value);
                let margin = ROUNDING * start[switch].abs().max(end[switch].abs());
                let [a, b, c] = [&start, &half, &end].map(|values| beyond(values));
                let place = 0.5 - 0.25 * (c - a) / (a - 2.0 * b + c);
                let turn = from + place * (until - from);
                let mut candidates = vec![middle, until];
                if from < turn && turn < until {
                    candidates.push(turn);
                    candidates.sort_by(f64::total_cmp);
                }
                let is_beyond = |time: &f64| beyond(&self.switches(region, *time)) > margin;
                let far = candidates.into_iter().find(is_beyond);
                let Some(far) = far else { continue };
                let crossing = if a > 0.0 { from } else { self.crossing((from, far), beyond, region) };
                if first.is_none_or(|(time, _)| crossing < time) {
                    first = Some((crossing, Border { switch, value, upwards }));
                }
            }
        }
        first
    }

    /// The time of a crossing between two.
    fn crossing(
        &self,
        (mut inside, mut outside): (f64, f64),
        beyond: impl Fn(&[f64]) -> f64,
        region: &[f64],
    ) -> f64 {
        for _ in 0..HALVINGS {
            let middle = 0.5 * (inside + outside);
            if beyond(&self.switches(region, middle)) > 0.0 {
                outside = middle;
            } else {
                inside = middle;
            }
        }
        outside
    }
}
