//! Orthogonal collocation of a periodic boundary value problem, with condensed linear algebra.
//!
//! The unit interval is divided by a mesh; on each interval the solution is a polynomial of degree `m` that
//! satisfies the equation at the `m` Gauss points. Unknowns, in this order: for every interval its left end
//! `u_j` (`n` numbers) and the values at its Gauss points (`m n` numbers); then the scalars. The interior
//! values of an interval depend on `u_j` and the scalars only, so each interval is condensed by one small
//! dense factorisation to `u_(j+1) = R_j u_j + Q_j s + rho_j`, and a cyclic system is left. Sources: de
//! Boor and Swartz, "Collocation at Gaussian points" (1973); Ascher, Mattheij and Russell, *Numerical
//! Solution of Boundary Value Problems* (1995), section 5.6; Doedel, Keller and Kernevez (1991).

use super::condensation::Condensation;
use super::gauss::Gauss;
use super::problem::{PeriodicProblem, Reference};
use crate::differentiation::{Dual, Scalar};

/// A discretised problem with the factors of its last linearisation.
#[derive(Debug, Clone)]
pub struct Collocation<P> {
    /// The problem.
    pub problem: P,
    mesh: Vec<f64>,
    reference: Vec<f64>,
    reference_slope: Vec<f64>,
    condensation: Condensation,
}

/// Memory for the evaluation of field and integrands with derivatives in up to `D` directions at a time.
struct DualWorkspace<const D: usize> {
    state: Vec<Dual<f64, D>>,
    scalars: Vec<Dual<f64, D>>,
    values: Vec<Dual<f64, D>>,
    integrands: Vec<Dual<f64, D>>,
}

impl<const D: usize> DualWorkspace<D> {
    fn new(n: usize, scalars: usize) -> Self {
        Self {
            state: vec![Dual::zero(); n],
            scalars: vec![Dual::zero(); scalars],
            values: vec![Dual::zero(); n],
            integrands: vec![Dual::zero(); scalars - 1],
        }
    }
}

/// Directions of the narrow and of the wide workspace.
const NARROW: usize = 4;
const WIDE: usize = 8;

