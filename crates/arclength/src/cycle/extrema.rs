//! Largest and smallest values along a cycle, of the interpolating polynomial: of the state variables, and of any smooth
//! function of them.

use super::orbit::Orbit;
use crate::collocation::equations::Collocation;
use crate::collocation::gauss::Gauss;
use crate::collocation::polynomials::Polynomials;
use crate::collocation::problem::BoundaryValueEquations;
use crate::differentiation::Dual;
use std::cell::RefCell;

/// Local extrema among the nodes within this part of the amplitude of the extreme node are refined too.
const CANDIDATE_MARGIN: f64 = 0.2;
const MOST_ITERATIONS: usize = 60;
/// Part of the largest value to which extreme values are found.
const ROUNDING: f64 = 1e-14;

/// Part of its range by which a function changes at a mesh point where the state jumps; less is rounding.
const JUMP: f64 = 1e-9;
/// Part of the way from the last node to a jump that is left before it where a slope before the jump is taken.
const BEFORE_JUMP: f64 = 1e-9;

/// Largest and smallest value of one component.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Extremes {
    pub(crate) largest: f64,
    pub(crate) smallest: f64,
}

/// A jump of the state, with the node behind it.
struct Jump {
    node: usize,
    before: Vec<f64>,
    behind: Vec<f64>,
}

/// The jumps along a cycle.
fn jumps_of<P: BoundaryValueEquations>(collocation: &Collocation<P>, unknown: &[f64]) -> Vec<Jump> {
    let n = collocation.problem.dimension();
    let scalars = &unknown[unknown.len() - collocation.problem.scalars()..];
    collocation
        .jump_points()
        .into_iter()
        .enumerate()
        .map(|(index, point)| {
            let before = collocation.end_of(unknown, point - 1);
            let node = point * (collocation.gauss().degree() + 1);
            let behind = unknown[node * n..(node + 1) * n].to_vec();
            // A mesh point may miss its jump by a time in which a fast state changes by more than its error.
            let [before, behind] =
                collocation.problem.at_jump(index, &before, scalars).unwrap_or([before, behind]);
            Jump { node, before, behind }
        })
        .collect()
}

/// The absolute values nearest to zero and farthest from it of one component on each of the ways that it goes without a jump of its
/// own. The value to which a jump sets it, zero as a rule, is exact and nothing to come near to. None where it does not jump.
pub(crate) fn ways_between_jumps<P: BoundaryValueEquations>(
    collocation: &Collocation<P>,
    unknown: &[f64],
    component: usize,
) -> Vec<[f64; 2]> {
    let n = collocation.problem.dimension();
    let values: Vec<f64> = unknown[..unknown.len() - collocation.problem.scalars()]
        .chunks_exact(n)
        .map(|state| state[component])
        .collect();
    let size = values.iter().fold(0.0_f64, |size, value| size.max(value.abs()));
    let mut jumps = jumps_of(collocation, unknown);
    jumps.retain(|jump| (jump.behind[component] - jump.before[component]).abs() > JUMP * size);
    let way = |from: &Jump, to: &Jump| {
        // The last way goes on at the start of the unit time. The node behind a jump misses it as its mesh point does.
        let before = if to.node > from.node { to.node } else { to.node + values.len() };
        let between = (from.node + 1..before).map(|node| values[node % values.len()]);
        let (low, high) = between
            .fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), value| (low.min(value), high.max(value)));
        let ends = from.behind[component].abs().max(to.before[component].abs());
        [low.abs().min(high.abs()), low.abs().max(high.abs()).max(ends)]
    };
    let following = jumps.iter().cycle().skip(1);
    jumps.iter().zip(following).map(|(from, to)| way(from, to)).collect()
}

/// Extremes of every component among the first `count`.
pub(crate) fn extremes<P: BoundaryValueEquations>(
    collocation: &Collocation<P>,
    unknown: &[f64],
    count: usize,
) -> Vec<Extremes> {
    let n = collocation.problem.dimension();
    let cycle = collocation.polynomials(unknown);
    let times = cycle.node_times();
    let mut values = vec![0.0; times.len()];
    let jumps = jumps_of(collocation, unknown);
    (0..count)
        .map(|component| {
            for (value, state) in values.iter_mut().zip(unknown.chunks_exact(n)) {
                *value = state[component];
            }
            for jump in &jumps {
                values[jump.node] = jump.behind[component];
            }
            let breaks: Vec<Break> = jumps
                .iter()
                .filter(|jump| jump.before != jump.behind)
                .map(|jump| Break { node: jump.node, before: jump.before[component] })
                .collect();
            let mut extremes = extremes_of(PeriodicFunction {
                times: &times,
                values: &values,
                slope_at_node: &|index| cycle.slope_at_node(index, component),
                at: &|time| cycle.component(time - time.floor(), component),
                breaks: &breaks,
            });
            // What is reached before a jump is no node.
            for jump in &jumps {
                extremes.largest = extremes.largest.max(jump.before[component]);
                extremes.smallest = extremes.smallest.min(jump.before[component]);
            }
            extremes
        })
        .collect()
}

