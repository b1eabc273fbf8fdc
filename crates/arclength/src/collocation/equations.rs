//! Orthogonal collocation of a boundary value problem, with condensed linear algebra.
//!
//! The unit interval is divided by a mesh; on each interval the solution is a polynomial of degree `m` that
//! satisfies the equation at the `m` Gauss points. Unknowns, in this order: for every interval its left end
//! `u_j` (`n` numbers) and the values at its Gauss points (`m n` numbers); then the scalars. The right end of
//! the last interval, `y(1)`, is the value of its polynomial there. The interior values of an interval depend
//! on `u_j` and the scalars only, so each interval is condensed by one small dense factorisation to
//! `u_(j+1) = R_j u_j + Q_j s + rho_j`, and a block-bidiagonal system with boundary conditions is left. Sources:
//! de Boor and Swartz, "Collocation at Gaussian points" (1973); Ascher, Mattheij and Russell, *Numerical
//! Solution of Boundary Value Problems* (1995), section 5.6; Doedel, Keller and Kernevez (1991).

use super::condensation::{Condensation, Jump};
use super::gauss::Gauss;
use super::polynomials::{Polynomials, combine};
use super::problem::{BoundaryValueEquations, Reference};
use crate::continuation::Equations;
use crate::error::Error;

/// A discretised problem with the factors of its last linearisation.
#[derive(Debug, Clone)]
pub struct Collocation<P> {
    /// The problem.
    pub problem: P,
    pub(super) mesh: Vec<f64>,
    pub(super) reference: Vec<f64>,
    pub(super) reference_slope: Vec<f64>,
    pub(super) condensation: Condensation,
    pub(super) boundary_is_differentiated: bool,
    /// Whether the problem has jumps: it need not be asked for every interval.
    pub(super) has_jumps: bool,
}

impl<P: BoundaryValueEquations> Collocation<P> {
    /// Discretises on a mesh `0 = t_0 < ... < t_N = 1` with polynomials of the given degree.
    ///
    /// # Errors
    /// [`Error::Invalid`] when the mesh is no such mesh, the degree is not one from 2 to 16, or the problem has no scalar or more
    /// conditions on integrals than conditions.
    pub fn try_new(problem: P, mesh: Vec<f64>, degree: usize) -> Result<Self, Error> {
        let invalid = |name: &str, value: String, allowed: String| {
            Err(Error::Invalid { name: name.into(), value, allowed })
        };
        let (n, e) = (problem.dimension(), problem.scalars());
        if n == 0 {
            return invalid("number of components", "0".into(), "one at least".into());
        }
        if e == 0 {
            return invalid("number of scalars", "0".into(), "one at least, the parameter".into());
        }
        let integrals = problem.integral_conditions();
        if integrals > n + e - 1 {
            let allowed = format!("{} at most", n + e - 1);
            return invalid("number of integral conditions", integrals.to_string(), allowed);
        }
        if !(2..=16).contains(&degree) {
            return invalid("degree", degree.to_string(), "2 to 16".into());
        }
        let ends = mesh.first() == Some(&0.0) && mesh.last() == Some(&1.0);
        if !(ends && mesh.windows(2).all(|pair| pair[0] < pair[1])) {
            return invalid("mesh", format!("{} points", mesh.len()), "ascending from 0 to 1".into());
        }
        Ok(Self::new(problem, mesh, degree))
    }

    /// As [`try_new`](Self::try_new), for what is known to fit.
    pub(crate) fn new(problem: P, mesh: Vec<f64>, degree: usize) -> Self {
        let n = problem.dimension();
        let size = (mesh.len() - 1) * degree * n;
        let boundary_conditions = n + problem.scalars() - 1 - problem.integral_conditions();
        Self {
            has_jumps: !problem.jumps().is_empty(),
            condensation: Condensation::new(
                degree,
                [n, problem.scalars(), boundary_conditions],
                problem.structure(),
            ),
            problem,
            mesh,
            reference: vec![0.0; size],
            reference_slope: vec![0.0; size],
            boundary_is_differentiated: false,
        }
    }

