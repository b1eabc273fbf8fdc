//! Orthogonal collocation of a periodic boundary value problem, with condensed linear algebra.
//!
//! The unit interval is divided by a mesh; on each interval the solution is a polynomial of degree `m` that
//! satisfies the equation at the `m` Gauss points. Unknowns, in this order: for every interval its left end
//! `u_j` (`n` numbers) and the values at its Gauss points (`m n` numbers); then the scalars. The interior
//! values of an interval depend on `u_j` and the scalars only, so each interval is condensed by one small
//! dense factorisation to `u_(j+1) = R_j u_j + Q_j s + rho_j`, and a [`Cyclic`] system is left. Sources: de
//! Boor and Swartz, "Collocation at Gaussian points" (1973); Ascher, Mattheij and Russell, *Numerical
//! Solution of Boundary Value Problems* (1995), section 5.6; Doedel, Keller and Kernevez (1991).

use super::cyclic::{Blocks, Cyclic};
use super::gauss::Gauss;
use super::problem::{PeriodicProblem, Reference};
use crate::differentiation::{Dual, Scalar};
use crate::linear::lu;
use pulp::Arch;

/// A discretised problem with the factors of its last linearisation.
#[derive(Debug, Clone)]
pub struct Collocation<P> {
    /// The problem.
    pub problem: P,
    gauss: Gauss,
    mesh: Vec<f64>,
    reference: Vec<f64>,
    reference_slope: Vec<f64>,
    /// LU factors of the interior systems, `(m n)^2` for each interval, and their pivots.
    factors: Vec<f64>,
    pivots: Vec<usize>,
    /// Interior response to `u_j` and the scalars: `m n` by `n + E` for each interval.
    response: Vec<f64>,
    transfer: Vec<f64>,
    scalar_columns: Vec<f64>,
    /// Gradients of the dense rows (conditions, then the border), without their scalar part.
    gradients: Vec<f64>,
    rows: Vec<f64>,
    corner: Vec<f64>,
    cyclic: Cyclic,
    arch: Arch,
}

impl<P: PeriodicProblem> Collocation<P> {
    /// Discretises on a mesh `0 = t_0 < ... < t_N = 1` with polynomials of the given degree.
    pub fn new(problem: P, mesh: Vec<f64>, degree: usize) -> Self {
        let size = (mesh.len() - 1) * degree * problem.dimension();
        Self {
            problem,
            gauss: Gauss::new(degree),
            mesh,
            reference: vec![0.0; size],
            reference_slope: vec![0.0; size],
            factors: Vec::new(),
            pivots: Vec::new(),
            response: Vec::new(),
            transfer: Vec::new(),
            scalar_columns: Vec::new(),
            gradients: Vec::new(),
            rows: Vec::new(),
            corner: Vec::new(),
            cyclic: Cyclic::default(),
            arch: Arch::new(),
        }
    }

    /// Number of mesh intervals.
    pub fn intervals(&self) -> usize {
        self.mesh.len() - 1
    }

    /// Mesh points, first 0 and last 1.
    pub fn mesh(&self) -> &[f64] {
        &self.mesh
    }

    /// Gauss points and coefficients.
    pub fn gauss(&self) -> &Gauss {
        &self.gauss
    }

    /// Number of unknowns of one interval: left end and interior values.
    pub fn interval_size(&self) -> usize {
        (self.gauss.degree() + 1) * self.problem.dimension()
    }

    /// Number of unknowns.
    pub fn unknowns(&self) -> usize {
        self.intervals() * self.interval_size() + self.problem.scalars()
    }

    /// The condensed blocks `R_j` of the last factorisation, n-by-n column-major, one after the other.
    pub fn transfer(&self) -> &[f64] {
        &self.transfer
    }

    /// Interior values, at the Gauss points of interval `interval`, of the linearised flow with start `start`
    /// at the interval's left end (of the last factorisation).
    pub fn interior_response(&self, interval: usize, start: &[f64], interior: &mut [f64]) {
        let n = self.problem.dimension();
        let rows = self.gauss.degree() * n;
        let response = &self.response[interval * rows * (n + self.problem.scalars())..];
        interior.fill(0.0);
        for (column, factor) in response.chunks_exact(rows).zip(start) {
            for (entry, value) in interior.iter_mut().zip(column) {
                *entry += factor * value;
            }
        }
    }