impl Orbit {
    /// Smallest and largest value along the orbit of a smooth function of the state, of which the dual numbers give the slope.
    /// The orbit must be one that passes [`check`](Self::check).
    ///
    /// ```
    /// use arclength::cycle::Orbit;
    /// // A parabola that is passed to and fro: x = (1 - s^2)/2, with nodes 0 and the Gauss points of degree 2.
    /// let gauss = 0.5 - 1.0 / 12.0_f64.sqrt();
    /// let parabola = |s: f64| 0.5 * (1.0 - s * s);
    /// let nodes = [0.0, gauss, 1.0 - gauss].map(|node| parabola(2.0 * node - 1.0));
    /// let orbit = Orbit { mesh: vec![0.0, 1.0], degree: 2, dimension: 1, states: nodes.to_vec(), period: 3.0 };
    /// let [smallest, largest] = orbit.range_of(|state| state[0] * state[0] * 4.0);
    /// assert!(smallest.abs() < 1e-15 && (largest - 1.0).abs() < 1e-15);
    /// ```
    pub fn range_of(&self, function: impl Fn(&[Dual<f64, 1>]) -> Dual<f64, 1>) -> [f64; 2] {
        let [range] = self.ranges_of(|state| [function(state)]);
        range
    }

    /// Smallest and largest values of several functions that share their computation, each as [`range_of`](Self::range_of).
    pub fn ranges_of<const K: usize>(
        &self,
        functions: impl Fn(&[Dual<f64, 1>]) -> [Dual<f64, 1>; K],
    ) -> [[f64; 2]; K] {
        let gauss = Gauss::of(self.degree);
        let n = self.dimension;
        let cycle = Polynomials { mesh: &self.mesh, gauss: &gauss, states: &self.states, n };
        let times = cycle.node_times();
        // The functions take states only, whose memory is kept.
        let state = RefCell::new(vec![Dual::constant(0.0); n]);
        let at_node = |node: usize, with_slopes: bool| {
            let mut state = state.borrow_mut();
            for (index, entry) in state.iter_mut().enumerate() {
                let slope = if with_slopes { cycle.slope_at_node(node, index) } else { 0.0 };
                *entry = Dual { value: self.states[node * n + index], derivatives: [slope] };
            }
            functions(&state)
        };
        let at_time = |time: f64| {
            let mut state = state.borrow_mut();
            cycle.components(time - time.floor(), 0..n, |index, value, slope| {
                state[index] = Dual { value, derivatives: [slope] };
            });
            functions(&state)
        };
        let mut values = vec![0.0; K * times.len()];
        for node in 0..times.len() {
            for (function, found) in at_node(node, false).into_iter().enumerate() {
                values[function * times.len() + node] = found.value;
            }
        }
        // What is reached before a jump is no node.
        let mut end = vec![0.0; n];
        let ends = (0..self.mesh.len() - 2).map(|interval| {
            cycle.state_within(interval..interval + 1, self.mesh[interval + 1], &mut end);
            let mut state = state.borrow_mut();
            for (entry, value) in state.iter_mut().zip(&end) {
                *entry = Dual::constant(*value);
            }
            functions(&state).map(|found| found.value)
        });
        let ends: Vec<[f64; K]> = ends.collect();
        std::array::from_fn(|function| {
            let values = &values[function * times.len()..(function + 1) * times.len()];
            let Extremes { smallest, largest } = extremes_of(PeriodicFunction {
                times: &times,
                values,
                slope_at_node: &|node| at_node(node, true)[function].derivatives[0],
                at: &|time| {
                    let Dual { value, derivatives: [slope] } = at_time(time)[function];
                    (value, slope)
                },
                breaks: &[],
            });
            let starts = values.iter().step_by(self.degree + 1).skip(1);
            let ends = ends.iter().map(|end| end[function]).zip(starts);
            let jumps = ends.filter(|(end, start)| (end - *start).abs() > JUMP * (largest - smallest));
            jumps.fold([smallest, largest], |[low, high], (end, _)| [low.min(end), high.max(end)])
        })
    }
}

