//! Folds of curves of solutions of an algebraic problem, located by their defining system.
//!
//! `F = 0`, `F_x v = 0`, `<normal, v> = 1` with the unknowns `(x, v, p)` is regular at a fold (Moore and Spence, *SIAM J.
//! Numer. Anal.* 17 (1980), equation 2.1).

use super::{AlgebraicEquations, AlgebraicProblem, solve_square};
use crate::differentiation::{Dual, Scalar};
use crate::erased::NarrowScalar;
use crate::error::Error;

struct FoldSystem<'a, P> {
    problem: &'a P,
    normal: Vec<f64>,
}

impl<P: AlgebraicProblem> AlgebraicEquations for FoldSystem<'_, P> {
    fn unknowns(&self) -> usize {
        2 * self.normal.len() + 1
    }

    fn equations(&self) -> usize {
        self.unknowns()
    }

    fn evaluate<T: NarrowScalar>(&self, unknown: &[T], residual: &mut [T]) {
        let n = self.normal.len();
        let (state, rest) = unknown.split_at(n);
        let (vector, parameter) = rest.split_at(n);
        let direction = vector.iter().copied().chain([T::zero()]);
        let lifted: Vec<Dual<T, 1>> = state
            .iter()
            .chain(parameter)
            .zip(direction)
            .map(|(&value, slope)| Dual { value, derivatives: [slope] })
            .collect();
        let mut values = vec![Dual::zero(); n];
        self.problem.evaluate(&lifted, &mut values);
        for (index, value) in values.iter().enumerate() {
            residual[index] = value.value;
            residual[n + index] = value.derivatives[0];
        }
        let product: T = vector.iter().zip(&self.normal).map(|(&entry, &weight)| entry * weight).sum();
        residual[2 * n] = product - 1.0;
    }
}

/// The fold near a solution, from the tangent there; `scales` are the sizes of the unknowns.
///
/// # Errors
/// [`Error::NotFound`] when Newton's method does not converge.
pub(super) fn fold_near<P: AlgebraicProblem>(
    problem: &P,
    unknown: &[f64],
    tangent: &[f64],
    scales: &[f64],
) -> Result<Vec<f64>, Error> {
    let n = unknown.len() - 1;
    // Next to a fold the tangent is nearly the null vector.
    let vector = &tangent[..n];
    let dual: Vec<f64> = vector.iter().zip(scales).map(|(entry, scale)| entry / (scale * scale)).collect();
    let square: f64 = vector.iter().zip(&dual).map(|(a, b)| a * b).sum();
    let normal = dual.iter().map(|entry| entry / square).collect();
    let start = [&unknown[..n], vector, &unknown[n..]].concat();
    let sizes = [&scales[..n], &scales[..n], &scales[n..]].concat();
    let solved = solve_square(&FoldSystem { problem, normal }, &start, &sizes)?;
    Ok([&solved.unknown[..n], &solved.unknown[2 * n..]].concat())
}
