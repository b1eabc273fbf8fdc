//! Condensation of a linearised collocation system: the interior of every interval is eliminated by one small
//! dense factorisation, and a [`Bidiagonal`] system in the left ends and the scalars is left.
//!
//! Apart from the evaluation of the vector field this is where the time of a continuation of cycles goes, so
//! it is compiled once, not for every field, and also for processors with wide vectors and fused operations;
//! [`LANES`] neighbouring intervals are condensed together, one in each lane of the vectors.
//! Source: Ascher, Mattheij and Russell, *Numerical Solution of Boundary Value Problems* (1995), section 7.2.

use super::bidiagonal::{Bidiagonal, Blocks, Sizes};
use super::gauss::Gauss;
use super::interior::{Interior, LinearField, Structure};
use super::polynomials::combine;
use crate::lanes::{Kernel, run};
use crate::linear::lane_entry::{LANES, Lanes};

/// A linearised collocation system and its factors; memory is kept from one factorisation to the next.
#[derive(Debug, Clone)]
pub(crate) struct Condensation {
    /// Number of state components.
    n: usize,
    /// Number of scalars.
    scalars: usize,
    /// Number of boundary conditions.
    boundary_conditions: usize,
    intervals: usize,
    /// Derivatives of the field at the Gauss points, to be filled in before [`factorize`](Self::factorize):
    /// `n` by `n + E` column-major for each point.
    pub(crate) derivatives: Vec<f64>,
    /// Derivatives of the boundary conditions with respect to `y(1)`, `y(0)` and the scalars, column-major; to be filled in.
    pub(crate) boundary: Vec<f64>,
    /// Gradients of the dense rows (conditions, then the border) in the states, row by row; to be filled in.
    pub(crate) gradients: Vec<f64>,
    /// Derivatives of the dense rows with respect to the scalars, row by row; to be filled in.
    pub(crate) corner: Vec<f64>,
    interior: Interior,
    /// Gradients of one group.
    gradient: Vec<Lanes>,
    /// Interior values that belong to a right-hand side.
    particular: Vec<Lanes>,
    transfer: Vec<f64>,
    scalar_columns: Vec<f64>,
    rows: Vec<f64>,
    states: Vec<f64>,
    /// Right-hand sides of the conditions; end and scalars of the solution.
    conditions: Vec<f64>,
    bidiagonal: Bidiagonal,
    /// Where the next left end is not the end of the interval but a function of it; to be filled in.
    pub(crate) jumps: Vec<Jump>,
}

/// The linearised jump at the end of an interval.
#[derive(Debug, Clone)]
pub(crate) struct Jump {
    pub interval: usize,
    /// Derivatives of the next left end in the end of the interval and in the scalars, `n` by `n + E`, column-major.
    pub derivatives: Vec<f64>,
}

impl Jump {
    /// Applies the derivatives in the state to `vector`.
    pub(crate) fn apply(&self, vector: &mut [f64]) {
        let before = vector.to_vec();
        combine(&self.derivatives[..before.len() * before.len()], &before, vector);
    }

    /// The same in `n` states without what the scalars do, of which there are `scalars`.
    pub(crate) fn of_states(&self, n: usize, scalars: usize) -> Self {
        let mut derivatives = self.derivatives[..n * n].to_vec();
        derivatives.resize(n * (n + scalars), 0.0);
        Self { interval: self.interval, derivatives }
    }
}

impl Condensation {
    /// For polynomials of a degree, numbers of components, scalars and boundary conditions, and what is known of the derivatives.
    pub(crate) fn new(
        degree: usize,
        [n, scalars, boundary_conditions]: [usize; 3],
        structure: Structure,
    ) -> Self {
        Self {
            interior: Interior::new(degree, n, scalars, structure),
            n,
            scalars,
            boundary_conditions,
            intervals: 0,
            derivatives: Vec::new(),
            boundary: Vec::new(),
            gradients: Vec::new(),
            corner: Vec::new(),
            gradient: vec![Lanes::ZERO; degree * n],
            particular: Vec::new(),
            transfer: Vec::new(),
            scalar_columns: Vec::new(),
            rows: Vec::new(),
            states: Vec::new(),
            conditions: Vec::new(),
            bidiagonal: Bidiagonal::default(),
            jumps: Vec::new(),
        }
    }

