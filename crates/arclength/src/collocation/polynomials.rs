//! A function on the unit interval that is a polynomial on every interval of a mesh.

use super::gauss::Gauss;
use serde::{Deserialize, Serialize};
use std::ops::Range;

/// Most nodes of one interval.
pub(crate) const MOST_NODES: usize = 17;

/// A function of `n` components, given at the left end and at the Gauss points of every interval of a mesh.
#[derive(Clone, Copy)]
pub(crate) struct Polynomials<'a> {
    /// Mesh `0 = t_0 < ... < t_N = 1`.
    pub mesh: &'a [f64],
    /// The Gauss points.
    pub gauss: &'a Gauss,
    /// Number of components.
    pub n: usize,
    /// Values at the nodes; more numbers may follow.
    pub states: &'a [f64],
}

impl Polynomials<'_> {
    /// Times of the nodes.
    pub(crate) fn node_times(&self) -> Vec<f64> {
        let mut times = Vec::with_capacity((self.mesh.len() - 1) * (self.gauss.degree() + 1));
        for pair in self.mesh.windows(2) {
            times.push(pair[0]);
            times.extend(self.gauss.points.iter().map(|point| pair[0] + point * (pair[1] - pair[0])));
        }
        times
    }

    /// Slope of a component at a node.
    pub(crate) fn slope_at_node(&self, index: usize, component: usize) -> f64 {
        let count = self.gauss.degree() + 1;
        let (interval, node) = (index / count, index % count);
        let width = self.mesh[interval + 1] - self.mesh[interval];
        let values = self.states[interval * count * self.n..].iter().skip(component).step_by(self.n);
        let slopes = self.gauss.slopes_at_node(node);
        values.zip(slopes).map(|(value, slope)| value * slope).sum::<f64>() / width
    }

    /// Where a time in `[0, 1]` lies on the mesh.
    fn place(&self, time: f64) -> MeshPlace {
        let interval = self.mesh[1..self.mesh.len() - 1].partition_point(|&point| point <= time);
        let width = self.mesh[interval + 1] - self.mesh[interval];
        MeshPlace { interval, position: (time - self.mesh[interval]) / width, width }
    }

    /// Writes the state at a time in `[0, 1]`.
    pub(crate) fn state(&self, time: f64, state: &mut [f64]) {
        self.state_by(self.place(time).interval, time, state);
    }

    /// Writes the state at a time by the polynomial of the interval among some that is closest to it.
    pub(crate) fn state_within(&self, intervals: Range<usize>, time: f64, state: &mut [f64]) {
        let interval = self.place(time).interval;
        self.state_by(interval.clamp(intervals.start, intervals.end - 1), time, state);
    }

    /// Writes the state at a time by the polynomial of an interval.
    fn state_by(&self, interval: usize, time: f64, state: &mut [f64]) {
        let width = self.mesh[interval + 1] - self.mesh[interval];
        let position = (time - self.mesh[interval]) / width;
        let mut basis = [0.0; MOST_NODES];
        let basis = &mut basis[..self.gauss.degree() + 1];
        self.gauss.basis(position, basis);
        let size = basis.len() * self.n;
        combine(&self.states[interval * size..(interval + 1) * size], basis, state);
    }

    /// Value and slope of a component at a time in `[0, 1]`.
    pub(crate) fn component(&self, time: f64, component: usize) -> (f64, f64) {
        let mut found = (0.0, 0.0);
        self.components(time, component..component + 1, |_, value, slope| found = (value, slope));
        found
    }

    /// Tells values and slopes of some components at a time in `[0, 1]`.
    pub(crate) fn components(&self, time: f64, wanted: Range<usize>, mut tell: impl FnMut(usize, f64, f64)) {
        let MeshPlace { interval, position, width } = self.place(time);
        let nodes = self.gauss.degree() + 1;
        let (mut basis, mut slopes) = ([0.0; MOST_NODES], [0.0; MOST_NODES]);
        self.gauss.basis_with_slopes(position, &mut basis[..nodes], &mut slopes[..nodes]);
        let size = nodes * self.n;
        let values = &self.states[interval * size..(interval + 1) * size];
        for component in wanted {
            let sum = |weights: &[f64]| -> f64 {
                let values = values[component..].iter().step_by(self.n);
                values.zip(weights).map(|(value, weight)| weight * value).sum()
            };
            tell(component, sum(&basis[..nodes]), sum(&slopes[..nodes]) / width);
        }
    }
}

/// Where a time lies on a mesh.
struct MeshPlace {
    interval: usize,
    /// Position in the interval, as part of its width.
    position: f64,
    width: f64,
}

/// A function of several components on the unit interval, a polynomial on every interval of a mesh, as plain data.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct PiecewisePolynomial {
    /// Mesh `0 = t_0 < ... < t_N = 1`.
    pub mesh: Vec<f64>,
    /// Degree of the polynomials, 1 to 16.
    pub degree: usize,
    /// Number of components.
    pub dimension: usize,
    /// For every interval the values at its left end and at its Gauss points.
    pub states: Vec<f64>,
}

impl PiecewisePolynomial {
    /// The components at a time of the unit interval.
    pub fn at(&self, time: f64) -> Vec<f64> {
        let gauss = Gauss::of(self.degree);
        let mut state = vec![0.0; self.dimension];
        let polynomials =
            Polynomials { mesh: &self.mesh, gauss: &gauss, n: self.dimension, states: &self.states };
        polynomials.state(time, &mut state);
        state
    }
}

/// Linear combination of the node states of one interval.
pub(crate) fn combine(interval: &[f64], basis: &[f64], state: &mut [f64]) {
    match state.len() {
        1 => combine_few::<1>(interval, basis, state),
        2 => combine_few::<2>(interval, basis, state),
        3 => combine_few::<3>(interval, basis, state),
        4 => combine_few::<4>(interval, basis, state),
        5 => combine_few::<5>(interval, basis, state),
        6 => combine_few::<6>(interval, basis, state),
        n => {
            state.fill(0.0);
            for (values, weight) in interval.chunks_exact(n).zip(basis) {
                for (entry, value) in state.iter_mut().zip(values) {
                    *entry += weight * value;
                }
            }
        }
    }
}

/// The same of a number of components that the compiler knows, whose sums stay in registers.
#[inline(always)]
fn combine_few<const N: usize>(interval: &[f64], basis: &[f64], state: &mut [f64]) {
    let mut sums = [0.0; N];
    for (values, weight) in interval.as_chunks::<N>().0.iter().zip(basis) {
        for (sum, value) in sums.iter_mut().zip(values) {
            *sum += weight * value;
        }
    }
    state.copy_from_slice(&sums);
}
