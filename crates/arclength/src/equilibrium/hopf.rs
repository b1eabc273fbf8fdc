//! Hopf points: frequency, speed of crossing and first Lyapunov coefficient.

use super::coefficient_error::{self, UncertainEquilibrium};
use super::multilinear::MultilinearForms;
use super::problem::EquilibriumProblem;
use crate::algebraic::{Differentiator, ScaledLu};
use crate::branch::Criticality;
use crate::erased::ErasedField;
use crate::error::Error;
use crate::linear::eigenvectors::{left_eigenvector, right_eigenvector};
use num_complex::Complex64;
use serde::{Deserialize, Serialize};

/// A first Lyapunov coefficient that is smaller than this part of its terms counts as zero.
const DEGENERATE: f64 = 1e-8;

/// A Hopf point, located by Newton's method on its defining system, with its normal form.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct HopfPoint {
    /// All parameters.
    pub parameters: Vec<f64>,
    /// Index of the parameter along which it was found.
    pub active: usize,
    /// Value of that parameter.
    #[serde(rename = "parameter")]
    pub value: f64,
    /// Error estimate of that value.
    pub location_error: f64,
    /// The equilibrium.
    pub state: Vec<f64>,
    /// Angular frequency `omega`, positive.
    pub frequency: f64,
    /// Right eigenvector `q` with `A q = i omega q`, `<q, q> = 1`, its largest component real and positive.
    pub eigenvector: Vec<Complex64>,
    /// Derivative of the real part of the critical eigenvalue with respect to the parameter; `None` where the equilibrium
    /// is not locally a function of the parameter.
    pub crossing_speed: Option<f64>,
    /// First Lyapunov coefficient in Kuznetsov's scaling, `Re(...)/(2 omega)` with `<q, q> = <p, q> = 1`; `None` where it
    /// does not exist because another eigenvalue is zero.
    pub first_lyapunov: Option<f64>,
    /// Error of that coefficient: how much it changes where the equilibrium moves by its own error.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub first_lyapunov_error: Option<f64>,
    /// The first Lyapunov coefficient times `omega`, MatCont's scaling: the real part of the coefficient of `z |z|^2`.
    pub c1_real: Option<f64>,
    /// Sense of the bifurcation; degenerate where the coefficient is zero within its error.
    pub criticality: Criticality,
}

impl HopfPoint {
    /// The Hopf point at a located equilibrium with an eigenvalue `i frequency`.
    pub(crate) fn at(
        problem: &EquilibriumProblem<'_>,
        unknown: &[f64],
        scales: &[f64],
        frequency: f64,
        location_error: f64,
    ) -> Result<Self, Error> {
        let n = problem.dimension;
        let state = unknown[..n].to_vec();
        let parameters = problem.parameters_at(&unknown[n..]);
        let active = problem.active[0];
        let local = CriticalPair::at(problem.field, &state, &parameters, frequency, scales)?;
        let first = local.first_lyapunov();
        let equilibrium =
            UncertainEquilibrium::on_branch(problem, (&state, &parameters), scales, location_error);
        let near = |state: &[f64], parameters: &[f64]| {
            CriticalPair::at(problem.field, state, parameters, frequency, scales).ok()
        };
        let first_lyapunov_error = first.and_then(|(value, _)| {
            let [error] = coefficient_error::errors([value], equilibrium, |state, parameters| {
                near(state, parameters)?.first_lyapunov().map(|(value, _)| [value])
            })?;
            Some(error)
        });
        // Next to a zero eigenvalue or a pair at twice the frequency the coefficient has a pole, at which not even its size is known. Where
        // the field itself is linear but for rounding its size is no better known, and it is zero within its error.
        let first = first.filter(|(_, size)| {
            first_lyapunov_error.is_none_or(|error| error < *size)
                || local.responses().is_some_and(|known| {
                    let there = |state: &[f64], parameters: &[f64]| near(state, parameters)?.responses();
                    let errors = coefficient_error::errors(known, equilibrium, there);
                    errors.is_some_and(|errors| errors.iter().zip(&known).all(|(error, size)| error < size))
                })
        });
        let first_lyapunov_error = first.and(first_lyapunov_error);
        let criticality = match (first, first_lyapunov_error) {
            (Some((value, size)), Some(error)) if value.abs() > error.max(DEGENERATE * size) => {
                if value < 0.0 { Criticality::Supercritical } else { Criticality::Subcritical }
            }
            _ => Criticality::Degenerate,
        };
        Ok(Self {
            first_lyapunov_error,
            crossing_speed: local.crossing_speed(active),
            first_lyapunov: first.map(|(value, _)| value),
            c1_real: first.map(|(value, _)| value * frequency),
            criticality,
            eigenvector: local.right,
            value: parameters[active],
            parameters,
            active,
            location_error,
            state,
            frequency,
        })
    }
}