impl<P: PeriodicProblem> Collocation<P> {
    /// Discretises on a mesh `0 = t_0 < ... < t_N = 1` with polynomials of the given degree.
    pub fn new(problem: P, mesh: Vec<f64>, degree: usize) -> Self {
        let n = problem.dimension();
        let size = (mesh.len() - 1) * degree * n;
        let sign = |component| if problem.is_antiperiodic(component) { -1.0 } else { 1.0 };
        let signs = (0..n).map(sign).collect();
        Self {
            condensation: Condensation::new(degree, n, problem.scalars(), signs),
            problem,
            mesh,
            reference: vec![0.0; size],
            reference_slope: vec![0.0; size],
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
        &self.condensation.gauss
    }

    /// Number of unknowns of one interval: left end and interior values.
    pub fn interval_size(&self) -> usize {
        (self.gauss().degree() + 1) * self.problem.dimension()
    }

    /// Number of unknowns.
    pub fn unknowns(&self) -> usize {
        self.intervals() * self.interval_size() + self.problem.scalars()
    }

    /// The condensed blocks `R_j` of the last factorisation, n-by-n column-major, one after the other.
    pub fn transfer(&self) -> &[f64] {
        self.condensation.transfer()
    }

    /// Derivatives of the field at the Gauss points of the last factorisation: for every point `n` by `n + E`, column-major.
    pub fn derivatives(&self) -> &[f64] {
        &self.condensation.derivatives
    }

    /// Interior values, at the Gauss points of interval `interval`, of the linearised flow with start `start`
    /// at the interval's left end (of the last factorisation).
    pub fn interior_response(&self, interval: usize, start: &[f64], interior: &mut [f64]) {
        self.condensation.interior_response(interval, start, interior);
    }

    /// Makes `unknown` the solution that phase and normalisation conditions refer to.
    pub fn set_reference(&mut self, unknown: &[f64]) {
        let n = self.problem.dimension();
        let degree = self.gauss().degree();
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
        let n = self.problem.dimension();
        let degree = self.gauss().degree();
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
                let weight = width * self.gauss().weights[point];
                for (sum, value) in condition_residuals.iter_mut().zip(&integrands) {
                    *sum += weight * value;
                }
            }
            let target = &mut interval_residuals[interval * size..(interval + 1) * size];
            self.interval_residual(interval, states, &values, target);
        }
    }

    /// Continuity and collocation residuals of one interval, from the field's values at its Gauss points.
    fn interval_residual(&self, interval: usize, states: &[f64], values: &[f64], target: &mut [f64]) {
        let n = self.problem.dimension();
        let degree = self.gauss().degree();
        let size = self.interval_size();
        let width = self.mesh[interval + 1] - self.mesh[interval];
        let here = &states[interval * size..(interval + 1) * size];
        let last = interval + 1 == self.intervals();
        let next =
            if last { &states[..n] } else { &states[(interval + 1) * size..(interval + 1) * size + n] };
        for component in 0..n {
            let sign = if last && self.problem.is_antiperiodic(component) { -1.0 } else { 1.0 };
            let end: f64 = self
                .gauss()
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
                    .map(|k| self.gauss().integration[point * degree + k] * values[k * n + component])
                    .sum();
                target[(point + 1) * n + component] =
                    here[(point + 1) * n + component] - here[component] - width * integral;
            }
        }
    }

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
        let n = self.problem.dimension();
        let e = self.problem.scalars();
        let degree = self.gauss().degree();
        let size = self.interval_size();
        let intervals = self.intervals();
        let conditions = e - 1;
        self.condensation.prepare(intervals);
        let (states, scalars) = unknown.split_at(intervals * size);
        for row in 0..conditions {
            for interval in 0..intervals {
                let start = (row * intervals + interval) * size;
                self.condensation.gradients[start..start + n].fill(0.0);
            }
        }
        self.condensation.gradients[conditions * intervals * size..]
            .copy_from_slice(&border[..intervals * size]);
        self.condensation.corner[conditions * e..].copy_from_slice(&border[intervals * size..]);
        let (interval_residuals, condition_residuals) = residual.split_at_mut(intervals * size);
        condition_residuals[..conditions].fill(0.0);
        let directions =
            (0..n + e).filter(|&column| Some(column) != self.problem.factor().map(|index| n + index));
        let directions: Vec<usize> = directions.collect();
        let mut narrow = DualWorkspace::<NARROW>::new(n, e);
        let mut wide = DualWorkspace::<WIDE>::new(n, e);
        let mut values = vec![0.0; degree * n];
        for interval in 0..intervals {
            let here = &states[interval * size..(interval + 1) * size];
            for point in 0..degree {
                let state = &here[n * (point + 1)..n * (point + 2)];
                let value = &mut values[point * n..(point + 1) * n];
                let place = Place { interval, point };
                for now in directions.chunks(WIDE) {
                    // The values are the same in all chunks, so that only the first one counts them.
                    let residuals = if now[0] == directions[0] {
                        &mut condition_residuals[..conditions]
                    } else {
                        &mut []
                    };
                    if now.len() <= NARROW {
                        self.differentiate(place, now, state, scalars, &mut narrow, value, residuals);
                    } else {
                        self.differentiate(place, now, state, scalars, &mut wide, value, residuals);
                    }
                }
                if let Some(factor) = self.problem.factor() {
                    let column = (interval * degree + point) * (n + e) + n + factor;
                    let target = &mut self.condensation.derivatives[column * n..][..n];
                    for (entry, value) in target.iter_mut().zip(value.iter()) {
                        *entry = value / scalars[factor];
                    }
                }
            }
            let target = &mut interval_residuals[interval * size..(interval + 1) * size];
            self.interval_residual(interval, states, &values, target);
        }
        self.condensation.factorize(&self.mesh)
    }

    /// Derivatives of field and integrands at one Gauss point in some directions, with the values of the field; those of the
    /// integrands are added up.
    #[allow(clippy::too_many_arguments)] // The inner loop of `factorize`, apart to be readable.
    fn differentiate<const D: usize>(
        &mut self,
        place: Place,
        directions: &[usize],
        state: &[f64],
        scalars: &[f64],
        duals: &mut DualWorkspace<D>,
        values: &mut [f64],
        condition_residuals: &mut [f64],
    ) {
        let (n, e, intervals, size) = (state.len(), scalars.len(), self.intervals(), self.interval_size());
        let columns = n + e;
        let node = place.interval * self.gauss().degree() + place.point;
        let weight =
            (self.mesh[place.interval + 1] - self.mesh[place.interval]) * self.gauss().weights[place.point];
        for (dual, value) in duals.state.iter_mut().zip(state).chain(duals.scalars.iter_mut().zip(scalars)) {
            *dual = Dual::constant(*value);
        }
        for (index, &direction) in directions.iter().enumerate() {
            let dual =
                if direction < n { &mut duals.state[direction] } else { &mut duals.scalars[direction - n] };
            dual.derivatives[index] = 1.0;
        }
        let reference = Reference {
            state: &self.reference[node * n..(node + 1) * n],
            slope: &self.reference_slope[node * n..(node + 1) * n],
        };
        self.problem.field(&duals.state, &duals.scalars, &mut duals.values);
        self.problem.integrands(&duals.state, &duals.scalars, reference, &mut duals.integrands);
        for (entry, dual) in values.iter_mut().zip(&duals.values) {
            *entry = dual.value;
        }
        for (sum, dual) in condition_residuals.iter_mut().zip(&duals.integrands) {
            *sum += weight * dual.value;
        }
        for (index, &column) in directions.iter().enumerate() {
            let target = &mut self.condensation.derivatives[(node * columns + column) * n..][..n];
            for (entry, dual) in target.iter_mut().zip(&duals.values) {
                *entry = dual.derivatives[index];
            }
            for (row, dual) in duals.integrands.iter().enumerate() {
                let slope = weight * dual.derivatives[index];
                if column < n {
                    let position = (row * intervals + place.interval) * size + (place.point + 1) * n + column;
                    self.condensation.gradients[position] = slope;
                } else {
                    self.condensation.corner[row * e + column - n] += slope;
                }
            }
        }
    }

    /// Solves with the last factorisation, in place; the last entry belongs to the border.
    pub fn solve(&mut self, right_hand_side: &mut [f64]) {
        self.condensation.solve(right_hand_side);
    }

    /// Writes the state at time `time` in `[0, 1]` of the piecewise polynomial `unknown`.
    pub fn evaluate(&self, unknown: &[f64], time: f64, state: &mut [f64]) {
        let interval = self.mesh[1..self.mesh.len() - 1].partition_point(|&point| point <= time);
        let width = self.mesh[interval + 1] - self.mesh[interval];
        let mut basis = [0.0; MOST_NODES];
        let basis = &mut basis[..self.gauss().degree() + 1];
        self.gauss().basis((time - self.mesh[interval]) / width, basis);
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
            for (state, point) in interior.chunks_exact_mut(n).zip(&self.gauss().points) {
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

/// A Gauss point of an interval.
#[derive(Clone, Copy)]
struct Place {
    interval: usize,
    point: usize,
}

/// Most nodes of one interval.
pub(crate) const MOST_NODES: usize = 17;

/// Linear combination of the node states of one interval.
pub(crate) fn combine(interval: &[f64], basis: &[f64], state: &mut [f64]) {
    let n = state.len();
    state.fill(0.0);
    for (values, weight) in interval.chunks_exact(n).zip(basis) {
        for (entry, value) in state.iter_mut().zip(values) {
            *entry += weight * value;
        }
    }
}