    /// Mesh points at which the problem has jumps.
    pub(crate) fn jump_points(&self) -> Vec<usize> {
        let jumps = self.problem.jumps().iter();
        jumps.map(|time| self.mesh.partition_point(|point| point < time)).collect()
    }

    /// Number of the jump at the end of an interval.
    pub(super) fn jump_behind(&self, interval: usize) -> Option<usize> {
        let end = self.mesh[interval + 1];
        let jumps = self.problem.jumps();
        let index = jumps.partition_point(|time| *time < end);
        (jumps.get(index) == Some(&end)).then_some(index)
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
        self.condensation.gauss()
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

    /// The jumps of the last factorisation.
    pub(crate) fn linear_jumps(&self) -> &[Jump] {
        &self.condensation.jumps
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
                let time = self.time(interval, point);
                let slope = &mut self.reference_slope[target + point * n..target + (point + 1) * n];
                self.problem.field(time, &states[n * (point + 1)..n * (point + 2)], scalars, slope);
            }
        }
    }

    /// Time of a Gauss point.
    #[inline(always)]
    pub(super) fn time(&self, interval: usize, point: usize) -> f64 {
        let (left, right) = (self.mesh[interval], self.mesh[interval + 1]);
        left + self.gauss().points[point] * (right - left)
    }

    /// Writes the residual: for every interval the continuity at its right end (`n`) and the collocation
    /// equations (`m n`), then the conditions that are left; the entry of the border is not touched. The first `n`
    /// conditions, those at the boundary before those on integrals, take the place of the continuity at the end of the last
    /// interval.
    pub fn residual(&mut self, unknown: &[f64], residual: &mut [f64]) {
        let n = self.problem.dimension();
        let degree = self.gauss().degree();
        let size = self.interval_size();
        let (states, scalars) = unknown.split_at(self.intervals() * size);
        let mut values = vec![0.0; degree * n];
        let mut integrals = vec![0.0; self.problem.integral_conditions()];
        let mut integrands = integrals.clone();
        for interval in 0..self.intervals() {
            let width = self.mesh[interval + 1] - self.mesh[interval];
            let here = &states[interval * size..(interval + 1) * size];
            for point in 0..degree {
                let state = &here[n * (point + 1)..n * (point + 2)];
                let time = self.time(interval, point);
                self.problem.field(time, state, scalars, &mut values[point * n..(point + 1) * n]);
                let reference = self.reference_at(interval, point);
                self.problem.integrands(state, scalars, reference, &mut integrands);
                let weight = width * self.gauss().weights[point];
                for (sum, value) in integrals.iter_mut().zip(&integrands) {
                    *sum += weight * value;
                }
            }
            self.interval_residual(interval, states, &values, &mut residual[interval * size..][..size]);
            if self.has_jumps
                && let Some(index) = self.jump_behind(interval)
            {
                let mut after = vec![0.0; n];
                self.problem.jump(index, &self.end_of(states, interval), scalars, &mut after);
                self.jump_residual(interval, states, &after, residual);
            }
        }
        self.write_conditions(states, scalars, &integrals, residual);
    }

    /// The continuity residual at the end of an interval behind which the state is `after`.
    pub(super) fn jump_residual(&self, interval: usize, states: &[f64], after: &[f64], residual: &mut [f64]) {
        let next = self.interval(states, interval + 1);
        let target = &mut residual[interval * self.interval_size()..];
        for ((entry, next), after) in target.iter_mut().zip(next).zip(after) {
            *entry = next - after;
        }
    }

    /// The state at the end of an interval, by its polynomial.
    pub(crate) fn end_of(&self, states: &[f64], interval: usize) -> Vec<f64> {
        let mut end = vec![0.0; self.problem.dimension()];
        combine(self.interval(states, interval), &self.gauss().end, &mut end);
        end
    }

    pub(super) fn boundary_conditions(&self) -> usize {
        self.condensation.bidiagonal_sizes().boundary_conditions
    }

    /// `y(1)`.
    pub(super) fn end(&self, states: &[f64]) -> Vec<f64> {
        self.end_of(states, self.intervals() - 1)
    }

    /// Writes the values of the conditions, those at the boundary and then those on integrals, to their places in the residual.
    pub(super) fn write_conditions(
        &self,
        states: &[f64],
        scalars: &[f64],
        integrals: &[f64],
        residual: &mut [f64],
    ) {
        let mut boundary = vec![0.0; self.boundary_conditions()];
        let start = &states[..self.problem.dimension()];
        self.problem.boundary_conditions(start, &self.end(states), scalars, &mut boundary);
        for (condition, value) in boundary.iter().chain(integrals).enumerate() {
            residual[self.condensation.place_of_condition(condition)] = *value;
        }
    }

    /// Continuity and collocation residuals of one interval, from the field's values at its Gauss points; at the end of the last
    /// interval there is no continuity.
    pub(super) fn interval_residual(
        &self,
        interval: usize,
        states: &[f64],
        values: &[f64],
        target: &mut [f64],
    ) {
        let n = self.problem.dimension();
        let degree = self.gauss().degree();
        let size = self.interval_size();
        let width = self.mesh[interval + 1] - self.mesh[interval];
        let here = &states[interval * size..(interval + 1) * size];
        let (start, inner) = here.split_at(n);
        let (continuity, targets) = target.split_at_mut(n);
        if let Some(next) = states.get((interval + 1) * size..(interval + 1) * size + n) {
            combine(here, &self.gauss().end, continuity);
            continuity.iter_mut().zip(next).for_each(|(entry, next)| *entry = next - *entry);
        }
        let rows = self.gauss().integration.chunks_exact(degree);
        for ((target, inner), row) in targets.chunks_exact_mut(n).zip(inner.chunks_exact(n)).zip(rows) {
            combine(values, row, target);
            for ((entry, inner), start) in target.iter_mut().zip(inner).zip(start) {
                *entry = inner - start - width * *entry;
            }
        }
    }

    fn reference_at(&self, interval: usize, point: usize) -> Reference<'_> {
        let n = self.problem.dimension();
        let index = interval * self.gauss().degree() + point;
        Reference {
            time: self.time(interval, point),
            state: &self.reference[index * n..(index + 1) * n],
            slope: &self.reference_slope[index * n..(index + 1) * n],
        }
    }

    /// Solves with the last factorisation, in place; the last entry belongs to the border.
    pub fn solve(&mut self, right_hand_side: &mut [f64]) {
        self.condensation.solve(right_hand_side);
    }

    /// The polynomials of a vector of unknowns.
    pub(crate) fn polynomials<'a>(&'a self, unknown: &'a [f64]) -> Polynomials<'a> {
        Polynomials { mesh: &self.mesh, gauss: self.gauss(), n: self.problem.dimension(), states: unknown }
    }

    /// Writes the state at time `time` in `[0, 1]` of the piecewise polynomial `unknown`.
    pub fn evaluate(&self, unknown: &[f64], time: f64, state: &mut [f64]) {
        self.polynomials(unknown).state(time, state);
    }

    /// The unknowns of one interval.
    pub fn interval<'a>(&self, unknown: &'a [f64], interval: usize) -> &'a [f64] {
        let size = self.interval_size();
        &unknown[interval * size..(interval + 1) * size]
    }

    /// Applies the metric: mean square over the unit interval of the components, each in units of its size, and squares of the
    /// scalars. `sizes` are those of the components and then of the scalars; what has none has weight zero.
    pub fn apply_metric(&self, sizes: &[f64], vector: &[f64], image: &mut [f64]) {
        let n = self.problem.dimension();
        let square = |index: usize| sizes.get(index).map_or(0.0, |size| 1.0 / (size * size));
        let squares: Vec<f64> = (0..n).map(square).collect();
        // With a number of components that the compiler knows the loops over them are unrolled.
        match n {
            1 => self.weigh_states(1, &squares, vector, image),
            2 => self.weigh_states(2, &squares, vector, image),
            3 => self.weigh_states(3, &squares, vector, image),
            4 => self.weigh_states(4, &squares, vector, image),
            5 => self.weigh_states(5, &squares, vector, image),
            6 => self.weigh_states(6, &squares, vector, image),
            _ => self.weigh_states(n, &squares, vector, image),
        }
        let states = self.intervals() * self.interval_size();
        for (index, (image, value)) in image[states..].iter_mut().zip(&vector[states..]).enumerate() {
            *image = square(n + index) * value;
        }
    }

    /// The part of the metric that is an integral over the states of `n` components with these weights.
    #[inline(always)]
    fn weigh_states(&self, n: usize, squares: &[f64], vector: &[f64], image: &mut [f64]) {
        let size = (self.gauss().degree() + 1) * n;
        let weights = &self.gauss().weights;
        let squares = &squares[..n];
        for ((pair, vector), image) in
            self.mesh.windows(2).zip(vector.chunks_exact(size)).zip(image.chunks_exact_mut(size))
        {
            let (start, rest) = image.split_at_mut(n);
            start.fill(0.0);
            for ((values, images), weight) in
                vector[n..].chunks_exact(n).zip(rest.chunks_exact_mut(n)).zip(weights)
            {
                let weight = weight * (pair[1] - pair[0]);
                for ((image, value), square) in images.iter_mut().zip(values).zip(squares) {
                    *image = weight * square * value;
                }
            }
        }
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

    /// Carries a vector over to a mesh of as many intervals whose points number `points` are moved a little: what lies between
    /// two of them stays there.
    pub(crate) fn carry_segments(&self, unknown: &[f64], mesh: &[f64], points: &[usize]) -> Vec<f64> {
        let n = self.problem.dimension();
        let polynomials = self.polynomials(unknown);
        let mut carried = vec![0.0; self.intervals() * self.interval_size()];
        let mut start = 0;
        for end in points.iter().copied().chain([self.intervals()]) {
            for interval in start..end {
                let (left, width) = (mesh[interval], mesh[interval + 1] - mesh[interval]);
                let target = &mut carried[interval * self.interval_size()..][..self.interval_size()];
                let nodes = std::iter::once(0.0).chain(self.gauss().points.iter().copied());
                for (state, node) in target.chunks_exact_mut(n).zip(nodes) {
                    polynomials.state_within(start..end, left + node * width, state);
                }
            }
            start = end;
        }
        carried.extend_from_slice(&unknown[self.intervals() * self.interval_size()..]);
        carried
    }

    /// Replaces the mesh and carries the unknowns, which become the reference, and other vectors over to it.
    pub(crate) fn move_to_mesh(
        &mut self,
        mesh: Vec<f64>,
        unknown: &mut Vec<f64>,
        vectors: &mut [&mut Vec<f64>],
    ) {
        *unknown = self.carry(unknown, &mesh);
        for vector in vectors.iter_mut() {
            **vector = self.carry(vector, &mesh);
        }
        self.set_mesh(mesh, unknown);
    }

    /// Replaces the mesh; vectors have to be [carried](Self::carry) before. The reference is carried here.
    pub fn set_mesh(&mut self, mesh: Vec<f64>, unknown: &[f64]) {
        self.mesh = mesh;
        self.has_jumps = !self.problem.jumps().is_empty();
        self.set_reference(unknown);
    }
}

impl<P: BoundaryValueEquations> Equations for Collocation<P> {
    fn unknowns(&self) -> usize {
        Self::unknowns(self)
    }

    fn residual(&mut self, unknown: &[f64], residual: &mut [f64]) {
        Self::residual(self, unknown, residual);
    }

    fn factorize(&mut self, unknown: &[f64], border: &[f64], residual: &mut [f64]) -> f64 {
        Self::factorize(self, unknown, border, residual)
    }

    fn solve(&mut self, right_hand_side: &mut [f64]) {
        Self::solve(self, right_hand_side);
    }
}
