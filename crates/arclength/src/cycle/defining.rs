//! Defining systems of the special cycles: the cycle together with its critical eigenfunction.
//!
//! Each is a periodic boundary value problem of its own that is regular at the special cycle, so that
//! Newton's method locates it and, with a second parameter, continuation follows it. Scalars are
//! `(T, kind's own, p, second p)`. Source: Kuznetsov, *Elements of Applied Bifurcation Theory*, 3rd edition
//! (2004), section 10.4; Doedel, Govaerts and Kuznetsov, "Computation of periodic solution bifurcations in
//! ODEs using bordered systems", SIAM J. Numer. Anal. 41 (2003).

use super::limit_cycle::phase_integrand;
use super::segments::Segments;
use crate::collocation::Structure;
use crate::collocation::problem::{BoundaryValueEquations, Reference};
use crate::differentiation::{Dual, Scalar};
use crate::erased::{ErasedField, FieldScalar, JacobianScalar};
use crate::linear::multiplier::Multiplier;
use crate::parameters::with_parameters;

/// Which special cycle a defining system is for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Kind {
    /// Fold: `v' = T f_x v + beta f`, `v` periodic; own scalar `beta`.
    Fold,
    /// Period doubling: `v' = T f_x v`, `v` antiperiodic; no own scalar.
    Doubling,
    /// Torus bifurcation: `(v + i w)' = (T f_x - i theta)(v + i w) + (beta_1 + i beta_2) f`, periodic and orthogonal to
    /// the flow; own scalars `theta`, `beta_1`, `beta_2`. Regular also at the strong resonances 1:1 and 1:2, where
    /// `theta` passes 0 and pi.
    Torus,
    /// Branch point: `u' = T f + b psi`, `psi' = -T f_x^T psi + sigma f`, periodic, with `psi` orthogonal to `f` and
    /// to the derivative of `f` in the active parameter; own scalars `b` and `sigma`, both zero at the solution.
    BranchPoint,
    /// Any cycle: `u' = T f`, with a linear condition on the scalars that stands for one from outside.
    Cycle,
}

impl Kind {
    /// Number of own scalars.
    pub(crate) fn own_scalars(self) -> usize {
        match self {
            Self::Doubling | Self::Cycle => 0,
            Self::Fold => 1,
            Self::BranchPoint => 2,
            Self::Torus => 3,
        }
    }

    /// The real multiplier that a cycle of this kind has.
    pub(crate) fn critical(self) -> Option<Multiplier> {
        let argument = match self {
            Self::Fold | Self::BranchPoint => 0.0,
            Self::Doubling => std::f64::consts::PI,
            Self::Torus | Self::Cycle => return None,
        };
        Some(Multiplier { log_modulus: 0.0, argument })
    }

    /// Number of real eigenfunctions.
    pub(crate) fn eigenfunctions(self) -> usize {
        match self {
            Self::Fold | Self::Doubling | Self::BranchPoint => 1,
            Self::Torus => 2,
            Self::Cycle => 0,
        }
    }
}

/// The defining system of a special cycle.
#[derive(Debug)]
pub(crate) struct Defining<'a> {
    /// The vector field.
    pub field: ErasedField<'a>,
    /// Which special cycle.
    pub kind: Kind,
    /// All parameters; the active ones are replaced by the unknowns.
    pub parameters: Vec<f64>,
    /// Index of the first active parameter.
    pub active: usize,
    /// Index of the second active parameter; without one its scalar has no effect.
    pub second: Option<usize>,
    /// Sizes of the state variables.
    pub scales: Vec<f64>,
    /// Size of the period.
    pub period_scale: f64,
    /// Size of the active parameter.
    pub parameter_scale: f64,
    /// The segments of the cycle, where the field is smooth only piece by piece.
    pub segments: Option<Segments>,
    /// Coefficients of `(T, p, second p)` in the condition that [`Kind::Cycle`] adds.
    pub stand_in: [f64; 3],
}

