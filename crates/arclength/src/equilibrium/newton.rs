//! Finding one equilibrium: damped Newton, then pseudo-transient continuation.
//!
//! Newton's method with the natural monotonicity test, which is invariant under linear transformation of
//! the equations (Deuflhard, *Newton Methods for Nonlinear Problems*, 2004, section 3.3). Where it fails,
//! implicit Euler steps of growing length go with the flow until they turn into Newton's method (Kelley
//! and Keyes, *SIAM J. Numer. Anal.* 35, 1998).

use super::problem::EquilibriumProblem;
use crate::algebraic::scales::natural_scales;
use crate::algebraic::{AlgebraicEquations, Differentiator, ScaledLu};
use crate::branch::check_length;
use crate::erased::ErasedField;
use crate::error::{CorrectionFailure, Error};
use crate::field::VectorField;

/// Newton updates, each with any number of dampings.
const MOST_UPDATES: usize = 100;
/// Smallest damping factor.
const SMALLEST_DAMPING: f64 = 1e-6;
/// Pseudo-transient steps.
const MOST_TRANSIENT_STEPS: usize = 1000;
/// Updates relative to the scales below which only rounding is left to improve.
const CONVERGED: f64 = 1e-10;
/// An update below this cannot be improved on.
const ROUNDING: f64 = 4.0 * f64::EPSILON;

/// The equilibrium of `field` at `parameters` that is found from `start`.
///
/// ```
/// use arclength::{Scalar, VectorField, equilibrium::find_equilibrium};
/// struct Pitchfork;
/// impl VectorField for Pitchfork {
///     fn state_names(&self) -> Vec<String> { vec!["x".into()] }
///     fn parameter_names(&self) -> Vec<String> { vec!["p".into()] }
///     fn evaluate<T: Scalar>(&self, x: &[T], p: &[T], derivative: &mut [T]) {
///         derivative[0] = p[0] * x[0] - x[0].powi(3);
///     }
/// }
/// let x = find_equilibrium(&Pitchfork, &[0.9], &[2.0])?;
/// assert!((x[0] - 2.0_f64.sqrt()).abs() < 1e-15);
/// # Ok::<(), arclength::Error>(())
/// ```
///
/// # Errors
/// [`Error::NotFound`] with the cause when neither Newton's method nor the flow reaches an equilibrium;
/// [`Error::Invalid`] when `start` or `parameters` have the wrong length or are not finite.
pub fn find_equilibrium<F: VectorField>(
    field: &F,
    start: &[f64],
    parameters: &[f64],
) -> Result<Vec<f64>, Error> {
    find_erased(field.erased(), start, parameters)
}

/// As [`find_equilibrium`].
pub(crate) fn find_erased(
    field: ErasedField<'_>,
    start: &[f64],
    parameters: &[f64],
) -> Result<Vec<f64>, Error> {
    check_length("start", start, field.dimension(), "the dimension of the field")?;
    check_length("parameters", parameters, field.parameter_names().len(), "the number of parameters")?;
    let mut search = Search::new(EquilibriumProblem::new(field, parameters, &[]), start);
    match search.regular_newton(start) {
        Ok(state) => Ok(state),
        Err(cause) => search
            .pseudo_transient(start)
            .and_then(|near| search.regular_newton(&near))
            .map_err(|_| Error::NotFound { sought: "equilibrium", cause }),
    }
}

struct Search<'a> {
    problem: EquilibriumProblem<'a>,
    differentiator: Differentiator,
    lu: ScaledLu,
    matrix: Vec<f64>,
    residual: Vec<f64>,
    floors: Vec<f64>,
}

impl<'a> Search<'a> {
    fn new(problem: EquilibriumProblem<'a>, start: &[f64]) -> Self {
        let n = start.len();
        let floors = natural_scales(&problem.field, start, &problem.parameters, &vec![0.0; n]);
        Self {
            problem,
            differentiator: Differentiator::default(),
            lu: ScaledLu::default(),
            matrix: vec![0.0; n * n],
            residual: vec![0.0; n],
            floors,
        }
    }

    /// Field and Jacobian at `state`.
    fn linearize(&mut self, state: &[f64]) -> Result<(), CorrectionFailure> {
        let n = state.len();
        self.differentiator.jacobian(&self.problem, state, &mut self.residual, &mut self.matrix, n);
        let finite = |entries: &[f64]| entries.iter().all(|entry| entry.is_finite());
        match (finite(&self.residual), finite(&self.matrix)) {
            (true, true) => Ok(()),
            (true, false) => Err(CorrectionFailure::NotDifferentiable),
            (false, _) => Err(CorrectionFailure::NotFinite),
        }
    }