/// An equilibrium with the eigenvalues `+-i frequency`, its eigenvectors and linear solves: what Hopf normal forms need.
#[derive(Clone, Debug)]
pub(crate) struct CriticalPair<'a> {
    field: ErasedField<'a>,
    state: Vec<f64>,
    parameters: Vec<f64>,
    pub frequency: f64,
    scales: Vec<f64>,
    matrix: Vec<f64>,
    /// `q`, `<q, q> = 1`.
    pub right: Vec<Complex64>,
    /// `p`, `A' p = -i omega p`, `<p, q> = 1`.
    pub left: Vec<Complex64>,
}

/// `sum conj(a) b`.
pub(crate) fn inner(a: &[Complex64], b: &[Complex64]) -> Complex64 {
    a.iter().zip(b).map(|(a, b)| a.conj() * b).sum()
}

impl<'a> CriticalPair<'a> {
    pub(crate) fn at(
        field: ErasedField<'a>,
        state: &[f64],
        parameters: &[f64],
        frequency: f64,
        scales: &[f64],
    ) -> Result<Self, Error> {
        let n = state.len();
        let mut matrix = vec![0.0; n * n];
        let mut residual = vec![0.0; n];
        let problem = EquilibriumProblem::new(field, parameters, &[]);
        Differentiator::default().jacobian(&problem, state, &mut residual, &mut matrix, n);
        let failed = |_| Error::Eigenvalues { quantity: "eigenvectors of the Hopf point" };
        let eigenvalue = Complex64::new(0.0, frequency);
        let right = right_eigenvector(&matrix, n, eigenvalue).map_err(failed)?.vector;
        let mut left = left_eigenvector(&matrix, n, eigenvalue).map_err(failed)?.vector;
        let product = inner(&left, &right);
        left.iter_mut().for_each(|entry| *entry /= product.conj());
        let scales = scales[..n].to_vec();
        Ok(Self {
            field,
            state: state.to_vec(),
            parameters: parameters.to_vec(),
            frequency,
            scales,
            matrix,
            right,
            left,
        })
    }