    /// Makes `unknown` the solution that phase and normalisation conditions refer to.
    pub fn set_reference(&mut self, unknown: &[f64]) {
        let n = self.problem.dimension();
        let degree = self.gauss.degree();
        let size = self.interval_size();
        let (states, scalars) = unknown.split_at(self.intervals() * size);
        self.reference.resize(self.intervals() * degree * n, 0.0);
        self.reference_slope.resize(self.intervals() * degree * n, 0.0);
        for (interval, states) in states.chunks_exact(size).enumerate() {
            let target = interval * degree * n;
            self.reference[target..target + degree * n].copy_from_slice(&states[n..]);
            for point in 0..degree {
                let slope = &mut self.reference_slope[target + point * n..target + (point + 1) * n];
                self.problem.field(&states[n * (point + 1)..n * (point + 2)], scalars, slope);
            }
        }
    }

    /// Writes the residual: for every interval the continuity at its right end (`n`) and the collocation
    /// equations (`m n`), then the conditions; the entry of the border is not touched.
    pub fn residual(&mut self, unknown: &[f64], residual: &mut [f64]) {
        let arch = self.arch;
        arch.dispatch(
            #[inline(always)]
            || self.residual_kernel(unknown, residual),
        );
    }

    #[inline(always)]
    fn residual_kernel(&mut self, unknown: &[f64], residual: &mut [f64]) {
        let n = self.problem.dimension();
        let degree = self.gauss.degree();
        let size = self.interval_size();
        let (states, scalars) = unknown.split_at(self.intervals() * size);
        let conditions = scalars.len() - 1;
        let (interval_residuals, condition_residuals) = residual.split_at_mut(self.intervals() * size);
        condition_residuals[..conditions].fill(0.0);
        let mut values = vec![0.0; degree * n];
        let mut integrands = vec![0.0; conditions];
        for interval in 0..self.intervals() {
            let width = self.mesh[interval + 1] - self.mesh[interval];
            let here = &states[interval * size..(interval + 1) * size];
            for point in 0..degree {
                let state = &here[n * (point + 1)..n * (point + 2)];
                self.problem.field(state, scalars, &mut values[point * n..(point + 1) * n]);
                let reference = self.reference_at(interval * degree + point);
                self.problem.integrands(state, scalars, reference, &mut integrands);
                let weight = width * self.gauss.weights[point];
                for (sum, value) in condition_residuals.iter_mut().zip(&integrands) {
                    *sum += weight * value;
                }
            }
            let target = &mut interval_residuals[interval * size..(interval + 1) * size];
            self.interval_residual(interval, states, &values, target);
        }
    }

    /// Continuity and collocation residuals of one interval, from the field's values at its Gauss points.
    #[inline(always)]
    fn interval_residual(&self, interval: usize, states: &[f64], values: &[f64], target: &mut [f64]) {
        let n = self.problem.dimension();
        let degree = self.gauss.degree();
        let size = self.interval_size();
        let width = self.mesh[interval + 1] - self.mesh[interval];
        let here = &states[interval * size..(interval + 1) * size];
        let last = interval + 1 == self.intervals();
        let next =
            if last { &states[..n] } else { &states[(interval + 1) * size..(interval + 1) * size + n] };
        for component in 0..n {
            let sign = if last && self.problem.is_antiperiodic(component) { -1.0 } else { 1.0 };
            let end: f64 = self
                .gauss
                .end
                .iter()
                .enumerate()
                .map(|(node, weight)| weight * here[node * n + component])
                .sum();
            target[component] = sign * next[component] - end;
        }
        for point in 0..degree {
            for component in 0..n {
                let integral: f64 = (0..degree)
                    .map(|k| self.gauss.integration[point * degree + k] * values[k * n + component])
                    .sum();
                target[(point + 1) * n + component] =
                    here[(point + 1) * n + component] - here[component] - width * integral;
            }
        }
    }