    /// Makes room for a mesh of `intervals` intervals and clears what is summed up.
    pub(crate) fn prepare(&mut self, intervals: usize) {
        let (n, e, inner) = (self.n, self.scalars, self.inner());
        self.intervals = intervals;
        let dense_rows = self.bidiagonal_sizes().dense_rows();
        self.derivatives.resize(intervals * inner * (n + e), 0.0);
        self.boundary.resize(self.boundary_conditions * (2 * n + e), 0.0);
        self.gradients.resize(dense_rows * intervals * (inner + n), 0.0);
        self.corner.clear();
        self.corner.resize(dense_rows * e, 0.0);
        let groups = intervals.div_ceil(LANES);
        self.interior.prepare(groups);
        self.particular.resize(groups * inner, Lanes::ZERO);
        self.transfer.resize(intervals * n * n, 0.0);
        self.scalar_columns.resize(intervals * n * e, 0.0);
        self.rows.resize(dense_rows * intervals * n, 0.0);
        self.states.resize(intervals * n, 0.0);
        self.conditions.resize(n + e, 0.0);
    }

    /// Sizes of the system that is left.
    pub(crate) fn bidiagonal_sizes(&self) -> Sizes {
        Sizes {
            components: self.n,
            scalars: self.scalars,
            boundary_conditions: self.boundary_conditions,
            intervals: self.intervals,
        }
    }

    /// Index among all equations of a condition, counted from the first boundary condition to the border: the first `n` take
    /// the place of the continuity at the end of the last interval.
    pub(crate) fn place_of_condition(&self, condition: usize) -> usize {
        let (n, size) = (self.n, (self.gauss().degree() + 1) * self.n);
        if condition < n {
            (self.intervals - 1) * size + condition
        } else {
            self.intervals * size + condition - n
        }
    }

    /// The condensed blocks `R_j`.
    pub(crate) fn transfer(&self) -> &[f64] {
        &self.transfer
    }

    /// The Gauss points.
    #[inline(always)]
    pub(crate) fn gauss(&self) -> &Gauss {
        self.interior.gauss()
    }

    /// Number of interior unknowns of an interval.
    #[inline(always)]
    fn inner(&self) -> usize {
        self.gauss().degree() * self.n
    }

    /// Interior values of the linearised flow that starts with `start` at the left end of an interval.
    pub(crate) fn interior_response(&self, interval: usize, start: &[f64], interior: &mut [f64]) {
        let (group, lane) = (interval / LANES, interval % LANES);
        interior.fill(0.0);
        for (column, factor) in self.interior.response(group).chunks_exact(self.inner()).zip(start) {
            for (entry, value) in interior.iter_mut().zip(column) {
                *entry += factor * value.0[lane];
            }
        }
    }

    /// Factorises; as [`Collocation::factorize`](super::Collocation::factorize).
    pub(crate) fn factorize(&mut self, mesh: &[f64]) -> f64 {
        for group in 0..self.intervals.div_ceil(LANES) {
            let field = LinearField { mesh, derivatives: &self.derivatives };
            if !run(Elimination(&mut self.interior, group, field)) {
                return 0.0;
            }
            run(Reduction(self, group));
        }
        let (n, e) = (self.n, self.scalars);
        for jump in &self.jumps {
            let transfer = &mut self.transfer[jump.interval * n * n..(jump.interval + 1) * n * n];
            transfer.chunks_exact_mut(n).for_each(|column| jump.apply(column));
            let scalar_columns = &mut self.scalar_columns[jump.interval * n * e..(jump.interval + 1) * n * e];
            for (column, own) in
                scalar_columns.chunks_exact_mut(n).zip(jump.derivatives[n * n..].chunks_exact(n))
            {
                jump.apply(column);
                column.iter_mut().zip(own).for_each(|(entry, value)| *entry += value);
            }
        }
        let blocks = Blocks {
            transfer: &self.transfer,
            scalar_columns: &self.scalar_columns,
            boundary: &self.boundary,
            rows: &self.rows,
            corner: &self.corner,
        };
        let sizes = self.bidiagonal_sizes();
        self.bidiagonal.factorize(blocks, sizes)
    }

