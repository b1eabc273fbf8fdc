//! Gauss points, the implicit Runge-Kutta coefficients of collocation at them, and the interpolating
//! polynomial of one mesh interval.
//!
//! A collocation polynomial of degree `m` on `[0, 1]` is represented by its values at the nodes
//! `0, c_1, ..., c_m`, the `c_i` being the Gauss points. Sources: Hairer and Wanner, *Solving Ordinary
//! Differential Equations II* (1996), section IV.5; Berrut and Trefethen, "Barycentric Lagrange
//! interpolation" (2004).

use std::borrow::Cow;
use std::sync::OnceLock;

/// Largest degree of which the coefficients are kept: that of polynomials, and one more for the measurement of their error.
const LARGEST_KEPT: usize = 17;

/// Coefficients of Gauss collocation with `m` points on the unit interval.
#[derive(Clone, Debug)]
pub struct Gauss {
    /// The `m` Gauss points.
    pub points: Vec<f64>,
    /// Their quadrature weights, of sum one.
    pub weights: Vec<f64>,
    /// Runge-Kutta matrix: `integration[i * m + k]` is the integral of the `k`th Lagrange polynomial of
    /// the Gauss points from 0 to `c_i`.
    pub integration: Vec<f64>,
    /// Values at 1 of the Lagrange polynomials of the nodes `0, c_1, ..., c_m`.
    pub end: Vec<f64>,
    /// Nodes `0, c_1, ..., c_m`.
    nodes: Vec<f64>,
    /// Barycentric weights of the nodes.
    barycentric: Vec<f64>,
    /// Slopes at each node of the Lagrange polynomials of the nodes.
    node_slopes: Vec<f64>,
    /// `max |integral from 0 to t of (s - c_1) ... (s - c_m) ds|` over `t` in `[0, 1]`.
    pub largest_integral: f64,
}

impl Gauss {
    /// Coefficients for `degree` points, computed once for each degree up to 17 and anew for others.
    pub fn of(degree: usize) -> Cow<'static, Self> {
        static KEPT: [OnceLock<Gauss>; LARGEST_KEPT + 1] = [const { OnceLock::new() }; LARGEST_KEPT + 1];
        match KEPT.get(degree) {
            Some(kept) => Cow::Borrowed(kept.get_or_init(|| Self::new(degree))),
            None => Cow::Owned(Self::new(degree)),
        }
    }

    /// Coefficients for `degree` points, 1 to 16.
    pub fn new(degree: usize) -> Self {
        let (points, weights) = points_and_weights(degree);
        let point_weights = barycentric_weights(&points);
        let mut integration = vec![0.0; degree * degree];
        let mut basis = vec![0.0; degree];
        for (row, &end) in points.iter().enumerate() {
            // The quadrature is exact: the Lagrange polynomials have degree m - 1.
            for (point, weight) in points.iter().zip(&weights) {
                lagrange(&points, &point_weights, end * point, &mut basis);
                for (column, value) in basis.iter().enumerate() {
                    integration[row * degree + column] += end * weight * value;
                }
            }
        }
        let mut nodes = vec![0.0];
        nodes.extend(&points);
        let barycentric = barycentric_weights(&nodes);
        let mut end = vec![0.0; degree + 1];
        lagrange(&nodes, &barycentric, 1.0, &mut end);
        let mut gauss = Self {
            points,
            weights,
            integration,
            end,
            nodes,
            barycentric,
            node_slopes: Vec::new(),
            largest_integral: 0.0,
        };
        let mut slopes = vec![0.0; (degree + 1) * (degree + 1)];
        for (row, node) in slopes.chunks_exact_mut(degree + 1).zip(&gauss.nodes) {
            gauss.basis_slopes(*node, row);
        }
        gauss.node_slopes = slopes;
        // It is largest at a Gauss point, up to which the Gauss points integrate the polynomial of degree m exactly.
        let integral_to = |end: f64| -> f64 {
            let terms = gauss.points.iter().zip(&gauss.weights);
            terms.map(|(point, weight)| end * weight * gauss.node_polynomial(end * point)).sum()
        };
        gauss.largest_integral = gauss.points.iter().map(|&end| integral_to(end).abs()).fold(0.0, f64::max);
        gauss
    }

    /// Number of Gauss points.
    pub fn degree(&self) -> usize {
        self.points.len()
    }

    /// Writes the values at `position` of the Lagrange polynomials of the nodes into `basis` (length `m + 1`).
    pub fn basis(&self, position: f64, basis: &mut [f64]) {
        lagrange(&self.nodes, &self.barycentric, position, basis);
    }

    /// Writes the slopes at `position` of the Lagrange polynomials of the nodes into `slopes` (length `m + 1`).
    pub fn basis_slopes(&self, position: f64, slopes: &mut [f64]) {
        let nodes = &self.nodes;
        for (k, slope) in slopes.iter_mut().enumerate() {
            *slope = 0.0;
            for skipped in (0..nodes.len()).filter(|&skipped| skipped != k) {
                let product: f64 = (0..nodes.len())
                    .filter(|&index| index != k && index != skipped)
                    .map(|index| position - nodes[index])
                    .product();
                *slope += product;
            }
            *slope *= self.barycentric[k];
        }
    }

    /// Slopes at a node, counted from the start of the interval, of the Lagrange polynomials of the nodes.
    pub fn slopes_at_node(&self, node: usize) -> &[f64] {
        let nodes = self.nodes.len();
        &self.node_slopes[node * nodes..(node + 1) * nodes]
    }

    /// Writes values and slopes at `position` together; faster than the two separately.
    pub fn basis_with_slopes(&self, position: f64, basis: &mut [f64], slopes: &mut [f64]) {
        self.basis(position, basis);
        // Close to a node the short formula loses digits by cancellation.
        const CLOSE: f64 = 1e-5;
        if self.nodes.iter().any(|node| (position - node).abs() < CLOSE) {
            self.basis_slopes(position, slopes);
            return;
        }
        let sum: f64 = self.nodes.iter().map(|node| 1.0 / (position - node)).sum();
        for ((slope, value), node) in slopes.iter_mut().zip(basis.iter()).zip(&self.nodes) {
            *slope = value * (sum - 1.0 / (position - node));
        }
    }

    /// `prod (position - c_i)`, the shape of the residual of a collocation polynomial.
    pub fn node_polynomial(&self, position: f64) -> f64 {
        self.points.iter().map(|point| position - point).product()
    }
}

