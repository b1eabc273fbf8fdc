//! Largest and smallest values of the state variables along a cycle, of the interpolating polynomial.

use super::collocation::{Collocation, MOST_NODES};
use super::problem::PeriodicProblem;

/// Local extrema among the nodes within this part of the amplitude of the extreme node are refined too.
const CANDIDATE_MARGIN: f64 = 0.2;
const MOST_ITERATIONS: usize = 60;
/// Part of the largest value to which extreme values are found.
const ROUNDING: f64 = 1e-14;

/// Largest and smallest value of one component.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Range {
    pub(crate) largest: f64,
    pub(crate) smallest: f64,
}

/// Range of every component among the first `count`.
pub(crate) fn ranges<P: PeriodicProblem>(
    collocation: &Collocation<P>,
    unknown: &[f64],
    count: usize,
) -> Vec<Range> {
    let n = collocation.problem.dimension();
    let degree = collocation.gauss().degree();
    let intervals = collocation.intervals();
    let mut times = Vec::with_capacity(intervals * (degree + 1));
    for pair in collocation.mesh().windows(2) {
        times.push(pair[0]);
        times.extend(collocation.gauss().points.iter().map(|point| pair[0] + point * (pair[1] - pair[0])));
    }
    let nodes = times.len();
    let value = |index: usize, component: usize| unknown[(index % nodes) * n + component];
    (0..count)
        .map(|component| {
            let mut range = (0..nodes).map(|index| value(index, component)).fold(
                Range { largest: f64::NEG_INFINITY, smallest: f64::INFINITY },
                |range, value| Range {
                    largest: range.largest.max(value),
                    smallest: range.smallest.min(value),
                },
            );
            let margin = CANDIDATE_MARGIN * (range.largest - range.smallest);
            let coarse = range;
            let size = range.largest.abs().max(range.smallest.abs());
            for index in 0..nodes {
                let (before, here, after) = (
                    value(index + nodes - 1, component),
                    value(index, component),
                    value(index + 1, component),
                );
                let peak = here >= before && here >= after && here > coarse.largest - margin;
                let valley = here <= before && here <= after && here < coarse.smallest + margin;
                if !(peak || valley) {
                    continue;
                }
                let sample =
                    |index: usize| Sample::at_node(collocation, unknown, component, index % nodes, &times);
                let (mut left, mut right) = (sample(index + nodes - 1), sample(index + 1));
                left.time -= if index == 0 { 1.0 } else { 0.0 };
                right.time += if index + 1 == nodes { 1.0 } else { 0.0 };
                let refined = refine(collocation, unknown, component, [left, sample(index), right], size);
                range.largest = range.largest.max(refined);
                range.smallest = range.smallest.min(refined);
            }
            range
        })
        .collect()
}

/// A component at one time.
#[derive(Clone, Copy)]
struct Sample {
    time: f64,
    value: f64,
    slope: f64,
}

impl Sample {
    fn at_node<P: PeriodicProblem>(
        collocation: &Collocation<P>,
        unknown: &[f64],
        component: usize,
        index: usize,
        times: &[f64],
    ) -> Self {
        let n = collocation.problem.dimension();
        let count = collocation.gauss().degree() + 1;
        let (interval, node) = (index / count, index % count);
        let width = collocation.mesh()[interval + 1] - collocation.mesh()[interval];
        let values = collocation.interval(unknown, interval).iter().skip(component).step_by(n);
        let slopes = collocation.gauss().slopes_at_node(node);
        let slope = values.zip(slopes).map(|(value, slope)| value * slope).sum::<f64>() / width;
        Self { time: times[index], value: unknown[index * n + component], slope }
    }
}

/// Value at the zero of the slope around an extreme node, from its neighbours and itself.
fn refine<P: PeriodicProblem>(
    collocation: &Collocation<P>,
    unknown: &[f64],
    component: usize,
    [left, middle, right]: [Sample; 3],
    size: f64,
) -> f64 {
    let (left, right) = if middle.slope * left.slope <= 0.0 {
        (left, middle)
    } else if middle.slope * right.slope <= 0.0 {
        (middle, right)
    } else {
        // A corner of the piecewise polynomial at a mesh point: its ends are all there is.
        return if middle.slope > 0.0 { right.value } else { left.value };
    };
    let (mut a, mut slope_a, mut b, mut slope_b) = (left.time, left.slope, right.time, right.slope);
    let mut best = left.value;
    for _ in 0..MOST_ITERATIONS {
        if slope_a == slope_b {
            break;
        }
        let trial = (a * slope_b - b * slope_a) / (slope_b - slope_a);
        let (value, slope) = value_and_slope(collocation, unknown, component, trial);
        best = value;
        // An error of dt in the place changes the value by slope dt / 2 only.
        if slope.abs() * (b - a).abs() <= ROUNDING * size || !(a < trial && trial < b) {
            break;
        }
        if slope * slope_a <= 0.0 {
            (b, slope_b) = (trial, slope);
            slope_a *= 0.5;
        } else {
            (a, slope_a) = (trial, slope);
            slope_b *= 0.5;
        }
    }
    best
}

fn value_and_slope<P: PeriodicProblem>(
    collocation: &Collocation<P>,
    unknown: &[f64],
    component: usize,
    time: f64,
) -> (f64, f64) {
    let n = collocation.problem.dimension();
    let time = time - time.floor();
    let mesh = collocation.mesh();
    let interval = mesh[1..mesh.len() - 1].partition_point(|&point| point <= time);
    let width = mesh[interval + 1] - mesh[interval];
    let nodes = collocation.gauss().degree() + 1;
    let (mut basis, mut slopes) = ([0.0; MOST_NODES], [0.0; MOST_NODES]);
    let position = (time - mesh[interval]) / width;
    collocation.gauss().basis_with_slopes(position, &mut basis[..nodes], &mut slopes[..nodes]);
    let values = collocation.interval(unknown, interval);
    let sum = |weights: &[f64]| -> f64 {
        weights.iter().enumerate().map(|(node, weight)| weight * values[node * n + component]).sum()
    };
    (sum(&basis[..nodes]), sum(&slopes[..nodes]) / width)
}