impl BoundaryValueEquations for Defining<'_> {
    #[inline]
    fn dimension(&self) -> usize {
        self.scales.len() * (1 + self.kind.eigenfunctions())
    }

    #[inline]
    fn scalars(&self) -> usize {
        3 + self.kind.own_scalars()
    }

    fn structure(&self) -> Structure {
        match self.kind {
            Kind::Fold | Kind::Doubling => Structure::Carried,
            Kind::Torus => Structure::Turning,
            Kind::BranchPoint | Kind::Cycle => Structure::Dense,
        }
    }

    fn rotation(&self, scalars: &[f64]) -> f64 {
        if self.kind == Kind::Torus { scalars[1] } else { 0.0 }
    }

    /// All but the parameters, where functions are carried along.
    fn is_known(&self, scalar: usize) -> bool {
        self.structure() != Structure::Dense && scalar <= self.kind.own_scalars()
    }

    fn known_derivative(
        &self,
        scalar: usize,
        state: &[f64],
        scalars: &[f64],
        value: &[f64],
        derivative: &mut [f64],
    ) {
        let n = self.scales.len();
        let period = scalars[0];
        let (flow, carried) = value.split_at(n);
        let (own, rest) = derivative.split_at_mut(n);
        if scalar == 0 {
            own.iter_mut().zip(flow).for_each(|(entry, value)| *entry = value / period);
            for (index, (entry, value)) in rest.iter_mut().zip(carried).enumerate() {
                let flow = flow[index % n] / period;
                // What is not multiplied by the period.
                let others = match self.kind {
                    Kind::Fold => scalars[1] * flow,
                    Kind::Torus if index < n => scalars[1] * state[2 * n + index] + scalars[2] * flow,
                    Kind::Torus => scalars[3] * flow - scalars[1] * state[index],
                    Kind::Doubling | Kind::BranchPoint | Kind::Cycle => 0.0,
                };
                *entry = (value - others) / period;
            }
            return;
        }
        own.fill(0.0);
        for (index, entry) in rest.iter_mut().enumerate() {
            let flow = flow[index % n] / period;
            *entry = match (self.kind, scalar, index < n) {
                (Kind::Fold, 1, _) | (Kind::Torus, 2, true) | (Kind::Torus, 3, false) => flow,
                (Kind::Torus, 1, true) => state[2 * n + index],
                (Kind::Torus, 1, false) => -state[index],
                _ => 0.0,
            };
        }
    }

    #[inline]
    fn has_linear_boundary_conditions(&self) -> bool {
        true
    }

    #[inline]
    fn integral_conditions(&self) -> usize {
        2 + self.kind.own_scalars()
    }

    /// All components are periodic but the eigenfunction of a period doubling, which returns to its negative.
    #[inline]
    fn boundary_conditions<T: JacobianScalar>(
        &self,
        start: &[T],
        end: &[T],
        _scalars: &[T],
        values: &mut [T],
    ) {
        let periodic = if self.kind == Kind::Doubling { self.scales.len() } else { start.len() };
        for (index, ((value, start), end)) in values.iter_mut().zip(start).zip(end).enumerate() {
            *value = if index < periodic { *end - *start } else { *end + *start };
        }
    }

    #[inline]
    fn field<T: JacobianScalar>(&self, time: f64, state: &[T], scalars: &[T], derivative: &mut [T]) {
        match self.kind {
            Kind::Torus => self.variational::<T, 2>(time, state, scalars, derivative),
            Kind::BranchPoint => self.adjoint(time, state, scalars, derivative),
            Kind::Fold | Kind::Doubling => self.variational::<T, 1>(time, state, scalars, derivative),
            Kind::Cycle => self.flow(time, state, scalars, derivative),
        }
    }

    fn takes_few_directions(&self) -> bool {
        self.segments.as_ref().is_some_and(Segments::has_slides)
    }

    fn jumps(&self) -> &[f64] {
        self.segments.as_ref().map_or(&[], |segments| &segments.times)
    }

    fn jump<T: JacobianScalar>(&self, index: usize, before: &[T], scalars: &[T], after: &mut [T]) {
        match self.kind {
            Kind::Torus => self.variational_jump::<T, 2>(index, before, scalars, after),
            Kind::BranchPoint => self.adjoint_jump(index, before, scalars, after),
            Kind::Fold | Kind::Doubling => self.variational_jump::<T, 1>(index, before, scalars, after),
            Kind::Cycle => {
                if let Some(segments) = &self.segments {
                    let replaced = self.replaced(scalars, |value| value);
                    segments.jump(self.field, index, before, scalars[0].value(), &replaced, after);
                }
            }
        }
    }

    fn delay(&self, index: usize, before: &[f64], scalars: &[f64]) -> Option<f64> {
        let states = &before[..self.scales.len()];
        let replaced = self.replaced(scalars, |value| value);
        let (delay, _) = self.segments.as_ref()?.delay(self.field, index, states, scalars[0], &replaced)?;
        Some(delay / scalars[0])
    }

    /// The states of the cycle alone: those of its eigenfunctions have no extremes that anybody asks for.
    fn at_jump(&self, index: usize, before: &[f64], scalars: &[f64]) -> Option<[Vec<f64>; 2]> {
        let states = &before[..self.scales.len()];
        let replaced = self.replaced(scalars, |value| value);
        self.segments.as_ref()?.at_gate(self.field, index, states, scalars[0], &replaced)
    }

    fn move_jumps(&mut self, times: &[f64]) {
        if let Some(segments) = &mut self.segments {
            segments.times.copy_from_slice(times);
        }
    }

    #[inline]
    fn integrands<T: JacobianScalar>(
        &self,
        state: &[T],
        scalars: &[T],
        reference: Reference<'_>,
        values: &mut [T],
    ) {
        let n = self.scales.len();
        values[0] = phase_integrand(&state[..n], reference, &self.scales);
        if self.kind == Kind::Cycle {
            values[1] = scalars.iter().zip(self.stand_in).map(|(scalar, factor)| *scalar * factor).sum();
            return;
        }
        let product = |a: &dyn Fn(usize) -> T, b: &dyn Fn(usize) -> T| -> T {
            (0..n).map(|index| a(index) * b(index) / (self.scales[index] * self.scales[index])).sum()
        };
        let v = |index: usize| state[n + index];
        if self.kind == Kind::BranchPoint {
            return self.adjoint_conditions(reference.time, state, scalars, values);
        }
        values[1] = product(&v, &v) - 1.0;
        match self.kind {
            Kind::Doubling | Kind::BranchPoint | Kind::Cycle => {}
            Kind::Fold => {
                let beta = scalars[1] / self.period_scale;
                values[1] += beta * beta;
                values[2] = product(&v, &|index| T::from(reference.slope[index]));
            }
            Kind::Torus => {
                let w = |index: usize| state[2 * n + index];
                values[1] += product(&w, &w);
                values[2] = product(&v, &|index| T::from(reference.state[2 * n + index]))
                    - product(&w, &|index| T::from(reference.state[n + index]));
                values[3] = product(&v, &|index| T::from(reference.slope[index]));
                values[4] = product(&w, &|index| T::from(reference.slope[index]));
            }
        }
    }
}