    fn damped_newton(&mut self, start: &[f64]) -> Result<Vec<f64>, CorrectionFailure> {
        let n = start.len();
        let mut state = start.to_vec();
        let mut update = vec![0.0; n];
        let mut simplified = vec![0.0; n];
        let mut trial = vec![0.0; n];
        let mut damping = 1.0_f64;
        let mut best: Option<(f64, Vec<f64>)> = None;
        self.linearize(&state)?;
        for _ in 0..MOST_UPDATES {
            update.copy_from_slice(&self.residual);
            if update.iter().all(|&entry| entry == 0.0) {
                return Ok(state);
            }
            let scales: Vec<f64> =
                state.iter().zip(&self.floors).map(|(value, floor)| value.abs().max(*floor)).collect();
            if self.lu.factorize(n, &self.matrix, &scales) == 0.0 {
                return best.map(|(_, state)| state).ok_or(CorrectionFailure::Singular);
            }
            self.lu.solve(&mut update);
            let size = crate::algebraic::length(&update, &scales);
            if !size.is_finite() {
                return best.map(|(_, state)| state).ok_or(CorrectionFailure::NotFinite);
            }
            if size < CONVERGED {
                state.iter_mut().zip(&update).for_each(|(entry, step)| *entry -= step);
                let stagnates = best.as_ref().is_some_and(|(smallest, _)| size > 0.5 * smallest);
                if best.as_ref().is_none_or(|(smallest, _)| size < *smallest) {
                    best = Some((size, state.clone()));
                }
                if size < ROUNDING || stagnates {
                    break;
                }
                self.linearize(&state)?;
                continue;
            }
            loop {
                for ((entry, here), step) in trial.iter_mut().zip(&state).zip(&update) {
                    *entry = here - damping * step;
                }
                self.problem.evaluate(&trial, &mut simplified);
                self.lu.solve(&mut simplified);
                let simplified_size = crate::algebraic::length(&simplified, &scales);
                let is_smaller = simplified_size <= (1.0 - 0.25 * damping) * size;
                // A step that leaves the domain of the derivatives is as bad as one that leaves that of the field.
                let cause =
                    if is_smaller { self.linearize(&trial) } else { Err(CorrectionFailure::Diverged) };
                if cause.is_ok() {
                    std::mem::swap(&mut state, &mut trial);
                    damping = (2.0 * damping).min(1.0);
                    break;
                }
                damping *= 0.5;
                if damping < SMALLEST_DAMPING {
                    let cause = cause.err().unwrap_or(CorrectionFailure::Diverged);
                    return Err(if simplified_size.is_finite() {
                        cause
                    } else {
                        CorrectionFailure::NotFinite
                    });
                }
            }
        }
        best.map(|(_, state)| state).ok_or(CorrectionFailure::Diverged)
    }

    /// As [`damped_newton`](Self::damped_newton), and the field has derivatives at the equilibrium itself: where a state is zero but
    /// for rounding, as at the end of the domain of a root, it has them beside it whether or not there are any.
    fn regular_newton(&mut self, start: &[f64]) -> Result<Vec<f64>, CorrectionFailure> {
        let state = self.damped_newton(start)?;
        let is_rounding = |(value, floor): (&f64, &f64)| value.abs() < ROUNDING * floor;
        if state.iter().zip(&self.floors).any(is_rounding) {
            let exact: Vec<f64> = state
                .iter()
                .zip(&self.floors)
                .map(|pair| if is_rounding(pair) { 0.0 } else { *pair.0 })
                .collect();
            self.linearize(&exact)?;
        }
        Ok(state)
    }

    /// Goes with the flow until the field is small.
    fn pseudo_transient(&mut self, start: &[f64]) -> Result<Vec<f64>, CorrectionFailure> {
        /// Reduction of the field after which Newton's method takes over.
        const REDUCTION: f64 = 1e-6;
        let n = start.len();
        let mut state = start.to_vec();
        self.linearize(&state)?;
        let rate = |residual: &[f64], floors: &[f64]| crate::algebraic::length(residual, floors);
        let first = rate(&self.residual, &self.floors);
        let mut current = first;
        let mut time_step = 0.1 / first;
        let mut update = vec![0.0; n];
        for _ in 0..MOST_TRANSIENT_STEPS {
            if current <= REDUCTION * first {
                return Ok(state);
            }
            // (I - h J) dx = h f.
            self.matrix.iter_mut().for_each(|entry| *entry *= -time_step);
            (0..n).for_each(|index| self.matrix[index * (n + 1)] += 1.0);
            update.iter_mut().zip(&self.residual).for_each(|(entry, slope)| *entry = time_step * slope);
            let solvable = self.lu.factorize(n, &self.matrix, &self.floors) != 0.0;
            self.lu.solve(&mut update);
            let trial: Vec<f64> = state.iter().zip(&update).map(|(value, step)| value + step).collect();
            let accepted = solvable && self.linearize(&trial).is_ok();
            let next = rate(&self.residual, &self.floors);
            if !accepted || next > 10.0 * current {
                time_step *= 0.25;
                if time_step * first < 1e-12 {
                    return Err(CorrectionFailure::Diverged);
                }
                self.linearize(&state)?;
                continue;
            }
            time_step *= (current / next).clamp(0.5, 4.0);
            current = next;
            state = trial;
        }
        Err(CorrectionFailure::Diverged)
    }
}