    #[inline(always)]
    fn reference_at(&self, index: usize) -> Reference<'_> {
        let n = self.problem.dimension();
        Reference {
            state: &self.reference[index * n..(index + 1) * n],
            slope: &self.reference_slope[index * n..(index + 1) * n],
        }
    }

    /// Linearises at `unknown`, bordered by `border`, writes the residual and factorises.
    ///
    /// Returns the sign of the determinant of the system reduced to one state and the scalars, zero if singular.
    pub fn factorize(&mut self, unknown: &[f64], border: &[f64], residual: &mut [f64]) -> f64 {
        let arch = self.arch;
        let directions = self.problem.dimension() + self.problem.scalars();
        arch.dispatch(
            #[inline(always)]
            || {
                if directions <= 4 {
                    self.factorize_kernel::<4>(unknown, border, residual)
                } else {
                    self.factorize_kernel::<8>(unknown, border, residual)
                }
            },
        )
    }

    #[inline(always)]
    fn factorize_kernel<const D: usize>(
        &mut self,
        unknown: &[f64],
        border: &[f64],
        residual: &mut [f64],
    ) -> f64 {
        let n = self.problem.dimension();
        let e = self.problem.scalars();
        let degree = self.gauss.degree();
        let inner = degree * n;
        let columns = n + e;
        let size = self.interval_size();
        let intervals = self.intervals();
        let conditions = e - 1;
        self.factors.resize(intervals * inner * inner, 0.0);
        self.pivots.resize(intervals * inner, 0);
        self.response.resize(intervals * inner * columns, 0.0);
        self.transfer.resize(intervals * n * n, 0.0);
        self.scalar_columns.resize(intervals * n * e, 0.0);
        self.gradients.resize(e * intervals * size, 0.0);
        self.rows.resize(e * intervals * n, 0.0);
        self.corner.clear();
        self.corner.resize(e * e, 0.0);
        let (states, scalars) = unknown.split_at(intervals * size);
        self.gradients[conditions * intervals * size..].copy_from_slice(&border[..intervals * size]);
        self.corner[conditions * e..].copy_from_slice(&border[intervals * size..]);
        let (interval_residuals, condition_residuals) = residual.split_at_mut(intervals * size);
        condition_residuals[..conditions].fill(0.0);

        let mut dual_state = vec![Dual::<f64, D>::zero(); n];
        let mut dual_scalars = vec![Dual::<f64, D>::zero(); e];
        let mut dual_values = vec![Dual::<f64, D>::zero(); n];
        let mut dual_integrands = vec![Dual::<f64, D>::zero(); conditions];
        let mut values = vec![0.0; inner];
        // Derivatives of the field at the Gauss points: n by (n + E) each, column-major.
        let mut derivatives = vec![0.0; degree * n * columns];
        for interval in 0..intervals {
            let width = self.mesh[interval + 1] - self.mesh[interval];
            let here = &states[interval * size..(interval + 1) * size];
            for point in 0..degree {
                let state = &here[n * (point + 1)..n * (point + 2)];
                let weight = width * self.gauss.weights[point];
                let node = interval * degree + point;
                let reference = Reference {
                    state: &self.reference[node * n..(node + 1) * n],
                    slope: &self.reference_slope[node * n..(node + 1) * n],
                };
                let mut first = 0;
                while first < columns {
                    for (index, (dual, value)) in dual_state.iter_mut().zip(state).enumerate() {
                        *dual = Dual::variable(*value, index.wrapping_sub(first));
                    }
                    for (index, (dual, value)) in dual_scalars.iter_mut().zip(scalars).enumerate() {
                        *dual = Dual::variable(*value, (n + index).wrapping_sub(first));
                    }
                    self.problem.field(&dual_state, &dual_scalars, &mut dual_values);
                    self.problem.integrands(&dual_state, &dual_scalars, reference, &mut dual_integrands);
                    let count = D.min(columns - first);
                    for direction in 0..count {
                        let column = first + direction;
                        let target = &mut derivatives[(point * columns + column) * n..][..n];
                        for (entry, dual) in target.iter_mut().zip(&dual_values) {
                            *entry = dual.derivatives[direction];
                        }
                        for (row, dual) in dual_integrands.iter().enumerate() {
                            let slope = weight * dual.derivatives[direction];
                            if column < n {
                                let position =
                                    row * intervals * size + interval * size + (point + 1) * n + column;
                                self.gradients[position] = slope;
                            } else {
                                self.corner[row * e + column - n] += slope;
                            }
                        }
                    }
                    if first == 0 {
                        for (entry, dual) in values[point * n..(point + 1) * n].iter_mut().zip(&dual_values) {
                            *entry = dual.value;
                        }
                        for (sum, dual) in condition_residuals.iter_mut().zip(&dual_integrands) {
                            *sum += weight * dual.value;
                        }
                    }
                    first += D;
                }
            }
            let target = &mut interval_residuals[interval * size..(interval + 1) * size];
            self.interval_residual(interval, states, &values, target);
            if !self.condense(interval, width, &derivatives) {
                return 0.0;
            }
        }
        for row in 0..conditions {
            for interval in 0..intervals {
                let start = row * intervals * size + interval * size;
                self.gradients[start..start + n].fill(0.0);
            }
        }
        self.reduce_rows();
        let signs: Vec<f64> = (0..n)
            .map(|component| if self.problem.is_antiperiodic(component) { -1.0 } else { 1.0 })
            .collect();
        let blocks = Blocks {
            transfer: &self.transfer,
            scalar_columns: &self.scalar_columns,
            rows: &self.rows,
            corner: &self.corner,
            signs: &signs,
        };
        self.cyclic.factorize(blocks, n, e, intervals)
    }

    /// Factorises the interior system of an interval and forms its response and transfer blocks.
    #[inline(always)]
    fn condense(&mut self, interval: usize, width: f64, derivatives: &[f64]) -> bool {
        let n = self.problem.dimension();
        let e = self.problem.scalars();
        let degree = self.gauss.degree();
        let inner = degree * n;
        let columns = n + e;
        let matrix = &mut self.factors[interval * inner * inner..(interval + 1) * inner * inner];
        // Column (k, c) of the interior system: unit vector minus width a_ik df/dy_c at Gauss point k.
        for k in 0..degree {
            for component in 0..n {
                let slope = &derivatives[(k * columns + component) * n..][..n];
                let target = &mut matrix[(k * n + component) * inner..][..inner];
                for (i, block) in target.chunks_exact_mut(n).enumerate() {
                    let factor = -width * self.gauss.integration[i * degree + k];
                    for (entry, value) in block.iter_mut().zip(slope) {
                        *entry = factor * value;
                    }
                }
                target[k * n + component] += 1.0;
            }
        }
        let response = &mut self.response[interval * inner * columns..(interval + 1) * inner * columns];
        response.fill(0.0);
        for component in 0..n {
            for point in 0..degree {
                response[component * inner + point * n + component] = 1.0;
            }
        }
        for scalar in 0..e {
            let target = &mut response[(n + scalar) * inner..(n + scalar + 1) * inner];
            for k in 0..degree {
                let slope = &derivatives[(k * columns + n + scalar) * n..][..n];
                for (i, block) in target.chunks_exact_mut(n).enumerate() {
                    let factor = width * self.gauss.integration[i * degree + k];
                    for (entry, value) in block.iter_mut().zip(slope) {
                        *entry += factor * value;
                    }
                }
            }
        }
        let pivots = &mut self.pivots[interval * inner..(interval + 1) * inner];
        if lu::factorize(matrix, inner, pivots) == 0.0 {
            return false;
        }
        lu::solve(matrix, inner, pivots, response);
        for (column, interior) in response.chunks_exact(inner).enumerate() {
            let target = if column < n {
                &mut self.transfer[(interval * n + column) * n..][..n]
            } else {
                &mut self.scalar_columns[(interval * e + column - n) * n..][..n]
            };
            target.fill(0.0);
            if column < n {
                target[column] = self.gauss.end[0];
            }
            for (block, weight) in interior.chunks_exact(n).zip(&self.gauss.end[1..]) {
                for (entry, value) in target.iter_mut().zip(block) {
                    *entry += weight * value;
                }
            }
        }
        true
    }

    /// Expresses the dense rows by the left ends and the scalars.
    #[inline(always)]
    fn reduce_rows(&mut self) {
        let n = self.problem.dimension();
        let e = self.problem.scalars();
        let inner = self.gauss.degree() * n;
        let size = self.interval_size();
        let intervals = self.intervals();
        for row in 0..e {
            for interval in 0..intervals {
                let gradient = &self.gradients[(row * intervals + interval) * size..][..size];
                let response = &self.response[interval * inner * (n + e)..(interval + 1) * inner * (n + e)];
                for (column, interior) in response.chunks_exact(inner).enumerate() {
                    let sum: f64 = gradient[n..].iter().zip(interior).map(|(a, b)| a * b).sum();
                    if column < n {
                        self.rows[(row * intervals + interval) * n + column] = gradient[column] + sum;
                    } else {
                        self.corner[row * e + column - n] += sum;
                    }
                }
            }
        }
    }

    /// Solves with the last factorisation, in place; the last entry belongs to the border.
    pub fn solve(&mut self, right_hand_side: &mut [f64]) {
        let arch = self.arch;
        arch.dispatch(
            #[inline(always)]
            || self.solve_kernel(right_hand_side),
        );
    }

    #[inline(always)]
    fn solve_kernel(&mut self, right_hand_side: &mut [f64]) {
        let n = self.problem.dimension();
        let e = self.problem.scalars();
        let inner = self.gauss.degree() * n;
        let size = self.interval_size();
        let intervals = self.intervals();
        let (blocks, scalars) = right_hand_side.split_at_mut(intervals * size);
        let mut states = vec![0.0; intervals * n];
        for (interval, block) in blocks.chunks_exact_mut(size).enumerate() {
            let (end, interior) = block.split_at_mut(n);
            let factors = &self.factors[interval * inner * inner..(interval + 1) * inner * inner];
            let pivots = &self.pivots[interval * inner..(interval + 1) * inner];
            lu::solve(factors, inner, pivots, interior);
            let target = &mut states[interval * n..(interval + 1) * n];
            target.copy_from_slice(end);
            for (values, weight) in interior.chunks_exact(n).zip(&self.gauss.end[1..]) {
                for (entry, value) in target.iter_mut().zip(values) {
                    *entry += weight * value;
                }
            }
            for (row, scalar) in scalars.iter_mut().enumerate() {
                let gradient = &self.gradients[(row * intervals + interval) * size..][..size];
                *scalar -= gradient[n..].iter().zip(interior.iter()).map(|(a, b)| a * b).sum::<f64>();
            }
        }
        self.cyclic.solve(&mut states, scalars);
        for (interval, block) in blocks.chunks_exact_mut(size).enumerate() {
            let start = &states[interval * n..(interval + 1) * n];
            let (end, interior) = block.split_at_mut(n);
            end.copy_from_slice(start);
            let response = &self.response[interval * inner * (n + e)..(interval + 1) * inner * (n + e)];
            let coefficients = start.iter().chain(scalars.iter());
            for (column, coefficient) in response.chunks_exact(inner).zip(coefficients) {
                for (entry, value) in interior.iter_mut().zip(column) {
                    *entry += coefficient * value;
                }
            }
        }
    }

    /// Writes the state at time `time` in `[0, 1]` of the piecewise polynomial `unknown`.
    pub fn evaluate(&self, unknown: &[f64], time: f64, state: &mut [f64]) {
        let interval = self.mesh[1..self.mesh.len() - 1].partition_point(|&point| point <= time);
        let width = self.mesh[interval + 1] - self.mesh[interval];
        let mut basis = [0.0; MOST_NODES];
        let basis = &mut basis[..self.gauss.degree() + 1];
        self.gauss.basis((time - self.mesh[interval]) / width, basis);
        combine(self.interval(unknown, interval), basis, state);
    }

    /// The unknowns of one interval.
    pub fn interval<'a>(&self, unknown: &'a [f64], interval: usize) -> &'a [f64] {
        let size = self.interval_size();
        &unknown[interval * size..(interval + 1) * size]
    }

    /// Carries a vector over to another mesh of the same degree by interpolation.
    pub fn carry(&self, unknown: &[f64], mesh: &[f64]) -> Vec<f64> {
        let n = self.problem.dimension();
        let mut carried = vec![0.0; (mesh.len() - 1) * self.interval_size()];
        for (pair, target) in mesh.windows(2).zip(carried.chunks_exact_mut(self.interval_size())) {
            let (left, interior) = target.split_at_mut(n);
            self.evaluate(unknown, pair[0], left);
            for (state, point) in interior.chunks_exact_mut(n).zip(&self.gauss.points) {
                self.evaluate(unknown, pair[0] + point * (pair[1] - pair[0]), state);
            }
        }
        carried.extend_from_slice(&unknown[self.intervals() * self.interval_size()..]);
        carried
    }

    /// Replaces the mesh; vectors have to be [carried](Self::carry) before. The reference is carried here.
    pub fn set_mesh(&mut self, mesh: Vec<f64>, unknown: &[f64]) {
        self.mesh = mesh;
        self.set_reference(unknown);
    }
}

/// Most nodes of one interval.
pub(super) const MOST_NODES: usize = 17;

/// Linear combination of the node states of one interval.
pub(super) fn combine(interval: &[f64], basis: &[f64], state: &mut [f64]) {
    let n = state.len();
    state.fill(0.0);
    for (values, weight) in interval.chunks_exact(n).zip(basis) {
        for (entry, value) in state.iter_mut().zip(values) {
            *entry += weight * value;
        }
    }
}
