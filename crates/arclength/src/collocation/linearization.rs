//! The Jacobian of a collocation system, bordered by one row, by dual numbers: its entries are written where
//! [`Condensation`](super::condensation::Condensation) takes them from.

use super::condensation::Jump;
use super::equations::Collocation;
use super::interior::Structure;
use super::problem::{BoundaryValueEquations, Reference};
use crate::differentiation::{Dual, Scalar};
use crate::erased::JacobianScalar;

/// Memory for the evaluation of field and integrands with derivatives in up to `D` directions at a time.
struct DualWorkspace<const D: usize> {
    state: Vec<Dual<f64, D>>,
    scalars: Vec<Dual<f64, D>>,
    values: Vec<Dual<f64, D>>,
    integrands: Vec<Dual<f64, D>>,
}

impl<const D: usize> DualWorkspace<D> {
    fn new(n: usize, scalars: usize, integrals: usize) -> Self {
        Self {
            state: vec![Dual::zero(); n],
            scalars: vec![Dual::zero(); scalars],
            values: vec![Dual::zero(); n],
            integrands: vec![Dual::zero(); integrals],
        }
    }

    /// Sets a point and the directions of the derivatives, which are counted through states and scalars.
    #[inline(always)]
    fn seed(&mut self, directions: &[usize], state: &[f64], scalars: &[f64]) {
        let n = state.len();
        for (dual, value) in self.state.iter_mut().zip(state).chain(self.scalars.iter_mut().zip(scalars)) {
            *dual = Dual::constant(*value);
        }
        for (index, &direction) in directions.iter().enumerate() {
            let dual =
                if direction < n { &mut self.state[direction] } else { &mut self.scalars[direction - n] };
            dual.derivatives[index] = 1.0;
        }
    }
}

/// Directions of the narrow and of the wide workspace.
const NARROW: usize = 4;
const WIDE: usize = 8;

/// A Gauss point of an interval.
#[derive(Clone, Copy)]
struct GaussPoint {
    interval: usize,
    point: usize,
}

impl<P: BoundaryValueEquations> Collocation<P> {
    /// Linearises at `unknown`, bordered by `border`, writes the residual and factorises.
    ///
    /// Returns the sign of the determinant of the system reduced to the states at both ends and the scalars, zero if singular.
    pub fn factorize(&mut self, unknown: &[f64], border: &[f64], residual: &mut [f64]) -> f64 {
        let n = self.problem.dimension();
        let e = self.problem.scalars();
        let degree = self.gauss().degree();
        let size = self.interval_size();
        let intervals = self.intervals();
        let mut integrals = vec![0.0; self.problem.integral_conditions()];
        self.condensation.prepare(intervals);
        self.condensation.jumps.clear();
        let (states, scalars) = unknown.split_at(intervals * size);
        for row in 0..integrals.len() {
            for interval in 0..intervals {
                let start = (row * intervals + interval) * size;
                self.condensation.gradients[start..start + n].fill(0.0);
            }
        }
        self.condensation.gradients[integrals.len() * intervals * size..]
            .copy_from_slice(&border[..intervals * size]);
        self.condensation.corner[integrals.len() * e..].copy_from_slice(&border[intervals * size..]);
        let leading = self.problem.structure().leading(n);
        let known: Vec<usize> = (0..e).filter(|&scalar| self.problem.is_known(scalar)).collect();
        let of_field: Vec<usize> = (0..leading)
            .chain((0..e).filter(|scalar| !known.contains(scalar)).map(|scalar| n + scalar))
            .collect();
        // Where the field is differentiated in fewer directions than the integrands, these are differentiated apart.
        let apart: Vec<usize> = if leading < n { (0..n + e).collect() } else { Vec::new() };
        let few = self.problem.takes_few_directions();
        let most = if few { NARROW } else { WIDE };
        let mut narrow = DualWorkspace::<NARROW>::new(n, e, integrals.len());
        let mut wide = DualWorkspace::<WIDE>::new(n, e, integrals.len());
        let mut values = vec![0.0; degree * n];
        for interval in 0..intervals {
            let here = &states[interval * size..(interval + 1) * size];
            for point in 0..degree {
                let state = &here[n * (point + 1)..n * (point + 2)];
                let value = &mut values[point * n..(point + 1) * n];
                let at = GaussPoint { interval, point };
                for (chunk, now) in of_field.chunks(most).enumerate() {
                    // The values are the same in all chunks, so that only the first one counts them.
                    let sums = if chunk == 0 { &mut integrals[..] } else { &mut [] };
                    let sums = apart.is_empty().then_some(sums);
                    if now.len() <= NARROW {
                        narrow.seed(now, state, scalars);
                        self.differentiate_field(at, now, &mut narrow, value);
                        if let Some(sums) = sums {
                            self.differentiate_integrands(at, now, &mut narrow, sums);
                        }
                    } else {
                        wide.seed(now, state, scalars);
                        self.differentiate_field(at, now, &mut wide, value);
                        if let Some(sums) = sums {
                            self.differentiate_integrands(at, now, &mut wide, sums);
                        }
                    }
                }
                for (chunk, now) in apart.chunks(WIDE).enumerate() {
                    let sums = if chunk == 0 { &mut integrals[..] } else { &mut [] };
                    wide.seed(now, state, scalars);
                    self.differentiate_integrands(at, now, &mut wide, sums);
                }
                self.complete(at, &known, state, scalars, value);
            }
            self.interval_residual(interval, states, &values, &mut residual[interval * size..][..size]);
            if self.has_jumps
                && let Some(index) = self.jump_behind(interval)
            {
                if few {
                    self.differentiate_jump::<NARROW>(index, interval, states, scalars, residual);
                } else {
                    self.differentiate_jump::<WIDE>(index, interval, states, scalars, residual);
                }
            }
        }
        if !(self.boundary_is_differentiated && self.problem.has_linear_boundary_conditions()) {
            self.differentiate_boundary(&states[..n], &self.end(states), scalars);
            self.boundary_is_differentiated = true;
        }
        self.write_conditions(states, scalars, &integrals, residual);
        self.condensation.factorize(&self.mesh)
    }