    pub(crate) fn forms(&self) -> MultilinearForms<'_> {
        MultilinearForms { field: self.field, state: &self.state, parameters: &self.parameters }
    }

    /// Solves `(shift - A) y = right_hand_side`; `None` if singular.
    pub(crate) fn resolvent(
        &self,
        shift: Complex64,
        right_hand_side: &[Complex64],
    ) -> Option<Vec<Complex64>> {
        self.bordered_resolvent(shift, right_hand_side, false)
    }

    /// Solves `(i frequency - A) y = right_hand_side`, `<p, y> = 0`, where `<p, right_hand_side> = 0`.
    pub(crate) fn critical_resolvent(&self, right_hand_side: &[Complex64]) -> Option<Vec<Complex64>> {
        self.bordered_resolvent(Complex64::new(0.0, self.frequency), right_hand_side, true)
    }

    fn bordered_resolvent(
        &self,
        shift: Complex64,
        right_hand_side: &[Complex64],
        bordered: bool,
    ) -> Option<Vec<Complex64>> {
        // As a real system: the complex number a + i b is the block (a, -b; b, a).
        let n = self.state.len();
        let half = n + usize::from(bordered);
        let m = 2 * half;
        let mut matrix = vec![0.0; m * m];
        let mut put = |row: usize, column: usize, value: Complex64| {
            matrix[row + m * column] += value.re;
            matrix[half + row + m * (half + column)] += value.re;
            matrix[half + row + m * column] += value.im;
            matrix[row + m * (half + column)] -= value.im;
        };
        for column in 0..n {
            for row in 0..n {
                put(row, column, Complex64::from(-self.matrix[row + n * column]));
            }
            put(column, column, shift);
            if bordered {
                put(n, column, self.left[column].conj());
                put(column, n, self.right[column]);
            }
        }
        let mut columns = self.scales.clone();
        columns.resize(half, 1.0);
        columns.extend_from_within(..);
        let mut lu = ScaledLu::default();
        if lu.factorize(m, &matrix, &columns) == 0.0 {
            return None;
        }
        let mut vector = vec![0.0; m];
        for (index, entry) in right_hand_side.iter().enumerate() {
            (vector[index], vector[half + index]) = (entry.re, entry.im);
        }
        lu.solve(&mut vector);
        if vector.iter().any(|entry| !entry.is_finite()) {
            return None;
        }
        Some((0..n).map(|index| Complex64::new(vector[index], vector[half + index])).collect())
    }

    /// Sizes of what the resolvents of the first Lyapunov coefficient make of a vector in no special direction: large next to its poles.
    fn responses(&self) -> Option<[f64; 2]> {
        let generic = self.scales.iter().enumerate();
        let generic: Vec<Complex64> = generic
            .map(|(index, scale)| Complex64::from(self.frequency * scale * (1.0 + (index as f64).sin())))
            .collect();
        let size = |shift: f64| {
            let response = self.resolvent(Complex64::new(0.0, shift), &generic)?;
            let squares = response.iter().zip(&self.scales).map(|(entry, scale)| (entry / scale).norm_sqr());
            Some(squares.sum::<f64>().sqrt())
        };
        Some([size(0.0)?, size(2.0 * self.frequency)?])
    }

    /// First Lyapunov coefficient (Kuznetsov, *Elements of Applied Bifurcation Theory*, equation 5.34) and the sum of
    /// the moduli of its terms.
    pub(crate) fn first_lyapunov(&self) -> Option<(f64, f64)> {
        let forms = self.forms();
        let q = &self.right;
        let conjugate: Vec<Complex64> = q.iter().map(Complex64::conj).collect();
        let cubic = forms.complex(&[q, q, &conjugate]);
        // A^-1 B(q, conj q) with the sign that (0 - A)^-1 gives.
        let constant = self.resolvent(Complex64::ZERO, &forms.complex(&[q, &conjugate]))?;
        let double = self.resolvent(Complex64::new(0.0, 2.0 * self.frequency), &forms.complex(&[q, q]))?;
        let terms = [
            inner(&self.left, &cubic),
            inner(&self.left, &forms.complex(&[q, &constant])) * 2.0,
            inner(&self.left, &forms.complex(&[&conjugate, &double])),
        ];
        let scale = 0.5 / self.frequency;
        let value = scale * terms.iter().map(|term| term.re).sum::<f64>();
        let size = scale * terms.iter().map(|term| term.norm()).sum::<f64>();
        (value.is_finite() && size.is_finite()).then_some((value, size))
    }

    /// Derivative of the critical eigenvalue's real part with respect to a parameter, along the branch.
    fn crossing_speed(&self, active: usize) -> Option<f64> {
        let n = self.state.len();
        let forms = self.forms();
        let mut along = vec![0.0; n + self.parameters.len()];
        along[n + active] = 1.0;
        let slope: Vec<Complex64> = forms.real(&[&along]).into_iter().map(Complex64::from).collect();
        // x' = -A^-1 f_p.
        let response = self.resolvent(Complex64::ZERO, &slope)?;
        let direction: Vec<Complex64> =
            response.into_iter().chain(along[n..].iter().map(|&entry| Complex64::from(entry))).collect();
        let speed = inner(&self.left, &forms.complex(&[&self.right, &direction])).re;
        speed.is_finite().then_some(speed)
    }
}