/// A periodic function of the unit time, by its values at the nodes and its slopes there and anywhere.
struct PeriodicFunction<'a> {
    times: &'a [f64],
    values: &'a [f64],
    slope_at_node: &'a dyn Fn(usize) -> f64,
    /// Value and slope.
    at: &'a dyn Fn(f64) -> (f64, f64),
    /// Nodes behind which the function goes on elsewhere.
    breaks: &'a [Break],
}

/// A node behind a jump, with the value before it.
#[derive(Clone, Copy, Debug)]
struct Break {
    node: usize,
    before: f64,
}

/// A function at one time.
#[derive(Clone, Copy)]
struct Sample {
    time: f64,
    value: f64,
    slope: f64,
}

/// Extremes of a periodic function: of its values at the nodes, and at the zeros of the slope around the extreme ones.
fn extremes_of(function: PeriodicFunction) -> Extremes {
    let (times, values) = (function.times, function.values);
    let nodes = times.len();
    let mut extremes = values.iter().fold(
        Extremes { largest: f64::NEG_INFINITY, smallest: f64::INFINITY },
        |extremes, &value| Extremes {
            largest: extremes.largest.max(value),
            smallest: extremes.smallest.min(value),
        },
    );
    let margin = CANDIDATE_MARGIN * (extremes.largest - extremes.smallest);
    let coarse = extremes;
    let size = extremes.largest.abs().max(extremes.smallest.abs());
    for index in 0..nodes {
        let (previous, next) = ((index + nodes - 1) % nodes, (index + 1) % nodes);
        let (before, here, after) = (values[previous], values[index], values[next]);
        let peak = here >= before && here >= after && here > coarse.largest - margin;
        let valley = here <= before && here <= after && here < coarse.smallest + margin;
        if !(peak || valley) {
            continue;
        }
        let sample = |index: usize| Sample {
            time: times[index],
            value: values[index],
            slope: (function.slope_at_node)(index),
        };
        let (mut left, mut right) = (sample(previous), sample(next));
        left.time -= if index == 0 { 1.0 } else { 0.0 };
        right.time += if index + 1 == nodes { 1.0 } else { 0.0 };
        // Beside a jump the last moment before it, or the place itself, stands for the neighbour beyond it.
        let break_at = |node: usize| function.breaks.iter().find(|jump| jump.node == node);
        if break_at(index).is_some() {
            left = sample(index);
        }
        if let Some(jump) = break_at(next) {
            right.time -= BEFORE_JUMP * (right.time - times[index]);
            right = Sample { value: jump.before, slope: (function.at)(right.time).1, ..right };
        }
        let refined = refine(function.at, [left, sample(index), right], size);
        extremes.largest = extremes.largest.max(refined);
        extremes.smallest = extremes.smallest.min(refined);
    }
    extremes
}

/// Value at the zero of the slope around an extreme node, from its neighbours and itself.
fn refine(at: &dyn Fn(f64) -> (f64, f64), [left, middle, right]: [Sample; 3], size: f64) -> f64 {
    let (left, right) = if middle.slope * left.slope <= 0.0 {
        (left, middle)
    } else if middle.slope * right.slope <= 0.0 {
        (middle, right)
    } else {
        // A corner of the piecewise polynomial at a mesh point: its ends are all there is.
        return if middle.slope > 0.0 { right.value } else { left.value };
    };
    let (mut left, mut right) = (left, right);
    let mut best = left.value;
    for _ in 0..MOST_ITERATIONS {
        if left.slope == right.slope {
            break;
        }
        let time = turning_point(left, right);
        let (value, slope) = at(time);
        best = value;
        let curvature = (right.slope - left.slope) / (right.time - left.time);
        // An error of `slope / curvature` in the place changes the value by half of that times the slope only.
        if 0.5 * slope * slope <= ROUNDING * size * curvature.abs()
            || !(left.time < time && time < right.time)
        {
            break;
        }
        let here = Sample { time, value, slope };
        if slope * left.slope <= 0.0 {
            right = here;
        } else {
            left = here;
        }
    }
    best
}

/// Place in an interval, at the ends of which the slopes differ in sign, where the slope of the cubic polynomial through both
/// values with both slopes is zero.
fn turning_point(left: Sample, right: Sample) -> f64 {
    let width = right.time - left.time;
    let (a, b) = (left.slope * width, right.slope * width);
    let rise = right.value - left.value;
    // The slope in units of the interval: a + 2 linear x + quadratic x^2.
    let (linear, quadratic) = (3.0 * rise - 2.0 * a - b, 3.0 * (a + b - 2.0 * rise));
    let root = (linear * linear - a * quadratic).max(0.0).sqrt();
    let fraction = -a / (linear + root.copysign(b - a));
    let secant = a / (a - b);
    left.time + width * if (0.0..=1.0).contains(&fraction) { fraction } else { secant }
}