    /// Forms the transfer blocks of a group of intervals from their responses.
    #[inline(always)]
    fn write_transfer<const FUSED: bool>(&mut self, group: usize) {
        let (n, e, inner) = (self.n, self.scalars, self.inner());
        let end = &self.interior.gauss().end;
        for (column, interior) in self.interior.response(group).chunks_exact(inner).enumerate() {
            for row in 0..n {
                let start = if row == column { end[0] } else { 0.0 };
                let mut sum = Lanes::from(start);
                for (value, weight) in interior[row..].iter().step_by(n).zip(&end[1..]) {
                    sum = sum.plus::<FUSED>(*value, Lanes::from(*weight));
                }
                for (interval, lane) in lanes_of(group, self.intervals) {
                    if column < n {
                        self.transfer[(interval * n + column) * n + row] = sum.0[lane];
                    } else {
                        self.scalar_columns[(interval * e + column - n) * n + row] = sum.0[lane];
                    }
                }
            }
        }
    }

    /// Expresses the dense rows in a group of intervals by the left ends and the scalars.
    #[inline(always)]
    fn reduce_rows<const FUSED: bool>(&mut self, group: usize) {
        let (n, e, inner, intervals) = (self.n, self.scalars, self.inner(), self.intervals);
        let size = inner + n;
        for row in 0..self.bidiagonal_sizes().dense_rows() {
            let gradient = &mut self.gradient;
            for (interval, lane) in lanes_of(group, intervals) {
                let source = &self.gradients[(row * intervals + interval) * size + n..][..inner];
                for (target, entry) in gradient.iter_mut().zip(source) {
                    target.0[lane] = *entry;
                }
            }
            for (column, interior) in self.interior.response(group).chunks_exact(inner).enumerate() {
                let mut sum = Lanes::ZERO;
                for (entry, value) in gradient.iter().zip(interior) {
                    sum = sum.plus::<FUSED>(*entry, *value);
                }
                for (interval, lane) in lanes_of(group, intervals) {
                    if column < n {
                        let start = self.gradients[(row * intervals + interval) * size + column];
                        self.rows[(row * intervals + interval) * n + column] = start + sum.0[lane];
                    } else {
                        self.corner[row * e + column - n] += sum.0[lane];
                    }
                }
            }
        }
    }

    /// Solves with the last factorisation, in place; the last entry belongs to the border.
    pub(crate) fn solve(&mut self, right_hand_side: &mut [f64]) {
        run(Solution(self, right_hand_side));
    }

