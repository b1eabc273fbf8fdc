//! Defining systems of special equilibria, regular at generic ones so that Newton's method locates them.
//!
//! With one active parameter the systems are square; with two their solutions are curves. Sources: Moore
//! and Spence, *SIAM J. Numer. Anal.* 17 (1980), for folds; Roose and Hlavacek, *SIAM J. Appl. Math.* 45
//! (1985), for Hopf points, here as two first-order equations so that nothing is squared; Moore, *Numer.
//! Funct. Anal. Optim.* 2 (1980), for branch points.

use super::problem::EquilibriumProblem;
use crate::algebraic::AlgebraicEquations;
use crate::differentiation::Scalar;
use crate::erased::NarrowScalar;

/// Inner product of a vector with a fixed one.
pub(crate) fn against<T: Scalar>(fixed: &[f64], vector: &[T]) -> T {
    vector.iter().zip(fixed).map(|(&entry, &weight)| entry * weight).sum()
}

/// Splits `unknown` into the parts of the given lengths and the rest.
pub(crate) fn parts<T, const N: usize>(mut unknown: &[T], lengths: [usize; N]) -> ([&[T]; N], &[T]) {
    let split = lengths.map(|length| {
        let (part, rest) = unknown.split_at(length);
        unknown = rest;
        part
    });
    (split, unknown)
}

/// State and parameters, the unknowns of the equilibrium problem, out of a longer list of unknowns.
pub(crate) fn equilibrium<T: Scalar>(state: &[T], values: &[T]) -> Vec<T> {
    state.iter().chain(values).copied().collect()
}

/// Folds: `f = 0`, `f_x v = 0`, `<normal, v> = 1` with the unknowns `(x, v, parameters)`.
#[derive(Clone, Debug)]
pub(crate) struct FoldSystem<'a> {
    pub equilibria: EquilibriumProblem<'a>,
    pub normal: Vec<f64>,
    /// Left null vector at the last point of a curve; empty at first.
    pub left: Vec<f64>,
}

impl AlgebraicEquations for FoldSystem<'_> {
    fn unknowns(&self) -> usize {
        2 * self.equilibria.dimension + self.equilibria.active.len()
    }

    fn equations(&self) -> usize {
        2 * self.equilibria.dimension + 1
    }

    fn evaluate<T: NarrowScalar>(&self, unknown: &[T], residual: &mut [T]) {
        let n = self.equilibria.dimension;
        let ([state, vector], values) = parts(unknown, [n, n]);
        let (field, rest) = residual.split_at_mut(n);
        let (image, rest) = rest.split_at_mut(n);
        self.equilibria.derivative_along(&equilibrium(state, values), vector, field, image);
        rest[0] = against(&self.normal, vector) - 1.0;
    }
}

/// Hopf points and neutral saddles: `f = 0`, `f_x v = rate w`, `f_x w = -kappa rate v`, `<normal, v> = 1`,
/// `<conormal, v> = 0` with the unknowns `(x, v, w, kappa, parameters)`.
///
/// The eigenvalues are `+-rate sqrt(-kappa)`: imaginary at a Hopf point, where `kappa` is positive, real at a
/// neutral saddle, where it is negative. The system is regular at a Bogdanov-Takens point in between.
#[derive(Clone, Debug)]
pub(crate) struct HopfSystem<'a> {
    pub equilibria: EquilibriumProblem<'a>,
    pub normal: Vec<f64>,
    pub conormal: Vec<f64>,
    pub rate: f64,
}

impl AlgebraicEquations for HopfSystem<'_> {
    fn unknowns(&self) -> usize {
        3 * self.equilibria.dimension + 1 + self.equilibria.active.len()
    }

    fn equations(&self) -> usize {
        3 * self.equilibria.dimension + 2
    }

    fn evaluate<T: NarrowScalar>(&self, unknown: &[T], residual: &mut [T]) {
        let n = self.equilibria.dimension;
        let ([state, first, second, kappa], values) = parts(unknown, [n, n, n, 1]);
        let point = equilibrium(state, values);
        let (field, rest) = residual.split_at_mut(n);
        let (first_image, rest) = rest.split_at_mut(n);
        let (second_image, rest) = rest.split_at_mut(n);
        self.equilibria.derivative_along(&point, first, field, first_image);
        self.equilibria.derivative_along(&point, second, field, second_image);
        for index in 0..n {
            first_image[index] = first_image[index] * (1.0 / self.rate) - second[index];
            second_image[index] = second_image[index] * (1.0 / self.rate) + kappa[0] * first[index];
        }
        rest[0] = against(&self.normal, first) - 1.0;
        rest[1] = against(&self.conormal, first);
    }
}

/// Branch points of curves in the first active parameter: `f + beta psi = 0`, `f_x' psi = 0`, `f_p . psi = 0`,
/// `<normal, psi> = 1` with the unknowns `(x, psi, beta, parameters)`; `beta` is zero at a branch point of the field
/// itself. Components are divided by `scales` where vectors of states and of rates meet.
#[derive(Clone, Debug)]
pub(crate) struct BranchPointSystem<'a> {
    pub equilibria: EquilibriumProblem<'a>,
    pub normal: Vec<f64>,
    /// Sizes of the states; the perturbation is `beta psi scales^2`, so that units match.
    pub scales: Vec<f64>,
    /// Size of `beta`: the largest modulus of an eigenvalue.
    pub rate: f64,
}

impl AlgebraicEquations for BranchPointSystem<'_> {
    fn unknowns(&self) -> usize {
        2 * self.equilibria.dimension + 1 + self.equilibria.active.len()
    }

    fn equations(&self) -> usize {
        2 * self.equilibria.dimension + 2
    }

    fn evaluate<T: NarrowScalar>(&self, unknown: &[T], residual: &mut [T]) {
        let n = self.equilibria.dimension;
        let ([state, left, beta], values) = parts(unknown, [n, n, 1]);
        let point = equilibrium(state, values);
        let mut direction = vec![T::zero(); n + 1];
        let mut image = vec![T::zero(); n];
        let (field, rest) = residual.split_at_mut(n);
        for column in 0..=n {
            direction[column] = T::one();
            self.equilibria.derivative_along(&point, &direction, field, &mut image);
            direction[column] = T::zero();
            rest[column] = image.iter().zip(left).map(|(&slope, &weight)| slope * weight).sum();
        }
        for index in 0..n {
            field[index] += beta[0] * left[index] * (self.scales[index] * self.scales[index]);
        }
        rest[n + 1] = against(&self.normal, left) - 1.0;
    }
}
