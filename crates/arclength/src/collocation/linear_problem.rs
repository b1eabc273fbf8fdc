//! Linear periodic problems with bordering, on the mesh of a cycle.
//!
//! Normal forms and starts of new branches ask for solutions of
//!
//! ```text
//! y' = M(t) y + sum_k s_k c_k(t) + g(t),   y(1) = +-y(0),   integral of <r_k, y> = d_k
//! ```
//!
//! with as many scalars `s_k` as conditions. `M` comes from the linearisation along the cycle and is singular as a periodic
//! problem; columns `c_k` and rows `r_k` make it regular, and the scalars that come out are what solvability demands (Govaerts,
//! *Numerical Methods for Bifurcations of Dynamical Equilibria* (2000), chapter 3). The discretisation is that of the cycle.

use super::condensation::{Condensation, Jump};
use super::gauss::Gauss;
use super::interior::Structure;

/// A function with `n` components on all nodes of a mesh: for every interval its left end and its Gauss points.
pub(crate) type NodeFunction = Vec<f64>;

/// A factorised bordered linear problem.
pub(crate) struct LinearProblem {
    mesh: Vec<f64>,
    components: usize,
    condensation: Condensation,
    scalars: usize,
}

/// The mesh and the nodes on it, with the jumps at its points.
#[derive(Clone, Copy)]
pub(crate) struct Nodes<'a> {
    pub mesh: &'a [f64],
    pub gauss: &'a Gauss,
    /// Jumps at the ends of intervals: what solutions are multiplied by there.
    pub jumps: &'a [Jump],
}

impl Nodes<'_> {
    /// Number of nodes, left ends included.
    pub(crate) fn count(self) -> usize {
        (self.mesh.len() - 1) * (self.gauss.degree() + 1)
    }

    /// For every Gauss point its interval, its index among all nodes and its quadrature weight.
    pub(crate) fn gauss_points(self) -> impl Iterator<Item = (usize, usize, f64)> {
        let degree = self.gauss.degree();
        self.mesh.windows(2).enumerate().flat_map(move |(interval, pair)| {
            (0..degree).map(move |point| {
                let weight = (pair[1] - pair[0]) * self.gauss.weights[point];
                (interval, interval * (degree + 1) + point + 1, weight)
            })
        })
    }

    /// Integral over the unit interval of the product of two functions.
    pub(crate) fn product(self, one: &[f64], other: &[f64]) -> f64 {
        let n = one.len() / self.count();
        self.gauss_points()
            .map(|(_, node, weight)| {
                let range = node * n..(node + 1) * n;
                weight * one[range.clone()].iter().zip(&other[range]).map(|(a, b)| a * b).sum::<f64>()
            })
            .sum()
    }
}

impl LinearProblem {
    /// Factorises the problem with the `signs` of `y(1) = +-y(0)`. `matrices` holds `M` at every Gauss point (`n` by `n`,
    /// column-major); `columns` and `rows` are the functions `c_k` and `r_k`. `None` if the problem is
    /// singular.
    pub(crate) fn new(
        nodes: Nodes<'_>,
        signs: Vec<f64>,
        matrices: &[f64],
        columns: &[&[f64]],
        rows: &[&[f64]],
    ) -> Option<Self> {
        let n = signs.len();
        let scalars = columns.len();
        let degree = nodes.gauss.degree();
        let intervals = nodes.mesh.len() - 1;
        let size = (degree + 1) * n;
        let mut condensation = Condensation::new(degree, [n, scalars, n], Structure::Dense);
        condensation.prepare(intervals);
        for (component, sign) in signs.iter().enumerate() {
            condensation.boundary[component * (n + 1)] = 1.0;
            condensation.boundary[n * n + component * (n + 1)] = -sign;
        }
        for (point, (_, node, weight)) in nodes.gauss_points().enumerate() {
            let target = &mut condensation.derivatives[point * n * (n + scalars)..][..n * (n + scalars)];
            target[..n * n].copy_from_slice(&matrices[point * n * n..(point + 1) * n * n]);
            for (column, target) in columns.iter().zip(target[n * n..].chunks_exact_mut(n)) {
                target.copy_from_slice(&column[node * n..(node + 1) * n]);
            }
            for (index, row) in rows.iter().enumerate() {
                let target = &mut condensation.gradients[index * intervals * size + node * n..][..n];
                for (entry, value) in target.iter_mut().zip(&row[node * n..]) {
                    *entry = weight * value;
                }
            }
        }
        for index in 0..scalars {
            for interval in 0..intervals {
                condensation.gradients[(index * intervals + interval) * size..][..n].fill(0.0);
            }
        }
        condensation.jumps = nodes.jumps.iter().map(|jump| jump.of_states(n, scalars)).collect();
        let problem = Self { mesh: nodes.mesh.to_vec(), components: n, condensation, scalars };
        problem.factorized()
    }