    /// Derivatives of a jump with respect to the state before it and the scalars, and the residual there.
    fn differentiate_jump<const D: usize>(
        &mut self,
        index: usize,
        interval: usize,
        states: &[f64],
        scalars: &[f64],
        residual: &mut [f64],
    ) where
        Dual<f64, D>: JacobianScalar,
    {
        let n = self.problem.dimension();
        let point = [&self.end_of(states, interval), scalars].concat();
        let mut duals: Vec<Dual<f64, D>> = point.iter().map(|value| Dual::constant(*value)).collect();
        let mut after = vec![Dual::zero(); n];
        let mut derivatives = Vec::with_capacity(n * point.len());
        for first in (0..point.len()).step_by(D) {
            let width = D.min(point.len() - first);
            for direction in 0..width {
                duals[first + direction].derivatives[direction] = 1.0;
            }
            let (before, scalars) = duals.split_at(n);
            self.problem.jump(index, before, scalars, &mut after);
            for direction in 0..width {
                derivatives.extend(after.iter().map(|value| value.derivatives[direction]));
                duals[first + direction].derivatives[direction] = 0.0;
            }
        }
        let after: Vec<f64> = after.iter().map(|value| value.value).collect();
        self.jump_residual(interval, states, &after, residual);
        self.condensation.jumps.push(Jump { interval, derivatives });
    }

    /// Derivatives of the boundary conditions with respect to `y(1)`, `y(0)` and the scalars.
    fn differentiate_boundary(&mut self, start: &[f64], end: &[f64], scalars: &[f64]) {
        let n = start.len();
        let conditions = self.boundary_conditions();
        let point = [end, start, scalars].concat();
        let mut duals: Vec<Dual<f64, WIDE>> = point.iter().map(|value| Dual::constant(*value)).collect();
        let mut values = vec![Dual::zero(); conditions];
        for first in (0..point.len()).step_by(WIDE) {
            let width = WIDE.min(point.len() - first);
            for direction in 0..width {
                duals[first + direction].derivatives[direction] = 1.0;
            }
            let (end, rest) = duals.split_at(n);
            let (start, scalars) = rest.split_at(n);
            self.problem.boundary_conditions(start, end, scalars, &mut values);
            for direction in 0..width {
                let column =
                    &mut self.condensation.boundary[(first + direction) * conditions..][..conditions];
                for (entry, value) in column.iter_mut().zip(&values) {
                    *entry = value.derivatives[direction];
                }
                duals[first + direction].derivatives[direction] = 0.0;
            }
        }
    }