/// Gauss points and weights on `[0, 1]`, by Newton's method on the Legendre polynomial.
fn points_and_weights(degree: usize) -> (Vec<f64>, Vec<f64>) {
    const NEWTON_STEPS: usize = 100;
    let mut points = vec![0.0; degree];
    let mut weights = vec![0.0; degree];
    for index in 0..degree {
        let mut x = (std::f64::consts::PI * (index as f64 + 0.75) / (degree as f64 + 0.5)).cos();
        let mut slope = 1.0;
        for _ in 0..NEWTON_STEPS {
            let (mut lower, mut value) = (1.0, x);
            for k in 2..=degree {
                let next = ((2 * k - 1) as f64 * x * value - (k - 1) as f64 * lower) / k as f64;
                lower = value;
                value = next;
            }
            slope = degree as f64 * (x * value - lower) / (x * x - 1.0);
            let step = value / slope;
            x -= step;
            if step.abs() < 1e-16 {
                break;
            }
        }
        points[degree - 1 - index] = 0.5 * (1.0 + x);
        weights[degree - 1 - index] = 1.0 / ((1.0 - x * x) * slope * slope);
    }
    (points, weights)
}

fn barycentric_weights(nodes: &[f64]) -> Vec<f64> {
    nodes
        .iter()
        .enumerate()
        .map(|(k, node)| {
            let product: f64 = nodes
                .iter()
                .enumerate()
                .filter(|(index, _)| *index != k)
                .map(|(_, other)| node - other)
                .product();
            1.0 / product
        })
        .collect()
}

fn lagrange(nodes: &[f64], weights: &[f64], position: f64, basis: &mut [f64]) {
    if let Some(hit) = nodes.iter().position(|&node| node == position) {
        basis.fill(0.0);
        basis[hit] = 1.0;
        return;
    }
    let mut sum = 0.0;
    for ((entry, node), weight) in basis.iter_mut().zip(nodes).zip(weights) {
        *entry = weight / (position - node);
        sum += *entry;
    }
    basis.iter_mut().for_each(|entry| *entry /= sum);
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn integrates_and_interpolates_polynomials_exactly() {
        for degree in 1..=12 {
            let gauss = Gauss::new(degree);
            for power in 0..2 * degree as i32 {
                let sum: f64 = gauss.points.iter().zip(&gauss.weights).map(|(c, b)| b * c.powi(power)).sum();
                assert!((sum - 1.0 / f64::from(power + 1)).abs() < 2e-15, "degree {degree}, power {power}");
            }
            for power in 0..degree as i32 {
                for (row, end) in gauss.points.iter().enumerate() {
                    let integral: f64 = (0..degree)
                        .map(|k| gauss.integration[row * degree + k] * gauss.points[k].powi(power))
                        .sum();
                    assert!((integral - end.powi(power + 1) / f64::from(power + 1)).abs() < 1e-13);
                }
            }
            let mut basis = vec![0.0; degree + 1];
            let mut slopes = vec![0.0; degree + 1];
            for position in [0.0, 0.3, 0.77, 1.0] {
                gauss.basis(position, &mut basis);
                gauss.basis_slopes(position, &mut slopes);
                let power = degree as i32;
                let at = |coefficients: &[f64]| -> f64 {
                    coefficients.iter().zip(&gauss.nodes).map(|(c, node)| c * node.powi(power)).sum()
                };
                assert!((at(&basis) - position.powi(power)).abs() < 1e-12);
                assert!((at(&slopes) - f64::from(power) * position.powi(power - 1)).abs() < 1e-10);
            }
        }
    }
}