    #[inline(always)]
    fn solve_kernel<const FUSED: bool>(&mut self, right_hand_side: &mut [f64]) {
        let (n, inner, intervals) = (self.n, self.inner(), self.intervals);
        let size = inner + n;
        for condition in 0..self.conditions.len() {
            let place = self.place_of_condition(condition);
            self.conditions[condition] = std::mem::take(&mut right_hand_side[place]);
        }
        let dense = &mut self.conditions[self.boundary_conditions..];
        let (blocks, scalars) = right_hand_side.split_at_mut(intervals * size);
        for (group, values) in self.particular.chunks_exact_mut(inner).enumerate() {
            let count = LANES.min(intervals - group * LANES);
            let here = &mut blocks[group * LANES * size..][..count * size];
            for (lane, block) in here.chunks_exact(size).enumerate() {
                for (target, value) in values.iter_mut().zip(&block[n..]) {
                    target.0[lane] = *value;
                }
            }
            self.interior.solve::<FUSED>(group, values);
            let weights = &self.interior.gauss().end[1..];
            for component in 0..n {
                let mut sum = Lanes::ZERO;
                for (value, weight) in values[component..].iter().step_by(n).zip(weights) {
                    sum = sum.plus::<FUSED>(*value, Lanes::from(*weight));
                }
                for (lane, block) in here.chunks_exact(size).enumerate() {
                    self.states[(group * LANES + lane) * n + component] = block[component] + sum.0[lane];
                }
            }
            for (row, value) in dense.iter_mut().enumerate() {
                let start = (row * intervals + group * LANES) * size;
                for (lane, gradient) in
                    self.gradients[start..start + count * size].chunks_exact(size).enumerate()
                {
                    let products = gradient[n..].iter().zip(values.iter());
                    *value -= products.map(|(entry, value)| entry * value.0[lane]).sum::<f64>();
                }
            }
        }
        for jump in &self.jumps {
            let place = jump.interval * n;
            let own = &blocks[jump.interval * size..][..n];
            let state = &mut self.states[place..place + n];
            state.iter_mut().zip(own).for_each(|(entry, value)| *entry -= value);
            jump.apply(state);
            state.iter_mut().zip(own).for_each(|(entry, value)| *entry += value);
        }
        self.bidiagonal.solve(&mut self.states, &mut self.conditions);
        scalars.copy_from_slice(&self.conditions[n..]);
        for (group, values) in self.particular.chunks_exact_mut(inner).enumerate() {
            let count = LANES.min(intervals - group * LANES);
            let starts = &self.states[group * LANES * n..][..count * n];
            for (column, interior) in self.interior.response(group).chunks_exact(inner).enumerate() {
                let coefficient = if column < n {
                    Lanes::from(std::array::from_fn(|lane| starts[lane.min(count - 1) * n + column]))
                } else {
                    Lanes::from(scalars[column - n])
                };
                for (entry, value) in values.iter_mut().zip(interior) {
                    *entry = entry.plus::<FUSED>(coefficient, *value);
                }
            }
            let here = &mut blocks[group * LANES * size..][..count * size];
            for (lane, block) in here.chunks_exact_mut(size).enumerate() {
                let (end, interior) = block.split_at_mut(n);
                end.copy_from_slice(&starts[lane * n..(lane + 1) * n]);
                for (target, value) in interior.iter_mut().zip(values.iter()) {
                    *target = value.0[lane];
                }
            }
        }
    }
}

/// The elimination of the interior of a group of intervals, with the vector instructions of the processor. Kernels are kept
/// small: in a large one the loops have too few registers.
struct Elimination<'a>(&'a mut Interior, usize, LinearField<'a>);

impl Kernel for Elimination<'_> {
    type Output = bool;

    #[inline(always)]
    fn run<const FUSED: bool>(self) -> bool {
        self.0.factorize::<FUSED>(self.1, self.2)
    }
}

/// What is left of a group of intervals, with the vector instructions of the processor.
struct Reduction<'a>(&'a mut Condensation, usize);

impl Kernel for Reduction<'_> {
    type Output = ();

    #[inline(always)]
    fn run<const FUSED: bool>(self) {
        self.0.write_transfer::<FUSED>(self.1);
        self.0.reduce_rows::<FUSED>(self.1);
    }
}

/// [`Condensation::solve`] with the vector instructions of the processor.
struct Solution<'a>(&'a mut Condensation, &'a mut [f64]);

impl Kernel for Solution<'_> {
    type Output = ();

    #[inline(always)]
    fn run<const FUSED: bool>(self) {
        self.0.solve_kernel::<FUSED>(self.1);
    }
}

/// The intervals of a group with their lanes.
#[inline(always)]
fn lanes_of(group: usize, intervals: usize) -> impl Iterator<Item = (usize, usize)> {
    (group * LANES..((group + 1) * LANES).min(intervals)).zip(0..)
}
