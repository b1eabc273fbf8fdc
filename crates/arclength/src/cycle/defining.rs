//! Defining systems of the special cycles: the cycle together with its critical eigenfunction.
//!
//! Each is a periodic boundary value problem of its own that is regular at the special cycle, so that
//! Newton's method locates it and, with a second parameter, continuation follows it. Scalars are
//! `(T, kind's own, p, second p)`. Source: Kuznetsov, *Elements of Applied Bifurcation Theory*, 3rd edition
//! (2004), section 10.4; Doedel, Govaerts and Kuznetsov, "Computation of periodic solution bifurcations in
//! ODEs using bordered systems", SIAM J. Numer. Anal. 41 (2003).

use super::limit_cycle::{phase_integrand, with_parameters};
use super::problem::{PeriodicProblem, Reference};
use crate::differentiation::{Dual, Scalar};
use crate::erased::ErasedField;
use crate::field::VectorField;

/// Which special cycle a defining system is for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// Fold: `v' = T f_x v + beta f`, `v` periodic; own scalar `beta`.
    Fold,
    /// Period doubling: `v' = T f_x v`, `v` antiperiodic; no own scalar.
    Doubling,
    /// Torus bifurcation: `(v + i w)' = (T f_x - i theta)(v + i w)`, periodic; own scalar `theta`.
    Torus,
}

impl Kind {
    /// Number of own scalars.
    pub fn own_scalars(self) -> usize {
        match self {
            Self::Fold | Self::Torus => 1,
            Self::Doubling => 0,
        }
    }

    /// Number of real eigenfunctions.
    pub fn eigenfunctions(self) -> usize {
        match self {
            Self::Fold | Self::Doubling => 1,
            Self::Torus => 2,
        }
    }
}

/// The defining system of a special cycle.
#[derive(Debug)]
pub struct Defining<'a> {
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
}

impl PeriodicProblem for Defining<'_> {
    #[inline]
    fn dimension(&self) -> usize {
        self.scales.len() * (1 + self.kind.eigenfunctions())
    }

    #[inline]
    fn scalars(&self) -> usize {
        3 + self.kind.own_scalars()
    }

    #[inline]
    fn is_antiperiodic(&self, component: usize) -> bool {
        self.kind == Kind::Doubling && component >= self.scales.len()
    }

    #[inline]
    fn field<T: Scalar>(&self, state: &[T], scalars: &[T], derivative: &mut [T]) {
        match self.kind {
            Kind::Torus => self.variational::<T, 2>(state, scalars, derivative),
            Kind::Fold | Kind::Doubling => self.variational::<T, 1>(state, scalars, derivative),
        }
    }

    #[inline]
    fn integrands<T: Scalar>(&self, state: &[T], scalars: &[T], reference: Reference<'_>, values: &mut [T]) {
        let n = self.scales.len();
        values[0] = phase_integrand(&state[..n], reference, &self.scales);
        let product = |a: &dyn Fn(usize) -> T, b: &dyn Fn(usize) -> T| -> T {
            (0..n).map(|index| a(index) * b(index) / (self.scales[index] * self.scales[index])).sum()
        };
        let v = |index: usize| state[n + index];
        values[1] = product(&v, &v) - 1.0;
        match self.kind {
            Kind::Doubling => {}
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
            }
        }
    }
}

impl Defining<'_> {
    #[inline]
    fn variational<T: Scalar, const K: usize>(&self, state: &[T], scalars: &[T], derivative: &mut [T]) {
        let n = self.scales.len();
        let own = self.kind.own_scalars();
        let mut values = vec![Dual::<T, K>::zero(); n];
        let duals: Vec<Dual<T, K>> = (0..n)
            .map(|index| {
                let mut dual = Dual::constant(state[index]);
                for (direction, slope) in dual.derivatives.iter_mut().enumerate() {
                    *slope = state[(direction + 1) * n + index];
                }
                dual
            })
            .collect();
        let first = (self.active, Dual::constant(scalars[1 + own]));
        let second = self.second.map(|index| (index, Dual::constant(scalars[2 + own])));
        let both;
        let one;
        let replaced: &[(usize, Dual<T, K>)] = match second {
            Some(second) => {
                both = [first, second];
                &both
            }
            None => {
                one = [first];
                &one
            }
        };
        with_parameters(&self.parameters, replaced, |parameters| {
            self.field.evaluate(&duals, parameters, &mut values);
        });
        let period = scalars[0];
        for index in 0..n {
            derivative[index] = values[index].value * period;
            for direction in 0..K {
                derivative[(direction + 1) * n + index] = values[index].derivatives[direction] * period;
            }
            match self.kind {
                Kind::Doubling => {}
                Kind::Fold => derivative[n + index] += scalars[1] * values[index].value,
                Kind::Torus => {
                    let theta = scalars[1];
                    derivative[n + index] += theta * state[2 * n + index];
                    derivative[2 * n + index] -= theta * state[n + index];
                }
            }
        }
    }
}