    /// Derivatives of the field at one Gauss point that are known without differentiation: in carried components and in some scalars.
    fn complete(&mut self, at: GaussPoint, known: &[usize], state: &[f64], scalars: &[f64], value: &[f64]) {
        let (n, e) = (state.len(), scalars.len());
        let node = at.interval * self.gauss().degree() + at.point;
        let block = &mut self.condensation.derivatives[node * n * (n + e)..(node + 1) * n * (n + e)];
        for &scalar in known {
            let target = &mut block[(n + scalar) * n..(n + scalar + 1) * n];
            self.problem.known_derivative(scalar, state, scalars, value, target);
        }
        let structure = self.problem.structure();
        let leading = structure.leading(n);
        for first in (leading..n).step_by(leading) {
            for component in 0..leading {
                let (source, target) = block.split_at_mut((first + component) * n);
                target[..n].fill(0.0);
                target[first..first + leading].copy_from_slice(&source[component * n..][..leading]);
                if structure == Structure::Turning {
                    let rotation = self.problem.rotation(scalars);
                    let (row, sign) = if first == leading { (2 * leading, -1.0) } else { (leading, 1.0) };
                    target[row + component] = sign * rotation;
                }
            }
        }
    }

    /// Derivatives of the field at one Gauss point in the directions that were seeded, with its values.
    #[inline(always)]
    fn differentiate_field<const D: usize>(
        &mut self,
        at: GaussPoint,
        directions: &[usize],
        duals: &mut DualWorkspace<D>,
        values: &mut [f64],
    ) where
        Dual<f64, D>: JacobianScalar,
    {
        let (n, columns) = (duals.state.len(), duals.state.len() + duals.scalars.len());
        let node = at.interval * self.gauss().degree() + at.point;
        let time = self.time(at.interval, at.point);
        self.problem.field(time, &duals.state, &duals.scalars, &mut duals.values);
        for (entry, dual) in values.iter_mut().zip(&duals.values) {
            *entry = dual.value;
        }
        for (index, &column) in directions.iter().enumerate() {
            let target = &mut self.condensation.derivatives[(node * columns + column) * n..][..n];
            for (entry, dual) in target.iter_mut().zip(&duals.values) {
                *entry = dual.derivatives[index];
            }
        }
    }

    /// Derivatives of the integrands at one Gauss point in the directions that were seeded; they and the values are added up.
    #[inline(always)]
    fn differentiate_integrands<const D: usize>(
        &mut self,
        at: GaussPoint,
        directions: &[usize],
        duals: &mut DualWorkspace<D>,
        integrals: &mut [f64],
    ) where
        Dual<f64, D>: JacobianScalar,
    {
        let (n, e) = (duals.state.len(), duals.scalars.len());
        let (intervals, size) = (self.intervals(), self.interval_size());
        let node = at.interval * self.gauss().degree() + at.point;
        let weight = (self.mesh[at.interval + 1] - self.mesh[at.interval]) * self.gauss().weights[at.point];
        let reference = Reference {
            time: self.time(at.interval, at.point),
            state: &self.reference[node * n..(node + 1) * n],
            slope: &self.reference_slope[node * n..(node + 1) * n],
        };
        self.problem.integrands(&duals.state, &duals.scalars, reference, &mut duals.integrands);
        for (sum, dual) in integrals.iter_mut().zip(&duals.integrands) {
            *sum += weight * dual.value;
        }
        for (index, &column) in directions.iter().enumerate() {
            for (row, dual) in duals.integrands.iter().enumerate() {
                let slope = weight * dual.derivatives[index];
                if column < n {
                    let position = (row * intervals + at.interval) * size + (at.point + 1) * n + column;
                    self.condensation.gradients[position] = slope;
                } else {
                    self.condensation.corner[row * e + column - n] += slope;
                }
            }
        }
    }
}