impl Defining<'_> {
    /// The active parameters with the unknowns that take their places.
    #[inline]
    fn replaced<T: Scalar, R: Scalar>(&self, scalars: &[T], lift: impl Fn(T) -> R) -> Vec<(usize, R)> {
        let own = self.kind.own_scalars();
        let first = (self.active, lift(scalars[1 + own]));
        std::iter::once(first).chain(self.second.map(|index| (index, lift(scalars[2 + own])))).collect()
    }

    /// Writes the field in the segment of a time.
    #[inline]
    fn velocity<T: Scalar, R: FieldScalar>(
        &self,
        time: f64,
        scalars: &[T],
        lift: impl Fn(T) -> R,
        state: &[R],
        derivative: &mut [R],
    ) {
        let own = self.kind.own_scalars();
        let first = (self.active, lift(scalars[1 + own]));
        let second = self.second.map(|index| (index, lift(scalars[2 + own])));
        match &self.segments {
            None => with_parameters(&self.parameters, [first].into_iter().chain(second), |parameters| {
                self.field.evaluate(state, parameters, derivative);
            }),
            Some(segments) => {
                let course = segments.course_at(time);
                match second {
                    Some(second) => course.velocity(self.field, state, &[first, second], derivative),
                    None => course.velocity(self.field, state, &[first], derivative),
                }
            }
        }
    }

    /// The field with its derivative in the direction `direction` of the state, or in the first active parameter for the
    /// index behind the states.
    #[inline]
    fn derivative_in<T: JacobianScalar>(
        &self,
        (direction, time): (usize, f64),
        state: &[T],
        scalars: &[T],
        values: &mut [Dual<T, 1>],
    ) {
        let n = self.scales.len();
        let duals: Vec<Dual<T, 1>> =
            (0..n).map(|index| Dual::variable(state[index], usize::from(index != direction))).collect();
        let lift = |value: T| Dual { value, derivatives: [T::zero()] };
        if direction < n {
            return self.velocity(time, scalars, lift, &duals, values);
        }
        let own = self.kind.own_scalars();
        let mut moved = vec![lift(T::zero()); scalars.len()];
        for (entry, scalar) in moved.iter_mut().zip(scalars) {
            *entry = lift(*scalar);
        }
        moved[1 + own].derivatives[0] = T::one();
        self.velocity(time, &moved, |value| value, &duals, values);
    }

    #[inline]
    fn flow<T: JacobianScalar>(&self, time: f64, state: &[T], scalars: &[T], derivative: &mut [T]) {
        self.velocity(time, scalars, |value| value, state, derivative);
        derivative.iter_mut().for_each(|entry| *entry *= scalars[0]);
    }

    #[inline]
    fn adjoint<T: JacobianScalar>(&self, time: f64, state: &[T], scalars: &[T], derivative: &mut [T]) {
        let n = self.scales.len();
        let (period, perturbation, multiple) = (scalars[0], scalars[1], scalars[2]);
        let mut values = vec![Dual::<T, 1>::zero(); n];
        for direction in 0..n {
            self.derivative_in((direction, time), state, scalars, &mut values);
            let sum: T = (0..n).map(|row| state[n + row] * values[row].derivatives[0]).sum();
            derivative[n + direction] = -(sum * period);
        }
        for index in 0..n {
            let square = self.scales[index] * self.scales[index];
            derivative[index] = values[index].value * period + perturbation * state[n + index] * square;
            derivative[n + index] += multiple * values[index].value / square;
        }
    }

    #[inline]
    fn adjoint_conditions<T: JacobianScalar>(&self, time: f64, state: &[T], scalars: &[T], values: &mut [T]) {
        let n = self.scales.len();
        let mut slopes = vec![Dual::<T, 1>::zero(); n];
        self.derivative_in((n, time), state, scalars, &mut slopes);
        let mut sums = [T::zero(); 3];
        for index in 0..n {
            let psi = state[n + index];
            let scaled = psi * self.scales[index];
            sums[0] += scaled * scaled;
            sums[1] += psi * slopes[index].value * self.period_scale;
            sums[2] += psi * slopes[index].derivatives[0] * self.period_scale * self.parameter_scale;
        }
        values[1] = sums[0] - 1.0;
        values[2] = sums[1];
        values[3] = sums[2];
    }

    /// A jump of the cycle and of the eigenfunctions, by the linearised one.
    fn variational_jump<T: JacobianScalar, const K: usize>(
        &self,
        index: usize,
        before: &[T],
        scalars: &[T],
        after: &mut [T],
    ) where
        Dual<T, K>: FieldScalar,
    {
        let Some(segments) = &self.segments else { return };
        let n = self.scales.len();
        let lifted = lifted::<T, K>(before, n);
        let mut values = vec![Dual::<T, K>::zero(); n];
        let replaced = self.replaced(scalars, Dual::constant);
        segments.jump(self.field, index, &lifted, scalars[0].value(), &replaced, &mut values);
        for (component, value) in values.iter().enumerate() {
            after[component] = value.value;
            for (direction, slope) in value.derivatives.iter().enumerate() {
                after[(direction + 1) * n + component] = *slope;
            }
        }
    }

    /// A jump of the cycle and of the adjoint eigenfunction; not numbers where the field jumps, which these equations leave out.
    fn adjoint_jump<T: JacobianScalar>(&self, index: usize, before: &[T], scalars: &[T], after: &mut [T]) {
        let Some(segments) = &self.segments else { return };
        let n = self.scales.len();
        let (states, adjoint) = before.split_at(n);
        let replaced = self.replaced(scalars, Dual::constant);
        let mut values = vec![Dual::<T, 1>::zero(); n];
        after[n..].copy_from_slice(adjoint);
        for direction in 0..n {
            let lifted: Vec<Dual<T, 1>> = (0..n)
                .map(|component| Dual::variable(states[component], usize::from(component != direction)))
                .collect();
            segments.jump(self.field, index, &lifted, scalars[0].value(), &replaced, &mut values);
            let jumps = values.iter().enumerate().any(|(row, value)| {
                let identity = if row == direction { 1.0 } else { 0.0 };
                let scaled = self.scales[direction] / self.scales[row];
                (value.derivatives[0].value() - identity).abs() * scaled > KINK_ONLY
            });
            if jumps {
                after[n..].fill(T::from(f64::NAN));
            }
        }
        for (entry, value) in after.iter_mut().zip(&values) {
            *entry = value.value;
        }
    }

    #[inline]
    fn variational<T: JacobianScalar, const K: usize>(
        &self,
        time: f64,
        state: &[T],
        scalars: &[T],
        derivative: &mut [T],
    ) where
        Dual<T, K>: FieldScalar,
    {
        let n = self.scales.len();
        let mut values = vec![Dual::<T, K>::zero(); n];
        let duals = lifted::<T, K>(state, n);
        self.velocity(time, scalars, Dual::constant, &duals, &mut values);
        let period = scalars[0];
        for index in 0..n {
            derivative[index] = values[index].value * period;
            for direction in 0..K {
                derivative[(direction + 1) * n + index] = values[index].derivatives[direction] * period;
            }
            match self.kind {
                Kind::Doubling | Kind::BranchPoint | Kind::Cycle => {}
                Kind::Fold => derivative[n + index] += scalars[1] * values[index].value,
                Kind::Torus => {
                    let theta = scalars[1];
                    let flow = values[index].value;
                    derivative[n + index] += theta * state[2 * n + index] + scalars[2] * flow;
                    derivative[2 * n + index] += scalars[3] * flow - theta * state[n + index];
                }
            }
        }
    }
}

/// States with `K` eigenfunctions behind them as dual numbers.
#[inline]
fn lifted<T: Scalar, const K: usize>(state: &[T], n: usize) -> Vec<Dual<T, K>> {
    let lift = |index: usize| {
        let mut dual = Dual::constant(state[index]);
        for (direction, slope) in dual.derivatives.iter_mut().enumerate() {
            *slope = state[(direction + 1) * n + index];
        }
        dual
    };
    (0..n).map(lift).collect()
}

/// Deviation of a linearised jump from the identity up to which the field has a kink there and does not jump.
const KINK_ONLY: f64 = 1e-7;