    fn factorized(mut self) -> Option<Self> {
        (self.condensation.factorize(&self.mesh) != 0.0).then_some(self)
    }

    /// The solution for the inhomogeneity `g` (on all nodes) and the values `d_k` of the conditions: function and scalars.
    pub(crate) fn solve(
        &mut self,
        inhomogeneity: &[f64],
        values: &[f64],
    ) -> Option<(NodeFunction, Vec<f64>)> {
        let n = self.components;
        let degree = self.condensation.gauss().degree();
        let size = (degree + 1) * n;
        let mut unknown = vec![0.0; inhomogeneity.len()];
        for (interval, pair) in self.mesh.windows(2).enumerate() {
            let width = pair[1] - pair[0];
            let source = &inhomogeneity[interval * size + n..(interval + 1) * size];
            let target = &mut unknown[interval * size + n..(interval + 1) * size];
            for (row, entry) in target.chunks_exact_mut(n).enumerate() {
                for (column, value) in source.chunks_exact(n).enumerate() {
                    let weight = width * self.condensation.gauss().integration[row * degree + column];
                    for (entry, value) in entry.iter_mut().zip(value) {
                        *entry += weight * value;
                    }
                }
            }
        }
        unknown.extend_from_slice(values);
        self.condensation.solve(&mut unknown);
        let scalars = unknown.split_off(unknown.len() - self.scalars);
        let finite = unknown.iter().chain(&scalars).all(|value| value.is_finite());
        finite.then_some((unknown, scalars))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::PI;

    #[test]
    fn a_forced_oscillation() {
        // y' = -y + s + cos(2 pi t), mean of y = 3: s = 3 and the response of a first-order lag.
        let gauss = Gauss::new(7);
        let mesh: Vec<f64> = [0.0, 0.1, 0.25, 0.4, 0.6, 0.8, 1.0].to_vec();
        let nodes = Nodes { mesh: &mesh, gauss: &gauss, jumps: &[] };
        let times: Vec<f64> = mesh
            .windows(2)
            .flat_map(|pair| {
                std::iter::once(pair[0])
                    .chain(gauss.points.iter().map(move |point| pair[0] + point * (pair[1] - pair[0])))
            })
            .collect();
        let ones = vec![1.0; nodes.count()];
        let minus = vec![-1.0; nodes.count()];
        let forcing: Vec<f64> = times.iter().map(|t| (2.0 * PI * t).cos()).collect();
        let mut problem = LinearProblem::new(nodes, vec![1.0], &minus, &[&ones], &[&ones]).expect("regular");
        let (response, scalars) = problem.solve(&forcing, &[3.0]).expect("finite");
        assert!((scalars[0] - 3.0).abs() < 1e-8);
        let omega = 2.0 * PI;
        for (time, value) in times.iter().zip(&response) {
            let exact = 3.0 + ((omega * time).cos() + omega * (omega * time).sin()) / (1.0 + omega * omega);
            assert!((value - exact).abs() < 1e-8, "{time}: {value} instead of {exact}");
        }
    }

    #[test]
    fn an_antiperiodic_problem() {
        // y' = (1 + s) cos(pi t), antiperiodic: y = (1 + s) sin(pi t) / pi; its product with the sine fixes s.
        let gauss = Gauss::new(6);
        let mesh: Vec<f64> = (0..=6).map(|index| f64::from(index) / 6.0).collect();
        let nodes = Nodes { mesh: &mesh, gauss: &gauss, jumps: &[] };
        let times: Vec<f64> = mesh
            .windows(2)
            .flat_map(|pair| {
                std::iter::once(pair[0])
                    .chain(gauss.points.iter().map(move |point| pair[0] + point * (pair[1] - pair[0])))
            })
            .collect();
        let forcing: Vec<f64> = times.iter().map(|t| (PI * t).cos()).collect();
        let sine: Vec<f64> = times.iter().map(|t| (PI * t).sin()).collect();
        let zeros = vec![0.0; nodes.count()];
        let mut problem =
            LinearProblem::new(nodes, vec![-1.0], &zeros, &[&forcing], &[&sine]).expect("regular");
        let (response, scalars) = problem.solve(&forcing, &[0.25]).expect("finite");
        assert!((scalars[0] - (0.5 * PI - 1.0)).abs() < 1e-8);
        for (exact, value) in sine.iter().zip(&response) {
            assert!((value - 0.5 * exact).abs() < 1e-8);
        }
    }
}
